//! What the forces of a step show: overlaps that are too deep, and obstacles whose force is not a number.

use crate::math::real::Real;
use crate::state::obstacle::Obstacle;

/// What the forces of a step found, by ids of grains and numbers of obstacles: the lowest of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForceCheck {
    /// The obstacle whose force or torque is not finite.
    pub unsound: Option<u32>,
    /// A grain and an obstacle that overlap by more than is allowed.
    pub on_obstacle: Option<(u32, u32)>,
    /// Two grains that overlap by more than half the smaller radius.
    pub of_pair: Option<(u32, u32)>,
    /// Whether the world has no room for the words of the law, or lists pairs less far than it reaches.
    pub misfit: bool,
}

impl ForceCheck {
    /// Nothing was found.
    pub const NONE: Self = Self {
        unsound: None,
        on_obstacle: None,
        of_pair: None,
        misfit: false,
    };

    /// This and what was found in other contacts: what one pass over both would have found.
    pub fn and(self, other: Self) -> Self {
        Self {
            unsound: lowest(self.unsound, other.unsound),
            on_obstacle: lowest(self.on_obstacle, other.on_obstacle),
            of_pair: lowest(self.of_pair, other.of_pair),
            misfit: self.misfit || other.misfit,
        }
    }

    /// Looks for an obstacle whose sums are not finite.
    pub(crate) fn of_obstacles<R: Real>(obstacles: &[Obstacle<R>]) -> Option<u32> {
        let unsound = |body: &Obstacle<R>| {
            let mut sums = body.force.iter().chain(&body.torque);
            !sums.all(|f| f.is_finite())
        };
        let place = obstacles.iter().position(unsound);
        place.map(|k| k as u32)
    }
}

fn lowest<T: Ord>(a: Option<T>, b: Option<T>) -> Option<T> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b < a { b } else { a }),
        (a, b) => a.or(b),
    }
}
