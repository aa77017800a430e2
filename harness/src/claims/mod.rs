//! What the runs of flowing beds say together, beside what Guillard 2014 says: points over seeds,
//! slopes, plateaus, and statements with verdicts. Everything is a pure function of the summary.

pub mod book;
pub mod evidence;
mod fits;
pub mod guillard;
mod judged;
pub mod kumar;
mod kumar_scaling;
mod points;
pub mod restitution;
mod soundness;
mod statements;
#[cfg(test)]
pub(crate) mod synthetic;

pub use fits::{
    LiftCoefficient, Plateau, SAME_DEPTH, Slope, depths, drag_slope, lift_coefficient, plateau,
};
pub use judged::{FAR_FIELD_LEAST, TRAVEL_LEAST, Verdict};
pub use points::{Group, Point, Spread, Way, groups};
pub use soundness::{OVERLAP_MAX, overlap_remark};
pub use statements::{DRAG_COEFFICIENT_NEAR, Statement, statements};
