//! What is read off a settled bed.

use super::settle::{energy_per_grain, stopped};
use crate::error::Result;
use crate::observe::{self, INTRUDER};
use crate::sim::{Role, Sim, hex};
use crate::summary::BedSummary;

/// What a survey must know besides the state.
#[derive(Clone, Copy, Debug)]
pub struct Measures {
    /// Mean grain diameter.
    pub diameter: f64,
    /// Mass density of the grains.
    pub density: f64,
    /// Acceleration of gravity.
    pub gravity: f64,
}

/// Reads off a settled bed what its summary says.
///
/// # Errors
/// [`crate::error::Error::Contract`].
pub fn survey(name: &str, measures: &Measures, sim: &mut Sim) -> Result<BedSummary> {
    let digest = sim.digest().map_err(|f| stopped(name, sim, f))?;
    let d = measures.diameter;
    let surface = observe::surface_height(sim, d);
    let body = &sim.obstacles[INTRUDER as usize];
    let center = body.point;
    let (_, weight, support) = observe::weight_and_support(sim);
    let base = (0..sim.count()).filter(|&i| sim.role(i) == Role::Base);
    Ok(BedSummary {
        name: name.to_string(),
        grains: sim.count(),
        frozen: base.count(),
        steps: sim.step_count(),
        surface,
        depth: surface - center[2],
        packing_fraction: observe::packing_fraction(sim, d, surface - 2.0 * d),
        coordination_number: observe::coordination_number(sim, surface - 2.0 * d),
        overlap_max: observe::deepest_overlap(sim) / d,
        kinetic_energy_over_weight_d: energy_per_grain(sim, measures),
        weight,
        support,
        chain: String::new(),
        digest: hex(&digest.whole),
        rig: None,
    })
}
