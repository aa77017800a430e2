//! New places for the grains of the lists, when grains come or go.

use crate::math::real::Real;
use crate::math::rows::{get_or_default, prefix, set};
use crate::neighbors::outer_list::OuterList;
use crate::neighbors::pair_list::{Listed, PairList};
use crate::neighbors::prune::flatten;
use crate::world::World;

/// The new place of a grain that is none any more.
pub const GONE: u32 = u32::MAX;

/// The new place of each grain, by its old one; kept places ascend.
#[derive(Clone, Copy)]
pub(crate) struct NewPlaces<'a>(pub &'a [u32]);

impl NewPlaces<'_> {
    fn of(&self, old: u32) -> Option<u32> {
        let new = self.0.get(old as usize).copied();
        new.filter(|new| *new != GONE)
    }
}

/// Renumbers pairs and obstacle contacts by a table of new places, of what will be so many grains. Contacts of grains
/// that are gone go too; the others keep their springs and their order.
pub(crate) fn renumber_contacts<R: Real>(
    world: &mut World<'_, R>,
    places: NewPlaces<'_>,
    grains: usize,
) {
    let count = world.clock.count;
    let (stretches, pairs, spare) = (&mut world.stretches, &mut world.pairs, &mut world.spare);
    let before = world.clock.listed;
    let budget = stretches.least_budget(before.stretches);
    let old = flatten(stretches, pairs, spare, before, count);
    let kept = kept_pairs(pairs, places, old.pairs);
    world.clock.listed = Listed {
        stretches: stretches.divide(prefix(pairs.lower, kept), budget, grains),
        end: kept,
        pairs: kept,
        touching: old.touching,
        obstacle_contacts: obstacle_contacts(pairs, places, old.obstacle_contacts),
    };
    stretches.travel_alike(world.clock.next_travel);
}

/// Moves the pairs that stay together; returns how many they are.
fn kept_pairs<R: Real>(list: &mut PairList<'_, R>, places: NewPlaces<'_>, count: usize) -> usize {
    let mut to = 0;
    for p in 0..count {
        let lower = places.of(get_or_default(list.lower, p));
        let partner = places.of(get_or_default(list.partner, p));
        let (Some(i), Some(j)) = (lower, partner) else {
            continue;
        };
        set(list.lower, to, i);
        set(list.partner, to, j);
        let kept = list.kept(p);
        list.keep(to, kept);
        to += 1;
    }
    to
}

fn obstacle_contacts<R: Real>(
    list: &mut PairList<'_, R>,
    places: NewPlaces<'_>,
    contacts: usize,
) -> usize {
    let mut to = 0;
    for t in 0..contacts {
        let Some(i) = places.of(get_or_default(list.obstacle_contact_grain, t)) else {
            continue;
        };
        let word = get_or_default(list.obstacle_contact_obstacle, t);
        let kept = list.kept_on_obstacle(t);
        set(list.obstacle_contact_grain, to, i);
        set(list.obstacle_contact_obstacle, to, word);
        list.keep_on_obstacle(to, kept);
        to += 1;
    }
    to
}

/// The same for the candidates of the last search, so that it need not be done again.
pub(crate) fn renumber_candidates<R: Real>(world: &mut World<'_, R>, places: NewPlaces<'_>) {
    let count = world.clock.count;
    let OuterList { row, partner } = &mut world.candidates;
    let (mut rows, mut to) = (0, 0);
    for i in 0..count {
        // Both are read before anything is written at or behind them.
        let (from, end) = (get_or_default(row, i), get_or_default(row, i + 1));
        if places.of(i as u32).is_none() {
            continue;
        }
        set(row, rows, to as u32);
        rows += 1;
        for c in from..end {
            if let Some(j) = places.of(get_or_default(partner, c as usize)) {
                set(partner, to, j);
                to += 1;
            }
        }
    }
    set(row, rows, to as u32);
    let stretches = world.clock.listed.stretches;
    world.stretches.note_neighbors(&world.candidates, stretches);
}
