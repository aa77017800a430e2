//! What runs say of intruders that forces moved: spheres that were dropped, pulled by a constant force, or dragged and
//! free to rise.
//!
//! Pure functions of a summary and its force series. Every fit says how good it is or why there is none.

pub mod float;
pub mod impact;
pub mod pull;
mod runs;
mod text;

pub use runs::{FreeRun, free_runs};
pub use text::text;
