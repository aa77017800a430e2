//! Grains that come, go, and are changed between two steps; all other histories stay.

use bitgrain_kernel::{NewGrain, nudge, regroup, remove};

use crate::arguments::{lent, vector};
use crate::block::with;
use crate::status::{BG_BAD_GRAIN, BG_BAD_SIZE, BG_UNKNOWN_GRAIN, fault};
use crate::types::{bg_fault, bg_grain, bg_world};

/// A fault of a grain.
fn of_grain(code: i32, id: u32) -> bg_fault {
    bg_fault {
        first: id,
        ..fault(code)
    }
}

/// Puts `count` grains into a world, by ids that ascend: before it is started each must follow the grains that are
/// there, between two steps each goes where its id belongs.
#[unsafe(no_mangle)]
pub extern "C" fn bg_insert(world: *mut bg_world, grains: *const bg_grain, count: usize) -> i32 {
    with(world, |parts| {
        let grains = lent(grains, count)?;
        for grain in grains {
            if grain.size as usize != size_of::<bg_grain>() {
                return Err(fault(BG_BAD_SIZE));
            }
            if grain.group > 255 {
                return Err(of_grain(BG_BAD_GRAIN, grain.id));
            }
        }
        let new = grains.iter().map(|grain| NewGrain {
            id: grain.id,
            group: grain.group as u8,
            position: grain.position,
            radius: grain.radius,
            mass: grain.mass,
            velocity: grain.velocity,
            spin: grain.spin,
        });
        let clock = *parts.store.world().clock;
        // One that a fault has stopped refuses them too.
        if clock.rests() || !clock.has_state() {
            return Ok(parts.store.insert(new)?);
        }
        let room = parts.store.capacity().grains;
        let needed = parts.store.count().saturating_add(count);
        if needed > room {
            return Err(bitgrain_kernel::Error::GrainsFull { needed }.into());
        }
        for grain in new {
            parts.store.add(&grain)?;
        }
        Ok(())
    })
}

/// Takes `count` grains out, by ids that ascend.
#[unsafe(no_mangle)]
pub extern "C" fn bg_remove(world: *mut bg_world, ids: *const u32, count: usize) -> i32 {
    with(world, |parts| {
        let ids = lent(ids, count)?;
        Ok(remove(&mut parts.store.world(), ids)?)
    })
}

/// Puts `count` grains into another group, by ids that ascend.
#[unsafe(no_mangle)]
pub extern "C" fn bg_regroup(
    world: *mut bg_world,
    ids: *const u32,
    count: usize,
    group: u32,
) -> i32 {
    with(world, |parts| {
        let ids = lent(ids, count)?;
        let first = ids.first().copied().unwrap_or(0);
        let group = u8::try_from(group).map_err(|_| of_grain(BG_BAD_GRAIN, first))?;
        Ok(regroup(&mut parts.store.world(), ids, group)?)
    })
}

/// Gives a grain another velocity and angular velocity. It costs nothing to speak of.
#[unsafe(no_mangle)]
pub extern "C" fn bg_nudge(
    world: *mut bg_world,
    id: u32,
    velocity: *const f64,
    spin: *const f64,
) -> i32 {
    with(world, |parts| {
        let (velocity, spin) = (vector(velocity)?, vector(spin)?);
        let mut world = parts.store.world();
        let place = world.place_of(id);
        let place = place.ok_or(of_grain(BG_UNKNOWN_GRAIN, id))?;
        Ok(nudge(&mut world, place, velocity, spin)?)
    })
}
