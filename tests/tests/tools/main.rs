//! Tests that build or run other programs: emulated machines, mutants of the kernel, counted instructions, a browser,
//! other simulators, schedulers.

mod browser;
mod capi;
mod chromium;
mod count;
mod instructions;
// The modules of the program `targets`, which uses the rest.
#[allow(dead_code)]
#[path = "../../machines/mod.rs"]
mod machines;
mod models;
mod mpi;
mod mutants;
mod page;
mod panics;
mod recordings;
mod schedulers;
mod slurm;
mod targets;
mod units;
