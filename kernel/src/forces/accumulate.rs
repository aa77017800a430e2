//! Forces: what the law says of every listed pair, and the sums in the contract's order.
//!
//! The force on a grain is the sum from +0.0 over obstacles by ascending number, then over
//! neighbours by ascending id. A half list walked with `i` and `j` ascending gives that order to
//! both partners without a sort: contributions of earlier rows were added before, in order, when the
//! row of grain `g` is walked. The chain of orderings, so that no change breaks one link unnoticed:
//!
//! * pairs are listed by `i` and then `j`, ascending, stretch of grains by stretch;
//! * a block of them is evaluated at once but summed pair by pair; a pair that does not touch gives
//!   +0.0, which changes no sum that began at +0.0;
//! * a range of grains first takes what pairs with lower ranges give it (their [`CrossRangeForce`]s, in order),
//!   then walks the pairs within it, then, stretch by stretch, takes what its pairs with higher ranges
//!   give. So any cut into ranges gives the bits of one range.
//!
//! After the pairs of a stretch nothing is added to the forces on its grains and nothing reads their rows any more:
//! they can be kicked, and moved on, while their rows are in the cache.

use crate::contact::block::{BLOCK, Block, Bodies};
use crate::contact::law::Law;
use crate::forces::stretch_range::{Cursor, StretchRange};
use crate::integrate::{GrainMotion, MotionCheck, MotionPhase, integrate, travel_at};
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::rows::{
    add_at, get_or_default, halves_mut, min, part, part_mut, prefix, set, split_at, sub_at, times,
};
use crate::math::vec3::Vec3;
use crate::state::domain::Domain;

/// Listed pairs, one after the other, with their springs.
pub struct PairRange<'a, R> {
    /// Place of the lower grain of each.
    pub lower: &'a [u32],
    /// Place of the higher grain.
    pub partner: &'a [u32],
    /// Tangential spring, component by component.
    pub spring: [&'a mut [R]; 3],
}

impl<R: Real> PairRange<'_, R> {
    /// How many pairs there are.
    pub fn len(&self) -> usize {
        self.lower.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.lower.is_empty()
    }

    /// The first `pairs` of them, and the others.
    #[inline(always)]
    pub fn split(self, pairs: usize) -> (Self, Self) {
        let lower = split_at(self.lower, pairs);
        let partner = split_at(self.partner, pairs);
        let [x, y, z] = self.spring.map(|s| halves_mut(s, pairs));
        let left = Self {
            lower: lower.0,
            partner: partner.0,
            spring: [x.0, y.0, z.0],
        };
        let right = Self {
            lower: lower.1,
            partner: partner.1,
            spring: [x.1, y.1, z.1],
        };
        (left, right)
    }
}

/// A range of grains and the pairs within it: what the force phase reads and writes. Ranges share
/// nothing.
pub struct GrainRange<'a, R> {
    /// Place of its first grain.
    pub first: usize,
    /// Its grains.
    pub grains: GrainMotion<'a, R>,
    /// Its stretches.
    pub stretches: StretchRange<'a, R>,
    /// Its pairs.
    pub pairs: PairRange<'a, R>,
    /// Time that the tangential springs advance by; 0 at step 0.
    pub dt: R,
}

impl<R: Real> GrainRange<'_, R> {
    /// The first `grains` of the range, and the others. No listed pair may have one grain in each: cut
    /// at the place where the list was cut.
    pub fn split(self, grains: usize) -> (Self, Self) {
        let middle = self.first.saturating_add(grains);
        let before = self.stretches.pairs.len();
        let places = prefix(self.stretches.place, before);
        let before = places.partition_point(|&i| (i as usize) < middle);
        let begin = |s| get_or_default(self.stretches.begin, s);
        let pairs = begin(before).saturating_sub(begin(0)) as usize;
        let (left, right) = self.grains.split(grains);
        let (within, others) = self.pairs.split(pairs);
        let (lower, higher) = self.stretches.split(before);
        let left = Self {
            first: self.first,
            grains: left,
            stretches: lower,
            pairs: within,
            dt: self.dt,
        };
        let right = Self {
            first: middle,
            grains: right,
            stretches: higher,
            pairs: others,
            dt: self.dt,
        };
        (left, right)
    }
}

/// What pairs of two ranges read: the rows of all grains.
#[derive(Clone, Copy)]
pub struct GrainView<'a, R> {
    /// The box.
    pub domain: &'a Domain<R>,
    /// Positions and radii.
    pub position: &'a [Row<R>],
    /// Velocities and masses.
    pub velocity: &'a [Row<R>],
    /// Spins and inverse contact masses.
    pub spin: &'a [Row<R>],
    /// Time that the tangential springs advance by; 0 at step 0.
    pub dt: R,
}

/// What a pair of two ranges gives its grains; +0.0 if it does not touch.
#[derive(Clone, Copy, Debug, Default)]
pub struct CrossRangeForce<R> {
    /// Place of the lower grain.
    pub i: u32,
    /// Place of the higher grain.
    pub j: u32,
    /// Force on `i`; the last word is zero.
    pub force: Row<R>,
    /// Normal crossed with the tangential force; the last word is zero.
    pub couple: Row<R>,
    /// Lever about `i`.
    pub lever_arm_i: R,
    /// Lever about `j`.
    pub lever_arm_j: R,
}

/// The other body of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partner {
    /// The grain at this place.
    Grain(u32),
    /// The obstacle of this number.
    Obstacle(u32),
}

/// One touching contact as it was evaluated, for the observer of a step.
#[derive(Clone, Copy, Debug)]
pub struct ContactForce<R> {
    /// Place of the grain (the lower one of two).
    pub i: u32,
    /// Its partner.
    pub partner: Partner,
    /// Depth of the overlap (length).
    pub overlap: R,
    /// Unit vector from the partner to the grain.
    pub normal: Vec3<R>,
    /// Normal force on the grain along `normal`; negative when it pulls.
    pub normal_force: R,
    /// Tangential force on the grain.
    pub tangential_force: Vec3<R>,
}

/// Two places whose grains overlap beyond the limit, or nothing.
pub type ExcessiveOverlap = Option<(u32, u32)>;

/// The lower of two deepest pairs: what one range over both would have found first.
pub fn first_excessive_overlap(a: ExcessiveOverlap, b: ExcessiveOverlap) -> ExcessiveOverlap {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b < a { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Evaluates pairs of two ranges into `out`, one entry for each pair; entries for which
/// `out` is too short are lost.
#[inline(always)]
pub fn cross_range<R: Real, L: Law<R>>(
    view: GrainView<'_, R>,
    mut pairs: PairRange<'_, R>,
    law: &L,
    out: &mut [CrossRangeForce<R>],
) -> ExcessiveOverlap {
    let (law, domain) = (*law, *view.domain);
    let bodies = Bodies {
        first: 0,
        position: view.position,
        velocity: view.velocity,
        spin: view.spin,
    };
    let mut block = Block::new();
    let mut deep = None;
    let mut out = out.iter_mut();
    let mut done = 0;
    while done < pairs.len() {
        let end = min(done + BLOCK, pairs.len());
        block.clear();
        take(&mut block, bodies, &pairs, done, end);
        block.evaluate(&domain, &law, view.dt);
        let [x, y, z] = &mut pairs.spring;
        block.keep(0, [x, y, z].map(|s| part_mut(s, done, end)));
        let shares = block.places().zip(block.shares());
        for (((i, j), (force, couple, lever_arm_i, lever_arm_j)), out) in shares.zip(&mut out) {
            *out = CrossRangeForce {
                i: *i,
                j: *j,
                force: *force,
                couple: *couple,
                lever_arm_i,
                lever_arm_j,
            };
        }
        deep = deep.or_else(|| deepest(&block));
        done = end;
    }
    deep
}

/// A hint that a row will be wanted; see [`accumulate`].
pub type Fetch<R> = fn(&[Row<R>], usize);

/// No hint.
pub const fn no_fetch<R>() -> Option<Fetch<R>> {
    None
}

/// What becomes of a grain whose sum is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum After {
    /// Nothing.
    Stay,
    /// The step ends for it: [`MotionPhase::Kick`].
    Rest,
    /// The next step begins for it too: [`MotionPhase::KickAndDrift`].
    FinishAndBegin,
}

/// Sums the forces and torques of a range that already hold the obstacles' share, and does `after`
/// with each grain whose sum is complete.
///
/// `lower` are spills whose higher grain is in the range, `own` those whose lower grain is, both in
/// order. With one range over all grains both are empty, and this is the definition. `watch` sees
/// every contact evaluated here (not the spills); it cannot change one. `fetch`, if there is one, is
/// called a block ahead with rows and a place that will be wanted: a hint to bring them near, for
/// worlds larger than a cache.
#[inline(always)]
pub fn accumulate<'s, R: Real, L: Law<R>>(
    range: &mut GrainRange<'_, R>,
    law: &L,
    lower: impl Iterator<Item = &'s CrossRangeForce<R>>,
    own: &[CrossRangeForce<R>],
    mut watch: impl FnMut(ContactForce<R>),
    fetch: Option<impl Fn(&[Row<R>], usize)>,
    after: After,
) -> (ExcessiveOverlap, MotionCheck<R>) {
    let (first, dt) = (range.first, range.dt);
    let GrainRange {
        grains,
        pairs,
        stretches,
        ..
    } = range;
    // Local copies: the compiler must see that nothing written here can change them.
    let (law, domain) = (*law, *grains.domain);
    // One length for all rows, so that a place is checked once for all of them.
    let all = grains.count();
    let grains = &mut grains.stretch(0, all);
    for one in lower {
        let j = (one.j as usize).wrapping_sub(first);
        sub_at(grains.force, j, &one.force);
        sub_at(grains.torque, j, &times(&one.couple, one.lever_arm_j));
    }
    let mut own = own;
    let mut block = Block::new();
    let (mut deep, mut passed) = (None, MotionCheck::NONE);
    let mut next = Cursor::default();
    let mut finished = 0;
    let count = min(stretches.travel.len(), stretches.pairs.len());
    while finished < count {
        let bodies = Bodies {
            first,
            position: grains.position,
            velocity: grains.velocity,
            spin: grains.spin,
        };
        let begin = next;
        block.clear();
        while let Some(piece) = next.take(stretches, block.room()) {
            take(&mut block, bodies, pairs, piece.start, piece.end);
        }
        if let Some(fetch) = &fetch {
            for j in pairs.partner.iter().skip(next.entry(stretches)).take(BLOCK) {
                let j = (*j as usize).wrapping_sub(first);
                fetch(bodies.position, j);
                fetch(bodies.velocity, j);
                fetch(bodies.spin, j);
                fetch(grains.force, j);
                fetch(grains.torque, j);
            }
        }
        block.evaluate(&domain, &law, dt);
        let (mut again, mut kept) = (begin, 0);
        while let Some(piece) = again.take(stretches, BLOCK - kept) {
            let [x, y, z] = &mut pairs.spring;
            block.keep(kept, [x, y, z].map(|s| part_mut(s, piece.start, piece.end)));
            kept += piece.len();
        }
        add_shares(grains, &block, first);
        show(&block, &mut watch);
        deep = deep.or_else(|| deepest(&block));
        // Sums of these stretches are complete but for what pairs with higher ranges give.
        for s in finished..next.stretch {
            let place = |s| (get_or_default(stretches.place, s) as usize).wrapping_sub(first);
            take_own(grains, &mut own, first, place(s + 1));
            let complete = &mut grains.stretch(place(s), place(s + 1));
            let one = match after {
                After::Stay => continue,
                After::Rest => integrate(complete, MotionPhase::Kick),
                After::FinishAndBegin => integrate(complete, MotionPhase::KickAndDrift),
            };
            set(stretches.travel, s, travel_at(one.speed2, complete.dt));
            passed = passed.and(one);
        }
        finished = next.stretch;
    }
    (deep, passed)
}

/// Adds what the pairs of a block give to the sums of their grains, in order.
#[inline(always)]
fn add_shares<R: Real>(grains: &mut GrainMotion<'_, R>, block: &Block<R>, first: usize) {
    for ((i, j), (push, couple, lever_arm_i, lever_arm_j)) in block.places().zip(block.shares()) {
        let i = (*i as usize).wrapping_sub(first);
        let j = (*j as usize).wrapping_sub(first);
        add_at(grains.force, i, push);
        sub_at(grains.force, j, push);
        sub_at(grains.torque, i, &times(couple, lever_arm_i));
        sub_at(grains.torque, j, &times(couple, lever_arm_j));
    }
}

/// Shows the contacts of a block that touch.
#[inline(always)]
fn show<R: Real>(block: &Block<R>, watch: &mut impl FnMut(ContactForce<R>)) {
    block.seen(|k, overlap, normal, normal_force, tangential_force| {
        let (i, j) = block.places_of(k);
        watch(ContactForce {
            i,
            partner: Partner::Grain(j),
            overlap,
            normal,
            normal_force,
            tangential_force,
        });
    });
}

/// Takes what the pairs with higher ranges give to grains below `next`.
#[inline(always)]
fn take_own<R: Real>(
    grains: &mut GrainMotion<'_, R>,
    own: &mut &[CrossRangeForce<R>],
    first: usize,
    next: usize,
) {
    while let [one, others @ ..] = *own {
        let i = (one.i as usize).wrapping_sub(first);
        if i >= next {
            return;
        }
        add_at(grains.force, i, &one.force);
        sub_at(grains.torque, i, &times(&one.couple, one.lever_arm_i));
        *own = others;
    }
}

/// Fills a block up with the pairs from `from` to `to`.
#[inline(always)]
fn take<R: Real>(
    block: &mut Block<R>,
    bodies: Bodies<'_, R>,
    pairs: &PairRange<'_, R>,
    from: usize,
    to: usize,
) {
    let (lower, partner) = (part(pairs.lower, from, to), part(pairs.partner, from, to));
    let [x, y, z] = &pairs.spring;
    block.fill(
        bodies,
        lower,
        partner,
        [part(x, from, to), part(y, from, to), part(z, from, to)],
    );
}

#[inline(always)]
fn deepest<R: Real>(block: &Block<R>) -> ExcessiveOverlap {
    Some(block.places_of(block.deepest()?))
}
