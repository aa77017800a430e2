//! Continuous fields of a bed that flows past its intruder, by coarse-graining, and the load on a cylinder
//! (Guillard 2014, sections III C and IV and appendix A).
//!
//! [`CoarseGraining`] sums samples during a drag; [`plane`](plane::plane) and [`Load`] are the means that follow,
//! [`text`] writes their files and [`read`] reads them again.

pub mod disturbed_zone;
pub mod gauge;
pub mod grid;
pub mod load;
pub mod plane;
pub mod read;
pub mod streamlines;
pub mod sums;
pub mod text;
pub mod window;

pub use gauge::Sampling;
pub use gauge::{CoarseGraining, intruder_outline};
pub use load::Load;
pub use plane::{FieldPoint, Fields, Flag, IntruderOutline};
