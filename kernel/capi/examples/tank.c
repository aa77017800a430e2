/* A tank of liquid: grains are dropped in, sink against its drag, lie on the floor, are pushed by a ball that is driven
 * through them, and leave through a hole, below which they are taken out. The world is saved on the way, and goes on in
 * a larger block of memory.
 *
 *     cc tank.c -I ../include ../target/release/libbitgrain_capi.a -lm -o tank && ./tank
 */
#include <bitgrain.h>
#include <stdio.h>
#include <stdlib.h>

static bg_world *world;

static void must(int status) {
    if (status != BG_OK) {
        bg_fault fault = {.size = sizeof fault};
        if (bg_get_fault(world, &fault) != BG_OK) fault.first = 0;
        fprintf(stderr, "bitgrain: %s (%u)\n", bg_strerror(status), (unsigned)fault.first);
        exit(1);
    }
}

/* Buoyancy of a tenth of the weight, and Stokes' drag, in + - * / only: so the bits are the same everywhere. */
static void liquid(void *user, uint32_t id, const double *x, const double *v, const double *w,
                   double *force, double *torque) {
    const double *drag = user;
    (void)id, (void)x, (void)w, (void)torque;
    for (int a = 0; a < 3; a++) force[a] = -drag[0] * v[a];
    force[2] += 0.1 * v[3];
}

static void gone(void *user, const bg_departure *departure) {
    (void)user;
    printf("step %llu: grain %u leaves at z = %.3f\n", (unsigned long long)departure->step,
           (unsigned)departure->id, departure->position[2]);
}

/* A world in new memory, with room for so many grains. */
static void *make(uint32_t grains) {
    bg_capacity room = {.size = sizeof room};
    must(bg_capacity_for_bed(grains, 2, &room));
    size_t bytes = bg_size(&room);
    void *memory = malloc(bytes);
    bg_config config = {
        .size = sizeof config,
        .periodic = 3, /* along x and y */
        .lo = {0, 0, -10},
        .hi = {6, 6, 20},
        .dt = 1e-3,
        .skin = 0.05,
        .outer_skin = 0.2,
    };
    config.law.size = sizeof config.law;
    must(bg_law_hertz_tsuji(2e4, 0.3, 0.6, 0.5, &config.law));
    must(bg_init(memory, bytes, &room, &config, &world));
    return memory;
}

int main(void) {
    double drag = 0.5;
    void *memory = make(16);
    uint32_t falling, floor, ball;
    bg_group falls = {.size = sizeof falls, .integrates = 7, .spins = 1, .gravity = {0, 0, -1}};
    must(bg_add_group(world, &falls, &falling));
    bg_obstacle plane = {.size = sizeof plane, .kind = BG_PLANE, .direction = {0, 0, 1}};
    must(bg_add_obstacle(world, &plane, &floor));
    bg_obstacle sphere = {.size = sizeof sphere, .kind = BG_SPHERE, .point = {3, 0.8, 0.8}, .radius = 0.6};
    must(bg_add_obstacle(world, &sphere, &ball));
    /* What falls below -1 is taken out. Nothing does, until the floor has moved down. */
    bg_policy policy = {.size = sizeof policy, .takes_out = 1, .drains = 1, .point = {0, 0, -1}, .normal = {0, 0, 1}};
    must(bg_set_policy(world, &policy));
    must(bg_start(world));

    for (uint32_t k = 0; k < 16; k++) {
        bg_grain grain = {.size = sizeof grain, .id = k + 1, .group = falling,
                          .position = {1 + 1.3 * (k % 4), 1 + 1.3 * (k / 4), 3}, .radius = 0.5, .mass = 0.5};
        must(bg_insert(world, &grain, 1));
        must(bg_step_apply(world, 200, liquid, gone, &drag));
    }

    /* On with it in a larger block, at another skin. */
    size_t bytes;
    must(bg_save_size(world, &bytes));
    void *saved = malloc(bytes);
    must(bg_save(world, saved, bytes));
    free(memory);
    memory = make(20);
    must(bg_load(world, saved, bytes));
    free(saved);

    uint32_t out[2] = {3, 7};
    must(bg_remove(world, out, 2));
    double up[3] = {0, 0, 2}, still[3] = {0, 0, 0};
    must(bg_nudge(world, 5, up, still));
    must(bg_drive(world, ball, (double[3]){0, 0.5, 0}));
    must(bg_step_apply(world, 4000, liquid, gone, &drag));
    must(bg_get_obstacle(world, ball, &sphere));
    printf("mean force on the ball %.6f %.6f %.6f\n", sphere.mean_force[0], sphere.mean_force[1], sphere.mean_force[2]);

    must(bg_drive(world, floor, (double[3]){0, 0, -1}));
    must(bg_step_apply(world, 2600, liquid, gone, &drag));
    bg_counts counts = {.size = sizeof counts};
    must(bg_get_counts(world, &counts));
    printf("%u grains, %llu left, %llu steps\n", (unsigned)counts.grains, (unsigned long long)counts.departed,
           (unsigned long long)counts.step);
    bg_digest digest = {.size = sizeof digest};
    must(bg_get_digest(world, &digest));
    for (int k = 0; k < 32; k++) printf("%02x", digest.whole[k]);
    printf("\n");
    free(memory);
    return 0;
}
