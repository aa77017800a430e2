/* Firmware in C around the C library: a ball falls on a floor, in static memory; the digest goes to the debugger, which
 * is here the emulator. No C library, no allocator. */
#include <bitgrain.h>

/* What bg_size says for one grain and one obstacle with 8 pairs, and some more; the firmware checks it. */
static uint64_t memory[420];

void *memcpy(void *to, const void *from, size_t count) {
    for (size_t k = 0; k < count; k++) ((volatile char *)to)[k] = ((const char *)from)[k];
    return to;
}
void *memset(void *to, int byte, size_t count) {
    for (size_t k = 0; k < count; k++) ((volatile char *)to)[k] = (char)byte;
    return to;
}

static void semihosting(int operation, const void *argument) {
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void end(int status) {
    const uint32_t block[2] = {0x20026, (uint32_t)status};
    semihosting(0x20, block);
    for (;;) {}
}

static void must(int status) {
    if (status != BG_OK) {
        semihosting(0x04, bg_strerror(status));
        end(1);
    }
}

static void run(void) {
    bg_capacity room = {.size = sizeof room, .grains = 1, .pairs = 8, .candidates = 8, .obstacle_contacts = 2,
                        .cells = 8, .obstacles = 1, .groups = 1};
    bg_config config = {.size = sizeof config, .dt = 1e-4, .skin = 0.1,
        .law = {.size = sizeof config.law, .kind = BG_HERTZ_HISTORY, .kn = 2e5, .kt = 2.45e5, .gamma_n = 792.0,
                .gamma_t = 792.0, .mu = 0.5}};
    bg_world *world;
    must(bg_init(memory, sizeof memory, &room, &config, &world));
    uint32_t number;
    bg_group falls = {.size = sizeof falls, .integrates = 7, .spins = 1, .gravity = {0, 0, -1}};
    must(bg_add_group(world, &falls, &number));
    bg_obstacle plane = {.size = sizeof plane, .kind = BG_PLANE, .direction = {0, 0, 1}};
    must(bg_add_obstacle(world, &plane, &number));
    bg_grain ball = {.size = sizeof ball, .id = 1, .position = {0, 0, 1}, .radius = 0.5, .mass = 0.5236};
    must(bg_insert(world, &ball, 1));
    must(bg_start(world));
    must(bg_step(world, 12000));
    bg_digest digest = {.size = sizeof digest};
    must(bg_get_digest(world, &digest));
    char text[66];
    for (int k = 0; k < 64; k++) text[k] = "0123456789abcdef"[digest.whole[k / 2] >> (k % 2 ? 0 : 4) & 15];
    text[64] = '\n';
    text[65] = 0;
    semihosting(0x04, text);
    end(0);
}

void reset(void) {
    /* The floating-point unit on, before any of its instructions. */
    *(volatile uint32_t *)0xe000ed88 |= 0xfu << 20;
    __asm__ volatile("dsb\nisb");
    run();
}

static void fault(void) { end(2); }

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    (void *)0x20010000, (void *)reset, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault,
};
