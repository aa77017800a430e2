//! Which bytes of a lent store's values may not be any: those that say yes or no, or which of several cases a value is.
//! A host whose memory others could have written to looks at them before it borrows the values; the other bytes are of
//! numbers, or of nothing.

use core::mem::offset_of;

use super::lent::Head;
use crate::clock::{Clock, Stage};
use crate::state::domain::Domain;
use crate::state::grains::Group;
use crate::state::motion::{FreeMotion, Motion};
use crate::state::obstacle::Obstacle;
use crate::state::shape::MESH;

/// Where such a byte stands in a value, and the largest that it may be.
pub type Flag = (usize, u8);

impl<R> Head<R> {
    /// Its flags.
    pub const FLAGS: [Flag; 7] = {
        let periodic = offset_of!(Self, domain) + Domain::<R>::PERIODIC;
        let clock = offset_of!(Self, clock);
        [
            (periodic, 1),
            (periodic + 1, 1),
            (periodic + 2, 1),
            (offset_of!(Self, takes_out), 1),
            (offset_of!(Self, drains), 1),
            (clock + offset_of!(Clock<R>, losing), 1),
            (clock + offset_of!(Clock<R>, stage), Stage::Listed as u8),
        ]
    };
}

impl<R> Group<R> {
    /// Its flags.
    pub const FLAGS: [Flag; 5] = {
        let integrates = offset_of!(Self, integrates);
        [
            (integrates, 1),
            (integrates + 1, 1),
            (integrates + 2, 1),
            (offset_of!(Self, spins), 1),
            (offset_of!(Self, infinite_mass), 1),
        ]
    };
}

impl<R> Obstacle<R> {
    /// Its flags; the last one is 1 if it moves freely.
    pub const FLAGS: [Flag; 3] = [
        (offset_of!(Self, shape), MESH as u8),
        (offset_of!(Self, curved), 1),
        (offset_of!(Self, motion), 1),
    ];

    /// Those that it has besides if it moves freely.
    pub const FREE_FLAGS: [Flag; 4] = {
        // In the layout of C the case comes first, and then what it holds.
        let free = offset_of!(Self, motion) + align_of::<Motion<R>>();
        let integrates = free + offset_of!(FreeMotion<R>, integrates);
        [
            (integrates, 1),
            (integrates + 1, 1),
            (integrates + 2, 1),
            (free + offset_of!(FreeMotion<R>, spins), 1),
        ]
    };
}
