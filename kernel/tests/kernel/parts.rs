//! Worlds in parts: whoever owns a grain, all that is found and decided is that of the whole world.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::parts::{renumber, restore, search_and_list};
use bitgrain_kernel::phases::{begin, measure, seal};
use bitgrain_kernel::{
    ContactHistory, Domain, Drain, Error, Group, LossPolicy, Obstacle, Store, World, digest, start,
    step, take_out,
};

use crate::common::parts::{Ghosts, steps_in_parts};

const GRAINS: usize = 8;

type Row = Store<f64, GRAINS, 1024, 16, 1>;

const LAW: HertzHistory<f64> = HertzHistory {
    kn: 2e5,
    kt: 2e5,
    gamma_n: 0.0,
    gamma_t: 0.0,
    mu: 0.5,
};

/// Eight grains in a row along x, 2 apart, of these radii and velocities, and a floor far below.
fn row(radius: impl Fn(u32) -> f64, velocity: impl Fn(u32) -> [f64; 3]) -> Row {
    let domain = Domain::new([0.0; 3], [20.0, 4.0, 4.0], [false; 3]).unwrap();
    // Candidates are found long before they are near.
    let mut store = Row::new(domain, 1e-3, 0.05);
    store.set_outer_skin(3.0);
    store.add_group(Group::free([0.0; 3])).unwrap();
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    store.add_obstacle(floor).unwrap();
    for id in 1..=GRAINS as u32 {
        let place = [2.0 * f64::from(id), 2.0, 2.0];
        store.add_grain(id, 0, place, radius(id), 0.5).unwrap();
    }
    for id in 1..=GRAINS {
        store.world().grains.velocity[id - 1][..3].copy_from_slice(&velocity(id as u32));
    }
    start(&mut store.world(), &LAW).unwrap();
    store
}

/// Who owns each grain: neighbours, every other one, each by itself.
const OWNERS: [[u8; GRAINS]; 5] = [
    [0; GRAINS],
    [0, 0, 0, 0, 1, 1, 1, 1],
    [0, 1, 0, 1, 0, 1, 0, 1],
    [2, 0, 0, 1, 2, 2, 1, 0],
    [7, 6, 5, 4, 3, 2, 1, 0],
];

/// Does so many steps of a row as a whole and in all ways in parts, which must end alike.
fn all_alike(row: impl Fn() -> Row, count: u64) -> (Result<(), Error>, Row) {
    let mut whole = row();
    let went = (0..count).try_for_each(|_| step(&mut whole.world(), &LAW));
    for owner in &OWNERS {
        for (ghosts, at_once) in [
            (Ghosts::Near, count),
            (Ghosts::All, count),
            (Ghosts::Near, 1),
        ] {
            let mut cut = row();
            let mut world = cut.world();
            let rounds = count / at_once;
            let parts = (0..rounds)
                .try_for_each(|_| steps_in_parts(&mut world, owner, ghosts, &LAW, at_once));
            assert_eq!(parts, went, "{owner:?} {ghosts:?}");
            assert_eq!(
                world.clock.step,
                whole.world().clock.step,
                "{owner:?} {ghosts:?}"
            );
            // After a fault neither has one.
            assert_eq!(
                digest(&world),
                digest(&whole.world()),
                "{owner:?} {ghosts:?}"
            );
        }
    }
    (went, whole)
}

/// Pairs are picked again when the fastest grain of any part needs it: else grains would end past each other.
#[test]
fn a_fast_grain_of_another_part_is_heard() {
    for fast in 2..=GRAINS as u32 {
        let throw = |id: u32| [if id == fast { -30.0 } else { 0.0 }, 0.0, 0.0];
        let (went, mut whole) = all_alike(|| row(|_| 0.5, throw), 60);
        let left = whole.world().grains.velocity[fast as usize - 2][0];
        assert!(went.is_ok() && left < -20.0, "grain {fast} hits: {left}");
    }
}

/// Of several faults in one step the lowest grain's is reported, whichever part finds it.
#[test]
fn faults_are_those_of_the_whole_world() {
    // Grains 3, 5 and 8 leave the box through the top at the same step.
    let leaves = |id: u32| [0.0, 0.0, if [3, 5, 8].contains(&id) { 10.0 } else { 0.0 }];
    // Grains 4 and 7 hit the ones before them too fast for their stiffness.
    let hits = |id: u32| [if [4, 7].contains(&id) { -300.0 } else { 0.0 }, 0.0, 0.0];
    // Grains 2, 4 and 6 fall deep into the floor, which is 1.5 below them.
    let falls = |id: u32| [0.0, 0.0, if [2, 4, 6].contains(&id) { -300.0 } else { 0.0 }];
    let ends = |velocity: fn(u32) -> [f64; 3]| all_alike(|| row(|_| 0.5, velocity), 400).0;
    assert_eq!(ends(leaves), Err(Error::Escaped { id: 3 }));
    assert_eq!(ends(hits), Err(Error::OverlapTooDeep { i: 3, j: 4 }));
    let deep = Error::ObstacleTooDeep { id: 2, obstacle: 0 };
    assert_eq!(ends(falls), Err(deep));
}

/// A part of small grains looks as far as the largest grains of others need.
#[test]
fn large_grains_of_another_part_are_met() {
    let drift = |id: u32| {
        [
            if id.is_multiple_of(2) { -2.0 } else { 2.0 },
            0.1 * f64::from(id % 3),
            0.0,
        ]
    };
    for large in [0, 1] {
        let radius = |id: u32| if id % 2 == large { 1.4 } else { 0.4 };
        let close = || {
            let mut store = row(radius, drift);
            store.set_outer_skin(0.1);
            store
        };
        let (went, mut whole) = all_alike(close, 300);
        assert_eq!(went, Ok(()));
        let turned = whole.world().grains.velocity[0][0] < 0.0;
        assert!(turned, "grains met");
    }
}

/// After steps in parts a whole world looks as far ahead as grains have become fast: two that are pressed together
/// at first fly apart.
#[test]
fn a_world_goes_on_from_its_parts() {
    let mut hits = 0;
    for (wide, count) in (0..10).flat_map(|wide| (1..20).map(move |count| (wide, count))) {
        let press = |id: u32| match id {
            1 => 1.2,
            2 => 1.0,
            _ => 0.5 + 0.01 * f64::from(wide),
        };
        let [mut whole, mut cut] = [0; 2].map(|_| {
            let mut store = row(press, |_| [0.0; 3]);
            store.set_skin(0.0);
            store
        });
        (0..=count).for_each(|_| step(&mut whole.world(), &LAW).unwrap());
        let mut world = cut.world();
        steps_in_parts(&mut world, &OWNERS[2], Ghosts::Near, &LAW, count).unwrap();
        step(&mut world, &LAW).unwrap();
        assert_eq!(digest(&world), digest(&whole.world()), "{wide} {count}");
        hits += usize::from(world.grains.force[2][0] > 0.0);
    }
    assert!(hits > 20, "grain 3 is hit: {hits}");
}

/// Grains that leave do so at the same step, and what is left goes on alike.
#[test]
fn losses_are_those_of_the_whole_world() {
    let policy = LossPolicy {
        takes_out: true,
        drain: Some(Drain {
            point: [3.0, 0.0, 0.0],
            normal: [1.0, 0.0, 0.0],
        }),
    };
    let velocity = |id: u32| [-2.0, 0.0, if [3, 5, 8].contains(&id) { 10.0 } else { 0.0 }];
    let run = |steps: &dyn Fn(&mut World<'_, f64>) -> Result<(), Error>| {
        let mut store = row(|_| 0.5, velocity);
        let mut lost = Vec::new();
        while store.world().clock.step < 1500 {
            let mut world = store.world();
            world.policy = policy;
            steps(&mut world).unwrap();
            let at = world.clock.step;
            if world.clock.is_losing() {
                take_out(&mut world, |one| lost.push((at, one.grain.id, one.cause))).unwrap();
            }
        }
        (lost, digest(&store.world()))
    };
    let whole = run(&|world| step(world, &LAW));
    assert_eq!(
        whole.0.len(),
        5,
        "three at the top, two behind the drain: {whole:?}"
    );
    for owner in &OWNERS {
        let parts = run(&|world| {
            let left = world.grains.id.iter();
            let owner: Vec<u8> = left.map(|id| owner[*id as usize - 1]).collect();
            let count = 1500 - world.clock.step;
            steps_in_parts(world, &owner, Ghosts::Near, &LAW, count)
        });
        assert_eq!(parts, whole, "{owner:?}");
    }
}

/// What a host may do wrong changes nothing.
#[test]
fn calls_out_of_order_are_refused() {
    let mut store = row(|_| 0.5, |_| [0.0; 3]);
    let mut world = store.world();
    let before = *world.clock;
    assert_eq!(renumber(&mut world, &[0, 1], 2), Err(Error::BadStorage));
    let sealed = seal(&world.grain_motion(), 0);
    begin(&mut world, sealed).unwrap();
    let extent = measure(&world);
    assert_eq!(search_and_list(&mut world, &extent), Err(Error::NotStarted));
    let history = ContactHistory::Obstacle {
        i: 0,
        obstacle: 0,
        spring: [0.0; 3],
    };
    assert_eq!(restore(&mut world, [history]), Err(Error::NotStarted));
    assert_eq!(world.clock.count(), before.count());
    assert_eq!(world.clock.listed(), before.listed());
}
