//! Which grains of a world are its own. The others are ghosts: copies of grains of other parts of a larger world.

use core::ops::Range;

/// Own grains, as runs of places.
#[derive(Clone, Copy)]
pub struct Owned<'a> {
    /// Where each run begins and ends, by turns, ascending.
    bounds: &'a [u32],
}

impl<'a> Owned<'a> {
    /// The runs that begin and end at these places; without any all grains are own.
    pub fn new(bounds: &'a [u32]) -> Self {
        let bounds = match bounds {
            [] => &[0, u32::MAX],
            some => some,
        };
        Self { bounds }
    }

    /// Whether the grain at a place is own.
    pub fn has(self, place: usize) -> bool {
        let before = self
            .bounds
            .partition_point(|bound| *bound as usize <= place);
        before % 2 == 1
    }

    /// A walk along the runs.
    #[inline(always)]
    pub(crate) fn runs(self) -> Runs<'a> {
        Runs {
            bounds: self.bounds,
            place: 0,
        }
    }
}

/// A walk along runs of own grains.
pub(crate) struct Runs<'a> {
    bounds: &'a [u32],
    /// All before it is done.
    place: usize,
}

impl Runs<'_> {
    /// The next own grains before `end`, if there are any: a run or a part of one.
    #[inline(always)]
    pub(crate) fn next_before(&mut self, end: usize) -> Option<Range<usize>> {
        while let [from, to, others @ ..] = self.bounds {
            let (from, to) = (*from as usize, *to as usize);
            if to <= self.place {
                self.bounds = others;
                continue;
            }
            let begin = if from > self.place { from } else { self.place };
            if begin >= end {
                return None;
            }
            self.place = if to < end { to } else { end };
            return Some(begin..self.place);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    proptest! {
        /// Each own grain comes once, in order, wherever the walk is cut.
        #[test]
        fn runs_hold_what_is_owned(
            own in prop::collection::vec(any::<bool>(), 1..40),
            cuts in prop::collection::btree_set(0..40usize, 0..6),
        ) {
            let mut bounds = Vec::new();
            for (place, is_own) in own.iter().enumerate() {
                let before = place > 0 && own[place - 1];
                if *is_own != before {
                    bounds.push(place as u32);
                }
            }
            if own[own.len() - 1] {
                bounds.push(own.len() as u32);
            }
            prop_assume!(!bounds.is_empty());
            let owned = Owned::new(&bounds);
            let mut runs = owned.runs();
            let mut seen = Vec::new();
            for end in cuts.into_iter().chain([own.len()]) {
                while let Some(run) = runs.next_before(end) {
                    prop_assert!(!run.is_empty() && run.end <= end);
                    seen.extend(run);
                }
            }
            let places = 0..own.len();
            prop_assert!(places.clone().all(|place| owned.has(place) == own[place]));
            prop_assert_eq!(seen, places.filter(|place| own[*place]).collect::<Vec<_>>());
        }
    }

    #[test]
    fn without_bounds_all_are_own() {
        let owned = Owned::new(&[]);
        assert!(owned.has(0) && owned.has(1 << 30));
        assert_eq!(owned.runs().next_before(7), Some(0..7));
    }
}
