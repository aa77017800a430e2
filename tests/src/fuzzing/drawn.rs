//! Numbers, slices and worlds of any kind, sound or not.

use bitgrain_kernel::contact::{Kept, MEMORY_MAX};
use bitgrain_kernel::phases::{Extent, ForceCheck, ObstacleShare};
use std::sync::Arc;

use bitgrain_kernel::{
    ContactHistory, Domain, Error as KernelError, Facet, FreeMotion, Group, Motion, Obstacle, Real,
    Row, Shape, arrange,
};

use super::bytes::Bytes;
use super::lent::{Lent, add, reserve};
use bitgrain::lists::List;

/// Most entries of a slice.
pub(super) const ENTRIES: u8 = 20;

/// Any number, a likely one as often as not.
pub(super) fn number<R: Real>(bytes: &mut Bytes) -> R {
    match bytes.below(8) {
        0..4 => R::from_f64(bytes.between(-2.0, 6.0)),
        4 => [R::ZERO, -R::ZERO, R::ONE, R::EPSILON][bytes.below(4)],
        5 => [R::MAX, -R::MAX, R::LEAST, R::LEAST_NORMAL][bytes.below(4)],
        6 => R::from_f64([f64::NAN, f64::INFINITY, f64::NEG_INFINITY][bytes.below(3)]),
        _ => R::from_f64(f64::from_le_bytes([0; 8].map(|_| bytes.byte()))),
    }
}

pub(super) fn vector<R: Real>(bytes: &mut Bytes) -> [R; 3] {
    [0; 3].map(|_| number(bytes))
}

pub(super) fn row<R: Real>(bytes: &mut Bytes) -> Row<R> {
    [0; 4].map(|_| number(bytes))
}

/// Any word, a small one as often as not.
pub(super) fn word(bytes: &mut Bytes) -> u32 {
    match bytes.below(4) {
        0 => u32::from_le_bytes([0; 4].map(|_| bytes.byte())),
        1 => [u32::MAX, 1 << 31, (1 << 31) - 1, 0][bytes.below(4)],
        _ => u32::from(bytes.byte() % ENTRIES),
    }
}

pub(super) fn many<T>(
    bytes: &mut Bytes,
    count: usize,
    mut one: impl FnMut(&mut Bytes) -> T,
) -> Vec<T> {
    // A slice of another length than its fellows, now and then.
    let count = if bytes.below(16) == 0 {
        bytes.below(ENTRIES)
    } else {
        count
    };
    (0..count).map(|_| one(bytes)).collect()
}

pub(super) fn domain<R: Real>(bytes: &mut Bytes) -> Domain<R> {
    let periodic = [0; 3].map(|_| bytes.below(2) == 0);
    let drawn = Domain::new(vector(bytes), vector(bytes), periodic);
    drawn.unwrap_or_else(|_| match bytes.below(2) {
        0 => Domain::open(),
        _ => Domain::new([R::ZERO; 3], [R::from_f64(6.0); 3], periodic).expect("a box"),
    })
}

pub(super) fn group<R: Real>(bytes: &mut Bytes) -> Group<R> {
    let mut flip = || bytes.below(2) == 0;
    let integrates = [flip(), flip(), flip()];
    let (spins, heavy) = (flip(), flip());
    Group {
        integrates,
        spins,
        infinite_mass: heavy,
        gravity: vector(bytes),
        // From 0 to 3, of which a law of three knows all but one.
        material: u8::from(spins) + 2 * u8::from(heavy),
    }
}

pub(super) fn obstacle<R: Real>(bytes: &mut Bytes) -> Obstacle<R> {
    let (point, radius) = (vector(bytes), number(bytes));
    let mut body = match bytes.below(10) {
        0 => Obstacle::sphere(point, radius),
        1 => Obstacle::plane(point, vector(bytes)),
        2 => Obstacle::cylinder(point, vector(bytes), radius),
        3 => Obstacle::plane(point, [R::ZERO, R::ZERO, R::ONE]),
        4 => Obstacle::cylinder(point, [R::ZERO, R::ONE, R::ZERO], radius),
        5 => Obstacle::finite_cylinder(point, vector(bytes), radius, number(bytes)),
        6 => Obstacle::capsule(point, vector(bytes), radius, number(bytes)),
        7 => Obstacle::cuboid(point, vector(bytes)),
        8 => Obstacle::drum(point, [R::ZERO, R::ONE, R::ZERO], radius, number(bytes)),
        _ => Obstacle {
            shape: Shape::Plane {
                normal: vector(bytes),
            },
            ..Obstacle::sphere(point, radius)
        },
    };
    (body.velocity, body.inverse_mass) = (vector(bytes), number(bytes));
    (body.angular_velocity, body.curved) = match bytes.below(3) {
        0 => (vector(bytes), bytes.below(2) == 0),
        _ => ([R::ZERO; 3], false),
    };
    body.orientation = match bytes.below(4) {
        0 => [0.6, 0.0, 0.8, 0.0].map(R::from_f64),
        1 => [0; 4].map(|_| number(bytes)),
        _ => body.orientation,
    };
    if bytes.below(3) == 0 {
        body.motion = Motion::Free(FreeMotion {
            inertia: vector(bytes),
            gravity: vector(bytes),
            force: vector(bytes),
            torque: vector(bytes),
            integrates: [0; 3].map(|_| bytes.below(2) == 0),
            spins: bytes.below(2) == 0,
        });
    }
    body.image = [0; 3].map(|_| word(bytes) as i32);
    body
}

/// Triangles of any numbers, in the order of a mesh; some of them slivers, lines and points.
pub(super) fn facets<R: Real>(bytes: &mut Bytes) -> Vec<Facet<R>> {
    let count = bytes.below(6);
    let mut all = many(bytes, count, |bytes| {
        let (a, b, c) = (vector(bytes), vector(bytes), vector(bytes));
        Facet::new(match bytes.below(6) {
            0 => [a, a, a],
            1 => [a, b, a],
            2 => [a, b, [a[0] + R::EPSILON, a[1], a[2]]],
            _ => [a, b, c],
        })
    });
    arrange(&mut all);
    all
}

pub(super) fn list<R: Real>(bytes: &mut Bytes) -> List<R> {
    let (pairs, touches) = (bytes.below(40), bytes.below(ENTRIES));
    List {
        lower: many(bytes, pairs, word),
        partner: many(bytes, pairs, word),
        spring: [0; 3].map(|_| many(bytes, pairs, number)),
        obstacle_contact_grain: many(bytes, touches, word),
        obstacle_contact_obstacle: many(bytes, touches, word),
        obstacle_contact_spring: many(bytes, touches, row),
        memory: [Vec::new(), Vec::new()],
    }
}

/// What a law keeps of a contact.
pub(super) fn kept<R: Real>(bytes: &mut Bytes) -> Kept<R> {
    Kept {
        spring: vector(bytes),
        memory: [0; MEMORY_MAX].map(|_| number(bytes)),
    }
}

/// Columns of words that fit their lists as often as not.
fn memory<R: Real>(bytes: &mut Bytes, list: &mut List<R>) {
    let lengths = [list.lower.len(), list.obstacle_contact_grain.len()];
    for (columns, length) in list.memory.iter_mut().zip(lengths) {
        let words = bytes.below(MEMORY_MAX as u8 + 2);
        let length = [length, bytes.below(ENTRIES)][bytes.below(8) / 7];
        *columns = many(bytes, words, |bytes| many(bytes, length, number));
    }
}

pub(super) fn share<R: Real>(bytes: &mut Bytes) -> ObstacleShare<R> {
    ObstacleShare {
        obstacle: word(bytes),
        force: vector(bytes),
        torque: vector(bytes),
    }
}

pub(super) fn extent<R: Real>(bytes: &mut Bytes) -> Extent<R> {
    Extent {
        lo: vector(bytes),
        hi: vector(bytes),
        largest: number(bytes),
        radius: number(bytes),
        least: number(bytes),
        reach: number(bytes),
    }
}

/// What forces may have shown, now and then.
pub(super) fn found(bytes: &mut Bytes) -> ForceCheck {
    let mut seldom = || bytes.below(4) == 0;
    let [unsound, on_obstacle, of_pair] = [seldom(), seldom(), seldom()];
    let mut two = |is: bool| is.then(|| (word(bytes), word(bytes)));
    ForceCheck {
        misfit: false,
        on_obstacle: two(on_obstacle),
        of_pair: two(of_pair),
        unsound: unsound.then(|| word(bytes)),
    }
}

/// Slices that fit together as often as not, full of anything.
pub(super) fn lent<R: Real>(bytes: &mut Bytes) -> Lent<R> {
    let n = bytes.below(ENTRIES);
    let mut lent = Lent::new(domain(bytes), number(bytes));
    (lent.skin, lent.outer_skin) = (number(bytes), number(bytes));
    let mut id = 0u32;
    lent.id = many(bytes, n, |bytes| {
        id = if bytes.below(32) == 0 {
            word(bytes)
        } else {
            id.wrapping_add(1)
        };
        id
    });
    let groups = bytes.below(5);
    lent.groups = many(bytes, groups, group);
    lent.group = many(bytes, n, |bytes| bytes.byte() % 8 / 2);
    lent.position = many(bytes, n, row);
    lent.velocity = many(bytes, n, row);
    lent.spin = many(bytes, n, row);
    lent.force = many(bytes, n, row);
    lent.torque = many(bytes, n, row);
    lent.image = many(bytes, n, |bytes| [0; 3].map(|_| word(bytes) as i32));
    let bodies = bytes.below(4);
    lent.obstacles = many(bytes, bodies, obstacle);
    lent.lists = [list(bytes), list(bytes)];
    lent.candidate_row = many(bytes, n + 1, word);
    let entries = bytes.below(60);
    lent.candidate = many(bytes, entries, word);
    let cells = bytes.below(50);
    lent.cell_start = many(bytes, cells, word);
    lent.cell_grain = many(bytes, n, word);
    if bytes.below(2) == 0 {
        let bounds = bytes.below(ENTRIES);
        lent.owned = many(bytes, bounds, word);
    }
    if bytes.below(2) == 0 {
        lent.facets = Arc::new(facets(bytes));
        // As often as not some of the triangles, or none.
        let (from, to) = (word(bytes) as usize, word(bytes) as usize);
        let own = lent.facets.get(from..to).unwrap_or(&lent.facets);
        let body = Obstacle::mesh(vector(bytes), own, from as u32);
        let orientation = [0; 4].map(|_| number(bytes));
        lent.obstacles.push(Obstacle {
            orientation,
            ..body
        });
    }
    if lent.id.len() % 4 == 3 {
        let lists = &mut lent.lists;
        lists.iter_mut().for_each(|list| memory(bytes, list));
        lent.clock.set_reach(number(bytes));
    }
    lent
}

/// Sound numbers in place of the drawn ones, so that what lies beyond the checks is reached.
pub(super) fn tame<R: Real>(bytes: &mut Bytes, lent: &mut Lent<R>) {
    let half = R::HALF;
    lent.domain =
        Domain::new([R::ZERO; 3], [R::from_f64(8.0); 3], [true, true, false]).expect("a box");
    (lent.dt, lent.skin, lent.outer_skin) = (R::from_f64(0.015625), half, half);
    lent.groups = vec![Group::free([R::ZERO, R::ZERO, -R::ONE]), Group::frozen()];
    lent.obstacles.truncate(1);
    lent.obstacles
        .fill(Obstacle::plane([R::ZERO; 3], [R::ZERO, R::ZERO, R::ONE]));
    let mut grains = Lent::new(lent.domain, lent.dt);
    for k in 0..bytes.below(ENTRIES) {
        let at = [k % 4, k / 4 % 4, k / 16].map(|n| 1.02 * n as f64 + 0.5);
        let [x, y, z] = at.map(|x| R::from_f64(x - 0.1 * bytes.between(0.0, 1.0)));
        let [u, v, w] = bytes.vector().map(R::from_f64);
        let group = (k % 7 == 6).into();
        let velocity = if group == 1 { [R::ZERO; 3] } else { [u, v, w] };
        add(
            &mut grains,
            group,
            [x, y, z, half],
            [velocity[0], velocity[1], velocity[2], R::ONE],
            [R::ZERO; 3],
        );
    }
    (lent.id, lent.group) = (grains.id, grains.group);
    (lent.position, lent.velocity, lent.spin) = (grains.position, grains.velocity, grains.spin);
    (lent.force, lent.torque, lent.image) = (grains.force, grains.torque, grains.image);
    lent.candidate_row.resize(lent.position.len() + 1, 0);
    for list in &mut lent.lists {
        *list = List::default();
        // As many as the laws of the fuzzers keep at most.
        let made = list.keep_words(3);
        made.expect("no memory is asked for yet");
    }
    lent.clock.set_reach(R::ZERO);
    reserve(lent, bytes.below(60), bytes.below(60), bytes.below(30));
}

pub(super) fn bond<R: Real>(bytes: &mut Bytes) -> ContactHistory<R> {
    let (i, partner) = (word(bytes), word(bytes));
    let spring = vector(bytes);
    match bytes.below(2) {
        0 => ContactHistory::Pair {
            i,
            j: partner,
            spring,
        },
        _ => ContactHistory::Obstacle {
            i,
            obstacle: partner,
            spring,
        },
    }
}

pub(super) fn fault(bytes: &mut Bytes) -> Option<KernelError> {
    (bytes.below(4) == 0).then(|| KernelError::Escaped { id: word(bytes) })
}
