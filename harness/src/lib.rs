//! A laboratory for dense granular beds whose every run is reproducible to the last bit.
//!
//! The command, in [`cli`] ([`bench`](mod@bench) times steps), and all of its crates under one name: `bitgrain-sim`
//! (a simulation, what is measured on it and kept of it), `bitgrain-lab` (scenarios, beds, drags, runs, campaigns)
//! and `bitgrain-analysis` (fits, claims, reports). The physics of a step is the `bitgrain-kernel` crate's.

#![forbid(unsafe_code)]

pub mod bench;
pub mod cli;
pub mod ranks;

pub use bitgrain_analysis::{analysis, claims, fit, present, released, remarks, report};
pub use bitgrain_lab::{
    against, bed, benchmark, bisect, campaign, case, changes, compare, confirm, drag, flow, folder,
    forecast, frames, json, manifest, near_field, parse_errors, plain, plug_flow, progress,
    published, recording, replay, rerun, run, scenario, selftest, series, summary, verify,
};
pub use bitgrain_sim::{
    block_averaging, body, chain, checkpoint, coarse_graining, coefficients, disk, energy_budget,
    error, export, files, format, histogram, histories, isa, lammps, law, lists, memory, mesh,
    motion, notes, observe, observer, owned_world, parts, random, simulation, spatial_order,
    stepping, threads, units,
};
