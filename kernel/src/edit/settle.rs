//! What every edit begins and ends with.

use crate::digest::seal::{seal, whole};
use crate::edit::depths::check_depths;
use crate::error::Error;
use crate::integrate::{MotionPhase, per_inertia};
use crate::math::real::{Real, smaller};
use crate::math::rows::get_or_default;
use crate::math::vec3::head;
use crate::phases::{end, go_on, moved, next_travel, refresh_pair_list, seal_all};
use crate::state::domain::Domain;
use crate::world::{Clock, Stage, World};

/// Checks that a world rests, that no grain waits to be taken out, and that nothing was written to since its last step,
/// so that an edit seals no other one.
pub(crate) fn open<R: Real>(world: &mut World<'_, R>) -> Result<(), Error> {
    if world.clock.stage != Stage::Resting {
        return Err(Error::NotStarted);
    }
    if world.clock.losing {
        return Err(Error::GrainsLeaving);
    }
    world.check_storage()?;
    let count = world.clock.count;
    let sealed = seal(&world.grain_motion().stretch(0, count), 0);
    match whole(world, sealed) == world.clock.seal {
        true => Ok(()),
        false => Err(Error::Edited),
    }
}

/// Checks a world whose rows an edit has changed, and lists its pairs anew; then [`seal_anew`] leaves it at rest. All
/// that can be refused is refused before the list is changed, but for overlaps, which only a list shows.
pub(crate) fn settle<R: Real>(
    world: &mut World<'_, R>,
    changed: impl Iterator<Item = u32>,
) -> Result<(), Error> {
    weigh(world);
    world.check(true)?;
    world.clock.count = world.grains.count();
    let least = world.least_way();
    for id in changed {
        if let Some(place) = world.place_of(id) {
            let velocity = head(get_or_default(world.grains.velocity, place));
            world.check_resolution_of(place, velocity, least)?;
        }
    }
    let passed = moved(world, MotionPhase::CheckOnly);
    go_on(world, passed)?;
    let travel = next_travel(world)?;
    world.clock.far = -R::ONE;
    refresh_pair_list(world, Some(travel))?;
    check_depths(world)
}

/// Seals a world that an edit has changed.
pub(crate) fn seal_anew<R: Real>(world: &mut World<'_, R>) -> Result<(), Error> {
    let sealed = seal_all(world);
    end(world, sealed)
}

/// Puts the clock back after an edit that was refused and undone. The lists are whole, but how far they reach is not
/// known any more.
pub(crate) fn put_back<R: Real>(world: &mut World<'_, R>, before: Clock<R>) {
    let listed = world.clock.listed;
    *world.clock = before;
    world.clock.listed = listed;
    world.clock.far = -R::ONE;
    world.stretches.travel_alike(before.next_travel);
}

/// Checks ids that an edit names: they ascend, and each has a grain.
pub(crate) fn check_ids<R: Real>(world: &World<'_, R>, ids: &[u32]) -> Result<(), Error> {
    let mut before = None;
    for id in ids.iter().copied() {
        if before.is_some_and(|before| before >= id) {
            return Err(Error::BadOrder { id });
        }
        before = Some(id);
        if world.place_of(id).is_none() {
            return Err(Error::UnknownGrain { id });
        }
    }
    Ok(())
}

/// Sets the smallest radius, and what rows keep so that no step divides: one over the mass of each grain as it enters
/// contacts, and over its moment of inertia.
pub(crate) fn weigh<R: Real>(world: &mut World<'_, R>) {
    world.clock.radius_min = smallest_period(world.domain);
    let g = &mut world.grains;
    let rows = g.velocity.iter().zip(g.position.iter()).zip(g.group.iter());
    let kept = g.spin.iter_mut().zip(g.torque.iter_mut());
    for ((w, torque), ((v, x), group)) in kept.zip(rows) {
        world.clock.radius_min = smaller(world.clock.radius_min, x[3]);
        let group = g.groups.get(usize::from(*group));
        let heavy = group.is_some_and(|group| group.infinite_mass);
        w[3] = if heavy { R::ZERO } else { R::ONE / v[3] };
        torque[3] = per_inertia(v[3], x[3]);
    }
}

/// Without grains, obstacles may still cross no more than one period in a step.
fn smallest_period<R: Real>(domain: &Domain<R>) -> R {
    let mut least = R::MAX;
    let (lo, hi) = (domain.lo(), domain.hi());
    for a in (0..3).filter(|a| domain.periodic()[*a]) {
        least = smaller(least, hi[a] - lo[a]);
    }
    least
}
