//! The times that a step must resolve, of worlds of grains, walls and free bodies.

use bitgrain_kernel::contact::{HertzTsuji, PairLaws};
use bitgrain_kernel::time_step::{ShortestTimes, collision, moduli, rayleigh_time, shortest_times};
use bitgrain_kernel::{Domain, FreeMotion, Group, Motion, Obstacle, Store, start, step};

use crate::common::crowd::{history, tsuji};

type Few = Store<f64, 4, 16, 8, 2>;

/// Grains apart from each other on a line over a floor, each by its radius, mass and velocity along x.
fn over_a_floor(grains: &[(u8, f64, f64, f64)]) -> Few {
    let mut store = Few::new(Domain::open(), 1e-4, 0.1);
    for material in 0..2 {
        let group = Group::free([0.0, 0.0, -1.0]).of_material(material);
        store.add_group(group).unwrap();
    }
    let floor = Obstacle {
        material: 1,
        ..Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0])
    };
    store.add_obstacle(floor).unwrap();
    for (k, (group, radius, mass, speed)) in grains.iter().copied().enumerate() {
        let position = [3.0 * k as f64, 0.0, 2.0];
        let id = k as u32;
        store.add_grain(id, group, position, radius, mass).unwrap();
        store.world().grains.velocity[k][0] = speed;
    }
    store
}

fn density(radius: f64, mass: f64) -> f64 {
    mass / (4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius)
}

fn close(a: f64, b: f64) {
    assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
}

#[test]
fn the_smallest_grain_and_the_fastest_pair_count() {
    let law = history(0.5);
    let mut store = over_a_floor(&[(0, 0.5, 0.6, 2.0), (0, 0.4, 0.2, -3.0)]);
    let times = shortest_times(&store.world(), &law);
    let wave = |radius, mass| rayleigh_time(moduli(law.kn, law.kt), radius, density(radius, mass));
    close(times.rayleigh, wave(0.4, 0.2));
    // Both grains against each other: two of the smaller one would be shorter, but there is only one.
    let (radius, mass) = (0.5 * 0.4 / 0.9, 0.6 * 0.2 / 0.8);
    let least = collision(law.kn, radius, mass, 5.0).1;
    assert!(times.collision <= least);
    assert!(times.collision > 0.8 * least);
    assert!(times.are_resolved_by(1e-4));
    // At rest nothing collides.
    let mut rest = over_a_floor(&[(0, 0.5, 0.6, 0.0)]);
    let times = shortest_times(&rest.world(), &law);
    assert_eq!(times.collision, f64::INFINITY);
    close(times.rayleigh, wave(0.5, 0.6));
    assert_eq!(times.fractions(1.0)[1], 0.0);
    // A grain that is alone meets the floor.
    let mut one = over_a_floor(&[(0, 0.5, 0.6, 2.0)]);
    let times = shortest_times(&one.world(), &law);
    close(times.collision, collision(law.kn, 0.5, 0.6, 2.0).1);
    let none = shortest_times(&over_a_floor(&[]).world(), &law);
    assert_eq!(none.rayleigh, f64::INFINITY);
}

#[test]
fn each_material_counts_with_its_own_stiffness() {
    let (soft, hard) = ([2e4, 0.3], [2e6, 0.3]);
    let laws = [[soft, soft], [soft, hard], [hard, hard]];
    let laws = laws.map(|pair| HertzTsuji::between(pair, 0.6, 0.5));
    let table = PairLaws::new(2, &laws).unwrap();
    let times = |of: u8| {
        let mut store = over_a_floor(&[(of, 0.5, 0.6, 1.0), (of, 0.5, 0.6, 0.0)]);
        shortest_times(&store.world(), &table)
    };
    let (soft, hard) = (times(0), times(1));
    close(soft.rayleigh / hard.rayleigh, 10.0);
    // Soft grains meet the hard floor with twice the stiffness at most.
    assert!(soft.collision > 5.0 * hard.collision);
    // A law that tells no material apart has those of one.
    let mut store = over_a_floor(&[(1, 0.5, 0.6, 1.0)]);
    let alone = shortest_times(&store.world(), &laws[0]);
    close(alone.rayleigh, soft.rayleigh);
}

#[test]
fn a_light_free_body_shortens_both_times() {
    let law = tsuji();
    let with = |mass: f64, speed: f64| {
        let mut store = over_a_floor(&[(0, 0.5, 0.6, 0.0), (0, 0.5, 0.6, 0.0)]);
        let ball = Obstacle {
            inverse_mass: 1.0 / mass,
            velocity: [0.0, speed, 0.0],
            motion: Motion::Free(FreeMotion::new([0.1; 3], [0.0; 3])),
            ..Obstacle::sphere([0.0, 9.0, 9.0], 0.5)
        };
        store.add_obstacle(ball).unwrap();
        shortest_times(&store.world(), &law)
    };
    let (heavy, light) = (with(6.0, 1.0), with(0.006, 1.0));
    close(heavy.rayleigh / light.rayleigh, 10.0);
    assert!(light.collision < 0.3 * heavy.collision);
    // The faster, the shorter, by the fifth root.
    close(with(6.0, 32.0).collision * 2.0, heavy.collision);
}

/// What is above a fifth of the Rayleigh time is said, and stops nothing.
#[test]
fn a_step_of_more_than_a_rayleigh_time_is_said() {
    let law = history(0.5);
    let mut store = over_a_floor(&[(0, 0.5, 0.6, 0.0)]);
    let times: ShortestTimes = shortest_times(&store.world(), &law);
    let mut slow = Few::new(Domain::open(), 1.4 * times.rayleigh, 0.1);
    slow.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    slow.add_grain(1, 0, [0.0, 0.0, 2.0], 0.5, 0.6).unwrap();
    let mut world = slow.world();
    let [fraction, _] = shortest_times(&world, &law).fractions(world.dt);
    close(fraction, 1.4);
    assert!(!times.are_resolved_by(world.dt));
    assert!(
        times.are_resolved_by(0.199 * times.rayleigh)
            && !times.are_resolved_by(0.201 * times.rayleigh)
    );
    start(&mut world, &law).unwrap();
    step(&mut world, &law).unwrap();
}
