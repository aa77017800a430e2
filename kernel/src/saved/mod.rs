//! A world as bytes: written at rest, read back with all histories, checked by two hashes.
//!
//! Words of 32 bits, little-endian; a number is one or two of them. In order: `bitgrain`, format, `BITS_VERSION`, name
//! of the number type (16 bytes); counts of grains, groups, obstacles, pair histories and obstacle histories; flags;
//! step (two words); time step, edges of the box, drain; groups; obstacles; grains; histories; the whole digest; the
//! BLAKE3 hash of all before it.

mod layout;
mod read;
mod write;

pub use read::Saved;
pub use write::{save, save_size};
