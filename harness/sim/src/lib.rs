//! An owned simulation over the bitgrain kernel, and what is measured on it and kept of it.
//!
//! * [`sim`]: grains and contacts in vectors; steps on any number of threads ([`threads`], [`stepping`]) and with any
//!   of the machine's instruction sets ([`registers`]), all with the same bits; [`order`] numbers grains in space,
//!   [`random`] draws numbers that never change;
//! * [`law`]: contact laws by name with their ranges, [`coefficients`] in the numbers of both papers;
//! * measuring: [`observe`] reads a state, [`witness`] looks on as it goes, [`audit`] keeps account of the energy,
//!   [`fields`] averages velocity and stress in space, [`histogram`] counts, [`blocks`] gives means their errors,
//!   in a [`motion`] and in [`units`];
//! * keeping: [`checkpoint`], [`chain`] (digests), [`lammps`] and [`export`] (LAMMPS and VTK files);
//! * below all: [`error`], [`disk`] (every call to the file system), [`files`], [`memory`], [`mod@format`].
//!
//! Everything that a step executes is compiled in this crate, as one unit.

#![forbid(unsafe_code)]

pub mod audit;
pub mod blocks;
pub mod chain;
pub mod checkpoint;
pub mod coefficients;
mod crowd;
pub mod disk;
pub mod error;
pub mod export;
pub mod fields;
pub mod files;
pub mod format;
pub mod histogram;
pub mod lammps;
pub mod law;
mod lists;
pub mod memory;
pub mod motion;
pub mod observe;
pub mod order;
pub mod random;
pub mod registers;
pub mod sim;
mod skin;
pub mod stepping;
pub mod threads;
pub mod units;
pub mod witness;
