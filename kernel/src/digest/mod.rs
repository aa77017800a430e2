//! Hashes of states: the digest that users compare, the seal that detects writes between steps, and a chain of digests
//! of arrays of any kind.

mod element;
pub mod record;
pub(crate) mod seal;
pub(crate) mod state;

/// Names the arithmetic of a step. Two builds with the same number give the same bits; a change that
/// alters any bit raises it.
pub const BITS_VERSION: u32 = 1;
