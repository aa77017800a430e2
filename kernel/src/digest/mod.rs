//! Hashes of states: the digest that users compare, and the seal that detects writes between steps.

pub mod blake3;
pub(crate) mod seal;
pub(crate) mod state;
