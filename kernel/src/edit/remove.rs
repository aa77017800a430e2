//! Grains that are taken away.

use super::renumber::{GONE, NewPlaces, renumber_candidates, renumber_contacts};
use super::settle::{check_ids, open, weigh};
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::{get_or_default, prefix, set};
use crate::phases::come_to_rest;
use crate::world::World;

/// Takes grains out of a world between two steps, by ids that ascend. The rows of the others move up and keep all their
/// histories; the world's slices become shorter by as many, and what they no longer cover is free. The forces of the
/// last step stay in the rows, with what the removed grains gave to them, as they would in a saved state.
///
/// An owner takes the number of its grains from [`Clock::count`](crate::Clock::count) afterwards.
///
/// # Errors
/// Before anything is changed: [`Error::NotStarted`], [`Error::GrainsLeaving`], [`Error::Edited`];
/// [`Error::UnknownGrain`]; [`Error::BadOrder`] of ids that do not ascend. [`Error::Arithmetic`] stops the world.
pub fn remove<R: Real>(world: &mut World<'_, R>, ids: &[u32]) -> Result<(), Error> {
    open(world)?;
    check_ids(world, ids)?;
    for id in ids {
        if let Some(place) = world.place_of(*id) {
            world.grains.mark(place);
        }
    }
    drop_marked(world)
}

/// Takes out the marked grains, and leaves the world at rest.
pub(crate) fn drop_marked<R: Real>(world: &mut World<'_, R>) -> Result<(), Error> {
    let left = compact(world, true);
    world.shrink(left);
    weigh(world);
    come_to_rest(world)
}

/// Moves the rows and contacts of the grains that are not marked together, and returns how many they are. Candidates
/// that are not kept must be searched for again.
pub(crate) fn compact<R: Real>(world: &mut World<'_, R>, keeps_candidates: bool) -> usize {
    let mut left = 0;
    for i in 0..world.clock.count {
        let goes = world.grains.is_marked(i);
        set(world.cells.grain, i, if goes { GONE } else { left as u32 });
        left += usize::from(!goes);
    }
    // The table stands in the storage of the cells, which only a search uses.
    let table = core::mem::take(&mut world.cells.grain);
    let places = NewPlaces(prefix(table, world.clock.count));
    renumber_contacts(world, places, left);
    if keeps_candidates {
        renumber_candidates(world, places);
    }
    world.cells.grain = table;
    for i in 0..world.clock.count {
        let to = get_or_default(world.cells.grain, i);
        if to != GONE {
            world.grains.copy_row(i, to as usize);
        }
    }
    left
}
