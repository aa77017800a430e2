//! Worlds and calls that no sound program makes: whatever is lent and in whatever order the phases are
//! called, the kernel neither panics nor hangs, and a full list changes nothing.

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::Line;
use bitgrain_kernel::contact::{
    Contact, HertzHistory, HertzTsuji, Law, PairLaws, Rolling, RollingResistance, RollingSpring,
    react,
};
use bitgrain_kernel::parts::{
    GONE, is_search_due, listed_obstacle_contacts, listed_pairs, renumber, restore,
    search_and_list, take_in, take_lists,
};
use bitgrain_kernel::phases::{
    After, GrainRange, MotionCheck, MotionPhase, NotedForces, Owned, Sealed, accumulate, begin,
    check_forces, drift, end, ensure_pair_list, ensure_pair_list_ahead, finish, integrate,
    is_draining, measure, no_fetch, obstacle_forces, seal, sum_on_obstacles,
};
use bitgrain_kernel::{
    Domain, Obstacle, Real, Row, Shape, Store, check_arithmetic, digest, resume, start,
    start_watched, step, step_watched,
};

use super::bytes::Bytes;
use super::drawn::{
    ENTRIES, bond, domain, extent, facets, fault, found, group, kept, lent, list, many, number,
    obstacle, share, tame, vector, word,
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
        let call = bytes.below(22);
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
                        draining: bytes.below(4) == 0,
                    };
                }
                either_way(drift(&mut lent.world(), passed));
            }
            12 => either_way(finish(&mut lent.world(), passed)),
            13 => pushed(bytes, &mut lent, law),
            14 => in_pieces(bytes, &mut lent, law),
            15 => either_way(check_forces(
                &mut lent.world(),
                found(bytes).and(found(bytes)),
            )),
            16 => {
                either_way(digest(&lent.world()));
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
            19 | 20 => as_part(bytes, &mut lent),
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

/// The phase of the forces over all grains, with room for shares or not.
fn pushed<R: Real, L: Law<R>>(bytes: &mut Bytes, lent: &mut Lent<R>, law: &L) {
    let dt = number(bytes);
    let after = [After::Stay, After::Rest, After::FinishAndBegin][bytes.below(3)];
    let room = bytes.below(ENTRIES);
    let mut shares = many(bytes, room, share);
    let mut world = lent.world();
    let (mut part, mut touch) = world.force_ranges(dt);
    touch.shares = &mut shares;
    let (places, rows) = (bytes.below(ENTRIES), bytes.below(ENTRIES));
    let places = many(bytes, places, word);
    let mut forces = vec![[R::ZERO; 4]; rows];
    part.noted = NotedForces {
        place: &places,
        force: &mut forces,
    };
    let hit = obstacle_forces(&mut part, &mut touch, law, |_| {});
    let (deep, passed) = accumulate(&mut part, law, |_| {}, no_fetch::<R>(), after);
    let _ = (hit.and(deep), passed);
    sum_on_obstacles(world.obstacles, shares.into_iter());
}

/// Rows and stretches cut anywhere.
fn in_pieces<R: Real, L: Law<R>>(bytes: &mut Bytes, lent: &mut Lent<R>, law: &L) {
    let dt = number(bytes);
    let mut world = lent.world();
    let (mut part, _) = world.force_ranges(dt);
    let place = |bytes: &mut Bytes| [usize::MAX, bytes.below(ENTRIES)][bytes.below(2)];
    let (begin, end) = (place(bytes), place(bytes));
    let passed = integrate(&mut part.grains.stretch(begin, end), MotionPhase::Kick);
    let bounds = bytes.below(ENTRIES);
    let bounds = many(bytes, bounds, word);
    part.owned = Owned::new(&bounds);
    let fetch = |_: &[Row<R>], _: usize| {};
    accumulate(&mut part, law, |_| {}, Some(fetch), After::FinishAndBegin);
    let GrainRange { grains, .. } = part;
    let (mut few, mut others) = grains.split(place(bytes));
    few.dt = number(bytes);
    let _ = passed
        .and(integrate(&mut few, MotionPhase::CheckOnly))
        .and(integrate(&mut others, MotionPhase::KickAndDrift));
}

/// What hosts of parts call, with tables of anything.
fn as_part<R: Real>(bytes: &mut Bytes, lent: &mut Lent<R>) {
    let count = bytes.below(ENTRIES);
    match bytes.below(9) {
        0 => {
            let places = many(bytes, count, word);
            let ghosts = many(bytes, count, |bytes| [0; 3].map(|_| vector(bytes)));
            take_in(&mut lent.world(), &places, &ghosts);
        }
        1 => {
            // As often as not it fits.
            let length = [lent.clock.count(), count][bytes.below(2)];
            let place = |bytes: &mut Bytes| [word(bytes), GONE][bytes.below(2)];
            let places: Vec<u32> = (0..length).map(|_| place(bytes)).collect();
            let grains = [usize::MAX, bytes.below(ENTRIES)][bytes.below(2)];
            either_way(renumber(&mut lent.world(), &places, grains));
        }
        2 => {
            let mut far = extent(bytes);
            if bytes.below(2) == 0 {
                far = measure(&lent.world()).and(far);
            }
            either_way(growing(lent, |lent| {
                search_and_list(&mut lent.world(), &far)
            }));
        }
        3 => {
            let own = measure(&lent.world());
            either_way(growing(lent, |lent| {
                search_and_list(&mut lent.world(), &own)
            }));
        }
        4 => {
            let histories = many(bytes, count, bond);
            either_way(restore(&mut lent.world(), histories));
        }
        5 => {
            let pairs = many(bytes, count, |bytes| {
                (word(bytes), word(bytes), kept(bytes))
            });
            let contacts = bytes.below(ENTRIES);
            let contacts = many(bytes, contacts, |bytes| {
                (word(bytes), word(bytes), kept(bytes))
            });
            let mut world = lent.world();
            either_way(take_lists(
                &mut world,
                pairs.into_iter(),
                contacts.into_iter(),
            ));
        }
        6 => lent.clock = lent.clock.of_part(count),
        7 => {
            let mut part = lent.clock.of_part(count);
            part.step = word(bytes).into();
            let most = [u64::MAX, word(bytes).into()][bytes.below(2)];
            lent.clock.rejoin(&part, most, most);
        }
        _ => {
            let world = lent.world();
            let _ = (is_search_due(&world), is_draining(&world));
            let listed = listed_pairs(&world).count() + listed_obstacle_contacts(&world).count();
            assert!(listed < 2000, "more than entries");
        }
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
        10 => lent.owned = many(bytes, place, word),
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
    let all = facets(bytes);
    let mesh = Obstacle::new(
        Shape::Mesh {
            first: word(bytes),
            count: word(bytes),
            reach: number(bytes),
            name: u64::from(word(bytes)),
        },
        vector(bytes),
    );
    for body in [body, mesh] {
        body.meet(word(bytes), &all, &domain, vector(bytes), number(bytes));
    }
    let contact = Contact {
        normal: vector(bytes),
        overlap: number(bytes),
        radius_i: number(bytes),
        radius_j: number(bytes),
        radius_effective: number(bytes),
        mass_effective: number(bytes),
        inverse_masses: [number(bytes), number(bytes)],
        materials: [0; 2].map(|_| bytes.byte()),
        velocity: vector(bytes),
        spin_i: vector(bytes),
        spin_j: vector(bytes),
        turning_j: vector(bytes),
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
    react(&history, &contact, kept(bytes), number(bytes));
    react(&tsuji, &contact, kept(bytes), number(bytes));
    let resistance = RollingResistance {
        spring: [RollingSpring::Sds, RollingSpring::Epsd2][bytes.below(2)],
        k: number(bytes),
        gamma: number(bytes),
        mu: number(bytes),
    };
    let law = Rolling {
        law: tsuji,
        resistance,
    };
    react(&law, &contact, kept(bytes), number(bytes));
    let laws = [history; 6];
    let count = bytes.byte();
    assert_eq!(PairLaws::new(count, &laws).is_some(), count == 3);
    let table = PairLaws::new(3, &laws).expect("six pairs");
    react(&table, &contact, kept(bytes), number(bytes));
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
    match bytes.below(3) {
        0 => stored(bytes, domain, &table),
        1 => stored(bytes, domain, &law),
        _ => stored(bytes, domain, &history),
    }
}

/// A store that is filled and stepped in any order.
fn stored<R: Real, L: Law<R>>(bytes: &mut Bytes, domain: Domain<R>, law: &L) -> bool {
    let mut store = Store::<R, 6, 16, 8, 3, 3>::vacant();
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
    either_way(digest(&store.world()));
    stepped
}
