//! What a world consists of: grains and their groups, the box, obstacles and how they move.

pub(crate) mod domain;
pub(crate) mod drive;
pub(crate) mod facet;
pub(crate) mod grains;
pub(crate) mod losses;
pub(crate) mod mesh;
pub(crate) mod motion;
pub(crate) mod obstacle;
pub(crate) mod obstacle_check;
pub(crate) mod owned;
pub(crate) mod rigid_body;
pub(crate) mod shape;
pub(crate) mod solid;
pub(crate) mod turning;
