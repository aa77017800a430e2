//! Why an obstacle is impossible, in words of geometry and mechanics.

use core::fmt;

/// What is wrong with an obstacle; the first of these that is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ObstacleDefect {
    /// A size is not positive, or another number of it is none.
    Number,
    /// A wall faces along a periodic axis.
    Facing,
    /// An endless bar lies askew to the axes, of which one is periodic.
    Askew,
    /// It is endless and turns, or is turned, other than about its own direction.
    Tilted,
    /// It is to move freely, and is infinitely heavy.
    Weightless,
    /// It is to turn freely, and is endless or has no moments of inertia.
    Inertia,
    /// It is to move freely in fixed point.
    Range,
    /// Its centre is outside the box.
    Outside,
    /// It is larger than the box.
    Large,
}

impl fmt::Display for ObstacleDefect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Number => {
                "a size is not positive, a direction or an orientation is not of length 1, or a number is not finite"
            }
            Self::Facing => {
                "a wall that faces along a periodic axis would cut the box off from its own next period"
            }
            Self::Askew => {
                "where an axis is periodic, an endless bar goes on in the next period only if it lies along x, y or z"
            }
            Self::Tilted => {
                "an endless body turns about its own direction only: a tilt would move its far parts without bound"
            }
            Self::Weightless => "forces move only what has a mass, and it is infinitely heavy",
            Self::Inertia => {
                "torques turn only what has moments of inertia, and it has none or is endless"
            }
            Self::Range => "free bodies need numbers of more range than fixed point has",
            Self::Outside => "its centre is outside the box",
            Self::Large => "it is larger than the box",
        })
    }
}
