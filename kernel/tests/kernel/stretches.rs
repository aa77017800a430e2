//! Stretches of grains renew their pairs when they need it: how many there are changes no bit.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::{
    Digest, Domain, Error, Group, NEIGHBORS, Obstacle, Store, StretchList, World, digest, nudge,
    remove, start, step,
};
use proptest::prelude::*;

use crate::common::cases::cases;

const GRAINS: usize = 96;

/// Fewer without optimization, which makes a step forty times as slow.
const CASES: u32 = if cfg!(debug_assertions) { 2 } else { 24 };

type Row = Store<f64, GRAINS, 4600, 200, 2>;

const LAW: HertzHistory<f64> = HertzHistory {
    kn: 2e5,
    kt: 2e5,
    gamma_n: 50.0,
    gamma_t: 50.0,
    mu: 0.5,
};

/// Grains of diameter 1, each `gap` from the last one, on a floor, in lines of 12; one has this velocity.
fn lines(gap: f64, skins: (f64, f64), fast: usize, velocity: [f64; 3]) -> Box<Row> {
    let domain = Domain::new([0.0; 3], [40.0, 40.0, 20.0], [false; 3]).unwrap();
    let mut store = Box::new(Row::new(domain, 2e-4, skins.0));
    store.set_outer_skin(skins.1);
    store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    store.add_obstacle(floor).unwrap();
    for k in 0..GRAINS as u32 {
        let [x, y] = [k % 12, k / 12].map(|n| 1.0 + (1.0 + gap) * f64::from(n));
        store.add_grain(k + 1, 0, [x, y, 0.51], 0.5, 0.5).unwrap();
    }
    store.world().grains.velocity[fast][..3].copy_from_slice(&velocity);
    store
}

/// A world of so many stretches, taken up for each call.
struct Cut {
    store: Box<Row>,
    words: Vec<u32>,
    numbers: Vec<f64>,
}

impl Cut {
    fn new(store: Box<Row>, stretches: usize) -> Self {
        Self {
            store,
            words: vec![0; stretches * (4 + NEIGHBORS) + 2],
            numbers: vec![0.0; 3 * stretches],
        }
    }

    fn world(&mut self) -> World<'_, f64> {
        let mut world = self.store.world();
        world.stretches = StretchList::new(&mut self.words, &mut self.numbers);
        world
    }

    fn steps(&mut self, count: u64) -> Result<Digest, Error> {
        for _ in 0..count {
            step(&mut self.world(), &LAW)?;
        }
        digest(&self.world())
    }
}

proptest! {
    #![proptest_config(cases(CASES))]

    /// A fast grain flies along and over the others, which rest: each stretch hears of it in time.
    #[test]
    fn a_fast_grain_is_heard_by_the_stretches_it_comes_to(
        gap in 0.0..0.6f64,
        fast in 0..GRAINS,
        along in -1.0..1.0f64,
        speed in -20.0..20.0f64,
        skin in 0.0..0.3f64,
        outer in 0.0..4.0f64,
    ) {
        let velocity = [speed, along * speed, 0.3];
        let run = |skins, stretches| {
            let mut cut = Cut::new(lines(gap, skins, fast, velocity), stretches);
            start(&mut cut.world(), &LAW)?;
            cut.steps(1500)
        };
        let wide = run((6.0, 6.0), 1);
        prop_assume!(wide.is_ok());
        for stretches in [1, 2, 5, 12] {
            prop_assert_eq!(run((skin, outer), stretches), wide, "{} stretches", stretches);
        }
    }

    /// A resting bed in which one grain is set going, and then another one taken away.
    #[test]
    fn edits_are_heard_by_all_stretches(
        place in 0..GRAINS,
        gone in 1..=GRAINS as u32,
        speed in -15.0..15.0f64,
        skin in 0.0..0.1f64,
    ) {
        let run = |skins, stretches| {
            let mut cut = Cut::new(lines(0.1, skins, 0, [0.0; 3]), stretches);
            start(&mut cut.world(), &LAW)?;
            cut.steps(100)?;
            nudge(&mut cut.world(), place, [speed, 3.0, 0.0], [0.0; 3])?;
            cut.steps(400)?;
            remove(&mut cut.world(), &[gone])?;
            cut.steps(400)
        };
        let wide = run((6.0, 6.0), 1);
        prop_assume!(wide.is_ok());
        for stretches in [1, 3, 12] {
            prop_assert_eq!(run((skin, 2.0), stretches), wide, "{} stretches", stretches);
        }
    }
}

/// Stretches at rest keep their pairs while others renew theirs: 3,408 grains were looked at, and 9,600 with one
/// stretch.
#[test]
fn slow_stretches_keep_their_pairs() {
    let renewals = |stretches: usize| {
        let mut cut = Cut::new(lines(0.05, (0.02, 4.0), 0, [0.0; 3]), stretches);
        start(&mut cut.world(), &LAW).unwrap();
        cut.steps(2000).unwrap();
        nudge(&mut cut.world(), GRAINS - 1, [8.0, 0.0, 4.0], [0.0; 3]).unwrap();
        let before = cut.world().clock.picked();
        cut.steps(500).unwrap();
        cut.world().clock.picked() - before
    };
    let (one, twelve) = (renewals(1), renewals(12));
    assert!(twelve < one / 2, "{twelve} and {one} grains");
}
