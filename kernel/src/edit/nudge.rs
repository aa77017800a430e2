//! Changes of a world at rest that need no new start.

use crate::digest::seal::seal;
use crate::error::Error;
use crate::integrate::next_velocity;
use crate::math::real::{Real, larger};
use crate::math::rows::get_or_default;
use crate::math::vec3::{Vec3, length_bound};
use crate::world::{Stage, World};

/// Gives the grain at a place another velocity and spin, between two steps: a blow, a jet, a correction. All contact
/// histories stay, and so do the forces of the last step. It takes the time of one grain, whatever the size of the
/// world (of a look at all, if the grain is carried), and gives the same bits at any skin: the bound of the coming
/// travel grows with the grain's speed, and the world is sealed anew with it.
///
/// # Errors
/// Before anything is changed: [`Error::NotStarted`] if the world is not between two stretches of steps;
/// [`Error::NoGrain`]; [`Error::NotFinite`] for a number that is not finite; [`Error::TooFast`] if the grain would move
/// more than its radius in the next step; [`Error::TooSlow`] of one that is carried. A row that was written to
/// otherwise is found by the next step, as ever.
pub fn nudge<R: Real>(
    world: &mut World<'_, R>,
    place: usize,
    velocity: Vec3<R>,
    spin: Vec3<R>,
) -> Result<(), Error> {
    if world.clock.stage != Stage::Resting {
        return Err(Error::NotStarted);
    }
    world.check_storage()?;
    let Some(id) = world.grains.id.get(place).copied() else {
        return Err(Error::NoGrain {
            place: u32::try_from(place).unwrap_or(u32::MAX),
        });
    };
    if !velocity.iter().chain(&spin).all(|x| x.is_finite()) {
        return Err(Error::not_finite::<R>(id));
    }
    let group = get_or_default(world.grains.group, place);
    let group = world.grains.groups.get(usize::from(group));
    if group.is_some_and(|group| group.integrates != [true; 3]) {
        world.check_resolution_of(place, velocity, world.least_way())?;
    }
    let dt = world.dt;
    let mut motion = world.grain_motion();
    let grain = motion.stretch(place, place.saturating_add(1));
    let before = seal(&grain, place);
    let rows = grain.velocity.first().zip(grain.spin.first());
    let (Some([.., radius]), Some(([.., mass], [.., inverse]))) = (grain.position.first(), rows)
    else {
        return Err(Error::BadStorage);
    };
    let moving = [velocity[0], velocity[1], velocity[2], *mass];
    let turning = [spin[0], spin[1], spin[2], *inverse];
    // The drift to come begins with half a kick by the forces that stand in its row.
    let way = length_bound(next_velocity(&grain, &moving)) * dt;
    let slow = way < *radius;
    if !slow {
        return Err(Error::TooFast { id });
    }
    grain.velocity.fill(moving);
    grain.spin.fill(turning);
    let after = seal(&grain, place);
    let clock = &mut *world.clock;
    clock.seal = clock.seal.wrapping_add(after.less(before));
    clock.next_travel = larger(clock.next_travel, way);
    let own = world.stretches.of(place as u32, clock.listed.stretches);
    if let Some(travel) = world.stretches.travel.get_mut(own) {
        *travel = larger(*travel, way);
    }
    Ok(())
}
