//! Numbers, vectors and rows of four words.

pub(crate) mod real;
pub(crate) mod rows;
pub mod vec3;
