//! One step: velocity Verlet with spin. This file is the physics on one screen; each phase is a
//! pass that lives in its own file.

use crate::contact::law::Law;
use crate::edit::settle::weigh;
use crate::error::Error;
use crate::external::add_external;
use crate::forces::accumulate::{After, ContactForce, accumulate, no_fetch};
use crate::forces::obstacle_contacts::obstacle_forces;
use crate::fp_environment::check_arithmetic;
use crate::integrate::{MotionPhase, without_turn};
use crate::math::real::Real;
use crate::math::vec3::Vec3;
use crate::neighbors::pair_list::{KeptContact, Listed};
use crate::phases::begin;
use crate::phases::check_forces;
use crate::phases::come_to_rest;
use crate::phases::cut_anew;
use crate::phases::drift;
use crate::phases::end;
use crate::phases::ensure_pair_list_ahead;
use crate::phases::finish;
use crate::phases::moved;
use crate::phases::next_travel;
use crate::phases::refresh_pair_list;
use crate::phases::seal_all;
use crate::state::grains::GrainState;
use crate::world::{Stage, World};

/// Advances a started world by one step `dt`. Within a stretch that the host began with [`begin`] the rows are not
/// looked at, and the stretch stays open: an observer of each step that writes to nothing saves the seals.
///
/// # Errors
/// A full list leaves the state untouched: enlarge the storage and call again. So does [`Error::Edited`],
/// of a world that was written to: start or resume it. Any other fault stops the world in the middle of the step: it
/// has no state then ([`Clock::has_state`](crate::Clock::has_state)), and is neither digested, saved, edited nor
/// started; [`Clock::step`](crate::Clock) says how many steps were finished.
#[inline]
pub fn step<R: Real, L: Law<R>>(world: &mut World<'_, R>, law: &L) -> Result<(), Error> {
    step_watched(world, law, nobody)
}

/// [`step`], showing every touching contact to `watch`: first those on obstacles, by grain and
/// obstacle, then those of two grains, by `(i, j)`. Watching changes no bit.
///
/// # Errors
/// As [`step`].
#[inline]
pub fn step_watched<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    watch: impl FnMut(ContactForce<R>),
) -> Result<(), Error> {
    let dt = world.dt;
    advance(world, |world| push_and_sum(world, law, dt, watch), |_| ())
}

/// [`step`] with a force and a torque on each grain besides those of its contacts: the drag of a fluid, a buoyancy, a
/// spring to a place. `external` is called once for each grain, by ascending id, and gives both vectors.
///
/// It sees positions as they are after the drift, and velocities and spins of the half step, as contact laws do. What
/// it gives is added to the row of the grain when the sum over all its contacts is complete, so it is the last term of
/// that sum: it acts in the half kick that ends this step and in the one that begins the next, and stands in
/// [`Grains::force`](crate::Grains) and in the digest. A result of zero leaves the bits of [`step`]; the forces of
/// [`start`] are of contacts alone. The same function called at each step gives the same bits at any skin; it must
/// itself use nothing but the operations of a step to give them on any machine.
///
/// # Errors
/// As [`step`]; [`Error::NotFinite`] of a grain whose force or torque is not a number.
#[inline]
pub fn step_with<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    external: impl FnMut(&GrainState<R>) -> (Vec3<R>, Vec3<R>),
) -> Result<(), Error> {
    let dt = world.dt;
    step_summed(
        world,
        |world| push_and_sum(world, law, dt, nobody),
        external,
    )
}

/// [`step_with`] for a host that sums the forces of all contacts itself: `sum` does what [`step_with`] does with its
/// law, by [`obstacle_forces`] and [`accumulate`] with [`After::Stay`], compiled as the host wants, and returns what
/// [`check_forces`] says of them.
///
/// # Errors
/// As [`step_with`], and those of `sum`.
#[inline]
pub fn step_summed<R: Real>(
    world: &mut World<'_, R>,
    sum: impl FnOnce(&mut World<'_, R>) -> Result<(), Error>,
    mut external: impl FnMut(&GrainState<R>) -> (Vec3<R>, Vec3<R>),
) -> Result<(), Error> {
    advance(world, sum, |world| add_external(world, &mut external))
}

/// One step; `sum` sums the contact forces, and `added` adds to their complete sums.
#[inline]
fn advance<R: Real>(
    world: &mut World<'_, R>,
    sum: impl FnOnce(&mut World<'_, R>) -> Result<(), Error>,
    added: impl FnOnce(&mut World<'_, R>),
) -> Result<(), Error> {
    // Within a stretch that the host began the rows are not looked at.
    let held = world.clock.has_begun();
    if !held {
        let sealed = seal_all(world);
        begin(world, sealed)?;
    }
    if let Err(fault) = ensure_pair_list_ahead(world) {
        if fault.stops() {
            world.clock.stage = Stage::Stopped;
        } else if !held {
            // As it was when it began, so that its seal holds.
            world.clock.stage = Stage::Resting;
        }
        return Err(fault);
    }
    let passed = moved(world, MotionPhase::Drift);
    drift(world, passed)?;
    sum(world)?;
    added(world);
    let passed = moved(world, MotionPhase::Kick);
    finish(world, passed)?;
    if held {
        return Ok(());
    }
    let sealed = seal_all(world);
    end(world, sealed)
}

/// Watches nothing. A separate function, so that starting and stepping share their code.
fn nobody<R>(_: ContactForce<R>) {}

/// Checks a world, makes its pair list, empties every history and evaluates the forces at step 0,
/// with the velocities as given.
///
/// # Errors
/// Whatever is wrong with the world, before anything is changed; a full list: enlarge the storage
/// and start again; or what the forces show: overlaps too deep, speeds too high. [`Error::NotStarted`] of a world that
/// a fault has stopped: whoever puts a state into its rows begins with a new [`Clock`](crate::Clock).
#[inline]
pub fn start<R: Real, L: Law<R>>(world: &mut World<'_, R>, law: &L) -> Result<(), Error> {
    start_watched(world, law, nobody)
}

/// [`start`], showing every touching contact to `watch` as [`step_watched`] does.
///
/// # Errors
/// As [`start`].
#[inline]
pub fn start_watched<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    watch: impl FnMut(ContactForce<R>),
) -> Result<(), Error> {
    check_materials(world, law)?;
    world.clock.reach = law.reach();
    prepare(world, false, true)?;
    world.grains.force.fill([R::ZERO; 4]);
    for torque in world.grains.torque.iter_mut() {
        *torque = without_turn(torque);
    }
    push_and_sum(world, law, R::ZERO, watch)?;
    come_to_rest(world)
}

/// Checks that the law knows the materials of all groups and obstacles; one that tells none apart is not asked.
fn check_materials<R: Real, L: Law<R>>(world: &World<'_, R>, law: &L) -> Result<(), Error> {
    if !L::KNOWS_MATERIALS {
        return Ok(());
    }
    let groups = world.grains.groups.iter().map(|group| group.material);
    let obstacles = world.obstacles.iter().map(|body| body.material);
    let unknown = |material: &u8| usize::from(*material) >= law.materials();
    match groups.chain(obstacles).find(unknown) {
        None => Ok(()),
        Some(material) => Err(Error::UnknownMaterial { material }),
    }
}

/// Checks a world, makes its pair list and puts back the histories of its touching contacts
/// ([`ContactHistory`](crate::ContactHistory), or [`KeptContact`] if the law keeps words of them); the
/// forces are those that its rows hold, and obstacles may have left through a closed edge. Going on from
/// here gives the bits of the run that was saved.
///
/// # Errors
/// As [`start`]; [`Error::BadContactHistory`] for a history that is not finite or joins bodies that are not near
/// each other; [`Error::LawMisfit`] for one with more words than the storage has.
#[inline]
pub fn resume<R: Real>(
    world: &mut World<'_, R>,
    histories: impl IntoIterator<Item = impl Into<KeptContact<R>>>,
) -> Result<(), Error> {
    take_up(world, histories, true)
}

/// [`resume`]; a world that ran is taken up too if a number type would not let it begin like this.
pub(crate) fn take_up<R: Real>(
    world: &mut World<'_, R>,
    histories: impl IntoIterator<Item = impl Into<KeptContact<R>>>,
    begins: bool,
) -> Result<(), Error> {
    prepare(world, true, begins)?;
    // Saved rows may hold anything in the word that is unused; a step takes it for zero.
    for row in world.grains.force.iter_mut() {
        row[3] = R::ZERO;
    }
    for contact in histories {
        let contact = contact.into();
        let listed = world.clock.listed;
        let sound = contact.is_finite();
        if contact.kept().words() > world.pairs.words() {
            return Err(Error::LawMisfit);
        }
        if !(sound && world.pairs.restore(&world.stretches, &contact, listed)) {
            return Err(Error::BadContactHistory);
        }
    }
    come_to_rest(world)
}

/// Checks a world and makes its first pair list, without histories. If that fails the contacts are still those that
/// were listed before, so that a full list loses nothing.
#[inline]
fn prepare<R: Real>(world: &mut World<'_, R>, has_moved: bool, begins: bool) -> Result<(), Error> {
    let clock = &mut *world.clock;
    if !clock.has_state() {
        return Err(Error::NotStarted);
    }
    clock.stage = Stage::New;
    clock.losing = false;
    if !world.pairs.holds(clock.listed) || !world.stretches.holds(clock.listed.stretches) {
        // Of other storage.
        clock.listed = Listed::NONE;
    }
    check_arithmetic::<R>()?;
    world.check(has_moved)?;
    if begins {
        world.check_resolution()?;
    }
    weigh(world);
    world.clock.far = -R::ONE;
    world.clock.next_travel = R::ZERO;
    let travel = next_travel(world)?;
    cut_anew(world);
    refresh_pair_list(world, Some(travel))?;
    world.pairs.forget(world.clock.listed);
    Ok(())
}

/// Obstacles first, then pairs: the order of every grain's sum.
fn push_and_sum<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    dt: R,
    mut watch: impl FnMut(ContactForce<R>),
) -> Result<(), Error> {
    let (mut part, mut touch) = world.force_ranges(dt);
    let hit = obstacle_forces(&mut part, &mut touch, law, &mut watch);
    let fetch = no_fetch::<R>();
    let (deep, _) = accumulate(&mut part, law, &mut watch, fetch, After::Stay);
    check_forces(world, hit.and(deep))
}
