//! Starting and stepping.

use core::ffi::c_void;

use bitgrain_kernel::contact::Law as Contacts;
use bitgrain_kernel::{
    Cause, Departure, Error, GrainState, World, digest, start, step, step_with, take_out,
};

use crate::arguments::give;
use crate::block::{Parts, with};
use crate::laws::{WithLaw, with_law};
use crate::status::Done;
use crate::types::{
    BG_CAUSE_DRAINED, BG_CAUSE_ESCAPED, BG_CAUSE_OBSTACLE_TOO_DEEP, BG_CAUSE_OVERLAP_TOO_DEEP,
    bg_apply, bg_departed, bg_departure, bg_digest, bg_world,
};

/// Checks a world, empties all histories and evaluates the forces at step 0. After a full list, enlarge the capacity or
/// lessen the skin and call again.
#[unsafe(no_mangle)]
pub extern "C" fn bg_start(world: *mut bg_world) -> i32 {
    with(world, |parts| with_law(parts, Start))
}

struct Start;

impl WithLaw for Start {
    fn run(self, parts: &mut Parts<'_>, law: &impl Contacts<f64>) -> Done {
        Ok(start(&mut parts.store.world(), law)?)
    }
}

/// Advances a world by `count` steps. Grains that its policy lets go are taken out and counted.
#[unsafe(no_mangle)]
pub extern "C" fn bg_step(world: *mut bg_world, count: u64) -> i32 {
    bg_step_apply(world, count, None, None, core::ptr::null_mut())
}

/// Advances a world by `count` steps. `apply`, unless it is null, is called for each grain in each step, by ascending
/// id, and gives a force and a torque besides those of its contacts: they are the last term of the grain's sum, act in
/// the half kicks that end this step and begin the next, and stand in the rows and the digest. `departed`, unless it is
/// null, is told of each grain that leaves. Both get `user`.
#[unsafe(no_mangle)]
pub extern "C" fn bg_step_apply(
    world: *mut bg_world,
    count: u64,
    apply: bg_apply,
    departed: bg_departed,
    user: *mut c_void,
) -> i32 {
    with(world, |parts| {
        parts.sums.fill([0.0; 6]);
        *parts.stepped = 0;
        let host = Host {
            apply,
            departed,
            user,
        };
        parts.locked(|parts| with_law(parts, Steps { host, count }))
    })
}

struct Steps {
    host: Host,
    count: u64,
}

impl WithLaw for Steps {
    fn run(self, parts: &mut Parts<'_>, law: &impl Contacts<f64>) -> Done {
        self.host.steps(parts, self.count, law)
    }
}

/// The caller's functions.
struct Host {
    apply: bg_apply,
    departed: bg_departed,
    user: *mut c_void,
}

impl Host {
    fn steps(&self, parts: &mut Parts<'_>, count: u64, law: &impl Contacts<f64>) -> Done {
        for _ in 0..count {
            let mut world = parts.store.world();
            self.lose(&mut world, parts.departed)?;
            match self.apply {
                Some(apply) => step_with(&mut world, law, |grain| self.pushed(apply, grain)),
                None => step(&mut world, law),
            }?;
            *parts.stepped = parts.stepped.saturating_add(1);
            for (sums, body) in parts.sums.iter_mut().zip(world.obstacles.iter()) {
                let both = body.force.iter().chain(&body.torque);
                for (sum, now) in sums.iter_mut().zip(both) {
                    *sum += now;
                }
            }
            self.lose(&mut world, parts.departed)?;
        }
        Ok(())
    }

    /// The force and the torque that the caller gives for a grain.
    fn pushed(
        &self,
        apply: unsafe extern "C" fn(
            *mut c_void,
            u32,
            *const f64,
            *const f64,
            *const f64,
            *mut f64,
            *mut f64,
        ),
        grain: &GrainState<f64>,
    ) -> ([f64; 3], [f64; 3]) {
        let ([x, y, z], [u, v, w]) = (grain.position, grain.velocity);
        let (position, velocity) = ([x, y, z, grain.radius], [u, v, w, grain.mass]);
        let (mut force, mut torque) = ([0.0; 3], [0.0; 3]);
        // SAFETY: the caller's own function, with copies that live until it returns.
        unsafe {
            apply(
                self.user,
                grain.id,
                position.as_ptr(),
                velocity.as_ptr(),
                grain.spin.as_ptr(),
                force.as_mut_ptr(),
                torque.as_mut_ptr(),
            );
        }
        (force, torque)
    }

    /// Takes out the grains that are lost, and tells of each.
    fn lose(&self, world: &mut World<'_, f64>, count: &mut u64) -> Result<(), Error> {
        let step = world.clock.step;
        let gone = take_out(world, |gone| {
            if let Some(departed) = self.departed {
                // SAFETY: the caller's own function, with a copy that lives until it returns.
                unsafe { departed(self.user, &departure(step, &gone)) };
            }
        })?;
        *count = count.saturating_add(gone as u64);
        Ok(())
    }
}

fn departure(step: u64, gone: &Departure<f64>) -> bg_departure {
    let (cause, partner) = match gone.cause {
        Cause::Drained => (BG_CAUSE_DRAINED, 0),
        Cause::ObstacleTooDeep { obstacle } => (BG_CAUSE_OBSTACLE_TOO_DEEP, obstacle),
        Cause::OverlapTooDeep { with } => (BG_CAUSE_OVERLAP_TOO_DEEP, with),
        _ => (BG_CAUSE_ESCAPED, 0),
    };
    let grain = &gone.grain;
    bg_departure {
        size: size_of::<bg_departure>() as u32,
        id: grain.id,
        cause,
        partner,
        step,
        position: grain.position,
        velocity: grain.velocity,
        radius: grain.radius,
        mass: grain.mass,
    }
}

/// Sets `out` to the digests of the state: the same on every machine and in every language. After a fault of the motion
/// a world has none.
#[unsafe(no_mangle)]
pub extern "C" fn bg_get_digest(world: *mut bg_world, out: *mut bg_digest) -> i32 {
    with(world, |parts| {
        let d = digest(&parts.store.world())?;
        give(
            out,
            bg_digest {
                size: size_of::<bg_digest>() as u32,
                whole: d.whole,
                positions: d.positions,
                velocities: d.velocities,
                spins: d.spins,
                histories: d.histories,
                forces: d.forces,
                obstacles: d.obstacles,
            },
        )
    })
}
