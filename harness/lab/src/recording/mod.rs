//! Recordings: named arrays of any program, by step, as a chain of digests; and where two of them part.
//!
//! The data flow:
//!
//! 1. A program gives named arrays at ascending steps: to a [`Recorder`], or as frames in a [`stream`].
//! 2. The recorder hashes each array and appends a line to `recording.csv`
//!    ([`bitgrain_kernel::record`] makes the lines); the arrays themselves are kept as [`Keep`] says.
//! 3. A [`Recording`] is read again, and every line is checked against the one before.
//! 4. [`part`] compares two recordings line by line, or [`search()`] two running commands frame by frame.
//! 5. [`difference`] says which array, element and bit differ at the first step that does.

pub mod array;
pub mod command;
pub mod difference;
pub mod keep;
pub mod parting;
pub mod read;
pub mod recorder;
pub mod search;
pub mod stream;

pub use array::{Array, ArrayRef};
pub use keep::Keep;
pub use parting::part;
pub use read::Recording;
pub use recorder::Recorder;
pub use search::search;
