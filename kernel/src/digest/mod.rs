//! Hashes of states: the digest that users compare, and the seal that finds what was written to between steps.

pub mod blake3;
pub(crate) mod seal;
pub(crate) mod state;
