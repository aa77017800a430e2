//! Worlds: how much memory they take, and what they are made of.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::{Capacity, Domain, Drain, Group, Head, LossPolicy, time_step};

use crate::arguments::{axes, flag, give, put, take};
use crate::block::{Parts, bytes, init, last_fault, with};
use crate::laws::{WithLaw, law_of, material, row_of, table_of, with_law};
use crate::status::{
    BG_BAD_ARGUMENT, BG_LAW_MISFIT, BG_LONG_TIME_STEP, BG_OK, BG_TOO_SMALL, Done, fault,
};
use crate::types::{
    BG_NO_ROLLING, bg_capacity, bg_config, bg_counts, bg_fault, bg_group, bg_law, bg_policy,
    bg_world,
};

/// The number of what came of a call that has no world.
pub(crate) fn code(done: Done) -> i32 {
    done.map_or_else(|fault| fault.code, |()| BG_OK)
}

/// Sets `out` to room for a bed of `grains` grains among `obstacles` obstacles: 8 pairs, 8 candidates, 2 obstacle
/// contacts and 2 cells for each grain and 64 more of each, 8 groups, no triangles and no table of materials.
/// Nothing but the memory depends on it.
#[unsafe(no_mangle)]
pub extern "C" fn bg_capacity_for_bed(grains: u32, obstacles: u32, out: *mut bg_capacity) -> i32 {
    let room = Capacity::for_bed(grains as usize, obstacles as usize);
    let count = |n: usize| u32::try_from(n).map_err(|_| fault(BG_TOO_SMALL));
    let make = || {
        Ok(bg_capacity {
            size: size_of::<bg_capacity>() as u32,
            grains,
            pairs: count(room.pairs)?,
            candidates: count(room.candidates)?,
            obstacle_contacts: count(room.obstacle_contacts)?,
            cells: count(room.cells)?,
            obstacles,
            groups: count(room.groups)?,
            facets: 0,
            materials: 0,
        })
    };
    code(make().and_then(|capacity| give(out, capacity)))
}

/// Bytes of memory that a world of this capacity takes; 0 if there can be none.
#[unsafe(no_mangle)]
pub extern "C" fn bg_size(capacity: *const bg_capacity) -> usize {
    let capacity = take(capacity).ok();
    capacity.and_then(|room| bytes(&room)).unwrap_or(0)
}

/// Makes `memory` of `size` bytes an empty world and sets `out` to it. The memory is the world: it may be copied to
/// another place between calls, and is free again when the caller says so. It begins at a multiple of `BG_ALIGNMENT`
/// bytes.
#[unsafe(no_mangle)]
pub extern "C" fn bg_init(
    memory: *mut core::ffi::c_void,
    size: usize,
    capacity: *const bg_capacity,
    config: *const bg_config,
    out: *mut *mut bg_world,
) -> i32 {
    let make = || {
        let (capacity, config) = (take(capacity)?, take(config)?);
        let row = row_of(&config.law)?;
        let law = match (capacity.materials, config.law.rolling) {
            (0, BG_NO_ROLLING) => law_of(config.law.kind, &row)?,
            (0, _) => return Err(fault(BG_LAW_MISFIT)),
            (materials, _) => table_of(config.law.kind, materials, &row)?,
        };
        let axes = axes(config.periodic)?;
        let domain = match config.lo == config.hi && config.periodic == 0 {
            true => Domain::open(),
            false => Domain::new(config.lo, config.hi, axes)?,
        };
        put(out, core::ptr::null_mut())?;
        let head = Head::new(domain, config.dt, config.skin);
        let world = init(memory.cast(), size, &capacity, (law, row), head)?;
        let skins = (config.skin, config.outer_skin);
        bg_set_skins(world, skins.0, skins.1);
        put(out, world)
    };
    code(make())
}

/// Sets `overlap` to the deepest overlap (length) and `duration` to the duration of a collision without damping: of two
/// bodies with this effective mass and effective radius (half of each for two equal grains, those of the grain on a
/// floor) that meet at this speed. Choose `kn` so that the overlap is below a fiftieth of a diameter, and a time step
/// of at most a tenth of the duration: a longer one makes energy (`bg_time_step` says so). Landau and Lifshitz, Theory
/// of Elasticity, section 9.
#[unsafe(no_mangle)]
pub extern "C" fn bg_collision(
    law: *const bg_law,
    radius: f64,
    mass: f64,
    speed: f64,
    overlap: *mut f64,
    duration: *mut f64,
) -> i32 {
    let collide = || {
        let law = take(law)?;
        row_of(&law)?;
        let sound = [radius, mass, speed].iter().all(|number| *number > 0.0);
        if !sound {
            return Err(fault(BG_BAD_ARGUMENT));
        }
        let (deepest, lasts) = time_step::collision(law.kn, radius, mass, speed);
        put(overlap, deepest)?;
        put(duration, lasts)
    };
    code(collide())
}

/// Sets `rayleigh` to the time step of a world over the shortest Rayleigh time of a grain or free body in it, and
/// `collision` to the same over the duration of its shortest collision, at the largest difference of two velocities:
/// for a look before `bg_start` and now and then, since it takes about as long as a step. Returns
/// `BG_LONG_TIME_STEP`, a warning, if they are above a fifth and a tenth: then restitution is off and collisions make
/// energy. The world can be stepped all the same, and nothing else warns.
#[unsafe(no_mangle)]
pub extern "C" fn bg_time_step(
    world: *mut bg_world,
    rayleigh: *mut f64,
    collision: *mut f64,
) -> i32 {
    let mut told = BG_OK;
    let look = Look {
        out: [rayleigh, collision],
        told: &mut told,
    };
    match with(world, |parts| with_law(parts, look)) {
        BG_OK => told,
        wrong => wrong,
    }
}

struct Look<'a> {
    out: [*mut f64; 2],
    told: &'a mut i32,
}

impl WithLaw for Look<'_> {
    fn run(self, parts: &mut Parts<'_>, law: &impl Law<f64>) -> Done {
        let world = parts.store.world();
        let times = time_step::shortest_times(&world, law);
        for (to, fraction) in self.out.into_iter().zip(times.fractions(world.dt)) {
            put(to, fraction)?;
        }
        if !times.are_resolved_by(world.dt) {
            *self.told = BG_LONG_TIME_STEP;
        }
        Ok(())
    }
}

/// Sets how far beyond touching pairs are listed, and beyond that are candidates (length): speed only, never a bit.
#[unsafe(no_mangle)]
pub extern "C" fn bg_set_skins(world: *mut bg_world, skin: f64, outer_skin: f64) -> i32 {
    with(world, |parts| {
        parts.store.set_skins(skin, outer_skin);
        Ok(())
    })
}

/// Says what becomes of grains that leave, from now on.
#[unsafe(no_mangle)]
pub extern "C" fn bg_set_policy(world: *mut bg_world, policy: *const bg_policy) -> i32 {
    with(world, |parts| {
        let policy = take(policy)?;
        let drain = Drain {
            point: policy.point,
            normal: policy.normal,
        };
        parts.store.set_policy(LossPolicy {
            takes_out: flag(policy.takes_out)?,
            drain: flag(policy.drains)?.then_some(drain),
        });
        Ok(())
    })
}

/// Adds a group before the world is started, and sets `number` to its number.
#[unsafe(no_mangle)]
pub extern "C" fn bg_add_group(
    world: *mut bg_world,
    group: *const bg_group,
    number: *mut u32,
) -> i32 {
    with(world, |parts| {
        let group = take(group)?;
        put(number, 0)?;
        let added = parts.store.add_group(Group {
            integrates: axes(group.integrates)?,
            spins: flag(group.spins)?,
            infinite_mass: flag(group.infinite_mass)?,
            gravity: group.gravity,
            material: material(group.material)?,
        })?;
        put(number, u32::from(added))
    })
}

/// Sets `out` to how much there is of everything.
#[unsafe(no_mangle)]
pub extern "C" fn bg_get_counts(world: *mut bg_world, out: *mut bg_counts) -> i32 {
    with(world, |parts| {
        let departed = *parts.departed;
        let world = parts.store.world();
        give(
            out,
            bg_counts {
                size: size_of::<bg_counts>() as u32,
                grains: world.grains.count() as u32,
                obstacles: world.obstacles.len() as u32,
                groups: world.grains.groups.len() as u32,
                step: world.clock.step,
                departed,
            },
        )
    })
}

/// Sets `out` to the last error of a call with this world; its code is 0 if there was none.
#[unsafe(no_mangle)]
pub extern "C" fn bg_get_fault(world: *mut bg_world, out: *mut bg_fault) -> i32 {
    code(last_fault(world).and_then(|last| give(out, last)))
}
