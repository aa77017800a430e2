//! What lies within which distance of the intruder, on grains that are placed by hand.

use std::path::Path;

use bitgrain::observe::{neighbourhood, overlaps, overlaps_beyond};
use bitgrain::scenario;
use bitgrain::simulation::{Grain, Simulation};
use bitgrain_kernel::{Domain, Group, Obstacle};
use bitgrain_tests::SMALL;

/// Balls of diameter 1 at these places in a box 16 wide, round a sphere of diameter 2 in its middle, which nothing
/// pulls.
fn placed(places: &[[f64; 3]]) -> Simulation {
    let domain = Domain::new([0.0; 3], [16.0; 3], [true, true, false]).unwrap();
    let grain = |(k, &position): (usize, &[f64; 3])| Grain {
        id: k as u32 + 1,
        group: 0,
        diameter: 1.0,
        density: 1.0,
        position,
        velocity: [0.0; 3],
        spin: [0.0; 3],
    };
    let grains: Vec<Grain> = places.iter().enumerate().map(grain).collect();
    let law = scenario::parse(SMALL, "small", &[], Path::new(""))
        .unwrap()
        .law
        .build()
        .unwrap();
    let body = Obstacle::sphere([8.0; 3], 1.0);
    let groups = vec![Group::free([0.0; 3])];
    let mut sim = Simulation::new(law, domain, 1e-4, groups, &grains, vec![body]);
    sim.start().unwrap();
    sim
}

#[test]
fn grains_count_within_the_distances_that_hold_their_centres() {
    // Centres at 0.49, 1.24, 2.2, 2.34 and 6.9 from the surface: the first touches the sphere and the second grain,
    // which overlaps it by a quarter; the third and the fourth touch each other.
    let mut sim = placed(&[
        [9.49, 8.0, 8.0],
        [10.24, 8.0, 8.0],
        [8.0, 11.2, 8.0],
        [8.0, 11.2, 8.95],
        [8.0, 0.1, 8.0],
    ]);
    let contacts = sim.count_contacts();
    let found = neighbourhood(&sim, &contacts, 10.0, 1.0);
    let within = |reach: f64| found.contacts(reach).collect::<Vec<f64>>();
    assert_eq!(found.angles.len(), 1);
    assert!(found.angles[0].abs() < 1e-12, "straight ahead");
    assert_eq!(within(0.4), [0.0; 0]);
    assert_eq!(within(0.6), [2.0]);
    assert_eq!(within(1.3), [2.0, 1.0]);
    assert_eq!(within(2.3), [2.0, 1.0, 1.0]);
    assert_eq!(within(3.0), [2.0, 1.0, 1.0, 1.0]);
    assert_eq!(within(7.0), [2.0, 1.0, 1.0, 1.0, 0.0]);
    let mut depths = overlaps(&mut sim);
    depths.sort_by(f64::total_cmp);
    let want = [0.01, 0.05, 0.25];
    let near = |(a, b): (&f64, f64)| (a - b).abs() < 1e-9;
    assert!(
        depths.len() == 3 && depths.iter().zip(want).all(near),
        "{depths:?}"
    );
    assert_eq!(overlaps_beyond(&mut sim, 0.04), Some(2.0 / 3.0));
    assert_eq!(overlaps_beyond(&mut placed(&[[1.0; 3]]), 0.04), None);
}
