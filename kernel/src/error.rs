//! What can go wrong in a world: small, copyable, and without allocation.

use core::fmt;

use crate::math::real::Real;
use crate::obstacle_defect::ObstacleDefect;

/// Why a world was refused or a step stopped. Grains are named by id, obstacles by number. Later versions may have more
/// kinds; [`Error::code`] numbers them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Error {
    /// The box edges are not finite or not in order on this axis.
    BadDomain {
        /// 0, 1, 2 for x, y, z.
        axis: u8,
    },
    /// A periodic axis is not longer than twice the largest contact distance.
    PeriodTooShort {
        /// 0, 1, 2 for x, y, z.
        axis: u8,
    },
    /// The lent slices do not have one entry for each grain.
    BadStorage,
    /// Ids do not strictly ascend at this place.
    BadOrder {
        /// The id that is not above the one before it.
        id: u32,
    },
    /// A grain's group, radius or mass is missing, not positive or not finite.
    BadGrain {
        /// The grain.
        id: u32,
    },
    /// An obstacle's size, place, direction or motion is impossible in this box.
    BadObstacle {
        /// The obstacle.
        obstacle: u32,
        /// What is wrong with it.
        flaw: ObstacleDefect,
    },
    /// The time step is not positive and finite, or the skin is negative or NaN.
    BadTimeStep,
    /// The machine's arithmetic is not that of the bit contract.
    Arithmetic {
        /// What is wrong with it.
        flaw: ArithmeticDefect,
    },
    /// A grain that is carried would move less than 16 units in the last place of the largest
    /// coordinate in one step, and so not at its speed.
    TooSlow {
        /// The grain.
        id: u32,
    },
    /// The same of an obstacle.
    ObstacleTooSlow {
        /// The obstacle.
        obstacle: u32,
    },
    /// The same of a grain that falls at the speed it gains over a distance of its own radius.
    GravityTooWeak {
        /// The group.
        group: u8,
    },
    /// A saved contact is not finite or joins bodies that are not near each other.
    BadContactHistory,
    /// Bytes are no saved world, or were changed or cut off after they were written; or they were forged, and the store
    /// that was to hold them is stopped.
    BadSave,
    /// A saved world of another layout, other arithmetic or another number type.
    OtherVersion,
    /// The triangles of the world are not those that this mesh was made of; or it has more than
    /// [`FACETS_MAX`](crate::FACETS_MAX).
    OtherFacets {
        /// The obstacle.
        obstacle: u32,
    },
    /// A group or an obstacle is of a material that the law does not know.
    UnknownMaterial {
        /// The number of the material.
        material: u8,
    },
    /// The storage has no room for the words that the law, or a saved contact, keeps of a contact, or the law acts
    /// further than pairs are listed.
    LawMisfit,
    /// There are more obstacles than [`OBSTACLES_MAX`](crate::OBSTACLES_MAX).
    TooManyObstacles {
        /// How many there are.
        count: u32,
        /// How many a world can have.
        most: u32,
    },
    /// The lent bytes are too few for a saved world; nothing was written.
    BufferTooShort {
        /// Bytes that would have been enough.
        needed: usize,
    },
    /// There is no room for so many grains; nothing was changed.
    GrainsFull {
        /// Grains that there would have to be room for.
        needed: usize,
    },
    /// The lent pair list is too short; nothing was changed.
    PairListFull {
        /// Entries that would have been enough.
        needed: usize,
    },
    /// The lent list of candidates, pairs that may come near, is too short; nothing was changed.
    OuterListFull {
        /// Entries that would have been enough.
        needed: usize,
    },
    /// The lent list of obstacle contacts is too short; nothing was changed.
    ObstacleContactsFull {
        /// Entries that would have been enough.
        needed: usize,
    },
    /// A number of this grain is too large for its fixed-point type; its row holds the overflow mark.
    Overflow {
        /// Its id.
        id: u32,
    },
    /// A number of this obstacle is too large for its fixed-point type.
    ObstacleOverflow {
        /// Its number.
        obstacle: u32,
    },
    /// A velocity, spin, force or torque became NaN, infinite or too large to square.
    NotFinite {
        /// The grain.
        id: u32,
    },
    /// The place of an obstacle, or the force or torque on it, became infinite or NaN.
    ObstacleNotFinite {
        /// The obstacle.
        obstacle: u32,
    },
    /// An obstacle would move more than the smallest grain radius in one step.
    ObstacleTooFast {
        /// The obstacle.
        obstacle: u32,
    },
    /// A grain would move more than its own radius in one step.
    TooFast {
        /// The grain.
        id: u32,
    },
    /// A grain left the box through an edge that is not periodic, or crossed a periodic one more often
    /// than can be counted.
    Escaped {
        /// The grain.
        id: u32,
    },
    /// Two grains overlap by more than a quarter of the smaller diameter.
    OverlapTooDeep {
        /// The lower id.
        i: u32,
        /// The higher id.
        j: u32,
    },
    /// A grain overlaps an obstacle by more than a quarter of the smaller diameter.
    ObstacleTooDeep {
        /// The grain.
        id: u32,
        /// The obstacle.
        obstacle: u32,
    },
    /// A step of a world that was not started, or whose last stretch of steps was not ended; or whatever needs a state
    /// of a world that a fault has stopped, which has none.
    NotStarted,
    /// There is no grain at this place.
    NoGrain {
        /// The place among the rows.
        place: u32,
    },
    /// No grain has this id.
    UnknownGrain {
        /// The id.
        id: u32,
    },
    /// Grains have left under the world's policy and were not taken out yet; nothing was changed.
    GrainsLeaving,
    /// What a step reads was written to since the last one ended; nothing was changed.
    Edited,
}

/// How a machine's arithmetic departs from the bit contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ArithmeticDefect {
    /// Subnormal results become zero.
    FlushToZero,
    /// Subnormal operands count as zero.
    DenormalsAreZero,
    /// Results are not rounded to nearest.
    Rounding,
    /// Results are kept with more digits and rounded twice.
    ExcessPrecision,
    /// A product and a sum are rounded as one.
    Fused,
}

impl fmt::Display for ArithmeticDefect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ArithmeticDefect::FlushToZero => {
                "results below the least normal number become zero (flush-to-zero is on, as a \
                 library linked with fast-math turns it on)"
            }
            ArithmeticDefect::DenormalsAreZero => {
                "operands below the least normal number count as zero (denormals-are-zero is on, \
                 as a library linked with fast-math turns it on)"
            }
            ArithmeticDefect::Rounding => {
                "results are not rounded to nearest (something has changed the rounding mode)"
            }
            ArithmeticDefect::ExcessPrecision => {
                "results are rounded twice (x87 registers hold more digits)"
            }
            ArithmeticDefect::Fused => {
                "products and sums are rounded as one (built with fused multiply-add allowed)"
            }
        })
    }
}

impl Error {
    /// The number of this kind of error, the same in every version and language; 0 is none. 1 to 19: something is wrong
    /// with what was given; 20 to 29: a list is full, and nothing was changed; 30 to 49: the motion went wrong, and the
    /// world is stopped; 50 to 59: the call was not due.
    pub const fn code(&self) -> u32 {
        match self {
            Self::BadDomain { .. } => 1,
            Self::PeriodTooShort { .. } => 2,
            Self::BadStorage => 3,
            Self::BadOrder { .. } => 4,
            Self::BadGrain { .. } => 5,
            Self::BadObstacle { .. } => 6,
            Self::BadTimeStep => 7,
            Self::Arithmetic { .. } => 8,
            Self::TooSlow { .. } => 9,
            Self::ObstacleTooSlow { .. } => 10,
            Self::GravityTooWeak { .. } => 11,
            Self::BadContactHistory => 12,
            Self::BadSave => 13,
            Self::OtherVersion => 14,
            Self::OtherFacets { .. } => 15,
            Self::UnknownMaterial { .. } => 16,
            Self::LawMisfit => 17,
            Self::TooManyObstacles { .. } => 18,
            Self::PairListFull { .. } => 20,
            Self::OuterListFull { .. } => 21,
            Self::ObstacleContactsFull { .. } => 22,
            Self::BufferTooShort { .. } => 23,
            Self::GrainsFull { .. } => 24,
            Self::Overflow { .. } => 30,
            Self::ObstacleOverflow { .. } => 31,
            Self::NotFinite { .. } => 32,
            Self::ObstacleNotFinite { .. } => 33,
            Self::ObstacleTooFast { .. } => 34,
            Self::TooFast { .. } => 35,
            Self::Escaped { .. } => 36,
            Self::OverlapTooDeep { .. } => 37,
            Self::ObstacleTooDeep { .. } => 38,
            Self::NotStarted => 50,
            Self::Edited => 51,
            Self::NoGrain { .. } => 52,
            Self::UnknownGrain { .. } => 53,
            Self::GrainsLeaving => 54,
        }
    }

    /// Whether it is one of the motion, which stops a world; see [`Error::code`].
    pub(crate) fn stops(&self) -> bool {
        (30..50).contains(&self.code())
    }

    /// Of two faults of grains the one of the lower id: what one pass over both would have found first.
    pub(crate) fn first(a: Option<Self>, b: Option<Self>) -> Option<Self> {
        let grain = |fault: &Self| match *fault {
            Self::Overflow { id }
            | Self::NotFinite { id }
            | Self::TooFast { id }
            | Self::Escaped { id } => id,
            _ => 0,
        };
        match (a, b) {
            (Some(a), Some(b)) => Some(if grain(&b) < grain(&a) { b } else { a }),
            (a, b) => a.or(b),
        }
    }

    /// A grain whose state is no number of this type.
    pub(crate) fn not_finite<R: Real>(id: u32) -> Self {
        match R::FIXED_POINT {
            true => Self::Overflow { id },
            false => Self::NotFinite { id },
        }
    }

    /// An obstacle whose state is no number of this type.
    pub(crate) fn obstacle_not_finite<R: Real>(obstacle: u32) -> Self {
        match R::FIXED_POINT {
            true => Self::ObstacleOverflow { obstacle },
            false => Self::ObstacleNotFinite { obstacle },
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Error::BadDomain { axis } => write!(
                f,
                "box edges along axis {axis} are not finite or not in order"
            ),
            Error::PeriodTooShort { axis } => write!(f, "periodic axis {axis} {TOO_SHORT}"),
            Error::BadStorage => write!(f, "storage does not hold one entry for each grain"),
            Error::BadOrder { id } => write!(f, "grain ids do not ascend at id {id}"),
            Error::BadGrain { id } => {
                write!(f, "grain {id} has an impossible group, radius or mass")
            }
            Error::BadObstacle { obstacle, flaw } => {
                write!(f, "obstacle {obstacle} is impossible in this box: {flaw}")
            }
            Error::BadTimeStep => write!(f, "time step or skin is not positive and finite"),
            Error::Arithmetic { flaw } => {
                write!(f, "this machine's arithmetic would change the bits: {flaw}")
            }
            Error::TooSlow { id } => write!(f, "grain {id} is carried {TOO_SLOW}"),
            Error::ObstacleTooSlow { obstacle } => {
                write!(f, "obstacle {obstacle} moves {TOO_SLOW}")
            }
            Error::GravityTooWeak { group } => write!(f, "grains of group {group} fall {TOO_SLOW}"),
            Error::BadContactHistory => write!(f, "a saved contact fits no bodies near each other"),
            Error::BadSave => write!(f, "these bytes are no saved world as it was written"),
            Error::OtherVersion => write!(
                f,
                "a saved world of another layout, other arithmetic or another number type"
            ),
            Error::OtherFacets { obstacle } => write!(
                f,
                "the world's triangles are not those that obstacle {obstacle} was made of: give it the same ones again"
            ),
            Error::UnknownMaterial { material } => {
                write!(f, "the law knows no material of number {material}")
            }
            Error::LawMisfit => write!(
                f,
                "the law keeps more words of a contact than there is storage for, or acts further than pairs are listed"
            ),
            Error::TooManyObstacles { count, most } => crowded(f, count, most),
            Error::BufferTooShort { needed } => write!(f, "a saved world takes {needed} bytes"),
            Error::GrainsFull { needed } => write!(f, "there is no room for {needed} grains"),
            Error::PairListFull { needed } => full(f, "pair", needed),
            Error::OuterListFull { needed } => full(f, "candidate", needed),
            Error::ObstacleContactsFull { needed } => full(f, "obstacle", needed),
            Error::Overflow { id } => write!(
                f,
                "a number of grain {id} is too large for the fixed-point type: {TOO_LARGE}"
            ),
            Error::ObstacleOverflow { obstacle } => write!(
                f,
                "a number of obstacle {obstacle} is too large for the fixed-point type: {TOO_LARGE}"
            ),
            Error::NotFinite { id } => write!(f, "the state of grain {id} is not finite"),
            Error::ObstacleNotFinite { obstacle } => {
                write!(f, "the state of obstacle {obstacle} is not finite")
            }
            Error::ObstacleTooFast { obstacle } => write!(
                f,
                "obstacle {obstacle} would move more than the smallest grain radius in one step"
            ),
            Error::TooFast { id } => {
                write!(
                    f,
                    "grain {id} would move more than its own radius in one step"
                )
            }
            Error::Escaped { id } => write!(f, "grain {id} left the box"),
            Error::OverlapTooDeep { i, j } => write!(
                f,
                "grains {i} and {j} overlap by more than a quarter of the smaller diameter"
            ),
            Error::ObstacleTooDeep { id, obstacle } => write!(
                f,
                "grain {id} overlaps obstacle {obstacle} by more than a quarter of the smaller diameter"
            ),
            Error::NotStarted => f.write_str(NOT_STARTED),
            Error::NoGrain { place } => write!(f, "there is no grain at place {place}"),
            Error::UnknownGrain { id } => write!(f, "there is no grain with id {id}"),
            Error::GrainsLeaving => f.write_str(LEAVING),
            Error::Edited => write!(
                f,
                "the world was changed between two steps; after a change start or resume it"
            ),
        }
    }
}

/// Says how many obstacles there are, and how many there can be.
fn crowded(f: &mut fmt::Formatter<'_>, count: u32, most: u32) -> fmt::Result {
    write!(
        f,
        "there are {count} obstacles, and a world can have {most}: join those in a mesh that move as one"
    )
}

/// Says how many entries a full list would need.
fn full(f: &mut fmt::Formatter<'_>, list: &str, needed: usize) -> fmt::Result {
    write!(f, "{list} list is full, {needed} entries needed")
}

const LEAVING: &str = "grains have left the world: take them out before the next step";

const NOT_STARTED: &str =
    "the world was not started, or a fault stopped it in the middle of a step and it has no state";

const TOO_LARGE: &str = "take one with fewer places after the point, or other units";

const TOO_SHORT: &str = "is not longer than twice the largest contact distance: a grain could touch two images \
                         of one body";

const TOO_SLOW: &str = "less than 16 units in the last place of the largest coordinate in one step: \
                        take a longer time step, a smaller box or more digits";

impl core::error::Error for Error {}
