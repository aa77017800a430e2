//! The phases of a step, for hosts that run them on their own threads.
//!
//! A step of one world, in order: [`seal()`] and [`begin`], which finds what was written to since the last step;
//! [`integrate`] that drifts and [`drift`]; then, for each of several steps, [`ensure_pair_list`], [`obstacle_forces`],
//! [`accumulate`], which also ends the step of a grain and begins its next one as soon as its sum is complete,
//! [`check_forces`] and [`finish`], and [`drift`] unless it was the last; at last [`seal()`] and [`end`]. Until then
//! only the phases may use what is lent.
//!
//! A host that has threads cuts a world into [`parts`](crate::parts), and does the phases of each.

use crate::digest::seal::whole;
use crate::error::Error;
use crate::fp_environment::check_arithmetic;
use crate::math::real::{Real, larger, magnitude};
use crate::math::rows::{part, set};
use crate::math::vec3::length_bound;
use crate::neighbors::cell_list::{Found, Scene, keep_obstacle_contacts, search};
use crate::neighbors::prune::{Pruning, flatten, prune_all, prune_stretch};
use crate::state::domain::limit;
use crate::world::{Stage, World};

pub use crate::digest::seal::{Sealed, seal};
pub use crate::forces::accumulate::{
    After, Fetch, GrainRange, NotedForces, PairRange, accumulate, no_fetch,
};
pub use crate::forces::force_check::ForceCheck;
pub use crate::forces::obstacle_contacts::{
    ObstacleContactRange, ObstacleShare, obstacle_forces, sum_on_obstacles,
};
pub use crate::forces::stretch_range::StretchRange;
use crate::integrate::travel_at;
pub use crate::integrate::{GrainMotion, MotionCheck, MotionPhase, integrate};
pub use crate::neighbors::extent::Extent;
pub use crate::state::owned::Owned;

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

/// The first joint of a step of a whole world that has begun: lists the pairs again when the list
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
    match is_any_old(world, ahead) {
        true => refresh_pair_list(world, ahead),
        false => Ok(()),
    }
}

/// The joint after a pass that drifted: moves the obstacles, kicks those first that move freely, and counts what the
/// list has lost of its validity.
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
    let count = world.clock.listed.stretches;
    world.stretches.foresee(count, world.clock.rounding);
    world.stretches.spend(count);
    // Until the passes that kick say so.
    world.stretches.travel_alike(-R::ONE);
    world.clock.far = world.clock.far - (travel + travel);
    for (k, body) in world.obstacles.iter_mut().enumerate() {
        body.kick(world.dt);
        body.drift(world.domain, world.dt);
        if !body.point.iter().all(|x| magnitude(*x) <= limit()) {
            return Err(Error::obstacle_not_finite::<R>(k as u32));
        }
    }
    world.clock.stage = Stage::Drifted;
    Ok(())
}

/// The joint between a drift and the forces, if [`ensure_pair_list_ahead`] was not called before the
/// drift: lists the pairs again that are too old.
///
/// # Errors
/// A full list: enlarge the storage and call again; nothing is lost. A world that has not drifted.
#[inline(always)]
pub fn ensure_pair_list<R: Real>(world: &mut World<'_, R>) -> Result<(), Error> {
    if world.clock.stage != Stage::Drifted {
        return Err(Error::NotStarted);
    }
    world.check_storage()?;
    if is_any_old(world, None) {
        refresh_here(world, None, None)?;
    }
    // A second call after a fault of the forces is refused: they would be summed twice.
    world.clock.stage = Stage::Listed;
    Ok(())
}

/// Whether there are pairs to list again: those that do not hold for the next drift, which takes a body as far as
/// `ahead`, or after the last one.
pub(crate) fn is_any_old<R: Real>(world: &mut World<'_, R>, ahead: Option<R>) -> bool {
    let clock = &mut *world.clock;
    let travel = ahead.unwrap_or(R::ZERO);
    let count = clock.listed.stretches;
    if ahead.is_some() {
        world.stretches.foresee(count, clock.rounding);
    }
    clock.far < travel + travel || (0..count).any(|s| world.stretches.is_old(s, ahead.is_some()))
}

/// Where the own grains are, and how large numbers and bodies are.
#[must_use]
pub fn measure<R: Real>(world: &World<'_, R>) -> Extent<R> {
    Extent::of(&world.grains, Owned::new(world.owned), world.obstacles)
}

/// Whether an own grain is behind the drain of the policy.
#[must_use]
pub fn is_draining<R: Real>(world: &World<'_, R>) -> bool {
    let Some(drain) = &world.policy.drain else {
        return false;
    };
    let mut runs = Owned::new(world.owned).runs();
    let mut found = false;
    while let Some(run) = runs.next_before(world.grains.count()) {
        let own = part(world.grains.position, run.start, run.end);
        found |= own.iter().any(|x| drain.has(x));
    }
    found
}

/// Upper bound of what the fastest body moves in the next step.
#[inline]
pub(crate) fn next_travel<R: Real>(world: &World<'_, R>) -> Result<R, Error> {
    let mut travel = world.clock.next_travel;
    for (k, body) in world.obstacles.iter().enumerate() {
        let next = body.kicked(world.dt);
        let way = (length_bound(next.velocity) + next.swing()) * world.dt;
        let slow = way < world.clock.radius_min;
        if !slow {
            return Err(Error::ObstacleTooFast { obstacle: k as u32 });
        }
        travel = if way > travel { way } else { travel };
    }
    // The speed was rounded; a thousandth covers that and is negligible against the skin.
    Ok(travel * R::from_f64(1.001) + world.clock.rounding)
}

/// [`refresh_here`]: one copy of it, for small machines.
#[inline(never)]
pub(crate) fn refresh_pair_list<R: Real>(
    world: &mut World<'_, R>,
    ahead: Option<R>,
) -> Result<(), Error> {
    refresh_here(world, ahead, None)
}

/// Lists the pairs again that are old, so that they hold for the next drift at least, which takes a body as far as
/// `ahead`; searches for candidates first, if those of the last search do not reach as far, or if an extent is given.
#[inline(always)]
pub(crate) fn refresh_here<R: Real>(
    world: &mut World<'_, R>,
    ahead: Option<R>,
    extent: Option<Extent<R>>,
) -> Result<(), Error> {
    let travel = ahead.unwrap_or(R::ZERO);
    let widest = larger(world.skin, travel + travel);
    let found = match extent.is_some() || world.clock.far < widest {
        true => Some(rebuild_outer_list(
            world,
            widest + world.outer_skin,
            extent,
        )?),
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
        slack: clock.slack,
    };
    let (pairs, spare, listed) = (&mut world.pairs, &mut world.spare, &mut clock.listed);
    let mut all = found.is_some();
    for s in 0..listed.stretches {
        if !all && stretches.is_old(s, ahead.is_some()) {
            let skin = larger(world.skin, stretches.need(s, ahead.is_some()));
            clock.picked += stretches.grains(s).len() as u64;
            all = !prune_stretch(&picking, (stretches, s), skin, pairs, spare, listed);
        }
    }
    if all {
        // If the list is full it is unchanged: nothing above wrote to what stands in it.
        let skin = (world.skin, ahead.is_some());
        clock.picked += world.grains.count() as u64;
        *listed = prune_all(&picking, stretches, skin, pairs, spare, *listed)?;
    }
    if let Some(found) = found {
        keep_obstacle_contacts(pairs, spare, found.obstacle_contacts);
        listed.obstacle_contacts = found.obstacle_contacts;
        clock.far = found.far;
    }
    clock.prunes = clock.prunes.saturating_add(1);
    Ok(())
}

/// Cuts the grains into stretches, between the passes of two steps.
pub(crate) fn cut_anew<R: Real>(world: &mut World<'_, R>) {
    let clock = &mut *world.clock;
    clock.listed = flatten(
        &mut world.stretches,
        &mut world.pairs,
        &mut world.spare,
        clock.listed,
        world.grains.count(),
    );
    world.stretches.travel_alike(clock.next_travel);
}

/// The search for candidates. They count from when the pairs picked from them are listed.
#[inline(never)]
fn rebuild_outer_list<R: Real>(
    world: &mut World<'_, R>,
    far: R,
    extent: Option<Extent<R>>,
) -> Result<Found<R>, Error> {
    let scene = Scene {
        domain: world.domain,
        grains: &world.grains,
        obstacles: world.obstacles,
        facets: world.facets,
        owned: Owned::new(world.owned),
        extent: extent.unwrap_or_else(|| measure(world)),
        far: far + world.clock.reach,
    };
    let clock = &mut *world.clock;
    // Until it is done there are none.
    clock.far = -R::ONE;
    let mut found = search(
        &scene,
        &mut world.candidates,
        &world.pairs,
        &mut world.spare,
        &mut world.cells,
        clock.listed.obstacle_contacts,
    )?;
    clock.outer_list_rebuilds = clock.outer_list_rebuilds.saturating_add(1);
    // What acts at a distance is listed as what touches is.
    clock.slack = found.slack + clock.reach;
    clock.rounding = found.rounding;
    found.far = far;
    Ok(found)
}

/// The joint after [`obstacle_forces`] and [`accumulate`], which say what they found.
///
/// # Errors
/// A world that does not fit its law; a force on an obstacle that is not finite; one of the overlaps, unless the policy
/// takes such grains out.
pub fn check_forces<R: Real>(world: &mut World<'_, R>, found: ForceCheck) -> Result<(), Error> {
    if found.misfit {
        return Err(Error::LawMisfit);
    }
    if let Some(k) = found.unsound {
        return Err(Error::obstacle_not_finite::<R>(k));
    }
    if world.policy.takes_out {
        world.clock.losing |= found.on_obstacle.is_some() || found.of_pair.is_some();
        return Ok(());
    }
    if let Some((id, obstacle)) = found.on_obstacle {
        return Err(Error::ObstacleTooDeep { id, obstacle });
    }
    match found.of_pair {
        Some((i, j)) => Err(Error::OverlapTooDeep { i, j }),
        None => Ok(()),
    }
}

/// The last joint of a step, after a pass that kicked: kicks the bodies that move freely, whose forces must be
/// complete, and counts the step.
///
/// # Errors
/// The fault that the pass found; the world is stopped. A world that has not drifted.
#[inline]
pub fn finish<R: Real>(world: &mut World<'_, R>, passed: MotionCheck<R>) -> Result<(), Error> {
    if !matches!(world.clock.stage, Stage::Drifted | Stage::Listed) {
        return Err(Error::NotStarted);
    }
    world.clock.stage = Stage::Stopped;
    for body in world.obstacles.iter_mut() {
        body.kick(world.dt);
    }
    go_on(world, passed)?;
    world.clock.losing |= passed.draining || is_draining(world);
    // A caller may have set any number; the largest one stays as it is.
    world.clock.step = world.clock.step.saturating_add(1);
    Ok(())
}

/// Leaves a world between two steps, unless it is unsound: then it stays as it is.
#[inline]
pub(crate) fn go_on<R: Real>(
    world: &mut World<'_, R>,
    passed: MotionCheck<R>,
) -> Result<(), Error> {
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
    let mut runs = Owned::new(world.owned).runs();
    for s in 0..world.clock.listed.stretches {
        let end = world.stretches.grains(s).end;
        let mut grains = world.grain_motion();
        let mut stretch = MotionCheck::NONE;
        while let Some(run) = runs.next_before(end) {
            let one = integrate(&mut grains.stretch(run.start, run.end), which);
            stretch = stretch.and(one);
        }
        if which != MotionPhase::Drift {
            set(
                world.stretches.travel,
                s,
                travel_at(stretch.speed2, world.dt),
            );
        }
        passed = passed.and(stretch);
    }
    passed
}

/// The seal of all grains: one copy of it, for small machines.
#[inline(never)]
pub(crate) fn seal_all<R: Real>(world: &mut World<'_, R>) -> Sealed {
    seal(&world.grain_motion(), 0)
}
