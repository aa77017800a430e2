//! Obstacles: what they are, how they move, and the forces on them.

use bitgrain_kernel::{Error, FACETS_MAX, Facet, FreeMotion, Motion, Obstacle, Shape, arrange};

use crate::arguments::{axes, flag, give, lent, put, take, vector};
use crate::block::{Parts, with};
use crate::laws::material;
use crate::status::{BG_BAD_ARGUMENT, BG_TOO_SMALL, Done, fault};
use crate::types::{
    BG_BOX, BG_CAPSULE, BG_CYLINDER, BG_DRUM, BG_FINITE_CYLINDER, BG_MESH, BG_PLANE, BG_SPHERE,
    bg_fault, bg_obstacle, bg_world,
};

/// Adds an obstacle before the world is started, and sets `number` to its number. Forces in the structure are not read.
#[unsafe(no_mangle)]
pub extern "C" fn bg_add_obstacle(
    world: *mut bg_world,
    obstacle: *const bg_obstacle,
    number: *mut u32,
) -> i32 {
    with(world, |parts| {
        let of = take(obstacle)?;
        put(number, 0)?;
        let made = match of.kind {
            BG_SPHERE => Obstacle::sphere(of.point, of.radius),
            BG_CYLINDER => Obstacle::cylinder(of.point, of.direction, of.radius),
            BG_PLANE => Obstacle::plane(of.point, of.direction),
            BG_FINITE_CYLINDER => {
                Obstacle::finite_cylinder(of.point, of.direction, of.radius, of.half[0])
            }
            BG_CAPSULE => Obstacle::capsule(of.point, of.direction, of.radius, of.half[0]),
            BG_BOX => Obstacle::cuboid(of.point, of.half),
            BG_DRUM => Obstacle::drum(of.point, of.direction, of.radius, of.half[0]),
            _ => return Err(fault(BG_BAD_ARGUMENT)),
        };
        let added = parts.store.add_obstacle(moving(&of, made)?)?;
        put(number, added)
    })
}

/// Adds a mesh before the world is started, and sets `number` to its number: `facets` triangles of nine numbers each,
/// the corners from the point of the mesh in its own axes (length), in any order. They are copied; grains touch both
/// sides. `obstacle` says the rest, as for `bg_add_obstacle`. A world that was saved with meshes is loaded into one to
/// which the same ones were added in the same order.
#[unsafe(no_mangle)]
pub extern "C" fn bg_add_mesh(
    world: *mut bg_world,
    obstacle: *const bg_obstacle,
    corners: *const f64,
    facets: u32,
    number: *mut u32,
) -> i32 {
    with(world, |parts| {
        let of = take(obstacle)?;
        put(number, 0)?;
        let count = facets as usize;
        let length = count.checked_mul(9).ok_or(fault(BG_BAD_ARGUMENT))?;
        let corners = lent(corners, length)?;
        let sound = corners.iter().all(|x| x.is_finite());
        if of.kind != BG_MESH || !sound || count == 0 || count > FACETS_MAX {
            return Err(fault(BG_BAD_ARGUMENT));
        }
        let (free, used) = (&mut *parts.facets.0, &mut *parts.facets.1);
        let room = free.get_mut(..count).ok_or(fault(BG_TOO_SMALL))?;
        let triangles = corners.as_chunks::<3>().0.as_chunks::<3>().0;
        for (facet, corners) in room.iter_mut().zip(triangles) {
            *facet = Facet::new(*corners);
        }
        arrange(room);
        let made = Obstacle::mesh(of.point, room, *used as u32);
        let added = parts.store.add_obstacle(moving(&of, made)?)?;
        *used += u64::from(facets);
        put(number, added)
    })
}

/// An obstacle of this shape and place that moves as a structure says.
fn moving(of: &bg_obstacle, made: Obstacle<f64>) -> Result<Obstacle<f64>, bg_fault> {
    Ok(Obstacle {
        velocity: of.velocity,
        angular_velocity: of.angular_velocity,
        orientation: match of.orientation {
            [0.0, 0.0, 0.0, 0.0] => made.orientation,
            turned => turned,
        },
        inverse_mass: of.inverse_mass,
        curved: flag(of.curved)?,
        material: material(of.material)?,
        motion: motion(of)?,
        ..made
    })
}

/// How an obstacle is to move.
fn motion(of: &bg_obstacle) -> Result<Motion<f64>, bg_fault> {
    let (integrates, spins) = (axes(of.integrates)?, flag(of.spins)?);
    if !flag(of.is_free)? {
        return Ok(Motion::Prescribed);
    }
    Ok(Motion::Free(FreeMotion {
        inertia: of.inertia,
        gravity: of.gravity,
        force: of.applied_force,
        torque: of.applied_torque,
        integrates,
        spins,
    }))
}

/// Changes the obstacle of this number, in a world with a time step, or nothing if it cannot turn so.
fn change(
    parts: &mut Parts<'_>,
    number: u32,
    act: impl FnOnce(&mut Obstacle<f64>, f64) -> Done,
) -> Done {
    let world = parts.store.world();
    let body = world.obstacles.get_mut(number as usize);
    let body = body.ok_or(fault(BG_BAD_ARGUMENT))?;
    let mut changed = *body;
    act(&mut changed, world.dt)?;
    changed.check_turn(number)?;
    *body = changed;
    Ok(())
}

/// Lets an obstacle turn at this angular velocity (radians / time, axes of the world) from the next step on; what is
/// endless turns about its own direction alone (`BG_BAD_OBSTACLE`).
#[unsafe(no_mangle)]
pub extern "C" fn bg_turn(world: *mut bg_world, number: u32, angular_velocity: *const f64) -> i32 {
    with(world, |parts| {
        let spin = vector(angular_velocity)?;
        change(parts, number, |body, _| {
            body.angular_velocity = spin;
            Ok(())
        })
    })
}

/// Lets an obstacle go to a point (length) and turn to an orientation, the shorter way round, in `steps` steps from the
/// next one on; then stop it with `bg_drive` and `bg_turn`. On a periodic axis it goes by the difference of the points,
/// which may be more than a period. What is endless turns about its own direction alone (`BG_BAD_OBSTACLE`).
#[unsafe(no_mangle)]
pub extern "C" fn bg_drive_to(
    world: *mut bg_world,
    number: u32,
    point: *const f64,
    orientation: *const f64,
    steps: u32,
) -> i32 {
    with(world, |parts| {
        let point = vector(point)?;
        let turned = lent(orientation, 4)?;
        let turned = turned.try_into().map_err(|_| fault(BG_BAD_ARGUMENT))?;
        change(parts, number, |body, dt| {
            let way = [0, 1, 2].map(|a| point[a] - body.point[a]);
            body.drive_to(way, turned, steps, dt);
            Ok(())
        })
    })
}

/// Puts a force of the host (mass length / time^2) on the point of a free obstacle, and a torque (mass length^2 /
/// time^2), from the next step on until they are changed.
#[unsafe(no_mangle)]
pub extern "C" fn bg_push(
    world: *mut bg_world,
    number: u32,
    force: *const f64,
    torque: *const f64,
) -> i32 {
    with(world, |parts| {
        let (force, torque) = (vector(force)?, vector(torque)?);
        change(parts, number, |body, _| match &mut body.motion {
            Motion::Free(free) => {
                (free.force, free.torque) = (force, torque);
                Ok(())
            }
            Motion::Prescribed => Err(fault(BG_BAD_ARGUMENT)),
        })
    })
}

/// Lets an obstacle move at this velocity (length / time) from the next step on.
#[unsafe(no_mangle)]
pub extern "C" fn bg_drive(world: *mut bg_world, number: u32, velocity: *const f64) -> i32 {
    with(world, |parts| {
        let velocity = vector(velocity)?;
        change(parts, number, |body, _| {
            body.velocity = velocity;
            Ok(())
        })
    })
}

/// Sets `out` to an obstacle as it is: its place, the force on it in the last step, and the means over the last steps.
/// After a fault of the motion there is none.
#[unsafe(no_mangle)]
pub extern "C" fn bg_get_obstacle(world: *mut bg_world, number: u32, out: *mut bg_obstacle) -> i32 {
    with(world, |parts| {
        let steps = (*parts.stepped).max(1) as f64;
        let sums = parts.sums.get(number as usize).copied();
        let world = parts.store.world();
        if !world.clock.has_state() {
            return Err(Error::NotStarted.into());
        }
        let body = world.obstacles.get(number as usize).zip(sums);
        let (body, sums) = body.ok_or(fault(BG_BAD_ARGUMENT))?;
        let nothing = [0.0; 3];
        let (kind, direction, radius, half) = match body.shape {
            Shape::Sphere { radius } => (BG_SPHERE, nothing, radius, nothing),
            Shape::Cylinder { axis, radius } => (BG_CYLINDER, axis, radius, nothing),
            Shape::Plane { normal } => (BG_PLANE, normal, 0.0, nothing),
            Shape::FiniteCylinder {
                axis,
                radius,
                half_length,
            } => (BG_FINITE_CYLINDER, axis, radius, [half_length, 0.0, 0.0]),
            Shape::Capsule {
                axis,
                radius,
                half_length,
            } => (BG_CAPSULE, axis, radius, [half_length, 0.0, 0.0]),
            Shape::Box { half } => (BG_BOX, nothing, 0.0, half),
            Shape::Drum {
                axis,
                radius,
                half_length,
            } => (BG_DRUM, axis, radius, [half_length, 0.0, 0.0]),
            Shape::Mesh { reach, .. } => (BG_MESH, nothing, reach, nothing),
        };
        let free = match body.motion {
            Motion::Free(free) => Some(free),
            Motion::Prescribed => None,
        };
        let flags = free.map_or([false; 3], |free| free.integrates);
        let flags = flags.map(u32::from);
        let [a, b, c, d, e, f] = sums.map(|sum| sum / steps);
        give(
            out,
            bg_obstacle {
                size: size_of::<bg_obstacle>() as u32,
                kind,
                point: body.point,
                direction,
                radius,
                inverse_mass: body.inverse_mass,
                velocity: body.velocity,
                force: body.force,
                torque: body.torque,
                mean_force: [a, b, c],
                mean_torque: [d, e, f],
                half,
                orientation: body.orientation,
                angular_velocity: body.angular_velocity,
                curved: body.curved.into(),
                is_free: free.is_some().into(),
                integrates: flags[0] | flags[1] << 1 | flags[2] << 2,
                spins: free.is_some_and(|free| free.spins).into(),
                inertia: free.map_or(nothing, |free| free.inertia),
                gravity: free.map_or(nothing, |free| free.gravity),
                applied_force: free.map_or(nothing, |free| free.force),
                applied_torque: free.map_or(nothing, |free| free.torque),
                material: body.material.into(),
                reserved: 0,
            },
        )
    })
}
