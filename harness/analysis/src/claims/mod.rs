//! What runs say beside the two papers. Of flowing beds (Guillard 2014): points over seeds, slopes, plateaus,
//! and [`statements`] with verdicts, a pure function of the summary. Of both papers: the [`book`] of claims.

pub mod book;
pub mod evidence;
mod fits;
pub mod guillard;
mod judged;
pub mod kumar;
pub mod kumar_curves;
mod kumar_scaling;
pub mod load;
mod load_claims;
mod points;
pub mod restitution;
mod soundness;
mod statements;
#[cfg(test)]
pub(crate) mod synthetic;
mod verdict;

pub use fits::{
    LiftCoefficient, Plateau, SAME_DEPTH, Slope, depths, drag_slope, lift_coefficient, plateau,
    same_depth,
};
pub use judged::{FAR_FIELD_LEAST, TRAVEL_LEAST};
pub use points::{Group, Point, Spread, Way, groups};
pub use soundness::{OVERLAP_MAX, overlap_remark};
pub use statements::{DRAG_COEFFICIENT_NEAR, statements};
pub use verdict::{Statement, Verdict};
