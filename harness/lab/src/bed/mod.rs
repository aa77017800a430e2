//! Beds: poured by gravity and settled ([`pour`]), or taken over from a file ([`import`]), and kept
//! for the next run ([`library`]) under the digest of their [`recipe`]. The result is a checkpoint.
//!
//! Pouring is Kumar 2018, section II: grains fall in layers from a loose lattice round the fixed
//! intruder, with random diameters, places and velocities, so that the lattice leaves no trace. When
//! the fall is over the lowest are frozen and all are numbered in spatial order; they keep those
//! numbers from then on. The motion left then, rattling and sound, carries no memory of the
//! pouring and would decay slowly: it is removed with stronger damping, and the bed comes to rest
//! once more under its own law.

mod assemble;
mod course;
mod groups;
pub mod import;
mod intruder;
mod lattice;
pub mod library;
mod lid;
mod make;
mod pouring;
mod proof;
pub mod recipe;
mod settle;
mod survey;
#[cfg(test)]
mod tests;
mod twist;

pub use course::{Phase, Pouring, PouringState};
pub use groups::{BASE, FREE, LID};
pub use proof::prove;
pub use survey::{Measures, energy_of_borne, survey};

use crate::progress::Stage;
use crate::scenario::{BedPlan, CheckedScenario, PACKING_GUESS};
use bitgrain_sim::error::Result;
use bitgrain_sim::simulation::Simulation;

/// Steps from release to rest over those of a fall through twice the bed's height: what beds have
/// taken so far, for forecasts.
const POURING_FALLS: f64 = 3.2;

/// Steps that a lid takes to come to rest over those of a fall through the bed: for forecasts.
const LID_FALLS: f64 = 3.0;

/// About how many steps a bed takes from release to rest: for forecasts, never for results.
pub fn pouring_steps(scenario: &CheckedScenario, plan: &BedPlan) -> u64 {
    let surface = scenario.expected_surface(plan.diameter);
    let fall = (4.0 * surface / scenario.gravity).sqrt();
    (POURING_FALLS * fall / scenario.drag.dt) as u64
}

/// About how many steps a lid takes to come to rest on it.
pub fn covering_steps(scenario: &CheckedScenario, plan: &BedPlan) -> u64 {
    (LID_FALLS * fall_time(scenario, plan) / scenario.drag.dt) as u64
}

/// Time of a fall through the bed.
fn fall_time(scenario: &CheckedScenario, plan: &BedPlan) -> f64 {
    (2.0 * scenario.expected_surface(plan.diameter) / scenario.gravity).sqrt()
}

/// Pours one bed and lets it settle; its lid is not yet on it.
///
/// # Errors
/// As [`Pouring::begin`] and [`Pouring::go_on`].
pub fn pour(scenario: &CheckedScenario, plan: &BedPlan, stage: &mut Stage) -> Result<Simulation> {
    let mut bed = Pouring::begin(scenario, plan)?;
    bed.go_on(scenario, plan, stage, &mut ())?;
    Ok(bed.sim)
}

impl CheckedScenario {
    /// Buoyancy of an intruder of this diameter, at the packing fraction that plans assume.
    fn buoyancy(&self, diameter: f64) -> f64 {
        PACKING_GUESS * self.bed.density * self.gravity * self.intruder_volume(diameter)
    }

    /// What surveys of its beds need to know.
    pub fn measures(&self) -> Measures {
        Measures {
            diameter: self.mean_diameter(),
            density: self.bed.density,
            gravity: self.gravity,
        }
    }
}

impl recipe::Recipe {
    /// What a survey of its bed needs to know.
    pub fn measures(&self) -> Measures {
        Measures {
            diameter: 0.5 * (self.diameters[0] + self.diameters[1]),
            density: self.density,
            gravity: self.gravity,
        }
    }
}
