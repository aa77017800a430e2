//! Hashes of states: the digest that users compare, the seal that detects writes between steps, and a chain of digests
//! of arrays of any kind.

pub mod blake3;
mod element;
pub mod record;
pub(crate) mod seal;
pub(crate) mod state;
