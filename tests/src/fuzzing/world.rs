//! Small worlds straight at the kernel, in floats of either precision and in fixed point, under either law.
//!
//! Sound ones, whose storage is too short as often as not: a full list leaves state, clock and digest as
//! they were, and with more room the run goes on to the digests of one that had room from the beginning.
//! Unsound ones are in `hostile.rs`.

use std::sync::Arc;

use crate::fuzzing::lent::add;
use crate::fuzzing::lent::growing;
use crate::fuzzing::lent::reserve;
use crate::fuzzing::lent::reserve_all;
use bitgrain_kernel::contact::{
    HertzHistory, HertzTsuji, Law, Rolling, RollingResistance, RollingSpring,
};
use bitgrain_kernel::phases::{Sealed, begin, end, seal};
use bitgrain_kernel::{
    Domain, Error as KernelError, Facet, Group, Obstacle, PARTS, Real, World, arrange, digest,
    resume, start, step,
};

use super::bytes::Bytes;
use super::exact::Exact;
use super::lent::Lent;
use super::parts::{Ghosts, Parts};
use super::{drawn, hostile};

/// Most grains of a sound world.
const GRAINS: u8 = 12;
const STEPS: u8 = 40;

/// A small world: sound or hostile, as the first byte says.
pub fn world(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    match bytes.byte() % 6 {
        0 => hostile::plain::<f64>(&mut bytes) | hostile::plain::<f32>(&mut bytes),
        1 => under_a_law::<f64>(&mut bytes, true),
        2 => under_a_law::<f32>(&mut bytes, true),
        3 => under_a_law::<f32>(&mut bytes, false),
        // Every operation is checked; what overflows must end the run with an error.
        5 => {
            let is_hostile = bytes.below(4) == 0;
            under_a_law::<Exact>(&mut bytes, is_hostile)
        }
        _ => under_a_law::<f64>(&mut bytes, false),
    }
}

fn under_a_law<R: Real>(bytes: &mut Bytes, is_hostile: bool) -> bool {
    // Few inputs roll, so that most of those that were found before mean what they meant.
    let byte = bytes.byte();
    let which = if byte >= 192 { 2 } else { byte % 2 };
    match (which, is_hostile) {
        (0, true) => {
            let [kn, kt, gamma_n, gamma_t, mu] = [0; 5].map(|_| drawn::number(bytes));
            let law = HertzHistory {
                kn,
                kt,
                gamma_n,
                gamma_t,
                mu,
            };
            hostile::world::<R, _>(bytes, &law)
        }
        (1, true) => {
            let [young, poisson, restitution, mu] = [0; 4].map(|_| drawn::number(bytes));
            hostile::world::<R, _>(bytes, &HertzTsuji::new(young, poisson, restitution, mu))
        }
        (_, true) => {
            let law = HertzTsuji::new(1e4, 0.3, 0.5, 0.5);
            let resistance = RollingResistance {
                spring: [RollingSpring::Sds, RollingSpring::Epsd2][bytes.below(2)],
                k: drawn::number(bytes),
                gamma: drawn::number(bytes),
                mu: drawn::number(bytes),
            };
            hostile::world::<R, _>(bytes, &Rolling { law, resistance })
        }
        (0, false) => {
            let (mut lent, stiff) = bed::<R>(bytes);
            let [kn, kt] = [stiff, stiff * bytes.between(0.0, 1.5)].map(R::from_f64);
            let [gamma_n, gamma_t] = [0; 2].map(|_| R::from_f64(bytes.zero_or_scale(-2.0, 2.0)));
            let mu = R::from_f64(bytes.zero_or_scale(-2.0, 1.0));
            runs(
                bytes,
                &mut lent,
                &HertzHistory {
                    kn,
                    kt,
                    gamma_n,
                    gamma_t,
                    mu,
                },
            )
        }
        (rolls, false) => {
            let (mut lent, stiff) = bed::<R>(bytes);
            let (poisson, restitution) = (bytes.between(-0.9, 0.5), bytes.between(0.01, 1.0));
            let mu = bytes.zero_or_scale(-2.0, 1.0);
            let law = HertzTsuji::new(stiff, poisson, restitution, mu);
            if rolls < 2 {
                return runs(bytes, &mut lent, &law);
            }
            let resistance = RollingResistance {
                spring: [RollingSpring::Sds, RollingSpring::Epsd2][bytes.below(2)],
                k: R::from_f64(stiff * bytes.between(0.0, 0.1)),
                gamma: R::from_f64(bytes.zero_or_scale(-4.0, 0.0)),
                mu: R::from_f64(bytes.zero_or_scale(-2.0, 1.0)),
            };
            let made = lent.keep_words(3);
            made.expect("memory for a few words");
            runs(bytes, &mut lent, &Rolling { law, resistance })
        }
    }
}

/// Runs a world with the storage that was drawn, and its twin with ample storage and another skin.
fn runs<R: Real, L: Law<R>>(bytes: &mut Bytes, lent: &mut Lent<R>, law: &L) -> bool {
    let mut twin = lent.clone();
    reserve_all(&mut twin);
    let skin = lent.skin * R::from_f64([0.0, 0.5, 1.0, 4.0][bytes.below(4)]);
    if lent.skin >= R::ZERO && skin.is_finite() {
        twin.skin = skin;
    }
    let began = growing(lent, |lent| start(&mut lent.world(), law));
    assert_eq!(
        began,
        start(&mut twin.world(), law),
        "a start depends on storage"
    );
    assert_same(lent, &mut twin);
    if began.is_err() {
        return false;
    }
    let sizes = sizes(lent);
    for done in 0..1 + bytes.byte() % STEPS {
        assert_finite(lent);
        let mut count = 1;
        let went = match bytes.below(8) {
            0 => {
                let histories: Vec<_> = lent.world().kept_contacts().collect();
                let went = growing(lent, |lent| {
                    resume(&mut lent.world(), histories.iter().copied())
                });
                match went {
                    Ok(()) => {}
                    // Grains may have flown so far that their numbers are too coarse to begin with.
                    Err(KernelError::TooSlow { .. } | KernelError::ObstacleTooSlow { .. })
                    | Err(KernelError::GravityTooWeak { .. }) => return true,
                    Err(fault) => panic!("a state that rests is not taken up again: {fault}"),
                }
                assert_same(lent, &mut twin);
                continue;
            }
            1..4 => {
                count = 1 + bytes.below(3) as u64;
                in_parts(bytes, lent, law, count)
            }
            _ => growing(lent, |lent| step(&mut lent.world(), law)),
        };
        let steps = twin.clock.step;
        assert_eq!(
            went,
            (0..count).try_for_each(|_| step(&mut twin.world(), law)),
            "a step depends on storage, skin or parts"
        );
        if went.is_err() {
            return done > 0;
        }
        let steps = steps + count;
        assert_eq!((lent.clock.step, twin.clock.step), (steps, steps));
        assert_same(lent, &mut twin);
        assert_eq!(self::sizes(lent), sizes, "a grain's size or mass changed");
    }
    assert_finite(lent);
    true
}

/// Radii and masses, in words.
fn sizes<R: Real>(lent: &Lent<R>) -> Vec<[(u32, Option<u32>); 2]> {
    let rows = lent.position.iter().zip(&lent.velocity);
    rows.map(|(x, v)| [x[3].to_words(), v[3].to_words()])
        .collect()
}

fn assert_same<R: Real>(one: &mut Lent<R>, other: &mut Lent<R>) {
    let state = |world: &World<'_, R>| digest(world).expect("it has a state");
    let (a, b) = (state(&one.world()), state(&other.world()));
    for ((part, a), b) in PARTS.iter().zip(a.parts()).zip(b.parts()) {
        assert_eq!(a, b, "{part} depend on storage, skin or parts");
    }
}

fn assert_finite<R: Real>(lent: &Lent<R>) {
    let rows = [
        &lent.position,
        &lent.velocity,
        &lent.spin,
        &lent.force,
        &lent.torque,
    ];
    for row in rows.into_iter().flatten() {
        assert!(row.iter().all(|x| x.is_finite()), "{row:?}");
    }
    for body in &lent.obstacles {
        let parts = [body.point, body.velocity, body.force, body.torque];
        assert!(parts.iter().flatten().all(|x| x.is_finite()), "{body:?}");
    }
}

/// Steps as in a host with threads, in parts that own any grains.
fn in_parts<R: Real, L: Law<R>>(
    bytes: &mut Bytes,
    lent: &mut Lent<R>,
    law: &L,
    count: u64,
) -> Result<(), KernelError> {
    let owner = owners(bytes, lent.position.len());
    let ghosts = [Ghosts::All, Ghosts::Near][bytes.below(2)];
    let places = [0; 3].map(|_| usize::from(bytes.byte() % (GRAINS + 1)));
    let mut world = lent.world();
    let sealed = seal_ranges(&mut world, places);
    begin(&mut world, sealed)?;
    let mut parts = Parts::of(&world, &owner, ghosts);
    let went = parts.steps(law, count, &mut |_| ());
    while let Err(fault) = parts.rejoin(&mut lent.world()) {
        if !lent.grow(fault) {
            return Err(fault);
        }
    }
    went?;
    let mut world = lent.world();
    let sealed = seal_ranges(&mut world, places);
    end(&mut world, sealed)
}

/// Who owns each of so many grains: up to four parts, some of which may own none.
pub(super) fn owners(bytes: &mut Bytes, grains: usize) -> Vec<u8> {
    let parts = 1 + bytes.below(4) as u8;
    (0..grains).map(|_| bytes.byte() % parts).collect()
}

/// The seal of all grains, made over the ranges that end at these places.
fn seal_ranges<R: Real>(world: &mut World<'_, R>, mut places: [usize; 3]) -> Sealed {
    places.sort_unstable();
    let (mut first, mut rest) = (0, world.grain_motion());
    let mut all = Sealed::NONE;
    for end in places {
        let (range, others) = rest.split(end.saturating_sub(first));
        let count = range.count();
        all = all.and(seal(&range, first));
        (first, rest) = (first + count, others);
    }
    all.and(seal(&rest, first))
}

/// A chain of grains that touch or nearly touch, with obstacles among them, and a stiffness that its time
/// step can follow, more or less. Storage is as short as it may be drawn.
fn bed<R: Real>(bytes: &mut Bytes) -> (Lent<R>, f64) {
    let size = bytes.scale(-3.0, 3.0);
    let dt = bytes.scale(-6.0, 0.0);
    let rows = |v: [f64; 3], w: f64| [v[0], v[1], v[2], w].map(R::from_f64);
    let length = [0; 3].map(|_| size * bytes.between(5.0, 12.0));
    let periodic = [0; 3].map(|_| bytes.below(2) == 0);
    let domain = Domain::new([R::ZERO; 3], length.map(R::from_f64), periodic);
    let domain = domain
        .ok()
        .filter(|_| bytes.below(5) > 0)
        .unwrap_or_else(Domain::open);
    let mut lent = Lent::new(domain, R::from_f64(dt));
    lent.skin = R::from_f64(size * [0.0, 0.01, 0.2, 1.0][bytes.below(4)]);
    lent.outer_skin = R::from_f64(size * [0.0, 0.01, 0.2, 1.0][bytes.below(4)]);
    let gravity = [0.0, 0.0, -bytes.zero_or_scale(-3.0, 2.0)].map(R::from_f64);
    lent.groups = vec![
        Group::free(gravity),
        Group::frozen(),
        Group::prescribed_velocity(),
        Group::free_along_z(gravity),
    ];
    let mut place = [0, 1, 2].map(|a| length[a] * bytes.between(0.1, 0.9));
    let speed = size / dt * bytes.scale(-6.0, -0.2);
    for _ in 0..bytes.below(3) {
        let point = [0, 1, 2].map(|a| R::from_f64(length[a] * bytes.between(0.0, 1.0)));
        let along = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][bytes.below(3)];
        let along = along.map(R::from_f64);
        let radius = R::from_f64(size * bytes.between(0.2, 2.0));
        let mut body = match bytes.below(3) {
            0 => Obstacle::plane(point, along),
            1 => Obstacle::cylinder(point, along, radius),
            _ => Obstacle::sphere(point, radius),
        };
        body.velocity = bytes
            .vector()
            .map(|v| R::from_f64(v * speed * bytes.below(2) as f64));
        body.inverse_mass = R::from_f64(bytes.zero_or_scale(-3.0, 3.0));
        lent.obstacles.push(body);
    }
    let mut before = 0.0;
    for _ in 0..bytes.byte() % GRAINS {
        let radius = 0.5 * size * [1.0, 0.9, 0.7, 0.3][bytes.below(4)];
        let way = bytes.direction();
        let apart = (before + radius) * bytes.between(0.93, 1.1);
        let mut at = [0, 1, 2].map(|a| R::from_f64(place[a] + way[a] * apart));
        domain.wrap(&mut at, &mut [0; 3]);
        place = at.map(R::to_f64);
        before = radius;
        let group = [0, 0, 0, 0, 1, 2, 3][bytes.below(7)];
        let moves = [1.0, 0.0, 1.0, 1.0][usize::from(group)];
        let velocity = bytes.vector().map(|v| v * speed * moves);
        let spins = [1.0, 0.0, 0.0, 1.0][usize::from(group)];
        let spin = bytes
            .vector()
            .map(|w| R::from_f64(w * spins * speed / radius));
        let mass = size * size * size * bytes.between(0.05, 1.0);
        add(
            &mut lent,
            group,
            rows(place, radius),
            rows(velocity, mass),
            spin,
        );
    }
    if bytes.below(2) == 0 {
        let at = |bytes: &mut Bytes| bytes.vector().map(|x| R::from_f64(x * size));
        let mut facets: Vec<_> = (0..1 + bytes.below(4))
            .map(|k| {
                let (a, b) = (at(bytes), at(bytes));
                Facet::new([a, b, if k % 3 == 2 { a } else { at(bytes) }])
            })
            .collect();
        arrange(&mut facets);
        lent.obstacles
            .push(Obstacle::mesh(place.map(R::from_f64), &facets, 0));
        lent.facets = Arc::new(facets);
    }
    lent.cell_start = vec![9; 2 + bytes.below(60)];
    reserve(&mut lent, bytes.below(30), bytes.below(30), bytes.below(12));
    let stiff = size / (dt * dt) * bytes.scale(-5.0, 0.0);
    (lent, stiff)
}
