//! What stops a world, and what does not: no failure comes of the clock, a fault leaves the same on every path, and an
//! obstacle may be put elsewhere.

use bitgrain::simulation::{AnyLaw, Grain, Simulation};
use bitgrain::threads::on_threads;
use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{Domain, Error, Group, Obstacle};

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
    sim.stepping.divide_always();
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

/// After a fault all that reads a state is refused, and so is all that goes on from one, however the steps were done.
#[test]
fn a_fault_leaves_no_state_on_any_path() {
    let still = [0.0; 3];
    let resting = |k: u32| [0.5 + 2.0 * f64::from(k), 4.0, 4.0];
    // Deep in another grain, in an obstacle, out of the box, and an obstacle that a grain makes too fast.
    let faults: [(&dyn Fn() -> Simulation, Error); 4] = [
        (
            &|| {
                room(
                    &[(resting(0), still), (resting(1), [-300.0, 0.0, 0.0])],
                    vec![],
                )
            },
            Error::OverlapTooDeep { i: 1, j: 2 },
        ),
        (
            &|| {
                let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
                room(
                    &[(resting(0), still), (resting(1), [0.0, 0.0, -300.0])],
                    vec![floor],
                )
            },
            Error::ObstacleTooDeep { id: 2, obstacle: 0 },
        ),
        (
            &|| {
                room(
                    &[(resting(0), [0.0, 0.0, 20.0]), (resting(1), still)],
                    vec![],
                )
            },
            Error::Escaped { id: 1 },
        ),
        (
            &|| {
                let ball = Obstacle::sphere(resting(1), 0.5);
                let ball = ball.free(1.0, [8e4, 0.0, 0.0]).unwrap();
                room(&[(resting(3), still), (resting(0), still)], vec![ball])
            },
            Error::ObstacleTooFast { obstacle: 0 },
        ),
    ];
    for (begin, fault) in faults {
        let mut ends = Vec::new();
        for (threads, at_once) in [(1, 1000), (1, 1), (2, 1000), (2, 1), (3, 7)] {
            let mut sim = begin();
            sim.start().unwrap();
            let went = on_threads(threads, || {
                (0..1000 / at_once).try_for_each(|_| sim.steps(at_once))
            });
            assert_eq!(went.unwrap(), Err(fault), "{threads} {at_once}");
            ends.push(sim.step_count());
            let refused = Error::NotStarted;
            let histories = sim.contact_histories();
            assert_eq!(sim.digest(), Err(refused), "{fault:?} {threads} {at_once}");
            assert_eq!(sim.save(), Err(refused));
            assert_eq!(sim.steps(1), Err(refused));
            assert_eq!(sim.start(), Err(refused));
            assert_eq!(sim.resume(&histories), Err(refused));
            assert_eq!(sim.rearrange(|_| ()), Err(refused));
            assert_eq!(sim.nudge(1, still, still), Err(refused));
            assert!(!sim.clock.has_state());
        }
        assert!(ends.iter().all(|end| *end == ends[0]), "{fault:?} {ends:?}");
    }
}

/// An obstacle is put away from a grain that it touches, back, and to another one: a contact ends when bodies part, at
/// every skin, and one that still touches keeps its spring.
#[test]
fn an_obstacle_that_is_put_elsewhere_ends_its_contacts() {
    let run = |skin: f64, part_min: usize| {
        let tip = |y: f64| [4.0, y, 4.0];
        let grains = [(tip(2.02), [0.0, -1.0, 0.3]), (tip(6.0), [0.0; 3])];
        let mut sim = room(&grains, vec![Obstacle::sphere(tip(1.0), 0.5)]);
        (sim.skin, sim.stepping.part_min) = (skin, part_min);
        sim.start().unwrap();
        let mut digests = Vec::new();
        let mut springs = Vec::new();
        on_threads(2, || {
            sim.steps(22).unwrap();
            for y in [0.999, 0.98, 3.0, 1.0, 5.01] {
                sim.rearrange(|sim| sim.obstacles[0].point = tip(y))
                    .unwrap();
                digests.push(sim.digest().unwrap());
                springs.push(sim.contact_histories().len());
                sim.steps(1).unwrap();
                digests.push(sim.digest().unwrap());
            }
        })
        .unwrap();
        (springs, digests)
    };
    let first = run(0.01, 1);
    assert_eq!(first.0, [1, 0, 0, 0, 0]);
    for (skin, part_min) in [(0.0, 1), (0.3, 1), (0.01, 100)] {
        assert_eq!(run(skin, part_min), first, "{skin}");
    }
}
