//! The golden cases in the kernel's own storage: the digests of the harness, without an allocator.

use bitgrain::law::{Sprung, WithLaw};
use bitgrain::simulation::{Simulation, hex};
use bitgrain_kernel::contact::Law;
use bitgrain_kernel::{Store, World, digest, start, step};
use bitgrain_tests::{golden, golden_case};

/// Room for the larger cases: 60 grains, all groups that a case has, and the words of a law that resists rolling.
type Room<const PAIRS: usize, const BODIES: usize> = Store<f64, 60, PAIRS, 256, BODIES, 3>;

/// The digests that `golden/digests` holds of a case, by step.
fn golden_digests(name: &str) -> Vec<(u64, String)> {
    let text = std::fs::read_to_string(golden("digests/cases.snap")).expect("the golden is there");
    let entry = |line: &str| {
        let mut words = line.split_whitespace();
        (words.next()? == name).then_some(())?;
        Some((words.next()?.parse().ok()?, words.next()?.to_string()))
    };
    text.lines().filter_map(entry).collect()
}

/// Moves a simulation at step 0 into a store.
fn store_of<const PAIRS: usize, const BODIES: usize>(
    sim: &Simulation,
    skin: f64,
) -> Box<Room<PAIRS, BODIES>> {
    let mut store = Box::new(Room::new(sim.domain, sim.dt, skin * sim.skin));
    for group in &sim.groups {
        store.add_group(*group).expect("room for the groups");
    }
    for obstacle in &sim.obstacles {
        store.add_obstacle(*obstacle).expect("room for obstacles");
    }
    for i in 0..sim.count() {
        let ([x, y, z, radius], mass) = (sim.position[i], sim.velocity[i][3]);
        store
            .add_grain(sim.id[i], sim.group[i], [x, y, z], radius, mass)
            .expect("room for the grains");
    }
    let grains = store.world().grains;
    grains.velocity.copy_from_slice(&sim.velocity);
    grains.spin.copy_from_slice(&sim.spin);
    store
}

fn follow<const PAIRS: usize, const BODIES: usize>(name: &str, sim: &Simulation, skin: f64) {
    let mut store = store_of::<PAIRS, BODIES>(sim, skin);
    let world = store.world();
    sim.law.with(Steps { name, world });
}

/// A world that is to have the golden digests of a case.
struct Steps<'s> {
    name: &'s str,
    world: World<'s, f64>,
}

impl WithLaw for Steps<'_> {
    type Output = ();

    fn run<L: Law<f64> + Sprung>(self, law: &L) {
        steps(self.name, self.world, law);
    }
}

fn steps(name: &str, mut world: World<'_, f64>, law: &impl Law<f64>) {
    let golden = golden_digests(name);
    assert!(golden.len() > 5, "{name} has golden digests");
    start(&mut world, law).expect("a sound case");
    for (at, expected) in golden {
        while world.clock.step < at {
            step(&mut world, law).expect("a sound case");
        }
        assert_eq!(
            hex(&digest(&world).unwrap().whole),
            expected,
            "{name} at step {at}"
        );
    }
}

const CASES: [&str; 5] = [
    "collapse.json",
    "lid.json",
    "rig.json",
    "rig.json:hertz_history",
    "rolling.json",
];

/// Whether the lists are nearly full or nearly empty.
/// Ten seconds, because each case of the goldens is followed twice, on stores of the kernel alone.
#[test]
fn a_store_of_any_size_gives_the_golden_digests() {
    for name in CASES {
        let sim = golden_case(name).start(name, |_| {});
        let sim = sim.expect("a sound case");
        follow::<320, 24>(name, &sim, 0.5);
        follow::<2048, 24>(name, &sim, 3.0);
    }
}
