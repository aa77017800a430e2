//! Threads that share the parts of a world, in model checkers: `.ci/run orders`.
#![cfg(test)]
// Each takes the sources of the harness with its own means of threads.
#![allow(clippy::duplicate_mod)]

mod crews;
mod letters;
