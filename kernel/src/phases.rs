//! The phases of a step, for hosts that run them on their own threads.
//!
//! Each phase works on a range of grains with its own output, and between two phases stands a call over the whole
//! world; any partition into ranges gives the same bits. In order: [`seal()`] and [`begin`], which finds what was
//! written to since the last step; [`integrate`] that drifts and [`drift`]; then, for each of several steps,
//! [`ensure_pair_list`], [`obstacle_forces`], [`cross_range`] for the pairs of two ranges and [`accumulate`] for all
//! others, which also ends the step of a grain and begins its next one as soon as its sum is complete,
//! [`check_overlaps`] and [`finish`], and [`drift`] unless it was the last; at last [`seal()`] and [`end`]. Until then
//! only the phases may use what is lent. `examples/threaded_host.rs` does so.

use crate::digest::seal::whole;
use crate::error::Error;
use crate::fp_environment::check_arithmetic;
use crate::math::real::{Real, larger, magnitude};
use crate::math::rows::{get_or_default, set};
use crate::math::vec3::length_bound;
use crate::neighbors::cell_list::{Found, Scene, keep_obstacle_contacts, search};
use crate::neighbors::prune::{Pruning, flatten, prune_across, prune_all, prune_stretch};
use crate::state::domain::limit;
use crate::world::{Stage, World};

pub use crate::digest::seal::{Sealed, seal};
pub use crate::forces::accumulate::{
    After, CrossRangeForce, ExcessiveOverlap, Fetch, GrainRange, GrainView, PairRange, accumulate,
    cross_range, first_excessive_overlap, no_fetch,
};
pub use crate::forces::obstacle_contacts::{ObstacleContactRange, obstacle_forces};
pub use crate::forces::stretch_range::StretchRange;
use crate::integrate::travel_at;
pub use crate::integrate::{GrainMotion, MotionCheck, MotionPhase, integrate};

/// The joint before a stretch of steps, after [`seal()`] over all grains: checks that nothing was written to
/// since the last stretch ended. From here to [`end`] only the phases may use what is lent.
///
/// # Errors
/// Before anything is changed: a world that does not rest, slices that do not fit together,
/// [`Error::GrainsLeaving`] and [`Error::Edited`].
#[inline]
pub fn begin<R: Real>(world: &mut World<'_, R>, sealed: Sealed) -> Result<(), Error> {
    if world.clock.stage != Stage::Resting {
        return Err(Error::NotStarted);
    }
    if world.clock.losing {
        return Err(Error::GrainsLeaving);
    }
    world.check_storage()?;
    if world.grains.count() != world.clock.count {
        return Err(Error::Edited);
    }
    if whole(world, sealed) != world.clock.seal {
        return Err(Error::Edited);
    }
    world.clock.stage = Stage::Going;
    Ok(())
}

/// The joint after a stretch of steps and [`seal()`] over all grains: tests the arithmetic of the thread
/// that it is called on, and leaves the world at rest.
///
/// # Errors
/// [`Error::Arithmetic`], if something changed the processor's modes since the world was started: it
/// is stopped, and none of its numbers can be trusted. A world that is not between two steps of a stretch.
#[inline]
pub fn end<R: Real>(world: &mut World<'_, R>, sealed: Sealed) -> Result<(), Error> {
    if world.clock.stage != Stage::Going {
        return Err(Error::NotStarted);
    }
    world.clock.stage = Stage::Stopped;
    check_arithmetic::<R>()?;
    world.clock.seal = whole(world, sealed);
    world.clock.stage = Stage::Resting;
    Ok(())
}

/// The first joint of a step over one range, of a world that has begun: lists the pairs again when the list
/// might not hold through the coming drift. Which step does so has no effect on any result.
///
/// # Errors
/// A full list, before anything is changed; an obstacle that is too fast; a world that has not begun.
#[inline]
pub fn ensure_pair_list_ahead<R: Real>(world: &mut World<'_, R>) -> Result<(), Error> {
    if world.clock.stage != Stage::Going {
        return Err(Error::NotStarted);
    }
    if world.clock.losing {
        return Err(Error::GrainsLeaving);
    }
    world.check_storage()?;
    let ahead = Some(next_travel(world)?);
    match is_any_old(world, ahead, &[]) {
        true => refresh_pair_list(world, ahead, &[]),
        false => Ok(()),
    }
}

/// The joint after a pass that drifted: moves the obstacles, and counts what the list has lost of its
/// validity.
///
/// # Errors
/// A world that has not begun; a grain that left the box, unless the policy takes it out; an obstacle that is too fast
/// or so far away that its place is not a number. The world is stopped in the middle of a step.
#[inline]
pub fn drift<R: Real>(world: &mut World<'_, R>, passed: MotionCheck<R>) -> Result<(), Error> {
    if world.clock.stage != Stage::Going {
        return Err(Error::NotStarted);
    }
    world.clock.stage = Stage::Stopped;
    let travel = next_travel(world)?;
    if let Some(fault) = passed.escaped {
        if !world.policy.takes_out {
            return Err(fault);
        }
        world.clock.losing = true;
    }
    world.clock.budget = world.clock.budget - travel;
    let count = world.clock.listed.stretches;
    world.stretches.foresee(count, world.clock.rounding);
    world.stretches.spend(count);
    // Until the passes that kick say so.
    world.stretches.travel_alike(-R::ONE);
    world.clock.far = world.clock.far - (travel + travel);
    for (k, body) in world.obstacles.iter_mut().enumerate() {
        body.advance(world.domain, world.dt);
        if !body.point.iter().all(|x| magnitude(*x) <= limit()) {
            return Err(Error::obstacle_not_finite::<R>(k as u32));
        }
    }
    world.clock.stage = Stage::Drifted;
    Ok(())
}

/// The joint between a drift and the forces, if [`ensure_pair_list_ahead`] was not called before the
/// drift: lists the pairs again when the list is too old or cut elsewhere than [`World::range_bounds`] says.
///
/// # Errors
/// A full list: enlarge the storage and call again; nothing is lost. A world that has not drifted.
#[inline(always)]
pub fn ensure_pair_list<R: Real>(world: &mut World<'_, R>) -> Result<(), Error> {
    if world.clock.stage != Stage::Drifted {
        return Err(Error::NotStarted);
    }
    world.check_storage()?;
    if is_any_old(world, None, world.range_bounds) {
        refresh_here(world, None, world.range_bounds)?;
    }
    // A second call after a fault of the forces is refused: they would be summed twice.
    world.clock.stage = Stage::Listed;
    Ok(())
}

/// Whether there are pairs to list again: those that do not hold for the next drift, which takes a body as far as
/// `ahead`, or after the last one; all if they are cut elsewhere.
pub(crate) fn is_any_old<R: Real>(
    world: &mut World<'_, R>,
    ahead: Option<R>,
    range_bounds: &[u32],
) -> bool {
    let clock = &mut *world.clock;
    let travel = ahead.unwrap_or(R::ZERO);
    let count = clock.listed.stretches;
    if ahead.is_some() {
        world.stretches.foresee(count, clock.rounding);
    }
    clock.partition_mark != mark(range_bounds)
        || clock.far < travel + travel
        || (!range_bounds.is_empty() && clock.budget < travel)
        || (0..count).any(|s| world.stretches.is_old(s, ahead.is_some()))
}

/// Upper bound of what the fastest body moves in the next step.
#[inline]
pub(crate) fn next_travel<R: Real>(world: &World<'_, R>) -> Result<R, Error> {
    let mut travel = world.clock.next_travel;
    for (k, body) in world.obstacles.iter().enumerate() {
        let way = length_bound(body.velocity) * world.dt;
        let slow = way < world.clock.radius_min;
        if !slow {
            return Err(Error::ObstacleTooFast { obstacle: k as u32 });
        }
        travel = if way > travel { way } else { travel };
    }
    // The speed was rounded; a thousandth covers that and is negligible against the skin.
    Ok(travel * R::from_f64(1.001) + world.clock.rounding)
}

/// No [`mark`] of any ranges, as far as can be.
pub(crate) const NEVER_CUT: u64 = 0;

/// Distinguishes one list of range_bounds from another: the hash of Fowler, Noll and Vo, word by word.
#[inline]
pub(crate) fn mark(range_bounds: &[u32]) -> u64 {
    let each = |mark: u64, cut: &u32| (mark ^ u64::from(*cut)).wrapping_mul(0x0100_0000_01b3);
    range_bounds.iter().fold(0xcbf2_9ce4_8422_2325, each)
}

/// [`refresh_here`]: one copy of it, for small machines.
#[inline(never)]
pub(crate) fn refresh_pair_list<R: Real>(
    world: &mut World<'_, R>,
    ahead: Option<R>,
    range_bounds: &[u32],
) -> Result<(), Error> {
    refresh_here(world, ahead, range_bounds)
}

/// Lists the pairs again that are old, so that they hold for the next drift at least, which takes a body as far as
/// `ahead`; searches for candidates first, if those of the last search do not reach as far.
#[inline(always)]
fn refresh_here<R: Real>(
    world: &mut World<'_, R>,
    ahead: Option<R>,
    range_bounds: &[u32],
) -> Result<(), Error> {
    let travel = ahead.unwrap_or(R::ZERO);
    let remade = cut_anew(world, ahead.is_some(), range_bounds);
    let widest = larger(world.skin, travel + travel);
    let found = match world.clock.far < widest {
        true => Some(rebuild_outer_list(world, widest + world.outer_skin)?),
        false => None,
    };
    let clock = &mut *world.clock;
    let stretches = &mut world.stretches;
    if found.is_some() {
        stretches.note_neighbors(&world.candidates, clock.listed.stretches);
    }
    if ahead.is_some() {
        stretches.foresee(clock.listed.stretches, clock.rounding);
    }
    let picking = Pruning {
        domain: world.domain,
        position: world.grains.position,
        candidates: &world.candidates,
        range_bounds,
        slack: clock.slack,
    };
    let (pairs, spare, listed) = (&mut world.pairs, &mut world.spare, &mut clock.listed);
    let mut all = remade || found.is_some();
    for s in 0..listed.stretches {
        if !all && stretches.is_old(s, ahead.is_some()) {
            let skin = larger(world.skin, stretches.need(s, ahead.is_some()));
            clock.picked += stretches.grains(s).len() as u64;
            all = !prune_stretch(&picking, (stretches, s), skin, pairs, spare, listed);
        }
    }
    let across = !range_bounds.is_empty() && clock.budget < travel;
    if across && !all {
        all = !prune_across(&picking, stretches, widest, pairs, spare, listed);
    }
    if all {
        // If the list is full it is unchanged: nothing above wrote to what stands in it.
        let skins = (world.skin, widest, ahead.is_some());
        clock.picked += world.grains.count() as u64;
        *listed = prune_all(&picking, stretches, skins, pairs, spare, *listed)?;
    }
    if let Some(found) = found {
        keep_obstacle_contacts(pairs, spare, found.obstacle_contacts);
        listed.obstacle_contacts = found.obstacle_contacts;
        clock.far = found.far;
    }
    if all || across {
        clock.budget = widest * R::HALF;
    }
    clock.prunes += 1;
    Ok(())
}

/// Cuts the grains into stretches if that was not done, or for other ranges.
fn cut_anew<R: Real>(world: &mut World<'_, R>, ahead: bool, range_bounds: &[u32]) -> bool {
    let clock = &mut *world.clock;
    let remade = clock.partition_mark != mark(range_bounds) || clock.listed.stretches == 0;
    if remade {
        let grains = (world.grains.count(), range_bounds);
        clock.listed = flatten(
            &mut world.stretches,
            &mut world.pairs,
            &mut world.spare,
            clock.listed,
            grains,
        );
        clock.partition_mark = mark(range_bounds);
        clock.budget = -R::ONE;
        let travel = if ahead { clock.next_travel } else { -R::ONE };
        world.stretches.travel_alike(travel);
    }
    remade
}

/// The search for candidates. They count from when the pairs picked from them are listed.
#[inline(never)]
fn rebuild_outer_list<R: Real>(world: &mut World<'_, R>, far: R) -> Result<Found<R>, Error> {
    let scene = Scene {
        domain: world.domain,
        grains: &world.grains,
        obstacles: world.obstacles,
        far,
    };
    let clock = &mut *world.clock;
    // Until it is done there are none.
    clock.far = -R::ONE;
    let found = search(
        &scene,
        &mut world.candidates,
        &world.pairs,
        &mut world.spare,
        &mut world.cells,
        clock.listed.obstacle_contacts,
    )?;
    clock.outer_list_rebuilds += 1;
    clock.slack = found.slack;
    clock.rounding = found.rounding;
    Ok(found)
}

/// The joint after [`obstacle_forces`] and [`accumulate`], which say what they found too deep.
///
/// # Errors
/// A force on an obstacle that is not finite; one of the overlaps, unless the policy takes such grains out.
pub fn check_overlaps<R: Real>(
    world: &mut World<'_, R>,
    hit: ExcessiveOverlap,
    deep: ExcessiveOverlap,
) -> Result<(), Error> {
    for (k, body) in world.obstacles.iter().enumerate() {
        if !body.force.iter().chain(&body.torque).all(|f| f.is_finite()) {
            return Err(Error::obstacle_not_finite::<R>(k as u32));
        }
    }
    if world.policy.takes_out {
        world.clock.losing |= hit.is_some() || deep.is_some();
        return Ok(());
    }
    let id = |place: u32| get_or_default(world.grains.id, place as usize);
    if let Some((i, obstacle)) = hit {
        return Err(Error::ObstacleTooDeep {
            id: id(i),
            obstacle,
        });
    }
    if let Some((i, j)) = deep {
        return Err(Error::OverlapTooDeep { i: id(i), j: id(j) });
    }
    Ok(())
}

/// The last joint of a step, after a pass that kicked: counts the step.
///
/// # Errors
/// The fault that the pass found; the world is stopped. A world that has not drifted.
#[inline]
pub fn finish<R: Real>(world: &mut World<'_, R>, passed: MotionCheck<R>) -> Result<(), Error> {
    if !matches!(world.clock.stage, Stage::Drifted | Stage::Listed) {
        return Err(Error::NotStarted);
    }
    go_on(world, passed)?;
    if let Some(drain) = &world.policy.drain {
        world.clock.losing |= world.grains.position.iter().any(|x| drain.has(x));
    }
    // A caller may have set any number; the largest one stays as it is.
    world.clock.step = world.clock.step.saturating_add(1);
    Ok(())
}

/// Leaves a world between two steps, unless it is unsound.
#[inline]
pub(crate) fn go_on<R: Real>(
    world: &mut World<'_, R>,
    passed: MotionCheck<R>,
) -> Result<(), Error> {
    world.clock.stage = Stage::Stopped;
    if let Some(fault) = passed.unsound {
        return Err(fault);
    }
    world.clock.next_travel = travel_at(passed.speed2, world.dt);
    world.stretches.travel_at_most(world.clock.next_travel);
    world.clock.stage = Stage::Going;
    Ok(())
}

/// Leaves a world that was checked and has its list and forces at rest.
#[inline]
pub(crate) fn come_to_rest<R: Real>(world: &mut World<'_, R>) -> Result<(), Error> {
    let passed = moved(world, MotionPhase::CheckOnly);
    go_on(world, passed)?;
    world.clock.count = world.grains.count();
    let sealed = seal_all(world);
    end(world, sealed)
}

/// A pass over all grains, stretch by stretch: one copy of it, for small machines.
#[inline(never)]
pub(crate) fn moved<R: Real>(world: &mut World<'_, R>, which: MotionPhase) -> MotionCheck<R> {
    let mut passed = MotionCheck::NONE;
    for s in 0..world.clock.listed.stretches {
        let own = world.stretches.grains(s);
        let mut grains = world.grain_motion();
        let one = integrate(&mut grains.stretch(own.start, own.end), which);
        if which != MotionPhase::Drift {
            set(world.stretches.travel, s, travel_at(one.speed2, world.dt));
        }
        passed = passed.and(one);
    }
    passed
}

/// The seal of all grains: one copy of it, for small machines.
#[inline(never)]
pub(crate) fn seal_all<R: Real>(world: &mut World<'_, R>) -> Sealed {
    seal(&world.grain_motion(), 0)
}
