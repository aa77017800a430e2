//! A laboratory for dense granular beds whose every run is reproducible to the last bit.
//!
//! The physics of a step is the `bitgrain-kernel` crate's; this crate makes whole experiments of it.
//! One module a stage, each reading and writing files, so that any stage can be redone alone:
//!
//! * [`scenario`] is what a user asks for, [`law`] the contact laws by name
//!   ([`coefficients`] in numbers), [`forecast`] what it
//!   would take, [`run`] the pipeline, [`folder`] the run directory;
//! * [`bed`] pours and settles grains ([`random`], [`order`]), keeps beds for the next run and takes
//!   those of others; [`checkpoint`] saves a state;
//! * [`drag`] pulls the intruder or carries the bed past it; [`flow`], [`observe`], [`surroundings`], [`plug`],
//!   [`fields`], [`audit`], [`series`], [`histogram`], [`blocks`] and [`summary`] hold what was measured, in [`units`];
//! * [`campaign`] runs a scenario over the values of its grids into one table, [`analysis`] is what such a table
//!   says ([`fit`] draws curves through points), [`claims`] what it comes to beside the papers;
//! * [`export`] and [`lammps`] write fields that others read, [`report`] draws the page from what
//!   [`present`] finds in the run directory; [`compare`] says where two states first differ.
//!
//! Beside the pipeline: [`case`](mod@case) and [`replay`] for the smallest unit of work, [`bench`](mod@bench)
//! for speed, [`selftest`](mod@selftest) for the machine, [`sim`] for whoever wants a simulation in a
//! program ([`stepping`] and [`registers`] are how it uses threads and wide instructions), [`cli`],
//! [`shelf`] (what `bitgrain bed` prints), [`progress`], [`plain`] (text for a terminal), [`files`], [`json`],
//! [`memory`] and [`error`].

#![forbid(unsafe_code)]

pub mod against;
pub mod analysis;
pub mod audit;
pub mod bed;
pub mod bench;
pub mod bisect;
pub mod blocks;
pub mod campaign;
pub mod case;
pub mod chain;
pub mod changes;
pub mod checkpoint;
pub mod claims;
pub mod cli;
pub mod coefficients;
pub mod compare;
pub mod disk;
pub mod drag;
pub mod error;
pub mod export;
pub mod fields;
pub mod files;
pub mod fit;
pub mod flow;
pub mod folder;
pub mod forecast;
pub mod format;
pub mod frames;
pub mod histogram;
pub mod json;
pub mod lammps;
pub mod law;
pub mod manifest;
pub mod memory;
pub mod motion;
pub mod observe;
pub mod order;
pub mod parse_errors;
pub mod plain;
pub mod plug;
pub mod present;
pub mod progress;
pub mod random;
pub mod remarks;
pub mod replay;
pub mod report;
pub mod rerun;
pub mod run;
pub mod scenario;
pub mod selftest;
pub mod series;
pub mod summary;
pub mod surroundings;
pub mod units;
pub mod verify;
pub mod witness;

pub use bitgrain_sim::{registers, sim, stepping, threads};
