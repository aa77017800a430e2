//! What is measured of a settled bed.

use crate::summary::BedSummary;
use bitgrain_kernel::Error as KernelError;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::observe::{self, INTRUDER};
use bitgrain_sim::simulation::{Role, Simulation, hex, sphere_mass};

/// What a survey needs to know besides the state.
#[derive(Clone, Copy, Debug)]
pub struct Measures {
    /// Mean grain diameter.
    pub diameter: f64,
    /// Mass density of the grains.
    pub density: f64,
    /// Acceleration of gravity.
    pub gravity: f64,
}

/// Measures of a settled bed what its summary says.
///
/// # Errors
/// [`bitgrain_sim::error::Error::Contract`].
pub fn survey(name: &str, measures: &Measures, sim: &mut Simulation) -> Result<BedSummary> {
    let digest = sim.digest().map_err(|f| stopped(name, sim, f))?;
    let d = measures.diameter;
    let surface = observe::surface_height(sim, d);
    let contacts = sim.count_contacts();
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
        coordination_number: observe::coordination_number(sim, &contacts, surface - 2.0 * d),
        overlap_max: observe::deepest_overlap(sim, &contacts) / d,
        kinetic_energy_over_weight_d: energy_per_grain(sim, measures),
        weight,
        support,
        chain: String::new(),
        digest: hex(&digest.whole),
        rig: None,
    })
}

pub fn stopped(bed: &str, sim: &Simulation, fault: KernelError) -> Error {
    Error::run(format!("pouring {bed}"), sim.step_count() + 1, fault)
}

/// Kinetic energy of the grains with two contacts or more, per free grain, over a grain's mean weight
/// times its mean diameter: it shows that a bed without weight rests, since a grain that was squeezed
/// out of one flies on.
pub fn energy_of_borne(sim: &mut Simulation, measures: &Measures) -> f64 {
    let contacts = sim.count_contacts().contacts;
    let borne = (0..sim.count()).filter(|&i| contacts[i] > 1);
    let energy = borne.map(|i| sim.kinetic_energy_of(i)).sum::<f64>();
    per_grain(energy, sim, measures)
}

/// Kinetic energy per free grain over a grain's mean weight times its mean diameter.
pub fn energy_per_grain(sim: &Simulation, measures: &Measures) -> f64 {
    per_grain(sim.kinetic_energy(), sim, measures)
}

/// An energy per free grain over the same.
pub fn per_grain(energy: f64, sim: &Simulation, measures: &Measures) -> f64 {
    let free = (0..sim.count())
        .filter(|&i| sim.role(i) == Role::Free)
        .count();
    let free = free.max(1) as f64;
    let weight = sphere_mass(measures.diameter, measures.density) * measures.gravity;
    energy / free / (weight * measures.diameter)
}
