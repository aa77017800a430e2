//! A laboratory for dense granular beds whose every run is reproducible to the last bit.
//!
//! The physics of a step is the `bitgrain-kernel` crate's; this crate makes whole experiments of it.
//! One module a stage, each reading and writing files, so that any stage can be redone alone:
//!
//! * [`scenario`] is what a user asks for, [`law`] the contact laws by name, [`run`] the pipeline;
//! * [`bed`] pours and settles grains ([`random`], [`order`]), [`checkpoint`] saves a state;
//! * [`drag`] pulls the intruder, [`observe`], [`series`] and [`summary`] hold what was
//!   measured, in [`units`];
//! * [`report`] draws it.
//!
//! Beside the pipeline: [`case`](mod@case) and [`replay`] for the smallest unit of work, [`bench`](mod@bench)
//! and [`lammps`] for the beds of others, [`sim`] for whoever wants a simulation in a program,
//! [`cli`], [`progress`], [`files`] and [`error`].

pub mod bed;
pub mod bench;
pub mod case;
pub mod checkpoint;
pub mod cli;
pub mod drag;
pub mod error;
pub mod files;
pub mod lammps;
pub mod law;
pub mod observe;
pub mod order;
pub mod progress;
pub mod random;
pub mod replay;
pub mod report;
pub mod run;
pub mod scenario;
pub mod series;
pub mod sim;
pub mod summary;
pub mod units;
