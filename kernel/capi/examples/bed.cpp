// A bed of grains in C++: memory in a vector, errors as exceptions, positions read with a stride.
//
//     c++ -std=c++17 bed.cpp -I ../include ../target/release/libbitgrain_capi.a -lm -o bed && ./bed
#include <bitgrain.h>

#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace {

void must(int status) {
    if (status != BG_OK) throw std::runtime_error(bg_strerror(status));
}

template <class T> T sized() {
    T made{};
    made.size = sizeof(T);
    return made;
}

/// A world and its memory.
class World {
  public:
    World(std::uint32_t grains, std::uint32_t obstacles, const bg_config &config) {
        auto room = sized<bg_capacity>();
        must(bg_capacity_for_bed(grains, obstacles, &room));
        memory_.resize((bg_size(&room) + 7) / 8);
        must(bg_init(memory_.data(), 8 * memory_.size(), &room, &config, &world_));
    }
    World(const World &) = delete;
    World &operator=(const World &) = delete;
    operator bg_world *() const { return world_; }

  private:
    std::vector<std::uint64_t> memory_; // 8 bytes each: aligned
    bg_world *world_ = nullptr;
};

struct Particle { // one's own record, into which positions are read
    double position[3];
    float color;
};

} // namespace

int main() try {
    auto config = sized<bg_config>();
    config.periodic = 3;
    const double lo[3] = {0, 0, -1}, hi[3] = {8, 8, 30};
    for (int a = 0; a < 3; a++) {
        config.lo[a] = lo[a];
        config.hi[a] = hi[a];
    }
    config.dt = 2e-4;
    config.skin = 0.02;
    config.outer_skin = 0.1;
    config.law.size = sizeof config.law;
    must(bg_law_hertz_tsuji(1e5, 0.3, 0.5, 0.4, &config.law));

    const int n = 343;
    World world(n, 1, config);
    auto group = sized<bg_group>();
    group.integrates = 7;
    group.spins = 1;
    group.gravity[2] = -1;
    std::uint32_t falling, floor;
    must(bg_add_group(world, &group, &falling));
    auto plane = sized<bg_obstacle>();
    plane.kind = BG_PLANE;
    plane.direction[2] = 1;
    must(bg_add_obstacle(world, &plane, &floor));

    std::vector<bg_grain> grains;
    for (int k = 0; k < n; k++) {
        auto grain = sized<bg_grain>();
        grain.id = static_cast<std::uint32_t>(k);
        grain.group = falling;
        const int place[3] = {k % 7, k / 7 % 7, k / 49};
        for (int a = 0; a < 3; a++) grain.position[a] = 0.6 + 1.12 * place[a] + 0.01 * (k % (a + 3));
        grain.radius = 0.45 + 0.05 * (k % 3) / 2;
        grain.mass = 4.18879 * grain.radius * grain.radius * grain.radius;
        grains.push_back(grain);
    }
    must(bg_insert(world, grains.data(), grains.size()));
    must(bg_start(world));
    must(bg_step(world, 20000));

    std::vector<Particle> particles(n);
    must(bg_read(world, BG_POSITION, particles.data(), sizeof(Particle), 0, n));
    double top = 0;
    for (const auto &particle : particles) top = particle.position[2] > top ? particle.position[2] : top;
    must(bg_get_obstacle(world, floor, &plane));
    std::printf("top %.4f, mean force on the floor %.4f\n", top, plane.mean_force[2]);
    auto digest = sized<bg_digest>();
    must(bg_get_digest(world, &digest));
    for (unsigned byte : digest.whole) std::printf("%02x", byte);
    std::printf("\n");
} catch (const std::exception &error) {
    std::fprintf(stderr, "bitgrain: %s\n", error.what());
    return 1;
}
