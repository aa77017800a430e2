//! Stretches: grains beside each other in the numbering, whose pairs are renewed together.
//!
//! Two grains approach by what both of them travel. Most grains of a bed are slower than the fastest by far, so the
//! pairs of most stretches hold much longer than those of the fastest one: each stretch foresees how far a pair of it
//! can approach in a step, from its own speed and the speeds of the stretches that hold its partners, and its pairs are
//! picked again when that is used up. Which stretch renews its pairs when has no effect on any result.

use crate::math::real::{Real, larger, smaller};
use crate::math::rows::{front_mut, get_or_default, halves_mut, min, part, part_mut, prefix, set};
use crate::neighbors::outer_list::OuterList;

/// Grains of a stretch at which a bed is fastest.
pub const STRETCH: usize = 64;

/// Fewest grains of a stretch, if there are more stretches than that takes.
const LEAST: usize = 8;

/// Words for the neighbours of each stretch: more than a dense bed numbered by columns has.
pub const NEIGHBORS: usize = 28;

/// In the place of a neighbour: all stretches are.
const ALL: u32 = u32::MAX;

/// Storage of the stretches, borrowed: `budget` says how many there are, at least one.
pub struct StretchList<'a, R> {
    /// Place of the first grain of each, and where the last one ends.
    pub place: &'a mut [u32],
    /// Where its pairs begin in the list, with room up to where those of the next one begin; one entry more than
    /// stretches.
    pub begin: &'a mut [u32],
    /// How many pairs it has.
    pub pairs: &'a mut [u32],
    /// How many of them touched when they were picked; for timings only.
    pub touching: &'a mut [u32],
    /// Stretches that hold partners of its grains; as many words for each. With none, all stretches do.
    pub neighbor: &'a mut [u32],
    /// How far any of its pairs may yet approach before pairs are picked again (length).
    pub budget: &'a mut [R],
    /// What its fastest grain travels in the next step (length).
    pub travel: &'a mut [R],
    /// How far any of its pairs can approach in the next step (length).
    pub approach: &'a mut [R],
}

impl<'a, R: Real> StretchList<'a, R> {
    /// As many stretches as there are three numbers for, and `4 + NEIGHBORS` words and two more.
    pub fn new(words: &'a mut [u32], numbers: &'a mut [R]) -> Self {
        let count = min(
            numbers.len() / 3,
            words.len().saturating_sub(2) / (4 + NEIGHBORS),
        );
        let (place, words) = halves_mut(words, count + 1);
        let (begin, words) = halves_mut(words, count + 1);
        let (pairs, words) = halves_mut(words, count);
        let (touching, words) = halves_mut(words, count);
        let (budget, numbers) = halves_mut(numbers, count);
        let (travel, numbers) = halves_mut(numbers, count);
        Self {
            place,
            begin,
            pairs,
            touching,
            neighbor: front_mut(words, NEIGHBORS * count),
            budget,
            travel,
            approach: front_mut(numbers, count),
        }
    }

    /// Whether the slices fit together.
    pub(crate) fn is_whole(&self) -> bool {
        let n = self.budget.len();
        n > 0
            && self.place.len() == n + 1
            && self.begin.len() == n + 1
            && self.pairs.len() == n
            && self.touching.len() == n
            && self.travel.len() == n
            && self.approach.len() == n
    }

    /// Whether there is room for so many.
    pub(crate) fn holds(&self, count: usize) -> bool {
        self.budget.len() >= count
    }

    /// Whether so many stretches are of so many grains and entries of the list at most, in order.
    pub(crate) fn is_within(&self, count: usize, grains: usize, entries: usize) -> bool {
        (0..count).all(|s| {
            let own = self.grains(s);
            let begin = get_or_default(self.begin, s) as usize;
            let room = entries.saturating_sub(begin);
            let pairs = get_or_default(self.pairs, s) as usize;
            own.start <= own.end && own.end <= grains && pairs <= room
        })
    }

    /// Cuts so many grains into stretches alike, but for the last; returns how many they are.
    pub(crate) fn lay_out(&mut self, grains: usize) -> usize {
        let most = self.budget.len();
        let alike = grains.saturating_add(most.saturating_sub(1));
        let alike = alike.checked_div(most).unwrap_or(grains);
        let size = if alike > LEAST { alike } else { LEAST };
        // Without grains there is one, which is empty.
        let count = grains.div_ceil(size);
        let count = if count > 0 { count } else { 1 };
        for s in 0..count {
            set(self.place, s, (s * size) as u32);
        }
        set(self.place, count, grains as u32);
        count
    }

    /// The stretch that a grain is in, of so many.
    pub(crate) fn of(&self, grain: u32, count: usize) -> usize {
        let ends = part(self.place, 1, count);
        ends.partition_point(|end| *end <= grain)
    }

    /// The grains of a stretch.
    pub(crate) fn grains(&self, s: usize) -> core::ops::Range<usize> {
        get_or_default(self.place, s) as usize..get_or_default(self.place, s + 1) as usize
    }

    /// Where its pairs are in the list.
    pub(crate) fn entries(&self, s: usize) -> core::ops::Range<usize> {
        let begin = get_or_default(self.begin, s) as usize;
        begin..begin + get_or_default(self.pairs, s) as usize
    }

    /// How many pairs there is room for.
    pub(crate) fn room(&self, s: usize) -> usize {
        let begin = get_or_default(self.begin, s);
        get_or_default(self.begin, s + 1).saturating_sub(begin) as usize
    }

    /// What the pair that is to be picked again first may yet approach.
    pub(crate) fn least_budget(&self, count: usize) -> R {
        let budgets = prefix(self.budget, count).iter();
        budgets.fold(R::MAX, |least, budget| smaller(least, *budget))
    }

    /// Finds the pairs of each in a list that ascends without gaps, any of which may yet approach by this budget;
    /// returns how many stretches there are.
    pub(crate) fn divide(&mut self, lower: &[u32], budget: R, grains: usize) -> usize {
        let count = self.lay_out(grains);
        for s in 0..count {
            let range = self.grains(s);
            let place = |grain: usize| lower.partition_point(|i| (*i as usize) < grain);
            let (begin, end) = (place(range.start), place(range.end));
            set(self.begin, s, begin as u32);
            set(self.pairs, s, (end - begin) as u32);
        }
        set(self.begin, count, lower.len() as u32);
        self.touching.fill(0);
        self.neighbor.fill(ALL);
        self.budget.fill(budget);
        count
    }

    /// Takes one travel for all, when that of each is not known; below zero if none is.
    pub(crate) fn travel_alike(&mut self, travel: R) {
        self.travel.fill(travel);
    }

    /// Takes a bound of all travels for those that are not known.
    pub(crate) fn travel_at_most(&mut self, bound: R) {
        for travel in self.travel.iter_mut() {
            let known = *travel >= R::ZERO;
            *travel = if known { *travel } else { bound };
        }
    }

    /// Words for the neighbours of each.
    fn words_each(&self) -> usize {
        let words = self.neighbor.len().checked_div(self.budget.len());
        words.unwrap_or_default()
    }

    /// Notes which stretches hold candidates of the grains of each.
    pub(crate) fn note_neighbors(&mut self, candidates: &OuterList<'_>, count: usize) {
        let words = self.words_each();
        for s in 0..count {
            let grains = self.grains(s);
            let from = get_or_default(candidates.row, grains.start) as usize;
            let to = get_or_default(candidates.row, grains.end) as usize;
            let (mut used, mut last) = (0, s);
            part_mut(self.neighbor, s * words, (s + 1) * words).fill(s as u32);
            for j in part(candidates.partner, from, to) {
                if self.grains(last).contains(&(*j as usize)) {
                    continue;
                }
                last = self.of(*j, count);
                let own = part_mut(self.neighbor, s * words, (s + 1) * words);
                if last == s || prefix(own, used).contains(&(last as u32)) {
                    continue;
                }
                if used == words {
                    own.fill(ALL);
                    break;
                }
                set(own, used, last as u32);
                used += 1;
            }
        }
    }

    /// Foresees how far the pairs of each can approach in the next step; `rounding` is what that may add to a travel.
    pub(crate) fn foresee(&mut self, count: usize, rounding: R) {
        let travel = prefix(self.travel, count);
        let fastest = travel.iter().fold(R::ZERO, |most, t| larger(most, *t));
        let words = self.words_each();
        for (s, approach) in front_mut(self.approach, count).iter_mut().enumerate() {
            let own = get_or_default(travel, s);
            let near = part(self.neighbor, s * words, (s + 1) * words);
            let mut other = own;
            if near.first().is_none_or(|first| *first == ALL) {
                other = fastest;
            }
            for neighbor in near {
                other = larger(other, get_or_default(travel, *neighbor as usize));
            }
            // Speeds were rounded; a thousandth covers that and is negligible against the skin.
            *approach = (own + other) * R::from_f64(1.001) + (rounding + rounding);
        }
    }

    /// After a drift: what was foreseen is used up.
    pub(crate) fn spend(&mut self, count: usize) {
        let approaches = prefix(self.approach, count);
        for (budget, approach) in front_mut(self.budget, count).iter_mut().zip(approaches) {
            *budget = *budget - *approach;
        }
    }

    /// How far pairs of a stretch can approach before they could be picked again.
    pub(crate) fn need(&self, s: usize, ahead: bool) -> R {
        match ahead {
            true => get_or_default(self.approach, s),
            false => R::ZERO,
        }
    }

    /// Whether its pairs are to be picked again: before the next drift, or after the last one.
    pub(crate) fn is_old(&self, s: usize, ahead: bool) -> bool {
        self.need(s, ahead) > get_or_default(self.budget, s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// How far pairs of the first of 60 stretches can approach, if its first grain has candidates in so many others,
    /// of which the last one is fast.
    fn approach_among(others: u32) -> f64 {
        let grains = 60 * LEAST;
        let (mut words, mut numbers) = (vec![0; 60 * (4 + NEIGHBORS) + 2], vec![0.0; 180]);
        let mut list = StretchList::<f64>::new(&mut words, &mut numbers);
        let count = list.lay_out(grains);
        assert_eq!(count, 60);
        let mut partner: Vec<u32> = (1..=others).map(|s| s * LEAST as u32).collect();
        let mut row = vec![others; grains + 1];
        row[0] = 0;
        let candidates = OuterList {
            row: &mut row,
            partner: &mut partner,
        };
        list.note_neighbors(&candidates, count);
        list.travel_alike(1.0);
        list.travel[others as usize] = 100.0;
        list.foresee(count, 0.0);
        let alone = list.approach[59] < 3.0;
        assert_eq!(alone, others < 59, "the last one has no partners");
        list.approach[0]
    }

    #[test]
    fn a_stretch_hears_of_each_of_its_partners() {
        for others in [
            1,
            2,
            NEIGHBORS as u32 - 1,
            NEIGHBORS as u32,
            NEIGHBORS as u32 + 1,
            59,
        ] {
            assert!(approach_among(others) > 101.0, "{others}");
        }
    }

    #[test]
    fn stretches_hold_each_grain_once() {
        let (mut words, mut numbers) = (vec![0; 12 * (4 + NEIGHBORS) + 2], vec![0.0; 36]);
        let mut list = StretchList::<f64>::new(&mut words, &mut numbers);
        for grains in [0, 1, 7, 8, 9, 95, 96, 97, 1000] {
            let count = list.lay_out(grains);
            assert!(list.place[..=count].is_sorted() && count <= 12 && count > 0);
            assert_eq!(list.place[count] as usize, grains);
            for grain in 0..grains {
                let own = list.of(grain as u32, count);
                assert!(list.grains(own).contains(&grain));
            }
        }
    }
}
