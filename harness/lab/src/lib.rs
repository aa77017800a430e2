//! Experiments on granular beds, every one reproducible to the last bit.
//!
//! Each stage reads and writes files, so that any of them can be redone alone:
//!
//! * [`scenario`] is what a user asks for, [`forecast`] its cost, [`run`] the pipeline, [`folder`] and
//!   [`manifest`] the run directory;
//! * [`bed`] pours and settles grains, keeps beds for the next run and imports others;
//! * [`drag`] pulls the intruder or carries the bed past it; [`series`], [`flow`], [`near_field`], [`plug_flow`],
//!   [`tank`] with its [`tank_tables`], [`frames`] and [`summary`] hold what was measured;
//! * [`campaign`] runs a scenario over the values of its grids into one table;
//! * [`verify`], [`confirm`], [`bisect`], [`against`], [`rerun`] and [`replay`] do parts of it again and compare
//!   ([`compare`], [`changes`]); [`case`](mod@case) is the smallest unit of work, [`selftest`](mod@selftest) tests the
//!   machine; [`published`] is what shipped scenarios come to;
//! * [`benchmark`]: cases that others published, beside theory and their points;
//! * [`recording`]: named arrays of any program, by step, and where two programs part;
//! * below them [`progress`], [`performance`] and [`pace`] (how fast stages went), [`plain`] (text for a terminal),
//!   [`json`] and [`parse_errors`].

#![forbid(unsafe_code)]

pub mod against;
pub mod bed;
pub mod benchmark;
pub mod beside;
pub mod bisect;
pub mod campaign;
pub mod case;
pub mod changes;
pub mod compare;
pub mod confirm;
pub mod drag;
pub mod flow;
pub mod folder;
pub mod forecast;
pub mod frames;
pub mod json;
pub mod manifest;
pub mod near_field;
pub mod pace;
pub mod parse_errors;
pub mod performance;
pub mod plain;
pub mod plug_flow;
pub mod progress;
pub mod published;
pub mod recording;
pub mod replay;
pub mod rerun;
pub mod run;
pub mod scenario;
pub mod selftest;
pub mod series;
pub mod summary;
pub mod tank;
pub mod tank_tables;
mod travel;
pub mod verify;
