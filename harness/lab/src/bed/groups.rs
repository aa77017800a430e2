//! The groups of a bed's grains.

/// Group of the grains that move.
pub const FREE: u8 = 0;

/// Group of the base: frozen, or carried if the bed moves.
pub const BASE: u8 = 1;

/// Group of the lid.
pub const LID: u8 = 2;
