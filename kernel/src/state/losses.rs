//! What a world says of grains that leave the box, fall through a plane or overlap too deeply.

use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::vec3::{Vec3, dot, head, sub};
use crate::state::grains::GrainState;

/// What becomes of grains that leave the box, overlap too deeply or come behind a plane.
///
/// Without a policy, [`LossPolicy::STOP`], the first two stop the world with an error. If grains are to be taken out,
/// the step in which one is lost is done to its end with it: its contacts push as ever, and its forces stay in the
/// rows of its partners. Then the world [is losing](crate::Clock::is_losing) and refuses further steps until
/// [`take_out`](crate::take_out) has removed such grains. So what is lost, and when, does not depend on where a run
/// is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LossPolicy<R> {
    /// Whether a grain beyond a closed edge of the box is taken out, and one that overlaps another body by more than a
    /// quarter of the smaller diameter; of two grains the one with the higher id.
    pub takes_out: bool,
    /// A plane behind which grains are taken out.
    pub drain: Option<Drain<R>>,
}

/// A plane: a grain whose centre is on the side that the normal points away from is taken out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Drain<R> {
    /// A point of the plane (length).
    pub point: Vec3<R>,
    /// A normal of any length, to the side where grains stay.
    pub normal: Vec3<R>,
}

/// A grain that is being taken out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure<R> {
    /// The grain as it was when it left.
    pub grain: GrainState<R>,
    /// Why it goes.
    pub cause: Cause,
}

/// Why a grain is taken out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// It is beyond a closed edge of the box.
    Escaped,
    /// It is behind the drain.
    Drained,
    /// It overlaps an obstacle too deeply.
    ObstacleTooDeep {
        /// The obstacle.
        obstacle: u32,
    },
    /// It overlaps a grain of a lower id too deeply.
    OverlapTooDeep {
        /// The id of that grain.
        with: u32,
    },
}

impl<R: Real> LossPolicy<R> {
    /// Whatever is lost stops the world.
    pub const STOP: Self = Self {
        takes_out: false,
        drain: None,
    };
}

impl<R: Real> Default for LossPolicy<R> {
    fn default() -> Self {
        Self::STOP
    }
}

impl<R: Real> Drain<R> {
    /// Whether a grain at this place is behind the plane.
    #[inline]
    pub(crate) fn has(&self, position: &Row<R>) -> bool {
        dot(sub(head(*position), self.point), self.normal) < R::ZERO
    }
}
