//! The letter of a part that adds up.

/// The sum of a part.
#[derive(Default)]
pub(super) struct Letter(pub u64);
