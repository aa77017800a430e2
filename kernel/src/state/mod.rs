//! What a world consists of: grains and their groups, the box, obstacles.

pub(crate) mod domain;
pub(crate) mod grains;
pub(crate) mod losses;
pub(crate) mod obstacle;
pub(crate) mod owned;
