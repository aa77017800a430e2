//! Beds: poured by gravity and settled ([`pour`]), or taken over from a file ([`import`]), and kept
//! for the next run ([`library`]) under the digest of their [`recipe`]. What comes out is a checkpoint.
//!
//! Pouring is Kumar 2018, section II: grains fall in layers from a loose lattice round the fixed
//! intruder, with random diameters, places and velocities, so that the lattice leaves no trace. When
//! the fall is over the lowest are frozen and all are numbered in spatial order; they keep those
//! numbers from then on. What motion is left then, rattling and sound, carries no memory of the
//! pouring and would die slowly: it is taken out with stronger damping, and the bed comes to rest
//! once more under its own law.

mod base;
pub mod import;
mod lattice;
pub mod library;
pub mod recipe;
mod survey;

pub use survey::{Measures, survey};

use bitgrain_kernel::{Domain, Fault, Group, Obstacle};

use crate::error::{Error, Result};
use crate::observe::{INTRUDER, weight_and_support};
use crate::progress::Stage;
use crate::scenario::{BedPlan, Scenario};
use crate::sim::{Grain, Sim, sphere_mass};
use base::freeze_base;
use lattice::Lattice;

/// Group of the grains that move.
pub const FREE: u8 = 0;
/// Group of the base.
pub const FROZEN: u8 = 1;

/// Steps between looks at the kinetic energy. Part of the recipe: it decides where settling ends.
const LOOK: u64 = 500;

/// A settled bed is carried by its base, planes and intruder to this fraction of its weight.
const CARRIED: f64 = 5e-4;

/// Kinetic energy per free grain, over its weight times its diameter, below which the fall is over:
/// what still moves rattles in its place.
const FALLEN: f64 = 1e-3;

/// Steps from release to rest over those of a fall through twice the bed's height: what beds have
/// taken so far, for forecasts.
const POURING_FALLS: f64 = 3.2;

/// About how many steps a bed takes from release to rest: for forecasts, never for results.
pub fn pouring_steps(scenario: &Scenario) -> u64 {
    let fall = (4.0 * scenario.expected_surface() / scenario.gravity).sqrt();
    (POURING_FALLS * fall / scenario.drag.dt) as u64
}

/// Longest settling, in units of the time a grain takes to fall from the top of the lattice.
const PATIENCE: f64 = 60.0;

/// Pours one bed and lets it settle.
///
/// # Errors
/// [`Error::Run`] where grains escape, overlap too deep or do not come to rest in time;
/// [`Error::Interrupted`].
pub fn pour(scenario: &Scenario, plan: &BedPlan, stage: &mut Stage) -> Result<Sim> {
    let lattice = Lattice::new(scenario, plan);
    let grains = lattice.grains(scenario);
    let mut sim = poured(scenario, plan, &lattice, &grains)?;
    sim.start().map_err(|f| stopped(&plan.name, &sim, f))?;
    let fall = (2.0 * lattice.top / scenario.gravity).sqrt();
    let fall_steps = (fall / scenario.drag.dt) as u64;
    let settled = scenario.bed.settled;
    let mut goal = Goal {
        energy: if settled > FALLEN { settled } else { FALLEN },
        carried: false,
        // Nothing can be settled before the highest grain has fallen.
        least: fall_steps,
        fall_steps,
    };
    settle(&mut sim, scenario, plan, &goal, stage)?;
    let mut sim = freeze_base(&mut sim, &scenario.bed).map_err(|f| stopped(&plan.name, &sim, f))?;
    let law = sim.law;
    sim.law = scenario
        .law
        .quenching(scenario.drag.dt, scenario.mean_diameter());
    goal = Goal {
        energy: settled,
        carried: true,
        least: 2 * LOOK,
        fall_steps,
    };
    settle(&mut sim, scenario, plan, &goal, stage)?;
    sim.law = law;
    settle(&mut sim, scenario, plan, &goal, stage)?;
    Ok(sim)
}

/// Where a settling ends.
struct Goal {
    /// Kinetic energy per free grain over its weight times its diameter.
    energy: f64,
    /// Whether the weight must be carried too.
    carried: bool,
    /// Fewest steps.
    least: u64,
    /// Steps of the fall, by which patience is measured.
    fall_steps: u64,
}

fn stopped(bed: &str, sim: &Sim, fault: Fault) -> Error {
    Error::run(format!("pouring {bed}"), sim.step_count() + 1, fault)
}

fn poured(scenario: &Scenario, plan: &BedPlan, lattice: &Lattice, grains: &[Grain]) -> Result<Sim> {
    let [x, y, z] = scenario.bed.size;
    let refuse = |what: String| Error::input(format!("scenario {}", scenario.name), what);
    let law = scenario
        .law
        .build()
        .map_err(|(key, p)| refuse(format!("law.{key} {p}")))?;
    // Grains thrown up by a fast intruder fall back; only one that leaves this far is an error.
    let ceiling = 2.0 * (if lattice.top > z { lattice.top } else { z });
    let floor = if scenario.bed.floor {
        0.0
    } else {
        -scenario.bed.diameters[1]
    };
    let lowest = floor - scenario.bed.diameters[1];
    let domain = Domain::new([0.0, 0.0, lowest], [x, y, ceiling], [true, true, false])
        .map_err(|f| refuse(f.to_string()))?;
    let gravity = [0.0, 0.0, -scenario.gravity];
    let radius = 0.5 * scenario.intruder.diameter;
    let mass = sphere_mass(scenario.intruder.diameter, scenario.intruder.density);
    let mut obstacles = vec![Obstacle {
        inverse_mass: 1.0 / mass,
        ..Obstacle::sphere(plan.center, radius)
    }];
    debug_assert_eq!(INTRUDER, 0);
    // Without a floor of its own the bed is poured on one all the same: the base is frozen from it.
    obstacles.push(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]));
    let groups = vec![Group::free(gravity), Group::frozen()];
    Ok(Sim::new(
        law,
        domain,
        scenario.drag.dt,
        groups,
        grains,
        obstacles,
    ))
}

/// Steps on until the goal is reached.
fn settle(
    sim: &mut Sim,
    scenario: &Scenario,
    plan: &BedPlan,
    goal: &Goal,
    stage: &mut Stage,
) -> Result<()> {
    let begin = sim.step_count();
    let limit = begin + (PATIENCE * goal.fall_steps as f64) as u64 + 100 * LOOK;
    loop {
        sim.steps(LOOK).map_err(|f| stopped(&plan.name, sim, f))?;
        let energy = energy_per_grain(sim, &scenario.measures());
        let (_, weight, support) = weight_and_support(sim, scenario.gravity);
        // A bed that still breathes carries more or less than its weight.
        let carried = (support - weight).abs() <= CARRIED * weight;
        let quiet = energy < goal.energy && (carried || !goal.carried);
        stage.settling(
            sim,
            energy,
            scenario.bed.settled,
            support / weight,
            goal.fall_steps,
        )?;
        if quiet && sim.step_count() - begin >= goal.least {
            return Ok(());
        }
        if sim.step_count() > limit {
            return Err(Error::Unsettled {
                bed: plan.name.clone(),
                step: sim.step_count(),
                energy,
                bound: goal.energy,
                carried: support / weight,
            });
        }
    }
}

/// Kinetic energy per free grain over a grain's mean weight times its mean diameter.
pub fn energy_per_grain(sim: &Sim, measures: &Measures) -> f64 {
    let free = sim.group.iter().filter(|&&g| g == FREE).count().max(1) as f64;
    let weight = sphere_mass(measures.diameter, measures.density) * measures.gravity;
    sim.kinetic_energy() / free / (weight * measures.diameter)
}

impl Scenario {
    /// What surveys of its beds must know.
    pub fn measures(&self) -> Measures {
        Measures {
            diameter: self.mean_diameter(),
            density: self.bed.density,
            gravity: self.gravity,
        }
    }
}

impl recipe::Recipe {
    /// What a survey of its bed must know.
    pub fn measures(&self) -> Measures {
        Measures {
            diameter: 0.5 * (self.diameters[0] + self.diameters[1]),
            density: self.density,
            gravity: self.gravity,
        }
    }
}
