//! The fast step against a slow one that follows the written definitions and nothing else: all
//! pairs, one at a time, a map for the springs, every sum in the contract's order. They are equal
//! to the bit.

use crate::common::cases::cases;
use crate::common::crowd::{DENSE, PER_GRAIN, Packing, REDUCED, SI, Units, crowd, history, tsuji};
use crate::common::slow_world::Slow;
use crate::common::sticky::STICKY;
use bitgrain_kernel::contact::{
    HertzHistory, HertzTsuji, Kept, Law, MEMORY_MAX, Materials, PairLaws, Rolling,
    RollingResistance, RollingSpring,
};
use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{
    ContactHistory, KeptContact, Obstacle, Row, World, obstacle_of, start, step, surface_of,
};
use proptest::prelude::*;

type V = [f64; 3];

/// Grains that fly and meet now and then.
const LOOSE: Packing = Packing {
    across: 1.25,
    up: 1.05,
    shake: 0.4,
    lift: 0.1,
};

fn bits(v: V) -> [u64; 3] {
    v.map(f64::to_bits)
}

fn same<L>(fast: &World<'_, f64>, slow: &Slow<L>, step: u64) -> Result<(), TestCaseError> {
    let all =
        |rows: &[Row<f64>]| -> Vec<[u64; 3]> { rows.iter().map(|r| bits(head(*r))).collect() };
    let g = &fast.grains;
    let parts = [
        ("position", &*g.position, &slow.position),
        ("velocity", &*g.velocity, &slow.velocity),
        ("spin", &*g.spin, &slow.spin),
        ("force", &*g.force, &slow.force),
        ("torque", &*g.torque, &slow.torque),
    ];
    for (name, a, b) in parts {
        prop_assert_eq!(all(a), all(b), "{} at step {}", name, step);
    }
    prop_assert_eq!(&*g.image, &slow.image, "crossings at step {}", step);
    for (a, b) in fast.obstacles.iter().zip(&slow.obstacles) {
        let words = |o: &Obstacle<f64>| {
            [o.point, o.velocity, o.angular_velocity, o.force, o.torque].map(bits)
        };
        let turned = |o: &Obstacle<f64>| o.orientation.map(f64::to_bits);
        prop_assert_eq!(turned(a), turned(b), "orientations at step {}", step);
        prop_assert_eq!(words(a), words(b), "obstacles at step {}", step);
        prop_assert_eq!(a.image, b.image, "crossings at step {}", step);
    }
    let held: Vec<_> = fast.kept_contacts().map(|one| words_of(&one)).collect();
    let pairs = slow.pairs.iter();
    let pairs = pairs.map(|(&(i, j), kept)| (0, i, (j, 0), all_bits(kept)));
    let touches = slow.touches.iter();
    let touches = touches.map(|(&(i, k, surface), kept)| (1, i, (k, surface), all_bits(kept)));
    let kept: Vec<_> = pairs.chain(touches).collect();
    prop_assert_eq!(held, kept, "histories at step {}", step);
    Ok(())
}

/// Of a spring and the words of a law.
type Words = ([u64; 3], [u64; MEMORY_MAX]);

fn all_bits(kept: &Kept<f64>) -> Words {
    (bits(kept.spring), kept.memory.map(f64::to_bits))
}

/// A pair is of kind 0, a contact on an obstacle of kind 1.
fn words_of(contact: &KeptContact<f64>) -> (u8, usize, (usize, u32), Words) {
    let words = all_bits(&contact.kept());
    match contact.history {
        ContactHistory::Pair { i, j, .. } => (0, i as usize, (j as usize, 0), words),
        ContactHistory::Obstacle { i, obstacle, .. } => {
            let on = (obstacle_of(obstacle) as usize, surface_of(obstacle));
            (1, i as usize, on, words)
        }
    }
}

fn follow<L: Law<f64>>(
    seed: &[f64],
    packing: &Packing,
    (law, laws): (impl Law<f64>, fn(Materials) -> L),
    units: &Units,
    skin: f64,
) -> Result<(), TestCaseError> {
    let mut store = crowd(seed, packing, units, skin);
    let mut fast = store.world();
    // Too deep from the start: not a world to step.
    prop_assume!(start(&mut fast, &law).is_ok());
    let mut slow = Slow::of(&fast, laws);
    slow.forces(0.0);
    same(&fast, &slow, 0)?;
    let mut contacts = [0, 0];
    for n in 1..=400 {
        if step(&mut fast, &law).is_err() {
            // A carried body drove into another: compared up to here.
            prop_assume!(n > 50, "stopped at step {}", n);
            break;
        }
        slow.step();
        same(&fast, &slow, n)?;
        contacts[0] += slow.pairs.len();
        contacts[1] += slow.touches.len();
    }
    let [between, on_obstacles] = contacts;
    prop_assume!(between + on_obstacles > 0, "nothing ever touched");
    if *packing == DENSE {
        prop_assume!(between > 0, "no two grains ever touched");
        prop_assume!(on_obstacles > 0, "no obstacle was ever touched");
    }
    Ok(())
}

/// [`follow`] with another law for each pair of three materials.
fn follow_table<L: Law<f64>>(
    seed: &[f64],
    packing: &Packing,
    laws: fn(Materials) -> L,
    units: &Units,
    skin: f64,
) -> Result<(), TestCaseError> {
    let table = table(laws);
    let table = PairLaws::new(3, &table).unwrap();
    follow(seed, packing, (table, laws), units, skin)
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn the_step_equals_its_definition_hertz_history(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
        mu in prop::sample::select(vec![0, 1, 2]),
    ) {
        let laws: [fn(Materials) -> _; 3] = [|_| history(0.0), |_| history(0.3), |_| history(0.9)];
        let laws = laws[mu];
        follow(&seed, &packing, (laws([0; 2]), laws), &REDUCED, skin)?;
    }

    #[test]
    fn the_step_equals_its_definition_hertz_tsuji(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 48),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
    ) {
        follow(&seed, &packing, (tsuji(), |_| tsuji()), &SI, skin)?;
    }

    #[test]
    fn the_step_equals_its_definition_of_several_materials(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
        is_history in any::<bool>(),
    ) {
        match is_history {
            true => follow_table(&seed, &packing, own_history, &REDUCED, skin)?,
            false => follow_table(&seed, &packing, own_tsuji, &SI, skin)?,
        }
    }
}

proptest! {
    #![proptest_config(cases(16))]

    /// Both models of rolling, for each pair of three materials another one.
    #[test]
    fn the_step_equals_its_definition_of_laws_that_resist_rolling(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
        is_history in any::<bool>(),
    ) {
        match is_history {
            true => follow_table(&seed, &packing, rolling_history, &REDUCED, skin)?,
            false => follow_table(&seed, &packing, rolling_tsuji, &SI, skin)?,
        }
    }

    /// A law that acts at a distance, keeps words, sees masses and materials and twists.
    #[test]
    fn the_step_equals_its_definition_of_a_law_that_acts_at_a_distance(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
    ) {
        follow(&seed, &packing, (STICKY, |_| STICKY), &REDUCED, skin)?;
    }
}

/// A law of two materials that resists rolling.
fn resisting<L: Law<f64>>([a, b]: Materials, law: L, k: f64) -> Rolling<f64, L> {
    let spring = match a == b {
        true => RollingSpring::Sds,
        false => RollingSpring::Epsd2,
    };
    let sum = f64::from(a + b);
    let resistance = RollingResistance {
        spring,
        k: k * (1.0 + sum),
        gamma: 1e-3 * k,
        mu: 0.05 * sum,
    };
    Rolling { law, resistance }
}

fn rolling_history(pair: Materials) -> Rolling<f64, HertzHistory<f64>> {
    resisting(pair, own_history(pair), 1e3)
}

fn rolling_tsuji(pair: Materials) -> Rolling<f64, HertzTsuji<f64>> {
    resisting(pair, own_tsuji(pair), 20.0)
}

/// The laws of three materials, in the order of a table.
fn table<L: Copy>(law: fn(Materials) -> L) -> Vec<L> {
    PairLaws::<L>::pairs(3).map(law).collect()
}

/// Numbers that tell every two materials from all others, in either order.
fn own_history([a, b]: Materials) -> HertzHistory<f64> {
    let [sum, product] = [a + b, a * b].map(f64::from);
    let law = history(0.2 + 0.1 * sum);
    HertzHistory {
        kn: law.kn * (1.0 + 0.2 * sum + 0.05 * product),
        gamma_t: law.gamma_t / (1.0 + product),
        ..law
    }
}

fn own_tsuji([a, b]: Materials) -> HertzTsuji<f64> {
    let of = |m: u8| [5e6 * (1.0 + 0.5 * f64::from(m)), 0.45 - 0.1 * f64::from(m)];
    HertzTsuji::between(
        [of(a), of(b)],
        0.6 - 0.1 * f64::from(a * b),
        0.2 + 0.1 * f64::from(a + b),
    )
}
