//! Stretches of grains in the force phase, and a walk along their pairs: blocks run over the ends of stretches.

use core::ops::Range;

use crate::math::real::Real;
use crate::math::rows::get_or_default;

/// Stretches of grains, and where their pairs are.
pub struct StretchRange<'a, R> {
    /// Place of the first grain of each, and where the last one ends.
    pub place: &'a [u32],
    /// Where the pairs of each begin in the list, and where those of the last one may end.
    pub begin: &'a [u32],
    /// How many pairs each has.
    pub pairs: &'a [u32],
    /// What the fastest grain of each travels in the next step.
    pub travel: &'a mut [R],
}

/// Where a walk along the pairs of stretches is.
#[derive(Clone, Copy, Default)]
pub(crate) struct Cursor {
    /// The first stretch that is not done.
    pub stretch: usize,
    /// Pairs of it that are done.
    done: usize,
}

impl Cursor {
    /// The entry of the next pair.
    #[inline(always)]
    pub(crate) fn entry<R: Real>(self, stretches: &StretchRange<'_, R>) -> usize {
        get_or_default(stretches.begin, self.stretch) as usize + self.done
    }

    /// Entries of pairs of one stretch, as many as there is room for; none if all is done.
    #[inline(always)]
    pub(crate) fn take<R: Real>(
        &mut self,
        stretches: &StretchRange<'_, R>,
        room: usize,
    ) -> Option<Range<usize>> {
        let pairs = *stretches.pairs.get(self.stretch)? as usize;
        let begin = self.entry(stretches);
        let left = pairs.saturating_sub(self.done);
        if left <= room {
            *self = Self {
                stretch: self.stretch + 1,
                done: 0,
            };
            return Some(begin..begin + left);
        }
        self.done += room;
        (room > 0).then_some(begin..begin + room)
    }
}
