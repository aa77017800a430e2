//! How far bodies reach: what decides over the margins of a search.

use crate::math::real::{Real, larger, magnitude, smaller};
use crate::math::rows::part;
use crate::state::grains::Grains;
use crate::state::obstacle::Obstacle;
use crate::state::owned::Owned;

/// Where own grains are, and how large numbers and bodies are. The parts of one world search with one extent, that of
/// all of them, so that they agree on which pairs are near.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extent<R> {
    /// The lower corner of a box round the centres of the own grains (length); above `hi` without grains.
    pub lo: [R; 3],
    /// The upper corner.
    pub hi: [R; 3],
    /// The largest coordinate of a body, without its sign (length).
    pub largest: R,
    /// The largest radius of a grain (length).
    pub radius: R,
    /// The smallest radius, and no more than 1 (length).
    pub least: R,
    /// The longest distance between a grain and the centre or axis of a body that it touches (length).
    pub reach: R,
}

impl<R: Real> Extent<R> {
    /// Of own grains and all obstacles.
    pub(crate) fn of(grains: &Grains<'_, R>, owned: Owned<'_>, obstacles: &[Obstacle<R>]) -> Self {
        let mut all = Self {
            lo: [R::MAX; 3],
            hi: [-R::MAX; 3],
            largest: R::ONE * R::EPSILON,
            radius: R::ZERO,
            least: R::ONE,
            reach: R::ZERO,
        };
        let mut runs = owned.runs();
        while let Some(run) = runs.next_before(grains.count()) {
            for x in part(grains.position, run.start, run.end) {
                all.radius = larger(all.radius, x[3]);
                all.least = smaller(all.least, x[3]);
                for a in 0..3 {
                    all.largest = larger(all.largest, magnitude(x[a]));
                    all.lo[a] = smaller(all.lo[a], x[a]);
                    all.hi[a] = larger(all.hi[a], x[a]);
                }
            }
        }
        all.reach = all.radius + all.radius;
        for body in obstacles {
            all.reach = larger(all.reach, all.radius + body.reach());
            for a in 0..3 {
                all.largest = larger(all.largest, magnitude(body.point[a]));
            }
        }
        all
    }

    /// That of the bodies of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        let mut all = Self {
            largest: larger(self.largest, other.largest),
            radius: larger(self.radius, other.radius),
            least: smaller(self.least, other.least),
            reach: larger(self.reach, other.reach),
            ..self
        };
        for a in 0..3 {
            all.lo[a] = smaller(self.lo[a], other.lo[a]);
            all.hi[a] = larger(self.hi[a], other.hi[a]);
        }
        all
    }
}
