//! Grains that come in.

use super::remove::compact;
use super::renumber::{NewPlaces, renumber_contacts};
use super::settle::{open, put_back, seal_anew, settle};
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::{get_or_default, prefix, set};
use crate::state::grains::NewGrain;
use crate::world::World;

/// Puts grains into a world between two steps, by ids that ascend; each goes where its id belongs, and all others keep
/// their histories. The world's slices must end with as many free rows as grains come in, whatever these hold:
/// [`Store::insert`](crate::Store::insert) and [`LentStore::insert`](crate::LentStore::insert) see to that.
///
/// A new grain comes with no force on it: it falls through the first half of its first step by its weight alone, and
/// contacts act on it from the forces of that step on. Neighbours are searched for once in a call.
///
/// # Errors
/// All is as it was: [`Error::NotStarted`], [`Error::GrainsLeaving`], [`Error::Edited`]; [`Error::BadStorage`] if there
/// are not as many free rows; [`Error::BadOrder`] of an id that is taken or does not ascend; what
/// [`start`](crate::start) refuses; [`Error::OverlapTooDeep`], [`Error::ObstacleTooDeep`]; a full list.
pub fn insert<R: Real, I>(world: &mut World<'_, R>, grains: I) -> Result<(), Error>
where
    I: IntoIterator<Item = NewGrain<R>, IntoIter: NewGrains>,
{
    open(world)?;
    let grains = grains.into_iter();
    let count = world.clock.count;
    if world.grains.count() != count.saturating_add(grains.len()) {
        return Err(Error::BadStorage);
    }
    let mut before = None;
    for grain in grains.clone() {
        let ascends = before.is_none_or(|before| before < grain.id);
        if !ascends || world.place_of(grain.id).is_some() {
            return Err(Error::BadOrder { id: grain.id });
        }
        before = Some(grain.id);
    }
    let clock = *world.clock;
    merge(world, grains.clone());
    let settled = settle(world, grains.clone().map(|grain| grain.id));
    if settled.is_ok() {
        return seal_anew(world);
    }
    for grain in grains {
        if let Some(place) = world.place_of(grain.id) {
            world.grains.mark(place);
        }
    }
    compact(world, false);
    put_back(world, clock);
    settled
}

/// An iterator that says how long it is and can be gone through again, from either end: that of an array or a slice.
pub trait NewGrains: DoubleEndedIterator + ExactSizeIterator + Clone {}
impl<I: DoubleEndedIterator + ExactSizeIterator + Clone> NewGrains for I {}

/// Moves rows apart and renumbers the lists, so that ids ascend.
fn merge<R: Real>(
    world: &mut World<'_, R>,
    mut grains: impl NewGrains + Iterator<Item = NewGrain<R>>,
) {
    let count = world.clock.count;
    let all = count + grains.len();
    let mut ascending = grains.clone().peekable();
    let mut lower = 0;
    for i in 0..count {
        let id = get_or_default(world.grains.id, i);
        while ascending.next_if(|grain| grain.id < id).is_some() {
            lower += 1;
        }
        set(world.cells.grain, i, (i + lower) as u32);
    }
    // The table stands in the storage of the cells, which only a search uses.
    let table = core::mem::take(&mut world.cells.grain);
    renumber_contacts(world, NewPlaces(prefix(table, count)), all);
    world.cells.grain = table;
    // From the last one down, so that no row is overwritten before it has moved.
    let (mut old, mut to) = (count, all);
    while let Some(grain) = grains.next_back() {
        while let Some(last) = old.checked_sub(1)
            && get_or_default(world.grains.id, last) > grain.id
        {
            to -= 1;
            world.grains.copy_row(last, to);
            old = last;
        }
        to -= 1;
        world.grains.put(to, &grain);
    }
    world.clock.count = all;
}
