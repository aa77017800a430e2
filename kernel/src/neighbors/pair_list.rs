//! The list of pairs near enough to touch soon, and what the law has kept of them beside it: tangential springs, and
//! words of its own if it has any.
//!
//! Grain pairs are listed once, by lower grain and then partner, both ascending: those of each stretch of grains
//! together, with room between stretches. Obstacle contacts are a separate list, by grain and then obstacle. A pair
//! keeps its history as long as it acts; which further pairs are listed has no effect on any result.

use crate::contact::kept::{ContactMemory, Kept};
use crate::math::real::Real;
use crate::math::rows::{Row, row};
use crate::math::rows::{front_mut, get_or_default, min, part, prefix, set};
use crate::math::vec3::{dot, head};
use crate::neighbors::memory::{MemoryColumns, is_whole, put, taken, words};
use crate::neighbors::stretch::StretchList;
use crate::state::domain::Domain;

/// Bit of a listed obstacle that says the contact touched in the last evaluation.
pub const TOUCHING: u32 = 1 << 31;

/// The rest of the word: the obstacle's number, and above it which of its surfaces.
pub(crate) const PLACE: u32 = TOUCHING - 1;

/// Where in the word the number of the surface begins.
const SURFACE: u32 = 12;

/// So many obstacles a world can have.
pub const OBSTACLES_MAX: usize = 1 << SURFACE;

/// The number of the obstacle in a word of the list or of a history.
#[inline(always)]
#[must_use]
pub fn obstacle_of(word: u32) -> u32 {
    word & (OBSTACLES_MAX as u32 - 1)
}

/// Which of its surfaces the grain may touch: a drum has its side, its end against its axis and its end along its axis;
/// other bodies have one.
#[inline(always)]
#[must_use]
pub fn surface_of(word: u32) -> u32 {
    (word & PLACE) >> SURFACE
}

/// The word of a surface of an obstacle.
#[inline(always)]
pub(crate) fn surface_word(obstacle: u32, surface: u32) -> u32 {
    obstacle | surface << SURFACE
}

/// Storage of one list, borrowed. Two of them make a renewal possible.
pub struct PairList<'a, R> {
    /// Place of the lower grain of each pair, by stretches.
    pub lower: &'a mut [u32],
    /// Place of the higher grain.
    pub partner: &'a mut [u32],
    /// Tangential spring of the pair, from the lower grain's side (length), component by component;
    /// zero if the grains do not touch.
    pub spring: [&'a mut [R]; 3],
    /// Words of the law of each pair.
    pub memory: MemoryColumns<'a, R>,
    /// Obstacle contacts: place of the grain.
    pub obstacle_contact_grain: &'a mut [u32],
    /// Number of the obstacle ([`obstacle_of`]) and of its surface ([`surface_of`]), with [`TOUCHING`].
    pub obstacle_contact_obstacle: &'a mut [u32],
    /// Tangential spring from the grain's side; last word unused.
    pub obstacle_contact_spring: &'a mut [Row<R>],
    /// Words of the law of each obstacle contact.
    pub obstacle_contact_memory: MemoryColumns<'a, R>,
}

/// How many entries of a list are in use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Listed {
    /// Stretches of grains; none before anything is listed.
    pub stretches: usize,
    /// Where the storage of their pairs ends.
    pub end: usize,
    /// All pairs.
    pub pairs: usize,
    /// Pairs that touched when they were listed; for timings only.
    pub touching: usize,
    /// Obstacle contacts.
    pub obstacle_contacts: usize,
}

impl Listed {
    /// Before anything is listed.
    pub const NONE: Self = Self {
        stretches: 0,
        end: 0,
        pairs: 0,
        touching: 0,
        obstacle_contacts: 0,
    };
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
        /// Number of the obstacle, and of its surface: [`obstacle_of`], [`surface_of`].
        obstacle: u32,
        /// Tangential spring of the grain against the obstacle (length).
        spring: [R; 3],
    },
}

/// A contact with the words that the law keeps of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptContact<R> {
    /// The contact and its spring.
    pub history: ContactHistory<R>,
    /// The law's words; zeros if it keeps none.
    pub memory: ContactMemory<R>,
}

impl<R: Real> From<ContactHistory<R>> for KeptContact<R> {
    fn from(history: ContactHistory<R>) -> Self {
        let Kept { memory, .. } = Kept::NOTHING;
        Self { history, memory }
    }
}

impl<R: Real> KeptContact<R> {
    /// The tangential spring and the law's words.
    #[must_use]
    pub fn kept(&self) -> Kept<R> {
        let (ContactHistory::Pair { spring, .. } | ContactHistory::Obstacle { spring, .. }) =
            self.history;
        Kept {
            spring,
            memory: self.memory,
        }
    }

    /// Whether all its numbers are.
    pub(crate) fn is_finite(&self) -> bool {
        let Kept { spring, memory } = self.kept();
        spring.iter().chain(&memory).all(|s| s.is_finite())
    }
}

/// The listed pairs by lower grain and partner.
pub(crate) struct InOrder<'a, R> {
    lower: &'a [u32],
    partner: &'a [u32],
    stretches: &'a StretchList<'a, R>,
    /// Stretches whose pairs have not begun.
    others: core::ops::Range<usize>,
    /// What is left of the pairs of a stretch.
    inner: core::ops::Range<usize>,
}

impl<R: Real> Iterator for InOrder<'_, R> {
    /// Lower grain, partner and entry.
    type Item = (u32, u32, usize);

    fn next(&mut self) -> Option<Self::Item> {
        while self.inner.is_empty()
            && let Some(next) = self.others.next()
        {
            self.inner = self.stretches.entries(next);
        }
        let p = self.inner.next()?;
        let (i, j) = (
            get_or_default(self.lower, p),
            get_or_default(self.partner, p),
        );
        Some((i, j, p))
    }
}

impl<R: Real> PairList<'_, R> {
    pub(crate) fn is_whole(&self) -> bool {
        self.partner.len() == self.lower.len()
            && self.spring.iter().all(|s| s.len() == self.lower.len())
            && self.obstacle_contact_grain.len() == self.obstacle_contact_obstacle.len()
            && self.obstacle_contact_grain.len() == self.obstacle_contact_spring.len()
            && is_whole(&self.memory, self.lower.len())
            && is_whole(
                &self.obstacle_contact_memory,
                self.obstacle_contact_grain.len(),
            )
            && self.partner.len() < TOUCHING as usize
    }

    /// How many words of each contact there is storage for.
    pub fn words(&self) -> usize {
        let of_pairs = words(&self.memory);
        // Without room for contacts with obstacles their columns are empty.
        match self.obstacle_contact_grain.is_empty() {
            true => of_pairs,
            false => min(of_pairs, words(&self.obstacle_contact_memory)),
        }
    }

    /// Whether the list has room for what is said to be in it.
    pub(crate) fn holds(&self, listed: Listed) -> bool {
        self.partner.len() >= listed.end
            && self.obstacle_contact_grain.len() >= listed.obstacle_contacts
    }

    /// Empties all histories.
    pub(crate) fn forget(&mut self, listed: Listed) {
        for column in self.spring.iter_mut().chain(&mut self.memory) {
            front_mut(column, listed.end).fill(R::ZERO);
        }
        let contacts = listed.obstacle_contacts;
        for word in front_mut(self.obstacle_contact_obstacle, contacts) {
            *word &= PLACE;
        }
        front_mut(self.obstacle_contact_spring, contacts).fill([R::ZERO; 4]);
        for column in &mut self.obstacle_contact_memory {
            front_mut(column, contacts).fill(R::ZERO);
        }
    }

    /// The listed pairs by lower grain and partner.
    pub(crate) fn in_order<'b>(
        &'b self,
        stretches: &'b StretchList<'b, R>,
        listed: Listed,
    ) -> InOrder<'b, R> {
        InOrder {
            lower: self.lower,
            partner: self.partner,
            stretches,
            others: 0..listed.stretches,
            inner: 0..0,
        }
    }

    /// What the law has kept of a pair.
    pub(crate) fn kept(&self, p: usize) -> Kept<R> {
        Kept {
            spring: self.spring.each_ref().map(|s| get_or_default(s, p)),
            memory: taken(&self.memory, p),
        }
    }

    pub(crate) fn keep(&mut self, p: usize, kept: Kept<R>) {
        for (column, number) in self.spring.iter_mut().zip(kept.spring) {
            set(column, p, number);
        }
        put(&mut self.memory, p, kept.memory);
    }

    /// What the law has kept of a contact with an obstacle.
    pub(crate) fn kept_on_obstacle(&self, t: usize) -> Kept<R> {
        Kept {
            spring: head(get_or_default(self.obstacle_contact_spring, t)),
            memory: taken(&self.obstacle_contact_memory, t),
        }
    }

    pub(crate) fn keep_on_obstacle(&mut self, t: usize, kept: Kept<R>) {
        set(self.obstacle_contact_spring, t, row(kept.spring));
        put(&mut self.obstacle_contact_memory, t, kept.memory);
    }

    /// The grain pairs that have a history by `(i, j)`, then the obstacle contacts that act by grain and
    /// obstacle. Grains are where the forces were evaluated, so the law's own overlap says who touches; a pair that
    /// acts without that has a spring or a word that is not zero.
    pub(crate) fn kept_contacts<'b>(
        &'b self,
        stretches: &'b StretchList<'b, R>,
        listed: Listed,
        domain: &'b Domain<R>,
        position: &'b [Row<R>],
    ) -> impl Iterator<Item = KeptContact<R>> + 'b {
        let touching = |i: u32, j: u32| {
            let (x, y) = (
                get_or_default(position, i as usize),
                get_or_default(position, j as usize),
            );
            let d = domain.separation(head(x), head(y));
            (x[3] + y[3]) - dot(d, d).sqrt() > R::ZERO
        };
        let pairs = self.in_order(stretches, listed);
        let pairs = pairs.filter(move |(i, j, p)| touching(*i, *j) || self.kept(*p).is_any());
        let pairs = pairs.map(|(i, j, p)| {
            let Kept { spring, memory } = self.kept(p);
            KeptContact {
                history: ContactHistory::Pair { i, j, spring },
                memory,
            }
        });
        let touches = (0..listed
            .obstacle_contacts
            .min(self.obstacle_contact_grain.len()))
            .filter(|&t| get_or_default(self.obstacle_contact_obstacle, t) & TOUCHING != 0)
            .map(|t| {
                let Kept { spring, memory } = self.kept_on_obstacle(t);
                KeptContact {
                    history: ContactHistory::Obstacle {
                        i: get_or_default(self.obstacle_contact_grain, t),
                        obstacle: get_or_default(self.obstacle_contact_obstacle, t) & PLACE,
                        spring,
                    },
                    memory,
                }
            });
        pairs.chain(touches)
    }

    /// Puts a history back into a list that was just built; `false` if the list has no such entry.
    pub(crate) fn restore(
        &mut self,
        stretches: &StretchList<'_, R>,
        contact: &KeptContact<R>,
        listed: Listed,
    ) -> bool {
        match contact.history {
            ContactHistory::Pair { i, j, .. } => {
                let Some(p) = self.find(stretches, listed, (i, j)) else {
                    return false;
                };
                self.keep(p, contact.kept());
            }
            ContactHistory::Obstacle { i, obstacle, .. } => {
                let grains = prefix(self.obstacle_contact_grain, listed.obstacle_contacts);
                let first = grains.partition_point(|grain| *grain < i);
                let end = grains.partition_point(|grain| *grain <= i);
                let words = part(self.obstacle_contact_obstacle, first, end);
                let Some(k) = words.iter().position(|word| word & PLACE == obstacle) else {
                    return false;
                };
                let t = first + k;
                set(self.obstacle_contact_obstacle, t, obstacle | TOUCHING);
                self.keep_on_obstacle(t, contact.kept());
            }
        }
        true
    }

    /// The entry of a pair.
    pub(crate) fn find(
        &self,
        stretches: &StretchList<'_, R>,
        listed: Listed,
        pair: (u32, u32),
    ) -> Option<usize> {
        if listed.stretches == 0 {
            return None;
        }
        // By halving.
        let entries = stretches.entries(stretches.of(pair.0, listed.stretches));
        let (mut from, mut to) = (entries.start, entries.end);
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
