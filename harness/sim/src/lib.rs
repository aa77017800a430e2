//! An owned simulation over the bitgrain kernel, and what is measured on it and kept of it.
//!
//! * [`simulation`]: grains and contacts in vectors ([`owned_world`], [`lists`]); steps on any number of threads
//!   ([`threads`], [`parts`], [`stepping`]) and with any of the machine's instruction sets ([`isa`]), all with the same
//!   bits; [`spatial_order`] numbers grains in space, [`random`] draws numbers that never change;
//! * [`law`]: contact laws by name with their ranges, [`coefficients`] in the numbers of both papers;
//! * measuring: [`observe`] reads a state, [`notes`] are taken of each step, [`observer`] watches a stage,
//!   [`energy_budget`] accounts for the energy, [`coarse_graining`] averages velocity and stress in space,
//!   [`histogram`] counts, [`exact_sum`] adds in any order, [`block_averaging`] gives means and their errors, in a
//!   [`motion`] and in [`units`];
//! * keeping: [`checkpoint`], [`chain`] (digests), [`lammps`] and [`export`] (LAMMPS and VTK files);
//! * below all: [`error`], [`disk`] (every call to the file system), [`files`], [`table`] (CSV), [`memory`],
//!   [`mod@format`]; [`body`] and [`mesh`] make obstacles of what hosts say.
//!
//! Everything that a step executes is compiled in this crate, as one unit.

#![forbid(unsafe_code)]

pub mod below;
pub mod block_averaging;
pub mod body;
pub mod chain;
pub mod checkpoint;
pub mod coarse_graining;
pub mod coefficients;
pub mod contact_count;
mod crowd;
pub mod disk;
pub mod edits;
pub mod energy_budget;
pub mod error;
pub mod exact_sum;
pub mod export;
pub mod files;
pub mod format;
mod grain;
pub mod histogram;
pub mod histories;
pub mod isa;
pub mod lammps;
pub mod law;
mod law_work;
pub mod lists;
mod long_step;
pub mod memory;
pub mod mesh;
pub mod motion;
pub mod notes;
pub mod observe;
pub mod observer;
pub mod owned_world;
pub mod parts;
mod pass;
pub mod random;
mod saved;
pub mod simulation;
mod skin;
pub mod spatial_order;
pub mod stepping;
pub mod table;
pub mod threads;
mod touching;
pub mod units;
