//! Tests that build or run other programs: emulated machines, mutants of the kernel, counted instructions, a browser.

mod browser;
mod instructions;
mod mutants;
mod panics;
mod targets;
