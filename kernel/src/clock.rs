//! Where a world is in time and within a step, and how long its lists hold.

use crate::math::real::Real;
use crate::neighbors::pair_list::Listed;

/// Where a world is in time, how long its pair list holds, and the seal of what it was when it came to
/// rest. Everything but `step` has no effect on any result.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Clock<R> {
    /// Steps done; time is `step * dt`.
    pub step: u64,
    pub(crate) outer_list_rebuilds: u64,
    pub(crate) prunes: u64,
    pub(crate) picked: u64,
    pub(crate) listed: Listed,
    /// The smallest grain radius: what an obstacle may move in one step.
    pub(crate) radius_min: R,
    /// How far beyond touching every pair is still a candidate (length); below zero there are none.
    pub(crate) far: R,
    /// Margin for the rounding of coordinates and distances.
    pub(crate) slack: R,
    /// How far beyond touching the law acts (length).
    pub(crate) reach: R,
    /// Bound of the next step's travel (length).
    pub(crate) next_travel: R,
    /// What rounding may add to it.
    pub(crate) rounding: R,
    /// Of the world as it came to rest; see [`crate::digest::seal`].
    pub(crate) seal: u64,
    /// Grains of the world when it was started or edited.
    pub(crate) count: usize,
    /// Whether grains wait to be taken out; see [`crate::take_out`].
    pub(crate) losing: bool,
    pub(crate) stage: Stage,
}

/// Where a world is within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub(crate) enum Stage {
    /// Not started, or changed since so that it must be started again: the rows are what their owner has put there.
    #[default]
    New,
    /// Stopped by a fault, in the middle of a step.
    Stopped,
    /// Between two stretches of steps, and sealed.
    Resting,
    /// Between two steps of a stretch.
    Going,
    /// After a drift: positions are those of the step that is being done, forces are zero.
    Drifted,
    /// After a drift, and the list was looked at: only the forces are still to come.
    Listed,
}

impl<R: Real> Clock<R> {
    /// Before the first step.
    pub(crate) const ZERO: Self = Self {
        step: 0,
        outer_list_rebuilds: 0,
        prunes: 0,
        picked: 0,
        listed: Listed::NONE,
        radius_min: R::ZERO,
        far: R::ZERO,
        slack: R::ZERO,
        reach: R::ZERO,
        next_travel: R::ZERO,
        rounding: R::ZERO,
        seal: 0,
        count: 0,
        losing: false,
        stage: Stage::New,
    };

    /// Searches done.
    pub fn outer_list_rebuilds(&self) -> u64 {
        self.outer_list_rebuilds
    }

    /// Times that pairs were picked from the candidates of a search: of all grains, or of a stretch at least.
    pub fn prunes(&self) -> u64 {
        self.prunes
    }

    /// Grains whose pairs were picked, all times together: what renewals cost.
    pub fn picked(&self) -> u64 {
        self.picked
    }

    /// Grain pairs listed.
    pub fn listed(&self) -> usize {
        self.listed.pairs
    }

    /// Those of them that touched when they were listed: for timings only.
    pub fn listed_touching(&self) -> usize {
        self.listed.touching
    }

    /// Obstacle contacts listed.
    pub fn obstacle_contacts(&self) -> usize {
        self.listed.obstacle_contacts
    }

    /// How many grains the world has since it was started or last edited: an owner's rows in use.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The smallest radius of a grain, or period of the box if that is smaller, as of the last start or edit (length);
    /// the largest number without either.
    pub fn radius_min(&self) -> R {
        self.radius_min
    }

    /// Whether grains have left under a [`LossPolicy`](crate::LossPolicy) and must be taken out, with
    /// [`crate::take_out`], before the next step.
    pub fn is_losing(&self) -> bool {
        self.losing
    }

    /// Whether the world is between two stretches of steps: not after a fault, and not if a full list
    /// interrupted several steps.
    pub fn rests(&self) -> bool {
        self.stage == Stage::Resting
    }

    /// Whether the world is within a stretch that [`crate::phases::begin`] began, between two of its steps.
    pub fn has_begun(&self) -> bool {
        self.stage == Stage::Going
    }

    /// Whether the world has a state: that of its last finished step, or what its owner has put there before a start.
    /// It has none in the middle of a step, nor after a fault has stopped one there: numbers of two steps stand in the
    /// rows then, and how many are of which depends on how the host steps.
    pub fn has_state(&self) -> bool {
        matches!(self.stage, Stage::New | Stage::Resting | Stage::Going)
    }

    /// Notes that the owner has changed what a step reads. What a fault has stopped stays so.
    pub(crate) fn unstart(&mut self) {
        if self.has_state() {
            self.stage = Stage::New;
        }
    }

    /// How far beyond touching the law of the world acts (length, zero or more); see
    /// [`Law::reach`](crate::contact::Law::reach). [`crate::start`] asks the law; a world that is resumed is told
    /// before that.
    pub fn set_reach(&mut self, reach: R) {
        self.reach = reach;
    }

    /// How far that is.
    pub fn reach(&self) -> R {
        self.reach
    }

    /// Stops a world that was computed wrongly, as its host found: it has no state then, and all that would read one,
    /// or go on from it, is refused with [`NotStarted`](crate::Error::NotStarted).
    pub fn stop(&mut self) {
        self.stage = Stage::Stopped;
    }
}
