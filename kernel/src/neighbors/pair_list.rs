//! The list of pairs near enough to touch soon, and the tangential springs beside them.
//!
//! Grain pairs are listed once, by lower grain and then partner, both ascending. Obstacle contacts
//! are a separate list, by grain and then obstacle. A pair keeps its spring as long as its bodies
//! touch; which further pairs are listed has no effect on any result.

use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::rows::{get_or_default, prefix, set};
use crate::math::vec3::{dot, head};
use crate::state::domain::Domain;

/// Bit of a listed obstacle that says the contact touched in the last evaluation.
pub const TOUCHING: u32 = 1 << 31;

/// The rest of the word: the obstacle's number.
pub(crate) const PLACE: u32 = TOUCHING - 1;

/// Storage of one list, borrowed. Two of them make a renewal possible.
pub struct PairList<'a, R> {
    /// Place of the lower grain of each pair. First the pairs within one range of grains, then, as
    /// ordered, those of two ranges; see [`crate::World::range_bounds`].
    pub lower: &'a mut [u32],
    /// Place of the higher grain.
    pub partner: &'a mut [u32],
    /// Tangential spring of the pair, from the lower grain's side (length), component by component;
    /// zero if the grains do not touch.
    pub spring: [&'a mut [R]; 3],
    /// Obstacle contacts: place of the grain.
    pub obstacle_contact_grain: &'a mut [u32],
    /// Number of the obstacle, with [`TOUCHING`].
    pub obstacle_contact_obstacle: &'a mut [u32],
    /// Tangential spring from the grain's side; last word unused.
    pub obstacle_contact_spring: &'a mut [Row<R>],
}

/// How many entries of a list are in use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Listed {
    /// Pairs within one range of grains: the first ones.
    pub inner: usize,
    /// All pairs.
    pub pairs: usize,
    /// Pairs that touched when they were listed; for timings only.
    pub touching: usize,
    /// Obstacle contacts.
    pub obstacle_contacts: usize,
}

/// One touching contact as the list holds it; places, not ids.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ContactHistory<R> {
    /// Two grains, `i` below `j`.
    Pair {
        /// Place of the lower grain.
        i: u32,
        /// Place of the higher grain.
        j: u32,
        /// Tangential spring of `i` against `j` (length).
        spring: [R; 3],
    },
    /// A grain and an obstacle.
    Obstacle {
        /// Place of the grain.
        i: u32,
        /// Number of the obstacle.
        obstacle: u32,
        /// Tangential spring of the grain against the obstacle (length).
        spring: [R; 3],
    },
}

/// The listed pairs by lower grain and partner: the two ascending parts of a list as one.
pub(crate) struct InOrder<'a> {
    lower: &'a [u32],
    partner: &'a [u32],
    /// What is left of the pairs within ranges, and of those of two ranges.
    inner: core::ops::Range<usize>,
    across: core::ops::Range<usize>,
}

impl Iterator for InOrder<'_> {
    /// Lower grain, partner and entry.
    type Item = (u32, u32, usize);

    fn next(&mut self) -> Option<Self::Item> {
        let entry = |p: usize| {
            (
                get_or_default(self.lower, p),
                get_or_default(self.partner, p),
                p,
            )
        };
        let (a, b) = (self.inner.start, self.across.start);
        let from_across = if self.inner.is_empty() {
            !self.across.is_empty()
        } else {
            !self.across.is_empty() && entry(b) < entry(a)
        };
        let stretch = if from_across {
            &mut self.across
        } else {
            &mut self.inner
        };
        stretch.next().map(entry)
    }
}

impl<R: Real> PairList<'_, R> {
    pub(crate) fn is_whole(&self) -> bool {
        self.partner.len() == self.lower.len()
            && self.spring.iter().all(|s| s.len() == self.lower.len())
            && self.obstacle_contact_grain.len() == self.obstacle_contact_obstacle.len()
            && self.obstacle_contact_grain.len() == self.obstacle_contact_spring.len()
            && self.partner.len() < TOUCHING as usize
    }

    /// Whether the list has room for what is said to be in it.
    pub(crate) fn holds(&self, listed: Listed) -> bool {
        self.partner.len() >= listed.pairs
            && self.obstacle_contact_grain.len() >= listed.obstacle_contacts
    }

    /// The listed pairs by lower grain and partner.
    pub(crate) fn in_order(&self, listed: Listed) -> InOrder<'_> {
        InOrder {
            lower: self.lower,
            partner: self.partner,
            inner: 0..listed.inner,
            across: listed.inner..listed.pairs,
        }
    }

    pub(crate) fn spring_of(&self, p: usize) -> [R; 3] {
        let [x, y, z] = &self.spring;
        [
            get_or_default(x, p),
            get_or_default(y, p),
            get_or_default(z, p),
        ]
    }

    pub(crate) fn set_spring(&mut self, p: usize, spring: [R; 3]) {
        let [x, y, z] = &mut self.spring;
        set(x, p, spring[0]);
        set(y, p, spring[1]);
        set(z, p, spring[2]);
    }

    /// The touching grain pairs by `(i, j)`, then the touching obstacle contacts by grain and
    /// obstacle. Grains are where the forces were evaluated, so the law's own overlap says who
    /// touches.
    pub(crate) fn contact_histories<'b>(
        &'b self,
        listed: Listed,
        domain: &'b Domain<R>,
        position: &'b [Row<R>],
    ) -> impl Iterator<Item = ContactHistory<R>> + 'b {
        let touching = |i: u32, j: u32| {
            let (x, y) = (
                get_or_default(position, i as usize),
                get_or_default(position, j as usize),
            );
            let d = domain.separation(head(x), head(y));
            (x[3] + y[3]) - dot(d, d).sqrt() > R::ZERO
        };
        let pairs = self.in_order(listed);
        let pairs = pairs.filter(move |(i, j, _)| touching(*i, *j));
        let pairs = pairs.map(|(i, j, p)| ContactHistory::Pair {
            i,
            j,
            spring: self.spring_of(p),
        });
        let touches = (0..listed
            .obstacle_contacts
            .min(self.obstacle_contact_grain.len()))
            .filter(|&t| get_or_default(self.obstacle_contact_obstacle, t) & TOUCHING != 0)
            .map(|t| ContactHistory::Obstacle {
                i: get_or_default(self.obstacle_contact_grain, t),
                obstacle: get_or_default(self.obstacle_contact_obstacle, t) & PLACE,
                spring: head(get_or_default(self.obstacle_contact_spring, t)),
            });
        pairs.chain(touches)
    }

    /// Puts a history back into a list that was just built; `false` if the list has no such entry.
    pub(crate) fn restore(&mut self, history: &ContactHistory<R>, listed: Listed) -> bool {
        let (ContactHistory::Pair { spring, .. } | ContactHistory::Obstacle { spring, .. }) =
            history;
        if !spring.iter().all(|s| s.is_finite()) {
            return false;
        }
        match *history {
            ContactHistory::Pair { i, j, spring } => {
                let found = self.find(0..listed.inner, (i, j));
                let found = found.or_else(|| self.find(listed.inner..listed.pairs, (i, j)));
                let Some(p) = found else {
                    return false;
                };
                self.set_spring(p, spring);
            }
            ContactHistory::Obstacle {
                i,
                obstacle,
                spring: [x, y, z],
            } => {
                let grains = prefix(self.obstacle_contact_grain, listed.obstacle_contacts).iter();
                let mut entries = grains
                    .zip(&mut *self.obstacle_contact_obstacle)
                    .zip(&mut *self.obstacle_contact_spring);
                let found =
                    entries.find(|((grain, word), _)| (**grain, **word & PLACE) == (i, obstacle));
                let Some(((_, word), row)) = found else {
                    return false;
                };
                *word |= TOUCHING;
                *row = [x, y, z, R::ZERO];
            }
        }
        true
    }

    /// The entry of a pair in a stretch that ascends, by halving.
    fn find(&self, stretch: core::ops::Range<usize>, pair: (u32, u32)) -> Option<usize> {
        let (mut from, mut to) = (stretch.start, stretch.end);
        while from < to {
            let middle = from + (to - from) / 2;
            let here = (
                get_or_default(self.lower, middle),
                get_or_default(self.partner, middle),
            );
            if here == pair {
                return Some(middle);
            }
            if here < pair {
                from = middle + 1;
            } else {
                to = middle;
            }
        }
        None
    }
}
