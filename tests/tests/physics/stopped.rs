//! What stops a world, and what does not: no failure comes of the clock.

use bitgrain::simulation::{AnyLaw, Grain, Simulation};
use bitgrain::threads::on_threads;
use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{Domain, Group, Obstacle};

const DT: f64 = 1e-3;

/// A box of twelve diameters, periodic along x and y, with grains of diameter 1 by ids from 1 on; any number of threads
/// share them.
fn room(grains: &[([f64; 3], [f64; 3])], obstacles: Vec<Obstacle<f64>>) -> Simulation {
    let law = HertzHistory {
        kn: 2e5,
        kt: 2e5,
        gamma_n: 100.0,
        gamma_t: 100.0,
        mu: 0.5,
    };
    let grain = |(id, (position, velocity)): (u32, &([f64; 3], [f64; 3]))| Grain {
        id,
        group: 0,
        diameter: 1.0,
        density: 1.0,
        position: *position,
        velocity: *velocity,
        spin: [0.0; 3],
    };
    let grains: Vec<Grain> = (1..).zip(grains).map(grain).collect();
    let domain = Domain::new([0.0; 3], [12.0; 3], [true, true, false]).unwrap();
    let groups = vec![Group::free([0.0; 3])];
    let law = AnyLaw::HertzHistory(law);
    let mut sim = Simulation::new(law, domain, DT, groups, &grains, obstacles);
    sim.stepping.part_min = 1;
    sim
}

/// A lattice of grains that move along x, each as fast as its place in it says.
fn stirred(edge: u32) -> Simulation {
    let grain = |k: u32| {
        let place = [k % edge, k / edge % edge, k / (edge * edge)];
        let speed = 4.0 * f64::from(k * 7 % 5) - 8.0;
        (place.map(|n| 0.6 + 1.1 * f64::from(n)), [speed, 0.0, 0.0])
    };
    let grains: Vec<_> = (0..edge.pow(3)).map(grain).collect();
    let mut sim = room(&grains, vec![]);
    sim.start().unwrap();
    sim
}

/// A world that is copied and edited every few steps, as a Python host does, is searched again and again. What that
/// takes by the clock must neither widen its lists without end nor change a bit.
#[test]
fn a_hundred_runs_with_edits_end_alike_on_any_threads() {
    let run = || {
        let mut sim = stirred(3);
        let widest = sim.clock.radius_min();
        sim.outer_skin = widest;
        for round in 0..20 {
            sim.steps(15).unwrap();
            let mut edited = sim.clone();
            let (id, speed) = (round % 27 + 1, 0.3 * f64::from(round));
            edited.nudge(id, [speed, 0.0, 0.0], [0.0; 3]).unwrap();
            sim = edited;
            assert!(sim.outer_skin <= widest, "{}", sim.outer_skin);
        }
        sim.digest().unwrap()
    };
    let first = run();
    for threads in [1, 2, 3] {
        on_threads(threads, || assert!((0..100).all(|_| run() == first))).unwrap();
    }
}

/// Skins that list more pairs than bodies have that do not lie in each other are narrowed: they are of no consequence.
#[test]
fn too_wide_a_skin_stops_nothing() {
    let run = |wide: f64| {
        let mut sim = stirred(9);
        sim.outer_skin = wide;
        sim.start().unwrap();
        sim.steps(20).unwrap();
        // Refused as the steps go on, too.
        sim.outer_skin = wide;
        sim.nudge(5, [1.0, 2.0, 3.0], [0.0; 3]).unwrap();
        sim.steps(20).unwrap();
        sim.digest().unwrap()
    };
    assert_eq!(run(1e3), run(0.05));
}
