//! Worlds and calls that no sound program makes: whatever is lent and in whatever order the phases are
//! called, the kernel neither panics nor hangs, and a full list changes nothing.

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::Line;
use bitgrain_kernel::contact::{Contact, HertzHistory, HertzTsuji, Law, react};
use bitgrain_kernel::phases::obstacle_forces;
use bitgrain_kernel::phases::{
    After, ExcessiveOverlap, GrainRange, accumulate, cross_range, first_excessive_overlap, no_fetch,
};
use bitgrain_kernel::phases::{MotionCheck, MotionPhase, integrate};
use bitgrain_kernel::phases::{Sealed, seal};
use bitgrain_kernel::phases::{
    begin, check_overlaps, drift, end, ensure_pair_list, ensure_pair_list_ahead, finish,
};
use bitgrain_kernel::{
    Domain, Real, Row, Store, check_arithmetic, digest, resume, start, start_watched, step,
    step_watched,
};

use super::bytes::Bytes;
use super::drawn::{
    ENTRIES, bond, domain, fault, group, lent, list, many, number, obstacle, spills, tame, vector,
    word,
};
use super::lent::Lent;
use super::lent::growing;

/// Most calls of one input.
const CALLS: usize = 48;

/// A call that may end as it likes.
fn either_way<T, E>(_: Result<T, E>) {}

/// A world of anything at all, and calls in any order. Whether it was started.
pub(super) fn world<R: Real, L: Law<R>>(bytes: &mut Bytes, law: &L) -> bool {
    let mut lent = lent::<R>(bytes);
    if bytes.below(2) == 0 {
        tame(bytes, &mut lent);
    }
    let (mut started, mut passed) = (false, MotionCheck::NONE);
    for _ in 0..CALLS {
        if bytes.0.is_empty() {
            break;
        }
        let call = bytes.below(20);
        match call {
            0 | 1 => started |= growing(&mut lent, |lent| start(&mut lent.world(), law)).is_ok(),
            2..6 => either_way(growing(&mut lent, |lent| step(&mut lent.world(), law))),
            6 => {
                let count = bytes.below(8);
                let mut histories = many(bytes, count, bond);
                // Some of its own among them.
                histories.extend(lent.world().contact_histories().take(bytes.below(4)));
                let taken = growing(&mut lent, |lent| {
                    resume(&mut lent.world(), histories.iter().copied())
                });
                started |= taken.is_ok();
            }
            7 => either_way(growing(&mut lent, |lent| {
                ensure_pair_list_ahead(&mut lent.world())
            })),
            8 => either_way(growing(&mut lent, |lent| {
                ensure_pair_list(&mut lent.world())
            })),
            9 | 10 => {
                let all = [
                    MotionPhase::CheckOnly,
                    MotionPhase::Drift,
                    MotionPhase::Kick,
                    MotionPhase::KickAndDrift,
                ];
                passed = passed.and(integrate(
                    &mut lent.world().grain_motion(),
                    all[bytes.below(4)],
                ));
            }
            11 => {
                if bytes.below(2) == 0 {
                    passed = MotionCheck {
                        speed2: number(bytes),
                        unsound: fault(bytes),
                        escaped: fault(bytes),
                    };
                }
                either_way(drift(&mut lent.world(), passed));
            }
            12 => either_way(finish(&mut lent.world(), passed)),
            13 => pushed(bytes, &mut lent, law),
            14 => in_parts(bytes, &mut lent, law),
            15 => {
                let deep =
                    |bytes: &mut Bytes| (bytes.below(4) == 0).then(|| (word(bytes), word(bytes)));
                let (hit, deep): (ExcessiveOverlap, ExcessiveOverlap) = (deep(bytes), deep(bytes));
                either_way(check_overlaps(
                    &mut lent.world(),
                    hit,
                    first_excessive_overlap(hit, deep),
                ));
            }
            16 => {
                digest(&lent.world());
                assert!(
                    lent.world().contact_histories().count() < 1000,
                    "more contacts than entries"
                );
            }
            17 => {
                let watched = start_watched(&mut lent.world(), law, |_| {});
                let stepped = step_watched(&mut lent.world(), law, |_| {});
                started |= watched.is_ok() && stepped.is_ok();
            }
            18 => {
                let sealed = sealed(bytes, &mut lent);
                either_way(match bytes.below(2) {
                    0 => begin(&mut lent.world(), sealed),
                    _ => end(&mut lent.world(), sealed),
                });
            }
            _ => spoil(bytes, &mut lent),
        }
    }
    started
}

/// The seal of all grains, or one of grains that stand elsewhere.
fn sealed<R: Real>(bytes: &mut Bytes, lent: &mut Lent<R>) -> Sealed {
    let first = if bytes.below(8) == 0 { usize::MAX } else { 0 };
    Sealed::NONE.and(seal(&lent.world().grain_motion(), first))
}

/// The phase of the forces over all grains, with spills of other ranges.
fn pushed<R: Real, L: Law<R>>(bytes: &mut Bytes, lent: &mut Lent<R>, law: &L) {
    let dt = number(bytes);
    let after = [After::Stay, After::Rest, After::FinishAndBegin][bytes.below(3)];
    let (lower, own) = (spills(bytes), spills(bytes));
    let mut world = lent.world();
    let (mut part, mut touch) = world.force_ranges(dt);
    obstacle_forces(&mut part, &mut touch, law, |_| {});
    accumulate(
        &mut part,
        law,
        lower.iter(),
        &own,
        |_| {},
        no_fetch::<R>(),
        after,
    );
    let mut out = spills(bytes);
    let (sight, mut across) = world.cross_range_pairs();
    if bytes.below(2) == 0 {
        let (left, right) = across.split(bytes.below(ENTRIES));
        cross_range(sight, right, law, &mut out);
        across = left;
    }
    cross_range(sight, across, law, &mut out);
}

/// Ranges cut anywhere.
fn in_parts<R: Real, L: Law<R>>(bytes: &mut Bytes, lent: &mut Lent<R>, law: &L) {
    let dt = number(bytes);
    let mut world = lent.world();
    let (mut part, _) = world.force_ranges(dt);
    if bytes.below(4) == 0 {
        part.first = [usize::MAX, 1, usize::from(bytes.byte())][bytes.below(3)];
    }
    let place = |bytes: &mut Bytes| [usize::MAX, bytes.below(ENTRIES)][bytes.below(2)];
    let (left, right) = part.split(place(bytes));
    for mut part in [left, right] {
        let (begin, end) = (place(bytes), place(bytes));
        let dt = part.dt;
        let passed = integrate(&mut part.grains.stretch(begin, end), MotionPhase::Kick);
        let (lower, own) = (spills(bytes), spills(bytes));
        let fetch = |_: &[Row<R>], _: usize| {};
        accumulate(
            &mut part,
            law,
            lower.iter(),
            &own,
            |_| {},
            Some(fetch),
            After::FinishAndBegin,
        );
        let GrainRange { grains, .. } = part;
        let (mut few, mut others) = grains.split(place(bytes));
        few.dt = dt;
        let _ = passed
            .and(integrate(&mut few, MotionPhase::CheckOnly))
            .and(integrate(&mut others, MotionPhase::KickAndDrift));
    }
}

/// Changes what is lent between two calls.
fn spoil<R: Real>(bytes: &mut Bytes, lent: &mut Lent<R>) {
    let place = bytes.below(ENTRIES);
    let rows = |rows: &mut Vec<Row<R>>, bytes: &mut Bytes| match rows.get_mut(place) {
        Some(row) => row[bytes.below(4)] = number(bytes),
        None => rows.truncate(place / 2),
    };
    match bytes.below(18) {
        0 => rows(&mut lent.position, bytes),
        1 => rows(&mut lent.velocity, bytes),
        2 => rows(&mut lent.spin, bytes),
        3 => rows(&mut lent.force, bytes),
        4 => rows(&mut lent.torque, bytes),
        5 => lent.lists[bytes.below(2)] = list(bytes),
        6 => lent.candidate = many(bytes, 30, word),
        7 => lent.candidate_row = many(bytes, place, word),
        8 => lent.cell_start = many(bytes, place, word),
        9 => lent.cell_grain = many(bytes, place, word),
        10 => lent.range_bounds = many(bytes, place, word),
        11 => lent.groups.truncate(place / 4),
        12 => lent.obstacles = many(bytes, 1, obstacle),
        13 => (lent.dt, lent.skin) = (number(bytes), number(bytes)),
        14 => lent.clock.step = u64::MAX - place as u64,
        15 => lent.image = many(bytes, place, |bytes| [0; 3].map(|_| word(bytes) as i32)),
        16 => lent.group = many(bytes, place, |bytes| bytes.byte()),
        _ => lent.id = many(bytes, place, word),
    }
}

/// What needs no world: boxes, obstacles, laws, hashes, lines, messages, and the store.
pub(super) fn plain<R: Real>(bytes: &mut Bytes) -> bool {
    let domain = domain::<R>(bytes);
    let (mut place, mut image) = (vector(bytes), [0; 3].map(|_| word(bytes) as i32));
    domain.wrap(&mut place, &mut image);
    domain.separation(place, vector(bytes));
    let body = obstacle::<R>(bytes);
    let checked = body.check(&domain, word(bytes));
    let contact = Contact {
        normal: vector(bytes),
        overlap: number(bytes),
        radius_i: number(bytes),
        radius_j: number(bytes),
        radius_effective: number(bytes),
        mass_effective: number(bytes),
        velocity: vector(bytes),
        spin_i: vector(bytes),
        spin_j: vector(bytes),
    };
    let [kn, kt, gamma_n, gamma_t, mu] = [0; 5].map(|_| number(bytes));
    let history = HertzHistory {
        kn,
        kt,
        gamma_n,
        gamma_t,
        mu,
    };
    let tsuji = HertzTsuji::new(number(bytes), number(bytes), number(bytes), number(bytes));
    react(&history, &contact, vector(bytes), number(bytes));
    react(&tsuji, &contact, vector(bytes), number(bytes));
    let mut hasher = Hasher::new();
    (0..bytes.byte()).for_each(|_| hasher.word(word(bytes)));
    let step = u64::from_le_bytes([0; 8].map(|_| bytes.byte()));
    let line = Line {
        real: R::NAME,
        world: "a name that is far too long for the line that it is put on, by half",
        step,
        digest: hasher.finish(),
    };
    assert_eq!(line.text().last(), Some(&b'\n'));
    assert_eq!(check_arithmetic::<R>(), Ok(()));
    if let Err(fault) = checked {
        assert!(!fault.to_string().is_empty());
    }
    stored(bytes, domain, &history)
}

/// A store that is filled and stepped in any order.
fn stored<R: Real, L: Law<R>>(bytes: &mut Bytes, domain: Domain<R>, law: &L) -> bool {
    let mut store = Store::<R, 6, 16, 8, 3>::vacant();
    let mut stepped = false;
    for id in 0..CALLS as u32 {
        if bytes.0.is_empty() {
            break;
        }
        match bytes.below(10) {
            0 => store.clear(domain, number(bytes), number(bytes)),
            1 => store = Store::new(Domain::open(), R::from_f64(0.01), R::HALF),
            2 => either_way(store.add_group(group(bytes))),
            3 => either_way(store.add_obstacle(obstacle(bytes))),
            4 | 5 => {
                let id = if bytes.below(8) == 0 { word(bytes) } else { id };
                either_way(store.add_grain(
                    id,
                    bytes.byte() % 4,
                    vector(bytes),
                    number(bytes),
                    number(bytes),
                ));
            }
            6 => store.set_skin(number(bytes)),
            7 => store.set_outer_skin(number(bytes)),
            8 => either_way(start(&mut store.world(), law)),
            _ => stepped |= step(&mut store.world(), law).is_ok(),
        }
    }
    digest(&store.world());
    stepped
}
