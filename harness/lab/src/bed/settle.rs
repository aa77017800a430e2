//! Rest: when the fall is over, how the motion left is removed, and when a bed counts as settled.

use bitgrain_kernel::Error as KernelError;

use super::course::Pouring;
use super::survey::{energy_of_borne, energy_per_grain, per_grain, stopped};
use super::twist;
use crate::progress::Stage;
use crate::scenario::{BedPlan, CheckedScenario, IntruderShape};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::motion::Moves;
use bitgrain_sim::observe::{INTRUDER, weight_and_support};
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;

/// Steps between looks at the kinetic energy. Part of the recipe: it decides where settling ends.
const LOOK: u64 = 500;

/// Steps between looks at the kinetic energy when maxima are searched for: a small part of the period
/// with which a bed of some tens of grains breathes.
const GLANCE: u64 = 50;

/// A settled bed is carried by its base, planes and intruder to this fraction of its weight.
const CARRIED: f64 = 5e-4;

/// Kinetic energy per free grain, over its weight times its diameter, below which the fall is over:
/// what still moves rattles in its place.
const FALLEN: f64 = 1e-3;

/// Change of the vertical force on the intruder between two looks, over its buoyancy, below which a bed
/// under its lid is at rest: the intruder carries what settles round it.
const STEADY: f64 = 0.1;

/// Longest settling, in units of the time a grain takes to fall from the top of the lattice.
const PATIENCE: f64 = 60.0;

/// Part of the longest settling after which twist is stopped if nothing else moves: by then a bed has come to rest that
/// comes to rest by itself.
const TWISTED: f64 = 0.1;

/// Where a settling ends.
pub struct Goal {
    /// Kinetic energy per free grain over its weight times its diameter.
    energy: f64,
    /// Whether the weight must be carried too.
    carried: bool,
    /// Change of the upward force on the intruder between two looks, over its buoyancy.
    steady: Option<f64>,
    /// Whether only grains that bear a load count: without weight, one that was squeezed out flies on.
    borne: bool,
    /// Whether all motion is stopped each time the kinetic energy begins to fall.
    kinetic_damping: bool,
    /// Fewest steps.
    least: u64,
    /// Steps of the fall, on which the limit of steps is based.
    fall_steps: u64,
}

/// The goal of the last two phases, under more damping and then under the bed's own law.
///
/// Contacts hardly damp the breathing of a bed that is high or bears a lid, and nothing damps a ball that
/// spins on a point. There, under more damping, all grains are stopped each time the kinetic energy passes
/// a maximum, where a mode of oscillation is at its equilibrium: the kinetic damping of dynamic relaxation
/// (Cundall 1976).
pub fn rest(scenario: &CheckedScenario, plan: &BedPlan, quench: bool) -> Goal {
    let lattice_fall = scenario.expected_surface(plan.diameter);
    let sphere = scenario.intruder.shape == IntruderShape::Sphere;
    Goal {
        energy: scenario.bed.settled,
        carried: true,
        steady: (!sphere || plan.lid.is_some()).then_some(STEADY),
        borne: plan.lid.is_some_and(|lid| !lid.pressure_gradient),
        kinetic_damping: quench && is_damped(scenario, plan),
        least: 2 * LOOK,
        fall_steps: steps_of_fall(scenario, lattice_fall),
    }
}

/// Whether all motion is stopped at maxima of the kinetic energy. It depends only on what the recipe of the bed
/// holds: other scenarios use the bare bed under a lid without one.
fn is_damped(scenario: &CheckedScenario, plan: &BedPlan) -> bool {
    let still =
        scenario.intruder.shape == IntruderShape::Sphere && scenario.drag.moves == Moves::Intruder;
    scenario
        .bed
        .kinetic_damping
        .unwrap_or(!still || plan.lid.is_some())
}

fn steps_of_fall(scenario: &CheckedScenario, height: f64) -> u64 {
    ((2.0 * height / scenario.gravity).sqrt() / scenario.drag.dt) as u64
}

/// The fall from this height is over.
pub fn fallen(scenario: &CheckedScenario, height: f64) -> Goal {
    let settled = scenario.bed.settled;
    let fall_steps = steps_of_fall(scenario, height);
    Goal {
        energy: if settled > FALLEN { settled } else { FALLEN },
        carried: false,
        steady: None,
        borne: false,
        kinetic_damping: false,
        // Nothing can be settled before the highest grain has fallen.
        least: fall_steps,
        fall_steps,
    }
}

/// Steps on until the goal is reached. Returns whether it was: `false` if `observer` has seen enough before.
///
/// # Errors
/// [`Error::Run`], [`Error::Unsettled`], [`Error::Interrupted`], and what `observer` returns.
pub fn settle(
    bed: &mut Pouring,
    scenario: &CheckedScenario,
    plan: &BedPlan,
    goal: &Goal,
    stage: &mut Stage,
    observer: &mut impl Observer,
) -> Result<bool> {
    let patience = (PATIENCE * goal.fall_steps as f64) as u64 + 100 * LOOK;
    let twisted = (TWISTED * patience as f64) as u64;
    let buoyancy = scenario.buoyancy(plan.diameter);
    loop {
        if bed.sim.step_count() >= observer.last_step() {
            return Ok(false);
        }
        let sim = &mut bed.sim;
        if goal.kinetic_damping {
            halt_at_maxima(sim, &plan.name, observer)?;
        } else {
            stride(sim, &plan.name, LOOK, observer, |_| Ok(()))?;
        }
        let energy = if goal.borne {
            energy_of_borne(sim, &scenario.measures())
        } else {
            energy_per_grain(sim, &scenario.measures())
        };
        let (_, weight, support) = weight_and_support(sim);
        // A bed that still breathes carries more or less than its weight.
        let carried = (support - weight).abs() <= CARRIED * weight;
        let change = (upward(sim) - bed.course.before).abs();
        bed.course.before = upward(sim);
        let steady = goal.steady.is_none_or(|bound| change < bound * buoyancy);
        let quiet = |energy: f64| energy < goal.energy && (carried || !goal.carried) && steady;
        let step = sim.step_count();
        let age = step - bed.course.begin;
        if quiet(energy) && age >= goal.least {
            return Ok(true);
        }
        if age > patience {
            return Err(Error::Unsettled {
                bed: plan.name.clone(),
                step,
                energy,
                bound: goal.energy,
                carried: support / weight,
            });
        }
        let rolls = scenario.law.rolling().is_some() && !goal.borne;
        if age > twisted && rolls && !quiet(energy) {
            let twists = twist::twists(sim);
            let left = sim.kinetic_energy() - twist::energy(sim, &twists);
            if quiet(per_grain(left, sim, &scenario.measures())) {
                twist::stop(sim, &twists).map_err(|f| stopped(&plan.name, sim, f))?;
            }
        }
        bed.looked(plan, observer)?;
        let share = support / weight;
        stage.settling(
            &bed.sim,
            energy,
            scenario.bed.settled,
            share,
            goal.fall_steps,
        )?;
    }
}

/// Upward force on the intruder, or on the floor of a bed that is poured up to it.
pub(super) fn upward(sim: &Simulation) -> f64 {
    sim.obstacles[INTRUDER as usize].force[2]
}

/// Steps on, showing `observer` the steps that it looks at; `last` is done to the state after the last of
/// them, before it is shown, and says what is wrong with the result.
fn stride(
    sim: &mut Simulation,
    bed: &str,
    steps: u64,
    observer: &mut impl Observer,
    last: impl FnOnce(&mut Simulation) -> std::result::Result<(), KernelError>,
) -> Result<()> {
    let end = sim.step_count() + steps;
    let mut last = Some(last);
    let mut seen = Vec::new();
    while sim.step_count() < end {
        let now = sim.step_count();
        let wanted = (now + 1..=end).find(|&n| observer.wants_step(n));
        let shows = wanted.is_some_and(|n| observer.wants_contacts(n));
        let quiet = wanted.unwrap_or(end) - u64::from(shows);
        sim.steps(quiet - now).map_err(|f| stopped(bed, sim, f))?;
        seen.clear();
        if shows {
            sim.step_seen(&mut seen).map_err(|f| stopped(bed, sim, f))?;
        }
        if sim.step_count() == end
            && let Some(last) = last.take()
        {
            last(sim).map_err(|f| stopped(bed, sim, f))?;
        }
        if let Some(n) = wanted {
            observer.on_step(n, sim, &seen)?;
        }
    }
    Ok(())
}

/// Steps on to the next look; stops every grain if the kinetic energy has just begun to fall.
fn halt_at_maxima(sim: &mut Simulation, bed: &str, observer: &mut impl Observer) -> Result<()> {
    let mut before = sim.kinetic_energy();
    let mut rising = false;
    for _ in 0..LOOK / GLANCE {
        stride(sim, bed, GLANCE, observer, |sim| {
            let energy = sim.kinetic_energy();
            if rising && energy < before {
                (before, rising) = (0.0, true);
                return halt(sim);
            }
            rising = energy > before;
            before = energy;
            Ok(())
        })?;
    }
    Ok(())
}

/// Stops every grain in its place, with its contacts and forces.
fn halt(sim: &mut Simulation) -> std::result::Result<(), KernelError> {
    let histories = sim.contact_histories();
    let world = &mut **sim;
    for row in world.velocity.iter_mut().chain(&mut world.spin) {
        *row = [0.0, 0.0, 0.0, row[3]];
    }
    sim.resume(&histories)
}

#[cfg(test)]
mod tests {
    use bitgrain_kernel::{Domain, Group, Obstacle};

    use super::*;
    use crate::bed::survey::Measures;
    use bitgrain_sim::law::{HertzTsujiParameters, LawSpec};
    use bitgrain_sim::simulation::Grain;

    const D: f64 = 1.5e-3;

    /// Grains at these places along x and z over a floor, which lose nothing in a contact.
    fn bouncing(places: &[[f64; 2]]) -> Simulation {
        let law = LawSpec::HertzTsuji(HertzTsujiParameters {
            young: 5e6,
            poisson: 0.45,
            restitution: 1.0,
            mu: 0.5,
            rolling: None,
        });
        let grain = |(k, &[x, z]): (usize, &[f64; 2])| Grain {
            id: k as u32 + 1,
            group: 0,
            diameter: D,
            density: 2500.0,
            position: [x, 0.005, z],
            velocity: [0.0; 3],
            spin: [0.0; 3],
        };
        let grains: Vec<Grain> = places.iter().enumerate().map(grain).collect();
        let domain = Domain::new([0.0; 3], [0.03, 0.01, 0.03], [true, true, false]).unwrap();
        let groups = vec![Group::free([0.0, 0.0, -9.81])];
        let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
        let mut sim = Simulation::new(
            law.build().unwrap(),
            domain,
            1e-6,
            groups,
            &grains,
            vec![floor],
        );
        sim.start().unwrap();
        sim
    }

    fn fastest(sim: &mut Simulation) -> f64 {
        let mut most = 0.0;
        for _ in 0..40 {
            sim.steps(50).unwrap();
            let energy = sim.kinetic_energy();
            most = if energy > most { energy } else { most };
        }
        most
    }

    /// A grain that breathes on the floor, undamped, goes on as it is; stopped at maxima it comes to rest.
    #[test]
    fn stopping_at_maxima_takes_an_oscillation_out() {
        // A quarter of the overlap under its weight: half its period is some 600 steps.
        let mut sim = bouncing(&[[0.01, 0.5 * D - 1.3e-7]]);
        let begin = fastest(&mut sim.clone());
        let mut free = sim.clone();
        free.steps(10 * LOOK).unwrap();
        // Seen every 50 steps, a maximum is found to a part in fifty.
        assert!((fastest(&mut free) / begin - 1.0).abs() < 0.02);
        for _ in 0..10 {
            halt_at_maxima(&mut sim, "bed", &mut ()).unwrap();
        }
        assert_eq!(sim.step_count(), 10 * LOOK);
        let left = fastest(&mut sim) / begin;
        assert!(left < 0.02, "{left}");
    }

    /// A grain with two contacts bears a load; one that rolls alone or flies does not, and counts among all only.
    #[test]
    fn who_flies_bears_nothing() {
        let measures = Measures {
            diameter: D,
            density: 2500.0,
            gravity: 9.81,
        };
        let low = 0.5 * D - 5e-7;
        let pair = [[0.01, low], [0.01 + D - 1e-7, low]];
        let mut sim = bouncing(&[pair[0], pair[1], [0.02, low], [0.02, 10.0 * D]]);
        let speeds = [0.1, 0.0, 0.2, 0.3];
        for (k, speed) in speeds.into_iter().enumerate() {
            sim.velocity[k][1] = speed;
        }
        // Half the square of the speed over g d, a mean over the four.
        let share = |speed: f64| 0.5 * speed * speed / (9.81 * D) / 4.0;
        let whole = speeds.into_iter().map(share).sum::<f64>();
        let all = energy_per_grain(&sim, &measures);
        assert!((all / whole - 1.0).abs() < 1e-12, "{all}");
        let borne = energy_of_borne(&mut sim, &measures);
        assert!((borne / share(0.1) - 1.0).abs() < 1e-12, "{borne}");
    }
}
