/* A ball falls on a floor and comes to rest.
 *
 *     cc drop.c -I ../include ../target/release/libbitgrain_capi.a -lm -o drop && ./drop
 */
#include <bitgrain.h>
#include <stdio.h>
#include <stdlib.h>

static void must(int status) {
    if (status != BG_OK) {
        fprintf(stderr, "bitgrain: %s\n", bg_strerror(status));
        exit(1);
    }
}

int main(void) {
    /* Room for one grain and one obstacle, in memory of our own. */
    bg_capacity room = {.size = sizeof room};
    must(bg_capacity_for_bed(1, 1, &room));
    size_t bytes = bg_size(&room);
    void *memory = malloc(bytes);

    /* Units in which density, grain diameter and gravity are 1. No .lo and .hi: open space. A collision at speed 1
     * lasts 216 time steps (bg_collision says so; ten are enough). */
    bg_config config = {
        .size = sizeof config,
        .dt = 1e-4,
        .skin = 0.1,
        .law = {.size = sizeof config.law, .kind = BG_HERTZ_HISTORY,
                .kn = 2e5, .kt = 2.45e5, .gamma_n = 792.0, .gamma_t = 792.0, .mu = 0.5},
    };
    bg_world *world;
    must(bg_init(memory, bytes, &room, &config, &world));

    uint32_t free_grains, floor;
    /* 7: it answers forces along x, y and z. */
    bg_group falls = {.size = sizeof falls, .integrates = 7, .spins = 1, .gravity = {0, 0, -1}};
    must(bg_add_group(world, &falls, &free_grains));
    bg_obstacle plane = {.size = sizeof plane, .kind = BG_PLANE, .direction = {0, 0, 1}};
    must(bg_add_obstacle(world, &plane, &floor));
    bg_grain ball = {.size = sizeof ball, .id = 1, .group = free_grains,
                     .position = {0, 0, 1}, .radius = 0.5, .mass = 0.5236};
    must(bg_insert(world, &ball, 1));

    must(bg_start(world));
    must(bg_step(world, 200000));

    double position[3];
    must(bg_read(world, BG_POSITION, position, 0, 0, 1));
    must(bg_get_obstacle(world, floor, &plane));
    bg_digest digest = {.size = sizeof digest};
    must(bg_get_digest(world, &digest));
    printf("height %.6f, force on the floor %.6f\n", position[2], plane.force[2]);
    for (int k = 0; k < 32; k++) printf("%02x", digest.whole[k]);
    printf("\n");
    free(memory);
    return 0;
}
