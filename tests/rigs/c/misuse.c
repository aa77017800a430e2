/* Calls the C library wrongly in every way that it promises to refuse. */
#include <bitgrain.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void is(int line, int got, int wanted) {
    if (got != wanted) {
        printf("line %d: %d (%s), not %d\n", line, got, bg_strerror(got), wanted);
        exit(1);
    }
}
#define IS(call, wanted) is(__LINE__, call, wanted)

static bg_world *inner;

static void meddles(void *user, uint32_t id, const double *x, const double *v, const double *w, double *force,
                    double *torque) {
    (void)user, (void)id, (void)x, (void)v, (void)w, (void)force, (void)torque;
    IS(bg_step(inner, 1), BG_BUSY);
    bg_counts counts = {.size = sizeof counts};
    IS(bg_get_counts(inner, &counts), BG_BUSY);
}

int main(void) {
    bg_capacity room = {.size = sizeof room};
    IS(bg_capacity_for_bed(3, 1, NULL), BG_NULL);
    room.size = 4;
    IS(bg_capacity_for_bed(3, 1, &room), BG_BAD_SIZE);
    room.size = sizeof room;
    IS(bg_capacity_for_bed(UINT32_MAX, 1, &room), BG_TOO_SMALL);
    IS(bg_capacity_for_bed(3, 1, &room), BG_OK);
    size_t bytes = bg_size(&room);
    bg_capacity none = room;
    none.cells = 0;
    IS((int)bg_size(&none), 0);
    IS((int)bg_size(NULL), 0);

    bg_config config = {.size = sizeof config, .dt = 1e-3, .skin = 0.1,
        .law = {.size = sizeof config.law, .kind = BG_HERTZ_HISTORY, .kn = 2e4, .kt = 2e4, .gamma_n = 50,
                .gamma_t = 50, .mu = 0.5}};
    bg_world *world = NULL;
    char *memory = malloc(bytes + 1);
    IS(bg_init(NULL, bytes, &room, &config, &world), BG_NULL);
    IS(bg_init(memory, bytes, NULL, &config, &world), BG_NULL);
    IS(bg_init(memory, bytes, &room, NULL, &world), BG_NULL);
    IS(bg_init(memory, bytes, &room, &config, NULL), BG_NULL);
    IS(bg_init(memory + 1, bytes, &room, &config, &world), BG_MISALIGNED);
    IS(bg_init(memory, bytes - 1, &room, &config, &world), BG_TOO_SMALL);
    IS(bg_init(memory, bytes, &none, &config, &world), BG_TOO_SMALL);
    bg_config wrong = config;
    wrong.size--;
    IS(bg_init(memory, bytes, &room, &wrong, &world), BG_BAD_SIZE);
    wrong = config;
    wrong.law.kind = 9;
    IS(bg_init(memory, bytes, &room, &wrong, &world), BG_BAD_ARGUMENT);
    wrong.law = config.law;
    wrong.law.kn = -1;
    IS(bg_init(memory, bytes, &room, &wrong, &world), BG_BAD_LAW);
    double overlap, duration;
    IS(bg_collision(&wrong.law, 0.25, 0.25, 1, &overlap, &duration), BG_BAD_LAW);
    IS(bg_collision(&config.law, 0.25, 0.25, 0, &overlap, &duration), BG_BAD_ARGUMENT);
    IS(bg_collision(&config.law, 0.25, 0.25, 1, NULL, &duration), BG_NULL);
    IS(bg_collision(&config.law, 0.25, 0.25, 1, &overlap, &duration), BG_OK);
    if (!(overlap > 0.015 && overlap < 0.017 && duration > 2.94 * overlap && duration < 2.95 * overlap)) return 5;
    wrong.law = config.law;
    wrong.law.rolling = BG_ROLLING_EPSD2;
    IS(bg_init(memory, bytes, &room, &wrong, &world), BG_LAW_MISFIT);
    wrong.law.rolling = 9;
    IS(bg_init(memory, bytes, &room, &wrong, &world), BG_BAD_ARGUMENT);
    bg_capacity many = room;
    many.materials = 33;
    IS(bg_init(memory, bytes, &many, &config, &world), BG_TOO_SMALL);
    many.materials = 2;
    char *table = malloc(bg_size(&many));
    IS(bg_init(table, bg_size(&many), &many, &config, &world), BG_OK);
    IS(bg_set_pair_law(world, 0, 1, NULL), BG_NULL);
    IS(bg_set_pair_law(world, 0, 1, &config.law), BG_OK);
    IS(bg_set_pair_law(world, 0, 2, &config.law), BG_BAD_ARGUMENT);
    IS(bg_set_pair_law(world, 256, 0, &config.law), BG_BAD_ARGUMENT);
    wrong.law = config.law;
    wrong.law.kind = BG_HERTZ_TSUJI;
    IS(bg_set_pair_law(world, 0, 0, &wrong.law), BG_BAD_ARGUMENT);
    wrong.law = config.law;
    wrong.law.rolling_mu = -1;
    IS(bg_set_pair_law(world, 0, 0, &wrong.law), BG_BAD_LAW);
    uint32_t first = 0;
    bg_group odd = {.size = sizeof odd, .integrates = 7, .spins = 1, .material = 2};
    IS(bg_add_group(world, &odd, &first), BG_OK);
    IS(bg_start(world), BG_UNKNOWN_MATERIAL);
    free(table);
    wrong.law = config.law;
    wrong.periodic = 8;
    IS(bg_init(memory, bytes, &room, &wrong, &world), BG_BAD_ARGUMENT);
    wrong.periodic = 1;
    IS(bg_init(memory, bytes, &room, &wrong, &world), BG_BAD_DOMAIN);

    memset(memory, 0, bytes);
    IS(bg_step((bg_world *)memory, 1), BG_FOREIGN);
    IS(bg_step(NULL, 1), BG_NULL);
    IS(bg_step((bg_world *)(memory + 1), 1), BG_MISALIGNED);
    IS(bg_init(memory, bytes, &room, &config, &world), BG_OK);
    IS(bg_step(world, 1), BG_NOT_STARTED);
    IS(bg_set_pair_law(world, 0, 0, &config.law), BG_LAW_MISFIT);
    uint32_t number = 0;
    bg_group group = {.size = sizeof group, .integrates = 7, .spins = 1, .gravity = {0, 0, -1}};
    IS(bg_add_group(world, &group, NULL), BG_NULL);
    IS(bg_add_group(world, NULL, &number), BG_NULL);
    /* What says yes or no is 1 or 0, and axes are three bits. */
    bg_group yes = group;
    yes.spins = 7;
    IS(bg_add_group(world, &yes, &number), BG_BAD_ARGUMENT);
    yes = group;
    yes.infinite_mass = 2;
    IS(bg_add_group(world, &yes, &number), BG_BAD_ARGUMENT);
    yes = group;
    yes.integrates = 8;
    IS(bg_add_group(world, &yes, &number), BG_BAD_ARGUMENT);
    bg_policy policy = {.size = sizeof policy, .takes_out = 7};
    IS(bg_set_policy(world, &policy), BG_BAD_ARGUMENT);
    policy.takes_out = 0;
    policy.drains = 7;
    IS(bg_set_policy(world, &policy), BG_BAD_ARGUMENT);
    IS(bg_add_group(world, &group, &number), BG_OK);
    bg_obstacle plane = {.size = sizeof plane, .kind = 99, .direction = {0, 0, 1}};
    IS(bg_add_obstacle(world, &plane, &number), BG_BAD_ARGUMENT);
    plane.kind = BG_PLANE;
    plane.curved = 7;
    IS(bg_add_obstacle(world, &plane, &number), BG_BAD_ARGUMENT);
    plane.curved = 0;
    plane.is_free = 7;
    IS(bg_add_obstacle(world, &plane, &number), BG_BAD_ARGUMENT);
    plane.is_free = 0;
    plane.spins = 7;
    IS(bg_add_obstacle(world, &plane, &number), BG_BAD_ARGUMENT);
    plane.spins = 0;
    IS(bg_add_obstacle(world, &plane, &number), BG_OK);
    IS(bg_add_obstacle(world, &plane, &number), BG_BAD_STORAGE);
    bg_obstacle mesh = {.size = sizeof mesh, .kind = BG_PLANE};
    double corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    IS(bg_add_mesh(world, &mesh, corners, 1, &number), BG_BAD_ARGUMENT);
    mesh.kind = BG_MESH;
    IS(bg_add_obstacle(world, &mesh, &number), BG_BAD_ARGUMENT);
    IS(bg_add_mesh(world, &mesh, NULL, 1, &number), BG_NULL);
    IS(bg_add_mesh(world, &mesh, corners, 0, &number), BG_BAD_ARGUMENT);
    IS(bg_add_mesh(world, &mesh, corners, 1, &number), BG_TOO_SMALL);
    bg_grain grains[4];
    memset(grains, 0, sizeof grains);
    for (int k = 0; k < 4; k++) {
        grains[k].size = sizeof grains[k];
        grains[k].id = (uint32_t)(2 * k + 1);
        grains[k].position[0] = 2 * k;
        grains[k].position[2] = 1;
        grains[k].radius = 0.5;
        grains[k].mass = 0.5;
    }
    IS(bg_insert(world, NULL, 1), BG_NULL);
    IS(bg_insert(world, NULL, 0), BG_OK);
    IS(bg_insert(world, grains, SIZE_MAX / 8), BG_BAD_ARGUMENT);
    IS(bg_insert(world, grains, 4), BG_GRAINS_FULL);
    grains[1].group = 256;
    IS(bg_insert(world, grains, 2), BG_BAD_GRAIN);
    grains[1].group = 0;
    grains[1].size = 0;
    IS(bg_insert(world, grains, 2), BG_BAD_SIZE);
    grains[1].size = sizeof grains[1];
    IS(bg_insert(world, grains, 2), BG_OK);
    /* A time step is looked at, and stops nothing. */
    double rayleigh, collides;
    IS(bg_time_step(world, NULL, &collides), BG_NULL);
    IS(bg_time_step(world, &rayleigh, &collides), BG_OK);
    if (!(rayleigh > 0.053 && rayleigh < 0.055 && collides == 0)) return 6;
    wrong = config;
    wrong.dt = 5e-3;
    char *slow = malloc(bytes);
    bg_world *other;
    IS(bg_init(slow, bytes, &room, &wrong, &other), BG_OK);
    IS(bg_add_group(other, &group, &number), BG_OK);
    IS(bg_insert(other, grains, 2), BG_OK);
    IS(bg_time_step(other, &rayleigh, &collides), BG_LONG_TIME_STEP);
    if (!(rayleigh > 0.26 && rayleigh < 0.28)) return 7;
    IS(bg_start(other), BG_OK);
    IS(bg_step(other, 1), BG_OK);
    free(slow);
    IS(bg_start(world), BG_OK);
    IS(bg_insert(world, grains, 1), BG_BAD_ORDER);
    bg_fault fault = {.size = sizeof fault};
    IS(bg_get_fault(world, &fault), BG_OK);
    IS(fault.code, BG_BAD_ORDER);
    IS((int)fault.first, 1);

    double v[3] = {0, 0, 0}, out[9];
    uint32_t unknown = 2;
    IS(bg_remove(world, &unknown, 1), BG_UNKNOWN_GRAIN);
    IS(bg_regroup(world, &unknown, 1, 0), BG_UNKNOWN_GRAIN);
    IS(bg_regroup(world, &unknown, 1, 999), BG_BAD_GRAIN);
    IS(bg_nudge(world, 2, v, v), BG_UNKNOWN_GRAIN);
    IS(bg_nudge(world, 1, NULL, v), BG_NULL);
    IS(bg_drive(world, 1, v), BG_BAD_ARGUMENT);
    IS(bg_get_obstacle(world, 1, &plane), BG_BAD_ARGUMENT);
    const double some[4] = {1, 0, 0, 0};
    IS(bg_turn(world, 1, some), BG_BAD_ARGUMENT);
    /* An endless wall would tilt. */
    const double tilted[4] = {0.8, 0.6, 0, 0};
    IS(bg_turn(world, 0, some), BG_BAD_OBSTACLE);
    IS(bg_drive_to(world, 0, some, tilted, 5), BG_BAD_OBSTACLE);
    IS(bg_get_fault(world, &fault), BG_OK);
    IS((int)fault.first, 0);
    IS(bg_drive_to(world, 0, some, NULL, 5), BG_NULL);
    IS(bg_push(world, 0, some, some), BG_BAD_ARGUMENT);
    IS(bg_read(world, BG_POSITION, out, 0, 0, 3), BG_NO_GRAIN);
    IS(bg_read(world, BG_POSITION, out, 0, SIZE_MAX, 2), BG_NO_GRAIN);
    IS(bg_read(world, BG_POSITION, out, 8, 0, 2), BG_BAD_ARGUMENT);
    IS(bg_read(world, BG_POSITION, NULL, 0, 0, 2), BG_NULL);
    IS(bg_read(world, 99, out, 0, 0, 2), BG_BAD_ARGUMENT);
    IS(bg_read(world, BG_POSITION, out, 0, 0, 2), BG_OK);
    if (out[3] != 2 || out[5] != 1) return 1;

    inner = world;
    IS(bg_step_apply(world, 2, meddles, NULL, NULL), BG_OK);
    IS(bg_step(world, 1), BG_OK);

    size_t needed = 0;
    IS(bg_save_size(world, &needed), BG_OK);
    char *saved = malloc(needed);
    IS(bg_save(world, saved, needed - 1), BG_BUFFER_TOO_SHORT);
    IS(bg_save(world, NULL, needed), BG_NULL);
    IS(bg_save(world, saved, needed), BG_OK);
    for (size_t at = 0; at < needed; at++) {
        saved[at] ^= 4;
        if (bg_load(world, saved, needed) == BG_OK) return 2;
        saved[at] ^= 4;
    }
    IS(bg_step(world, 1), BG_OK);
    IS(bg_load(world, saved, needed - 1), BG_BAD_SAVE);
    IS(bg_load(world, saved, 3), BG_BAD_SAVE);
    IS(bg_load(world, NULL, needed), BG_NULL);
    IS(bg_load(world, saved, needed), BG_OK);

    /* Memory may be moved, and damage is found where it can be known. */
    char *moved = malloc(bytes);
    memcpy(moved, memory, bytes);
    free(memory);
    IS(bg_step((bg_world *)moved, 5), BG_OK);
    moved[bytes - 1] ^= 1;
    IS(bg_step((bg_world *)moved, 1), BG_FOREIGN);
    moved[bytes - 1] ^= 1;
    moved[0] ^= 1;
    IS(bg_step((bg_world *)moved, 1), BG_FOREIGN);
    free(moved);
    free(saved);
    char line[BG_LINE];
    const size_t shape[1] = {2};
    bg_recording recording = {.size = sizeof recording};
    IS(bg_record_begin(NULL, line, sizeof line), BG_NULL);
    IS(bg_record_begin(&recording, line, 10), BG_TOO_SMALL);
    IS(bg_record_begin(&recording, NULL, sizeof line), BG_NULL);
    IS(bg_record_begin(&recording, line, sizeof line), BG_OK);
    IS(bg_record(&recording, 5, NULL, "f64", shape, 1, out, line, sizeof line), BG_NULL);
    IS(bg_record(&recording, 5, "a b", "f64", shape, 1, out, line, sizeof line), BG_BAD_RECORD);
    IS(bg_record(&recording, 5, "x", "double", shape, 1, out, line, sizeof line), BG_BAD_RECORD);
    IS(bg_record(&recording, 5, "x", "f64", NULL, 1, out, line, sizeof line), BG_NULL);
    IS(bg_record(&recording, 5, "x", "f64", shape, 1, NULL, line, sizeof line), BG_NULL);
    IS(bg_record(&recording, 5, "x", "f64", shape, 1, out, line, 9), BG_TOO_SMALL);
    IS(bg_record(&recording, 5, "x", "f64", shape, 1, out, line, sizeof line), BG_OK);
    IS(bg_record(&recording, 4, "x", "f64", shape, 1, out, line, sizeof line), BG_BAD_RECORD);
    IS(bg_record_end(&recording, line, 9), BG_TOO_SMALL);
    IS(bg_record_end(&recording, line, sizeof line), BG_OK);
    if (bg_abi_version() != BG_ABI_VERSION) return 3;
    for (int code = -2; code < 200; code++)
        if (strlen(bg_strerror(code)) < 5) return 4;
    printf("every misuse was refused\n");
    return 0;
}
