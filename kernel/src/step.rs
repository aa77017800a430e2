//! One step: velocity Verlet with spin. This file is the physics on one screen; each phase is a
//! pass that lives in its own file.

use crate::fault::Fault;
use crate::law::Law;
use crate::motion::{Kick, begin_kick, drift, end_kick};
use crate::pairs::Bond;
use crate::push::{Part, Pushed, Sight, TouchPart, push_obstacles, sum};
use crate::real::{Real, smaller};
use crate::search::{Scene, search};
use crate::vec3::dot;
use crate::world::World;

/// Advances a started world by one step `dt`.
///
/// # Errors
/// A full list leaves the state untouched: enlarge the storage and call again. Any other fault
/// leaves the world stopped in the middle of the step, for inspection.
#[inline(always)]
pub fn step<R: Real, L: Law<R>>(world: &mut World<'_, R>, law: &L) -> Result<(), Fault> {
    step_watched(world, law, |_| {})
}

/// [`step`], showing every touching contact to `watch`: first those on obstacles, by grain and
/// obstacle, then those of two grains, by `(i, j)`. Watching changes no bit.
///
/// # Errors
/// As [`step`].
#[inline(always)]
pub fn step_watched<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    watch: impl FnMut(Pushed<R>),
) -> Result<(), Fault> {
    find_who_may_touch(world)?;
    // A fault below stops the world in the middle of a step.
    world.clock.started = false;

    let half = world.dt * R::HALF;
    begin_kick(&mut kick_of(world), half);
    drift_all(world)?;
    push_and_sum(world, law, world.dt, watch)?;
    finish_kick(world, half)?;

    world.clock.step += 1;
    world.clock.started = true;
    Ok(())
}

/// Checks a world, makes its pair list, empties every history and evaluates the forces at step 0,
/// with the velocities as given.
///
/// # Errors
/// Whatever is wrong with the world, before anything is changed; a full list: enlarge the storage
/// and start again; or what the forces show: overlaps too deep, speeds too high.
#[inline(always)]
pub fn start<R: Real, L: Law<R>>(world: &mut World<'_, R>, law: &L) -> Result<(), Fault> {
    start_watched(world, law, |_| {})
}

/// [`start`], showing every touching contact to `watch` as [`step_watched`] does.
///
/// # Errors
/// As [`start`].
#[inline(always)]
pub fn start_watched<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    watch: impl FnMut(Pushed<R>),
) -> Result<(), Fault> {
    prepare(world)?;
    push_and_sum(world, law, R::ZERO, watch)?;
    foresee(world)?;
    world.clock.started = true;
    Ok(())
}

/// Checks a world, makes its pair list and puts back the histories of its touching contacts; the
/// forces are those that its rows hold. Going on from here gives the bits of the run that was saved.
///
/// # Errors
/// As [`start`]; [`Fault::BadBond`] for a bond that is not finite or joins bodies that are not near
/// each other.
#[inline(always)]
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
    foresee(world)?;
    world.clock.started = true;
    Ok(())
}

#[inline(always)]
fn prepare<R: Real>(world: &mut World<'_, R>) -> Result<(), Fault> {
    world.clock.started = false;
    world.clock.listed = 0;
    world.clock.touches = 0;
    world.check()?;
    world.clock.radius_min = R::MAX;
    for i in 0..world.grains.count() {
        let heavy = world.grains.groups[world.grains.group[i] as usize].heavy;
        let per_mass = R::ONE / world.grains.velocity[i][3];
        world.grains.spin[i][3] = if heavy { R::ZERO } else { per_mass };
        let radius = world.grains.position[i][3];
        world.clock.radius_min = smaller(world.clock.radius_min, radius);
    }
    world.pairs.row.fill(0);
    world.clock.budget = -R::ONE;
    world.clock.next_travel = R::ZERO;
    let travel = next_travel(world)?;
    search_now(world, travel)
}

/// Searches when the list might not hold through the coming drift. Which step that is has no effect
/// on any result.
#[inline(always)]
fn find_who_may_touch<R: Real>(world: &mut World<'_, R>) -> Result<(), Fault> {
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
    Ok(())
}

/// Bound of what the fastest body moves in the next step.
#[inline(always)]
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

#[inline(always)]
fn drift_all<R: Real>(world: &mut World<'_, R>) -> Result<(), Fault> {
    for body in world.obstacles.iter_mut() {
        body.advance(world.domain, world.dt);
    }
    let g = &mut world.grains;
    drift(
        world.domain,
        g.id,
        g.position,
        g.image,
        g.velocity,
        world.dt,
    )
}

/// Obstacles first, then pairs: the order of every grain's sum.
#[inline(always)]
fn push_and_sum<R: Real, L: Law<R>>(
    world: &mut World<'_, R>,
    law: &L,
    dt: R,
    mut watch: impl FnMut(Pushed<R>),
) -> Result<(), Fault> {
    let n = world.grains.count();
    let g = &mut world.grains;
    let sight = Sight {
        domain: world.domain,
        position: g.position,
        velocity: g.velocity,
        spin: g.spin,
        row: world.pairs.row,
        dt,
    };
    let touches = world.clock.touches;
    let mut touch = TouchPart {
        grain: &world.pairs.touch_grain[..touches],
        obstacle: &mut world.pairs.touch_obstacle[..touches],
        spring: &mut world.pairs.touch_spring[..touches],
        obstacles: world.obstacles,
    };
    let hit = push_obstacles(sight, &mut touch, g.force, g.torque, law, &mut watch);
    let mut part = Part {
        rows: 0..n,
        force: g.force,
        torque: g.torque,
        partner: world.pairs.partner,
        spring: world.pairs.spring,
    };
    let deep = sum(sight, &mut part, law, &[], &[], &mut watch);
    for (k, body) in world.obstacles.iter().enumerate() {
        if !body.force.iter().chain(&body.torque).all(|f| f.is_finite()) {
            return Err(Fault::ObstacleNotFinite { obstacle: k as u32 });
        }
    }
    if let Some((i, obstacle)) = hit {
        let id = g.id[i as usize];
        return Err(Fault::ObstacleTooDeep { id, obstacle });
    }
    if let Some((i, j)) = deep {
        let (i, j) = (g.id[i as usize], g.id[j as usize]);
        return Err(Fault::OverlapTooDeep { i, j });
    }
    Ok(())
}

#[inline(always)]
fn finish_kick<R: Real>(world: &mut World<'_, R>, half: R) -> Result<(), Fault> {
    let dt = world.dt;
    let fastest = end_kick(&mut kick_of(world), half, dt, true)?;
    world.clock.next_travel = fastest.sqrt() * dt;
    Ok(())
}

/// Bounds the first step's travel without moving anything.
#[inline(always)]
fn foresee<R: Real>(world: &mut World<'_, R>) -> Result<(), Fault> {
    let (dt, half) = (world.dt, world.dt * R::HALF);
    let fastest = end_kick(&mut kick_of(world), half, dt, false)?;
    world.clock.next_travel = fastest.sqrt() * dt;
    Ok(())
}

#[inline(always)]
fn kick_of<'w, R: Real>(world: &'w mut World<'_, R>) -> Kick<'w, R> {
    let g = &mut world.grains;
    Kick {
        id: g.id,
        group: g.group,
        groups: g.groups,
        position: g.position,
        force: g.force,
        torque: g.torque,
        velocity: g.velocity,
        spin: g.spin,
    }
}
