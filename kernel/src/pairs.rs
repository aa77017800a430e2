//! The list of pairs near enough to touch soon, and the tangential springs beside them.
//!
//! Grain pairs are a half list in rows by the lower grain, partners ascending. Obstacle contacts
//! are a list of their own, by grain and then obstacle. A row keeps its spring as long as its bodies
//! touch; which further pairs are listed has no effect on any result.

use crate::grains::Row;
use crate::real::Real;
use crate::rows::at;

/// Bit of a listed partner that says the pair touched in the last evaluation.
pub const TOUCHING: u32 = 1 << 31;

/// The rest of the word: the partner's place.
pub(crate) const PLACE: u32 = TOUCHING - 1;

/// Storage of one list, borrowed. Two of them make a rebuild possible.
pub struct Pairs<'a, R> {
    /// Where each grain's row begins in `partner`; one entry more than grains.
    pub row: &'a mut [u32],
    /// Place of the higher grain, with [`TOUCHING`].
    pub partner: &'a mut [u32],
    /// Tangential spring of the pair, from the lower grain's side (length); last word unused.
    pub spring: &'a mut [Row<R>],
    /// Obstacle contacts: place of the grain.
    pub touch_grain: &'a mut [u32],
    /// Number of the obstacle, with [`TOUCHING`].
    pub touch_obstacle: &'a mut [u32],
    /// Tangential spring from the grain's side.
    pub touch_spring: &'a mut [Row<R>],
}

/// One touching contact as the list holds it; places, not ids.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Bond<R> {
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
    Touch {
        /// Place of the grain.
        i: u32,
        /// Number of the obstacle.
        obstacle: u32,
        /// Tangential spring of the grain against the obstacle (length).
        spring: [R; 3],
    },
}

impl<R: Real> Pairs<'_, R> {
    pub(crate) fn is_whole(&self, grains: usize) -> bool {
        self.row.len() == grains + 1
            && self.partner.len() == self.spring.len()
            && self.touch_grain.len() == self.touch_obstacle.len()
            && self.touch_grain.len() == self.touch_spring.len()
            && self.partner.len() < TOUCHING as usize
    }

    /// Entries of the row of grain `i`.
    #[inline(always)]
    pub(crate) fn row_of(&self, i: usize) -> core::ops::Range<usize> {
        at(self.row, i) as usize..at(self.row, i + 1) as usize
    }

    /// The touching grain pairs by `(i, j)`, then the touching obstacle contacts by grain and
    /// obstacle; `touches` is the number of obstacle contacts listed.
    pub fn bonds(&self, touches: usize) -> impl Iterator<Item = Bond<R>> + '_ {
        let grains = self.row.len().saturating_sub(1);
        let pairs = (0..grains).flat_map(move |i| {
            self.row_of(i)
                .filter(|&p| at(self.partner, p) & TOUCHING != 0)
                .map(move |p| Bond::Pair {
                    i: i as u32,
                    j: at(self.partner, p) & PLACE,
                    spring: crate::vec3::head(at(self.spring, p)),
                })
        });
        let touches = (0..touches.min(self.touch_grain.len()))
            .filter(|&t| at(self.touch_obstacle, t) & TOUCHING != 0)
            .map(|t| Bond::Touch {
                i: at(self.touch_grain, t),
                obstacle: at(self.touch_obstacle, t) & PLACE,
                spring: crate::vec3::head(at(self.touch_spring, t)),
            });
        pairs.chain(touches)
    }

    /// Puts a bond back into a list that was just built; `false` where the list has no such entry.
    pub(crate) fn restore(&mut self, bond: &Bond<R>, touches: usize) -> bool {
        let (Bond::Pair { spring, .. } | Bond::Touch { spring, .. }) = bond;
        if !spring.iter().all(|s| s.is_finite()) {
            return false;
        }
        let ([x, y, z], place, word, springs) = match *bond {
            Bond::Pair { i, j, spring } => {
                let mut row = self.row_of(i as usize);
                let place = row.find(|&p| at(self.partner, p) & PLACE == j);
                (spring, place, &mut *self.partner, &mut *self.spring)
            }
            Bond::Touch {
                i,
                obstacle,
                spring,
            } => {
                let place = (0..touches).find(|&t| {
                    at(self.touch_grain, t) == i && at(self.touch_obstacle, t) & PLACE == obstacle
                });
                let (word, springs) = (&mut *self.touch_obstacle, &mut *self.touch_spring);
                (spring, place, word, springs)
            }
        };
        let entry = place.and_then(|p| Some((word.get_mut(p)?, springs.get_mut(p)?)));
        let Some((word, row)) = entry else {
            return false;
        };
        *word |= TOUCHING;
        *row = [x, y, z, R::ZERO];
        true
    }
}
