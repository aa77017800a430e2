//! Numbers, vectors and rows of four words.

#[cfg(feature = "fixed")]
pub mod fixed_point;
pub(crate) mod real;
pub(crate) mod rows;
#[cfg(feature = "fixed")]
pub mod scaling;
pub mod vec3;
