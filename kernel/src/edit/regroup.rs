//! Grains that change their group.

use super::settle::{check_ids, open, put_back, seal_anew, settle, weigh};
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::{get_or_default, set};
use crate::world::World;

/// Puts grains into another group between two steps: to freeze, release or carry them. `ids` ascend. All contact
/// histories stay, but those of two grains that are now both infinitely heavy: such grains have no contact. Velocity
/// and spin are kept: a grain that is to rest needs a [`nudge`](crate::nudge) too, before or after.
///
/// # Errors
/// All is as it was: [`Error::NotStarted`], [`Error::GrainsLeaving`], [`Error::Edited`]; [`Error::UnknownGrain`],
/// [`Error::BadOrder`], [`Error::BadGrain`] for a group that there is not; what [`start`](crate::start) refuses;
/// [`Error::OverlapTooDeep`] of grains that were both infinitely heavy; a full list.
pub fn regroup<R: Real>(world: &mut World<'_, R>, ids: &[u32], group: u8) -> Result<(), Error> {
    open(world)?;
    check_ids(world, ids)?;
    if let (Some(id), None) = (ids.first(), world.grains.groups.get(usize::from(group))) {
        return Err(Error::BadGrain { id: *id });
    }
    let clock = *world.clock;
    for id in ids {
        if let Some(place) = world.place_of(*id) {
            let old = get_or_default(world.grains.group, place);
            set(world.grains.group, place, group);
            // Its old group waits in a word that no check reads, for the way back.
            set_last(world, place, R::from_count(u32::from(old)));
        }
    }
    let settled = settle(world, ids.iter().copied());
    for id in ids {
        if let Some(place) = world.place_of(*id) {
            let old = get_or_default(world.grains.force, place)[3].to_index();
            set_last(world, place, R::ZERO);
            if settled.is_err() {
                set(world.grains.group, place, old as u8);
            }
        }
    }
    if settled.is_ok() {
        return seal_anew(world);
    }
    put_back(world, clock);
    weigh(world);
    settled
}

fn set_last<R: Real>(world: &mut World<'_, R>, place: usize, word: R) {
    if let Some(row) = world.grains.force.get_mut(place) {
        row[3] = word;
    }
}
