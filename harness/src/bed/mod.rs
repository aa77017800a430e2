//! Beds: poured by gravity and settled ([`pour`]), or taken over from a file ([`import`]), and kept
//! for the next run ([`library`]) under the digest of their [`recipe`]. What comes out is a checkpoint.
//!
//! Pouring is Kumar 2018, section II: grains fall in layers from a loose lattice round the fixed
//! intruder, with random diameters, places and velocities, so that the lattice leaves no trace. When
//! the fall is over the lowest are frozen and all are numbered in spatial order; they keep those
//! numbers from then on. What motion is left then, rattling and sound, carries no memory of the
//! pouring and would die slowly: it is taken out with stronger damping, and the bed comes to rest
//! once more under its own law.

mod assemble;
mod course;
pub mod import;
mod lattice;
pub mod library;
mod lid;
mod pouring;
mod proof;
pub mod recipe;
mod settle;
mod survey;
#[cfg(test)]
mod tests;

pub use course::{Course, Phase, Pouring};
pub use proof::prove;
pub use survey::{Measures, energy_of_borne, survey};

use bitgrain_kernel::{Domain, Fault, Group, Obstacle, Shape as Body};

use crate::error::{Error, Result};
use crate::motion::Moves;
use crate::observe;
use crate::order::spatial_order;
use crate::progress::Stage;
use crate::scenario::{BedPlan, PACKING_GUESS, Pouring as Order, Scenario, Shape};
use crate::sim::{Sim, sphere_mass};
use assemble::{Member, assemble};
use lattice::Lattice;

/// Group of the grains that move.
pub const FREE: u8 = 0;
/// Group of the base: frozen, or carried where the bed moves.
pub const BASE: u8 = 1;
/// Group of the lid.
pub const LID: u8 = 2;

/// Steps from release to rest over those of a fall through twice the bed's height: what beds have
/// taken so far, for forecasts.
const POURING_FALLS: f64 = 3.2;

/// Steps that a lid takes to come to rest over those of a fall through the bed: for forecasts.
const LID_FALLS: f64 = 3.0;

/// About how many steps a bed takes from release to rest: for forecasts, never for results.
pub fn pouring_steps(scenario: &Scenario, plan: &BedPlan) -> u64 {
    let surface = scenario.expected_surface(plan.diameter);
    let fall = (4.0 * surface / scenario.gravity).sqrt();
    (POURING_FALLS * fall / scenario.drag.dt) as u64
}

/// About how many steps a lid takes to come to rest on it.
pub fn covering_steps(scenario: &Scenario, plan: &BedPlan) -> u64 {
    (LID_FALLS * fall_time(scenario, plan) / scenario.drag.dt) as u64
}

/// Time of a fall through the bed.
fn fall_time(scenario: &Scenario, plan: &BedPlan) -> f64 {
    (2.0 * scenario.expected_surface(plan.diameter) / scenario.gravity).sqrt()
}

/// Pours one bed and lets it settle; its lid is not yet on it.
///
/// # Errors
/// As [`Pouring::begin`] and [`Pouring::go_on`].
pub fn pour(scenario: &Scenario, plan: &BedPlan, stage: &mut Stage) -> Result<Sim> {
    let mut bed = Pouring::begin(scenario, plan)?;
    bed.go_on(scenario, plan, stage, &mut ())?;
    Ok(bed.sim)
}

/// Freezes the grains whose centres lie below the base's height, takes the floor away where the bed
/// has none, and numbers all grains in spatial order.
fn freeze_base(old: &mut Sim, scenario: &Scenario) -> std::result::Result<Sim, Fault> {
    let group = |k: usize| {
        if old.position[k][2] < scenario.bed.base {
            BASE
        } else {
            FREE
        }
    };
    let members = in_order(old)
        .map(|k| Member::Old(k, group(k)))
        .collect::<Vec<_>>();
    let mut obstacles: Vec<_> = old.obstacles.iter().copied().zip((0..).map(Some)).collect();
    if !scenario.bed.floor {
        obstacles.retain(|(body, _)| !matches!(body.shape, Body::Plane { .. }));
    }
    let groups = old.groups.clone();
    assemble(old, &members, groups, obstacles)
}

/// Numbers all grains in spatial order.
fn renumbered(old: &mut Sim) -> std::result::Result<Sim, Fault> {
    let members: Vec<Member> = in_order(old)
        .map(|k| Member::Old(k, old.group[k]))
        .collect();
    let obstacles = old.obstacles.iter().copied().zip((0..).map(Some)).collect();
    let groups = old.groups.clone();
    assemble(old, &members, groups, obstacles)
}

/// The grains in spatial order.
fn in_order(sim: &Sim) -> impl Iterator<Item = usize> + use<> {
    let mean = 2.0 * sim.position.iter().map(|x| x[3]).sum::<f64>() / sim.count().max(1) as f64;
    spatial_order(&sim.position, mean).into_iter()
}

/// Puts the intruder into a bed that reaches up to it, and lets the rest of the grains go above; those
/// whose place it takes are among them. Returns the height they fall from, too.
fn buried(
    lower: &mut Sim,
    scenario: &Scenario,
    plan: &BedPlan,
    count: usize,
) -> std::result::Result<(Sim, f64), Fault> {
    let body = intruder(scenario, plan);
    let clear = |k: usize| {
        let x = lower.position[k];
        let off = observe::offset(&lower.domain, &body, [x[0], x[1], x[2]]);
        observe::length(off) > body.reach() + x[3]
    };
    let mut members: Vec<Member> = (0..lower.count())
        .filter(|&k| clear(k))
        .map(|k| Member::Old(k, lower.group[k]))
        .collect();
    let top = lower.position.iter().map(|x| x[2] + x[3]);
    let top = top.fold(0.0, |a, b| if b > a { b } else { a });
    let rest = Lattice::new(scenario, count - members.len(), top, Some(plan));
    let first = lower.count() as u32;
    members.extend(
        rest.grains(scenario, plan, first)
            .into_iter()
            .map(Member::New),
    );
    let mut obstacles = vec![(body, None)];
    obstacles.extend(lower.obstacles.iter().copied().zip((0..).map(Some)));
    let groups = lower.groups.clone();
    Ok((assemble(lower, &members, groups, obstacles)?, rest.top))
}

/// The intruder of a plan, at rest.
fn intruder(scenario: &Scenario, plan: &BedPlan) -> Obstacle<f64> {
    let radius = 0.5 * plan.diameter;
    match scenario.intruder.shape {
        Shape::Cylinder => Obstacle::cylinder(plan.center, [0.0, 1.0, 0.0], radius),
        Shape::Sphere => Obstacle {
            inverse_mass: scenario
                .intruder
                .density
                .map_or(0.0, |density| 1.0 / sphere_mass(plan.diameter, density)),
            ..Obstacle::sphere(plan.center, radius)
        },
    }
}

/// The grains of a lattice as a world: with the intruder where all are poured at once.
fn dropped(scenario: &Scenario, plan: &BedPlan, lattice: &Lattice) -> Result<Sim> {
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
    let mut obstacles = match scenario.bed.pouring {
        Order::AtOnce => vec![intruder(scenario, plan)],
        Order::InTurn => vec![],
    };
    // Without a floor of its own the bed is poured on one all the same: the base is frozen from it.
    obstacles.push(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]));
    let base = match scenario.drag.moves {
        Moves::Intruder => Group::frozen(),
        Moves::Bed => Group::carried(),
    };
    let groups = vec![Group::free(gravity), base];
    let grains = lattice.grains(scenario, plan, 0);
    Ok(Sim::new(
        law,
        domain,
        scenario.drag.dt,
        groups,
        &grains,
        obstacles,
    ))
}

impl Scenario {
    /// Buoyancy of an intruder of this diameter, at the packing fraction that plans assume.
    fn buoyancy(&self, diameter: f64) -> f64 {
        PACKING_GUESS * self.bed.density * self.gravity * self.intruder_volume(diameter)
    }

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
