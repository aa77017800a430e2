//! The neighbour search and the filter: who is listed, who touches, and what springs live through.

use std::collections::BTreeSet;

use crate::common::cases::cases;
use crate::common::crowd::{DENSE, PER_GRAIN, REDUCED, SI, Units, crowd, history, tsuji};
use bitgrain_kernel::contact::Law;
use bitgrain_kernel::vec3::{Vec3, dot, head, scale};
use bitgrain_kernel::{
    ContactHistory, Digest, Domain, Group, Obstacle, Partner, Store, World, digest, resume, start,
    start_watched, step, step_watched,
};
use proptest::prelude::*;

type V = Vec3<f64>;
type Listed = BTreeSet<(usize, usize)>;

/// Radius of the largest grain and of the ball among them.
const LARGEST: f64 = 0.5;

/// Where a coordinate is put: at which kind of place, how far along, and how many units in the last
/// place beside it.
type Spot = (u8, f64, i32);

/// `x` moved by so many units in the last place.
fn nudged(x: f64, units: i32) -> f64 {
    let step = |x: f64| {
        if units > 0 {
            x.next_up()
        } else {
            x.next_down()
        }
    };
    (0..units.abs()).fold(x, |x, _| step(x))
}

/// One coordinate in the box, most often where a search goes wrong first: on the edge of a cell, on
/// the edge of the box, or touching the grain before.
fn coordinate(domain: &Domain<f64>, a: usize, skin: f64, spot: Spot, before: f64) -> f64 {
    let (lo, hi) = (domain.lo()[a], domain.hi()[a]);
    let (kind, along, units) = spot;
    let length = hi - lo;
    let cells = (length / (2.0 * LARGEST + skin)).floor().max(1.0);
    let at = match kind {
        0 | 1 => lo + length * (along * (cells + 1.0)).floor() / cells,
        2 if along < 0.5 => lo,
        2 => hi,
        3 if along < 0.5 => before + 2.0 * LARGEST + skin,
        3 => before - 2.0 * LARGEST - skin,
        4 => before,
        _ => lo + along * length,
    };
    let at = nudged(at, units);
    if domain.periodic()[a] {
        let mut place = domain.lo();
        place[a] = at;
        domain.wrap(&mut place, &mut [0; 3]);
        place[a].clamp(lo, hi.next_down())
    } else {
        at.clamp(lo, hi)
    }
}

/// The distance to the nearest image, found by trying three along every axis.
fn distance(domain: &Domain<f64>, a: V, b: V) -> f64 {
    let d: V = core::array::from_fn(|k| {
        let period = domain.hi()[k] - domain.lo()[k];
        let across = if domain.periodic()[k] { period } else { 0.0 };
        let raw = a[k] - b[k];
        raw.abs()
            .min((raw + across).abs())
            .min((raw - across).abs())
    });
    dot(d, d).sqrt()
}

/// The listed pairs, which ascend.
fn listed_pairs(world: &World<'_, f64>) -> Listed {
    let pairs = world.listed_pairs();
    let all: Vec<_> = pairs.map(|(i, j)| (i as usize, j as usize)).collect();
    assert_eq!(all.len(), world.clock.listed());
    assert!(all.is_sorted_by(|a, b| a < b), "pairs ascend");
    all.into_iter().collect()
}

fn listed_touches(world: &World<'_, f64>) -> Listed {
    let touches = 0..world.clock.obstacle_contacts();
    let pair = |t: usize| {
        (
            world.pairs.obstacle_contact_grain[t],
            world.pairs.obstacle_contact_obstacle[t],
        )
    };
    touches
        .map(pair)
        .map(|(i, k)| (i as usize, k as usize))
        .collect()
}

/// Compares a world's lists with all pairs. What lies beyond the skin by more than rounding is not
/// listed; 1e-9 is far above the list's own margin at coordinates of a thousand, some 1e-11.
fn compare_with_all(world: &World<'_, f64>, skin: f64) -> Result<(), TestCaseError> {
    let g = &world.grains;
    let heavy = |i: usize| g.groups[g.group[i] as usize].infinite_mass;
    let (pairs, touches) = (listed_pairs(world), listed_touches(world));
    for j in 0..g.count() {
        for i in 0..j {
            let (x, y) = (g.position[i], g.position[j]);
            let gap = distance(world.domain, head(x), head(y)) - (x[3] + y[3]);
            let able = !(heavy(i) && heavy(j));
            let is = pairs.contains(&(i, j));
            prop_assert!(is || !able || gap >= skin, "{:?} {:?} are missing", x, y);
            prop_assert!(!is || (able && gap < skin + 1e-9), "{:?} {:?}", x, y);
        }
        for (k, body) in world.obstacles.iter().enumerate() {
            let x = g.position[j];
            let gap = distance(world.domain, head(x), body.point) - (x[3] + body.reach());
            let able = !(heavy(j) && body.inverse_mass == 0.0);
            let is = touches.contains(&(j, k));
            prop_assert!(is || !able || gap >= skin, "{:?} on {} is missing", x, k);
            prop_assert!(!is || (able && gap < skin + 1e-9), "{:?} on {}", x, k);
        }
    }
    Ok(())
}

fn spot() -> impl Strategy<Value = Spot> {
    (0..6u8, 0.0..1.0f64, -2..=2i32)
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn every_near_pair_is_listed(
        spots in prop::collection::vec((prop::array::uniform3(spot()), 0..4u8), 3..40),
        lo in prop::array::uniform3(prop::sample::select(vec![0.0, -2.7, 1000.1])),
        cells in prop::array::uniform3((1..6u8, -2..=2i32, 0.0..0.3f64)),
        periodic in prop::array::uniform3(any::<bool>()),
        skin in prop::sample::select(vec![0.0, 0.1, 0.7]),
    ) {
        // A whole number of cells and next to it, or a bit more; periods must exceed two contacts.
        let least = 4.0 * LARGEST + 0.01;
        let hi = core::array::from_fn(|a| {
            let (count, units, more) = cells[a];
            let more = if more < 0.1 { 0.0 } else { more };
            let length = (2.0 * LARGEST + skin) * (f64::from(count) + more);
            lo[a] + nudged(length, units).max(least)
        });
        let domain = Domain::new(lo, hi, periodic).unwrap();
        let mut store = Box::new(Store::<f64, 40, 1024, 80, 2>::new(domain, 1e-3, skin));
        store.add_group(Group::free([0.0; 3])).unwrap();
        store.add_group(Group::frozen()).unwrap();
        let mut before = lo;
        for (k, (spots, kind)) in spots.iter().enumerate() {
            let at: V =
                core::array::from_fn(|a| coordinate(&domain, a, skin, spots[a], before[a]));
            before = at;
            if k == 0 {
                store.add_obstacle(Obstacle::sphere(at, LARGEST)).unwrap();
                let own = Obstacle { inverse_mass: 1.0, ..Obstacle::sphere(lo, LARGEST) };
                store.add_obstacle(own).unwrap();
            } else {
                let radius = if *kind < 3 { LARGEST } else { 0.3 };
                store.add_grain(k as u32, u8::from(*kind == 0), at, radius, 1.0).unwrap();
            }
        }
        let mut world = store.world();
        // Taking up a state searches and evaluates nothing, so that grains may lie on each other.
        resume(&mut world, core::iter::empty::<ContactHistory<f64>>()).unwrap();
        compare_with_all(&world, skin)?;
    }

    /// Pairs a few units in the last place from touching, in all directions and across the edges:
    /// who is evaluated as touching is who overlaps by the law's own measure, also in a list without a
    /// skin.
    #[test]
    fn the_filter_drops_no_touching_pair(
        pairs in prop::collection::vec(
            (prop::array::uniform3(-1.0..1.0f64), 0.3..0.5f64, 0.3..0.5f64, -24..24i32),
            27,
        ),
    ) {
        let domain = Domain::new([0.0; 3], [9.0; 3], [true; 3]).unwrap();
        let mut store = Box::new(Store::<f64, 54, 256, 54, 1>::new(domain, 1e-3, 0.0));
        store.add_group(Group::free([0.0; 3])).unwrap();
        for (k, &(toward, ri, rj, units)) in pairs.iter().enumerate() {
            let length = dot(toward, toward).sqrt();
            prop_assume!(length > 0.1);
            let way = scale(toward, (ri + rj) * (1.0 + f64::from(units) * f64::EPSILON) / length);
            // The first of a pair lies on edges of the box where its site is 0.
            let from = [k % 3, k / 3 % 3, k / 9].map(|site| 3.0 * site as f64);
            let mut to = core::array::from_fn(|a| from[a] + way[a]);
            domain.wrap(&mut to, &mut [0; 3]);
            store.add_grain(2 * k as u32, 0, from, ri, 1.0).unwrap();
            store.add_grain(2 * k as u32 + 1, 0, to, rj, 1.0).unwrap();
        }
        let mut world = store.world();
        let mut seen = Listed::new();
        start_watched(&mut world, &history(0.5), |p| match p.partner {
            Partner::Grain(j) => { seen.insert((p.i as usize, j as usize)); }
            Partner::Obstacle(_) => {}
        })
        .unwrap();
        let mut touching = Listed::new();
        for j in 0..54 {
            for i in 0..j {
                let (x, y) = (world.grains.position[i], world.grains.position[j]);
                let d = domain.separation(head(x), head(y));
                if (x[3] + y[3]) - dot(d, d).sqrt() > 0.0 {
                    touching.insert((i, j));
                }
            }
        }
        prop_assume!((1..27).contains(&touching.len()), "some touch and some do not");
        prop_assert_eq!(seen, touching);
    }
}

fn words(world: &World<'_, f64>) -> Vec<(u8, u32, u32, [u64; 3])> {
    let word = |bond| match bond {
        ContactHistory::Pair { i, j, spring } => (0, i, j, spring.map(f64::to_bits)),
        ContactHistory::Obstacle {
            i,
            obstacle,
            spring,
        } => (1, i, obstacle, spring.map(f64::to_bits)),
    };
    world.contact_histories().map(word).collect()
}

/// Steps two equal crowds, one searched anew every step and one hardly ever: their springs, and
/// all else, are equal to the bit.
fn rebuild(seed: &[f64], units: &Units, law: impl Law<f64>) -> Result<(), TestCaseError> {
    let mut stores = [
        crowd(seed, &DENSE, units, 0.0),
        crowd(seed, &DENSE, units, 0.6),
    ];
    let [mut often, mut seldom] = stores.each_mut().map(|store| store.world());
    prop_assume!(start(&mut often, &law).is_ok());
    start(&mut seldom, &law).unwrap();
    let mut stretched = [0, 0];
    for n in 1..=300 {
        let went = step(&mut often, &law);
        prop_assert_eq!(went, step(&mut seldom, &law));
        if went.is_err() {
            // A driven body went too deep: compared up to here.
            break;
        }
        let springs = words(&often);
        prop_assert_eq!(&springs, &words(&seldom), "springs at step {}", n);
        if n % 20 == 0 {
            prop_assert_eq!(digest(&often), digest(&seldom), "step {}", n);
        }
        for (kind, _, _, spring) in springs {
            stretched[kind as usize] += u32::from(spring != [0; 3]);
        }
    }
    let searches = (
        often.clock.outer_list_rebuilds(),
        seldom.clock.outer_list_rebuilds(),
    );
    prop_assume!(searches.0 > 50, "stopped early");
    prop_assert!(searches.0 > 10 * searches.1, "{:?} searches", searches);
    prop_assume!(stretched[0] > 100, "few springs between grains");
    prop_assume!(stretched[1] > 10, "few springs on obstacles");
    Ok(())
}

proptest! {
    #![proptest_config(cases(12))]

    #[test]
    fn springs_survive_a_rebuild_hertz_history(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
    ) {
        rebuild(&seed, &REDUCED, history(0.5))?;
    }

    #[test]
    fn springs_survive_a_rebuild_hertz_tsuji(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 48),
    ) {
        rebuild(&seed, &SI, tsuji())?;
    }
}

/// Two grains fly at each other, so that each uses up half of what the skin allows: however wide it
/// is, they meet in the same step.
#[test]
fn two_that_fly_at_each_other_meet_in_time() {
    let law = history(0.5);
    for gap in [0.0005, 0.05, 0.15, 0.25, 0.35, 0.45] {
        let mut met: Vec<(f64, u64, Digest)> = Vec::new();
        for skin in [0.0, 0.1, 0.2, 0.3, 0.4, 5.0] {
            let mut store = Store::<f64, 2, 16, 2, 1>::new(Domain::open(), 1e-3, skin);
            store.add_group(Group::free([0.0; 3])).unwrap();
            store.add_grain(1, 0, [0.0; 3], 0.5, 0.5).unwrap();
            store
                .add_grain(2, 0, [1.0 + gap, 0.0, 0.0], 0.5, 0.5)
                .unwrap();
            let mut world = store.world();
            world.grains.velocity[0][0] = 1.0;
            world.grains.velocity[1][0] = -1.0;
            start(&mut world, &law).unwrap();
            let mut first = None;
            for n in 0..300 {
                step_watched(&mut world, &law, |_| first = first.or(Some(n))).unwrap();
            }
            met.push((skin, first.expect("they meet"), digest(&world).unwrap()));
        }
        for (skin, step, state) in &met {
            assert_eq!(
                (*step, *state),
                (met[0].1, met[0].2),
                "gap {gap}, skin {skin}"
            );
        }
    }
}

/// Few strays, however far, leave the bed its cells: all pairs are found, and none is listed twice.
#[test]
fn strays_hide_no_pair() {
    for far in [30.0, 1e4, 1e9, 1e150, f64::MAX] {
        let mut store = Store::<f64, 600, 6000, 1, 1>::new(Domain::open(), 1e-3, 0.1);
        store.add_group(Group::free([0.0; 3])).unwrap();
        let mut id = 0..;
        for k in 0..512u32 {
            let x = [k % 8, k / 8 % 8, k / 64].map(|n| 1.05 * f64::from(n) - 4.0);
            store.add_grain(id.next().unwrap(), 0, x, 0.5, 0.5).unwrap();
        }
        // On both sides of every axis, and two that touch.
        let close = if far < 1e9 { 0.99 } else { 0.0 };
        for x in [
            [far, 0.0, 0.0],
            [-far, far, 0.0],
            [0.0, 0.5 * far, -far],
            [close, 0.5 * far, -far],
        ] {
            store.add_grain(id.next().unwrap(), 0, x, 0.5, 0.5).unwrap();
        }
        let mut world = store.world();
        let started = start(&mut world, &history(0.5));
        let pairs = 3 * 7 * 64;
        match far < 1e9 {
            true => {
                assert_eq!(started, Ok(()), "{far}");
                assert_eq!(world.clock.listed(), pairs + 1);
                compare_with_all(&world, 0.1).unwrap();
            }
            // The two lie in the same place, or are too far for numbers.
            false => assert!(started.is_err() || world.clock.listed() >= pairs, "{far}"),
        }
    }
}
