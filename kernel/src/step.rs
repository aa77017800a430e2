//! One step: velocity Verlet with spin. This file is the physics on one screen; each phase is a
//! pass that lives in its own file.

use crate::canary::check_arithmetic;
use crate::fault::Fault;
use crate::law::Law;
use crate::motion::{foresee, kick, kick_and_drift};
use crate::pairs::Bond;
use crate::push::{Deep, LANES, Pushed, sum};
use crate::real::{Real, smaller};
use crate::rows::at;
use crate::search::{Scene, search};
use crate::touch::push_obstacles;
use crate::vec3::dot;
use crate::world::World;

/// Advances a started world by one step `dt`.
///
/// # Errors
/// A full list leaves the state untouched: enlarge the storage and call again. Any other fault
/// leaves the world stopped in the middle of the step, for inspection.
#[inline]
pub fn step<R: Real, L: Law<R>>(world: &mut World<'_, R>, law: &L) -> Result<(), Fault> {
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
    watch: impl FnMut(Pushed<R>),
) -> Result<(), Fault> {
    find_who_may_touch(world)?;
    kick_and_drift(&mut world.moving())?;
    push_and_sum(world, law, world.dt, watch)?;
    let fastest = kick(&mut world.moving())?;
    finish(world, fastest);
    Ok(())
}

/// Watches nothing. A function of its own, so that starting and stepping share their code.
fn nobody<R>(_: Pushed<R>) {}

/// Checks a world, makes its pair list, empties every history and evaluates the forces at step 0,
/// with the velocities as given.
///
/// # Errors
/// Whatever is wrong with the world, before anything is changed; a full list: enlarge the storage
/// and start again; or what the forces show: overlaps too deep, speeds too high.
#[inline]
pub fn start<R: Real, L: Law<R>>(world: &mut World<'_, R>, law: &L) -> Result<(), Fault> {
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
    watch: impl FnMut(Pushed<R>),
) -> Result<(), Fault> {
    prepare(world)?;
    push_and_sum(world, law, R::ZERO, watch)?;
    let fastest = foresee(&mut world.moving())?;
    ready(world, fastest);
    Ok(())
}

/// Checks a world, makes its pair list and puts back the histories of its touching contacts; the
/// forces are those that its rows hold. Going on from here gives the bits of the run that was saved.
///
/// # Errors
/// As [`start`]; [`Fault::BadBond`] for a bond that is not finite or joins bodies that are not near
/// each other.
#[inline]
pub fn resume<R: Real>(
    world: &mut World<'_, R>,
    bonds: impl IntoIterator<Item = Bond<R>>,
) -> Result<(), Fault> {
    prepare(world)?;
    for bond in bonds {
        if !world.pairs.restore(&bond, world.clock.touches) {
            return Err(Fault::BadBond);
        }
    }
    let fastest = foresee(&mut world.moving())?;
    ready(world, fastest);
    Ok(())
}

#[inline]
fn prepare<R: Real>(world: &mut World<'_, R>) -> Result<(), Fault> {
    world.clock.started = false;
    world.clock.listed = 0;
    world.clock.touches = 0;
    check_arithmetic::<R>()?;
    world.check()?;
    world.clock.radius_min = R::MAX;
    let g = &mut world.grains;
    let rows = g.velocity.iter().zip(g.position.iter()).zip(g.group);
    for (w, ((v, x), group)) in g.spin.iter_mut().zip(rows) {
        world.clock.radius_min = smaller(world.clock.radius_min, x[3]);
        let group = g.groups.get(usize::from(*group));
        let heavy = group.is_some_and(|group| group.heavy);
        w[3] = if heavy { R::ZERO } else { R::ONE / v[3] };
    }
    world.pairs.row.fill(0);
    world.clock.budget = -R::ONE;
    world.clock.next_travel = R::ZERO;
    let travel = next_travel(world)?;
    search_now(world, travel)
}

/// The first joint of a step, before [`kick_and_drift`]: searches when the list might not hold
/// through the drift, and moves the obstacles. Which step searches has no effect on any result.
///
/// # Errors
/// A full list, before anything is changed; an obstacle that is too fast; a world not started.
#[inline]
pub fn find_who_may_touch<R: Real>(world: &mut World<'_, R>) -> Result<(), Fault> {
    if !world.clock.started {
        return Err(Fault::NotStarted);
    }
    world.check_storage()?;
    let mut travel = next_travel(world)?;
    if travel > world.clock.budget {
        search_now(world, travel)?;
        travel = travel + world.clock.rounding;
    }
    world.clock.budget = world.clock.budget - travel;
    // A fault from here on stops the world in the middle of a step.
    world.clock.started = false;
    for body in world.obstacles.iter_mut() {
        body.advance(world.domain, world.dt);
    }
    Ok(())
}

/// Bound of what the fastest body moves in the next step.
#[inline]
fn next_travel<R: Real>(world: &World<'_, R>) -> Result<R, Fault> {
    let mut travel = world.clock.next_travel;
    for (k, body) in world.obstacles.iter().enumerate() {
        let way = dot(body.velocity, body.velocity).sqrt() * world.dt;
        let slow = way < world.clock.radius_min;
        if !slow {
            return Err(Fault::ObstacleTooFast { obstacle: k as u32 });
        }
        travel = if way > travel { way } else { travel };
    }
    // The speed was rounded; a part in a thousand covers that and is nothing to the skin.
    Ok(travel * R::from_f64(1.001) + world.clock.rounding)
}

#[inline(never)]
fn search_now<R: Real>(world: &mut World<'_, R>, travel: R) -> Result<(), Fault> {
    let clock = &mut *world.clock;
    let scene = Scene {
        domain: world.domain,
        grains: &world.grains,
        obstacles: world.obstacles,
        skin: world.skin,
        step_travel: travel,
    };
    let found = search(
        &scene,
        &mut world.pairs,
        &mut world.spare,
        &mut world.cells,
        clock.touches,
    )?;
    clock.searches += 1;
    clock.listed = found.pairs;
    clock.touches = found.touches;
    clock.budget = found.budget;
    clock.rounding = found.rounding;
    Ok(())
}

/// Obstacles first, then pairs: the order of every grain's sum.
fn push_and_sum<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    dt: R,
    mut watch: impl FnMut(Pushed<R>),
) -> Result<(), Fault> {
    let (sight, mut touch, mut part) = world.pushing(dt);
    let hit = push_obstacles(sight, &mut touch, part.force, part.torque, law, &mut watch);
    let none = core::iter::empty();
    let deep = sum::<R, L, LANES>(sight, &mut part, law, none, &[], &mut watch);
    judge(world, hit, deep)
}

/// The joint after [`push_obstacles`] and [`sum`], which say what they found too deep.
///
/// # Errors
/// A force on an obstacle that is not finite, or one of the overlaps.
pub fn judge<R: Real>(world: &World<'_, R>, hit: Deep, deep: Deep) -> Result<(), Fault> {
    for (k, body) in world.obstacles.iter().enumerate() {
        if !body.force.iter().chain(&body.torque).all(|f| f.is_finite()) {
            return Err(Fault::ObstacleNotFinite { obstacle: k as u32 });
        }
    }
    let id = |place: u32| at(world.grains.id, place as usize);
    if let Some((i, obstacle)) = hit {
        return Err(Fault::ObstacleTooDeep {
            id: id(i),
            obstacle,
        });
    }
    if let Some((i, j)) = deep {
        return Err(Fault::OverlapTooDeep { i: id(i), j: id(j) });
    }
    Ok(())
}

/// The last joint of a step: counts it. `fastest` is what [`kick`] returned, the largest of all
/// ranges.
#[inline]
pub fn finish<R: Real>(world: &mut World<'_, R>, fastest: R) {
    world.clock.step += 1;
    ready(world, fastest);
}

#[inline]
fn ready<R: Real>(world: &mut World<'_, R>, fastest: R) {
    world.clock.next_travel = fastest.sqrt() * world.dt;
    world.clock.started = true;
}
