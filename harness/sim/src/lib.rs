//! An owned simulation over the bitgrain kernel: grains and contacts in vectors, steps on any number of threads and
//! with any of the machine's instruction sets, all with the same bits.
//!
//! It is a crate of its own because everything that a step executes is compiled in it, as one unit.

#![forbid(unsafe_code)]

mod crowd;
mod lists;
pub mod registers;
pub mod sim;
mod skin;
pub mod stepping;
pub mod threads;
