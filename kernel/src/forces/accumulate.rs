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
//! * a part of a world stands in for all of it: its grains and the ghosts beside them keep the order of ids, and
//!   every pair of an own grain is listed and evaluated there, from the same numbers in the same orientation. So
//!   the sums on own grains are those of the whole world, and what is summed on ghosts is not used.
//!
//! After the pairs of a stretch nothing is added to the forces on its grains and nothing reads their rows any more:
//! they can be kicked, and moved on, while their rows are in the cache.

use crate::contact::block::{BLOCK, Block, Bodies};
use crate::contact::law::Law;
use crate::forces::force_check::ForceCheck;
use crate::forces::stretch_range::{Cursor, StretchRange};
use crate::integrate::{GrainMotion, MotionCheck, MotionPhase, integrate, travel_at};
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::rows::{add_at, get_or_default, min, part, part_mut, set, sub_at, times};
use crate::math::vec3::Vec3;
use crate::neighbors::memory::{MemoryColumns, has_room};
use crate::state::owned::Owned;

/// Listed pairs, one after the other, with their springs.
pub struct PairRange<'a, R> {
    /// Place of the lower grain of each.
    pub lower: &'a [u32],
    /// Place of the higher grain.
    pub partner: &'a [u32],
    /// Tangential spring, component by component.
    pub spring: [&'a mut [R]; 3],
    /// The law's words.
    pub memory: MemoryColumns<'a, R>,
}

/// The grains of a world, their stretches and their pairs: what the force phase reads and writes.
pub struct GrainRange<'a, R> {
    /// The grains.
    pub grains: GrainMotion<'a, R>,
    /// Which of them are own.
    pub owned: Owned<'a>,
    /// Their stretches.
    pub stretches: StretchRange<'a, R>,
    /// Their pairs.
    pub pairs: PairRange<'a, R>,
    /// Where to note the sums of some of them; empty if that is not wanted.
    pub noted: NotedForces<'a, R>,
    /// How far beyond touching pairs are listed in any case; see [`Law::reach`].
    pub reach: R,
    /// Time that the tangential springs advance by; 0 at step 0.
    pub dt: R,
}

impl<R: Real> GrainRange<'_, R> {
    /// Whether there is room for the law's words, and pairs are listed as far as it reaches.
    #[inline(always)]
    fn fits<L: Law<R>>(&self, law: &L) -> bool {
        has_room(&self.pairs.memory, L::MEMORY, self.pairs.lower.len())
            && (!L::ACTS_APART || law.reach() <= self.reach)
    }
}

/// Forces on some grains as their sums are complete, for a host that wants to know them although the pass that sums
/// them begins the next step, which sets them to zero.
#[derive(Default)]
pub struct NotedForces<'a, R> {
    /// Places of the grains, ascending.
    pub place: &'a [u32],
    /// Their forces, in the same order.
    pub force: &'a mut [Row<R>],
}

impl<R: Real> NotedForces<'_, R> {
    /// Notes the sums of the grains from the one of number `next` up to the place `end`, and returns the number of the
    /// first beyond it.
    #[inline(always)]
    fn note(&mut self, mut next: usize, end: usize, sums: &[Row<R>]) -> usize {
        while let Some(place) = self.place.get(next).map(|place| *place as usize)
            && place < end
        {
            set(self.force, next, get_or_default(sums, place));
            next += 1;
        }
        next
    }
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
    /// Which surface of an obstacle; 0 of a grain.
    pub surface: u32,
    /// Depth of the overlap (length).
    pub overlap: R,
    /// Unit vector from the partner to the grain.
    pub normal: Vec3<R>,
    /// Normal force on the grain along `normal`; negative when it pulls.
    pub normal_force: R,
    /// Tangential force on the grain.
    pub tangential_force: Vec3<R>,
    /// Torque on the grain beside that of the tangential force.
    pub torque: Vec3<R>,
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

/// Sums the forces and torques of grains that already hold the obstacles' share, and does `after` with each own grain
/// whose sum is complete.
///
/// `watch` sees every contact; it cannot change one. `fetch`, if there is one, is called a block ahead with rows and a
/// place that will be wanted: a hint to bring them near, for worlds larger than a cache.
#[inline(always)]
pub fn accumulate<R: Real, L: Law<R>>(
    range: &mut GrainRange<'_, R>,
    law: &L,
    mut watch: impl FnMut(ContactForce<R>),
    fetch: Option<impl Fn(&[Row<R>], usize)>,
    after: After,
) -> (ForceCheck, MotionCheck<R>) {
    let dt = range.dt;
    let has_room = range.fits(law);
    let GrainRange {
        grains,
        pairs,
        stretches,
        owned,
        noted,
        ..
    } = range;
    // Local copies: the compiler must see that nothing written here can change them.
    let (law, domain) = (*law, *grains.domain);
    // One length for all rows, so that a place is checked once for all of them.
    let all = grains.count();
    let grains = &mut grains.stretch(0, all);
    let mut block = Block::new();
    let (mut deep, mut passed) = (None, MotionCheck::NONE);
    let mut next = Cursor::default();
    let (mut finished, mut note) = (0, 0);
    let mut own = owned.runs();
    let count = min(stretches.travel.len(), stretches.pairs.len());
    while finished < count {
        let bodies = Bodies {
            position: grains.position,
            velocity: grains.velocity,
            spin: grains.spin,
            group: (grains.group, grains.groups),
        };
        let begin = next;
        block.clear();
        while let Some(piece) = next.take(stretches, block.room()) {
            take::<R, L>(&mut block, bodies, pairs, piece.start, piece.end);
        }
        if let Some(fetch) = &fetch {
            for j in pairs.partner.iter().skip(next.entry(stretches)).take(BLOCK) {
                let j = *j as usize;
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
            keep::<R, L>(&block, kept, pairs, piece.start, piece.end);
            kept += piece.len();
        }
        add_shares::<R, L>(grains, &block);
        show::<R, L>(&block, &mut watch);
        deep = deep.or_else(|| Some(block.places_of(block.deepest()?)));
        // The sums of these stretches are complete.
        for s in finished..next.stretch {
            let end = get_or_default(stretches.place, s + 1) as usize;
            note = noted.note(note, end, grains.force);
            let phase = match after {
                After::Stay => continue,
                After::Rest => MotionPhase::Kick,
                After::FinishAndBegin => MotionPhase::KickAndDrift,
            };
            let mut moved = MotionCheck::NONE;
            while let Some(run) = own.next_before(end) {
                let complete = &mut grains.stretch(run.start, run.end);
                moved = moved.and(integrate(complete, phase));
            }
            set(stretches.travel, s, travel_at(moved.speed2, dt));
            passed = passed.and(moved);
        }
        finished = next.stretch;
    }
    let id = |place: u32| get_or_default(grains.id, place as usize);
    let found = ForceCheck {
        of_pair: deep.map(|(i, j)| (id(i), id(j))),
        misfit: !has_room,
        ..ForceCheck::NONE
    };
    (found, passed)
}

/// Adds what the pairs of a block give to the sums of their grains, in order.
#[inline(always)]
fn add_shares<R: Real, L: Law<R>>(grains: &mut GrainMotion<'_, R>, block: &Block<R>) {
    let shares = block.places().zip(block.shares()).zip(block.torques());
    for (((i, j), (push, couple, lever_arm_i, lever_arm_j)), torque) in shares {
        let (i, j) = (*i as usize, *j as usize);
        add_at(grains.force, i, push);
        sub_at(grains.force, j, push);
        sub_at(grains.torque, i, &times(couple, lever_arm_i));
        sub_at(grains.torque, j, &times(couple, lever_arm_j));
        // Pair by pair too: which pairs share a block must not show.
        if L::TURNS {
            add_at(grains.torque, i, torque);
            sub_at(grains.torque, j, torque);
        }
    }
}

/// Shows the contacts of a block that act.
#[inline(always)]
fn show<R: Real, L: Law<R>>(block: &Block<R>, watch: &mut impl FnMut(ContactForce<R>)) {
    block.seen::<L>(
        |k, overlap, normal, normal_force, [tangential_force, torque]| {
            let (i, j) = block.places_of(k);
            watch(ContactForce {
                i,
                partner: Partner::Grain(j),
                surface: 0,
                overlap,
                normal,
                normal_force,
                tangential_force,
                torque,
            });
        },
    );
}

/// Puts what is left of the pairs of a block, from one of them on, back among the pairs from `from` to `to`.
#[inline(always)]
fn keep<R: Real, L: Law<R>>(
    block: &Block<R>,
    begin: usize,
    pairs: &mut PairRange<'_, R>,
    from: usize,
    to: usize,
) {
    let springs = pairs.spring.each_mut().map(|s| part_mut(s, from, to));
    let memory = pairs.memory.each_mut().map(|s| part_mut(s, from, to));
    block.keep::<L>(begin, springs, memory);
}

/// Fills a block up with the pairs from `from` to `to`.
#[inline(always)]
fn take<R: Real, L: Law<R>>(
    block: &mut Block<R>,
    bodies: Bodies<'_, R>,
    pairs: &PairRange<'_, R>,
    from: usize,
    to: usize,
) {
    let (lower, partner) = (part(pairs.lower, from, to), part(pairs.partner, from, to));
    let springs = pairs.spring.each_ref().map(|s| part(s, from, to));
    let memory = pairs.memory.each_ref().map(|s| part(s, from, to));
    block.fill::<L>(bodies, lower, partner, (springs, memory));
}
