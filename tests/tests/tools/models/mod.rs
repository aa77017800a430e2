//! Threads that share the parts of a world: in model checkers, and with stalls.

// Each takes the sources of the harness with its own means of threads.
#![allow(clippy::duplicate_mod)]

mod letters;
mod orders;
mod stalls;
