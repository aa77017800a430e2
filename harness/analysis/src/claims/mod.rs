//! What runs say beside the two papers: of flowing beds (Guillard 2014) points over seeds, slopes and plateaus; of both
//! the [`book`] of claims, each with what was measured of it and a verdict.

mod angles;
pub mod book;
pub mod combine;
pub mod evidence;
mod fits;
mod front;
pub mod guillard;
mod judge;
pub mod kumar;
pub mod kumar_curves;
mod kumar_drags;
mod kumar_scaling;
mod lifts;
mod listing;
pub mod load;
mod load_claims;
pub mod means;
pub mod number;
mod pairs;
mod place;
mod points;
pub mod restitution;
mod shape;
#[cfg(test)]
pub(crate) mod synthetic;
#[cfg(test)]
mod synthetic_load;
pub(crate) mod tank;
mod verdict;
mod wake;

pub use fits::{
    LiftCoefficient, Plateau, SAME_DEPTH, Slope, depths, drag_slope, drag_slope_by_weight,
    lift_coefficient, plateau, same_depth,
};
pub use listing::{lines, table};
pub use number::Combine;
pub use place::Place;
pub use points::{FAR_FIELD_LEAST, Group, Point, Spread, TRAVEL_LEAST, Way, groups};
pub use verdict::Verdict;
