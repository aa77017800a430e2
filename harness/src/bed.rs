//! Pouring a bed: grains fall from a loose lattice round the fixed intruder, settle, the lowest are
//! frozen, and the rest settles again. What comes out is a checkpoint.
//!
//! Kumar 2018, section II. The grains are let go with random diameters, places and velocities, so
//! that the lattice leaves no trace; they are numbered in spatial order when the base is frozen and
//! keep those numbers from then on.

use bitgrain_kernel::{Bond, Domain, Fault, Group, Obstacle};

use crate::error::{Error, Result};
use crate::observe::{INTRUDER, weight_and_support};
use crate::order::spatial_order;
use crate::progress::Stage;
use crate::random::{Purpose, uniforms};
use crate::scenario::{Bed, BedPlan, Scenario};
use crate::sim::{Grain, Sim, sphere_mass};

/// Group of the grains that move.
pub const FREE: u8 = 0;
/// Group of the base.
pub const FROZEN: u8 = 1;

/// Steps between looks at the kinetic energy. Part of the recipe: it decides where settling ends.
const LOOK: u64 = 500;

/// A settled bed is carried by its base, planes and intruder to this fraction of its weight.
const CARRIED: f64 = 5e-4;

/// Longest settling, in units of the time a grain takes to fall from the top of the lattice.
const PATIENCE: f64 = 60.0;

/// Pours one bed and lets it settle.
///
/// # Errors
/// [`Error::Run`] where grains escape, overlap too deep or do not come to rest in time.
pub fn pour(scenario: &Scenario, plan: &BedPlan, stage: &mut Stage) -> Result<Sim> {
    let lattice = Lattice::new(scenario, plan);
    let grains = lattice.grains(scenario);
    let mut sim = poured(scenario, plan, &lattice, &grains)?;
    sim.start().map_err(|f| stopped(&plan.name, &sim, f))?;
    let fall = (2.0 * lattice.top / scenario.gravity).sqrt();
    let fall_steps = (fall / scenario.drag.dt) as u64;
    // Nothing can be settled before the highest grain has fallen.
    settle(&mut sim, scenario, plan, fall_steps, fall_steps, stage)?;
    let mut sim = freeze_base(&mut sim, &scenario.bed).map_err(|f| stopped(&plan.name, &sim, f))?;
    settle(&mut sim, scenario, plan, 2 * LOOK, fall_steps, stage)?;
    Ok(sim)
}

fn stopped(bed: &str, sim: &Sim, fault: Fault) -> Error {
    Error::run(format!("pouring {bed}"), sim.step_count() + 1, fault)
}

/// Sites far enough apart for the largest grains, round the intruder, filled from below.
struct Lattice {
    sites: Vec<[f64; 3]>,
    spacing: [f64; 3],
    top: f64,
}

impl Lattice {
    fn new(scenario: &Scenario, plan: &BedPlan) -> Self {
        let [x, y, _] = scenario.bed.size;
        let most = scenario.bed.diameters[1];
        let fit = |length: f64| (length / (1.15 * most)).floor().max(1.0);
        let (nx, ny) = (fit(x), fit(y));
        let spacing = [x / nx, y / ny, 1.15 * most];
        let least = scenario.bed.diameters[0];
        let shift = spacing.map(|s| 0.5 * (s - least));
        let clear = 0.5 * (scenario.intruder.diameter + most) + length(shift);
        let domain = Domain::new([0.0; 3], [x, y, 1.0], [true, true, false]);
        let domain = domain.expect("the scenario was checked");
        let mut sites = Vec::with_capacity(scenario.grain_count());
        let mut layer = 0;
        while sites.len() < scenario.grain_count() {
            let z = (f64::from(layer) + 0.5) * spacing[2];
            for iy in 0..ny as usize {
                if sites.len() == scenario.grain_count() {
                    break;
                }
                for ix in 0..nx as usize {
                    let at = [
                        (ix as f64 + 0.5) * spacing[0],
                        (iy as f64 + 0.5) * spacing[1],
                        z,
                    ];
                    let d = domain.separation(at, plan.center);
                    if length(d) > clear && sites.len() < scenario.grain_count() {
                        sites.push(at);
                    }
                }
            }
            layer += 1;
        }
        Self {
            sites,
            spacing,
            top: f64::from(layer) * spacing[2],
        }
    }

    fn grains(&self, scenario: &Scenario) -> Vec<Grain> {
        let [least, most] = scenario.bed.diameters;
        let speed = (scenario.gravity * scenario.mean_diameter()).sqrt();
        let seed = scenario.seed;
        let place = |(k, site): (usize, &[f64; 3])| {
            let id = k as u32 + 1;
            let [u] = uniforms(seed, Purpose::Diameter, id);
            let diameter = least + (most - least) * u;
            let shift: [f64; 3] = uniforms(seed, Purpose::Shift, id);
            let kick: [f64; 3] = uniforms(seed, Purpose::Velocity, id);
            let mut position = *site;
            let mut velocity = [0.0; 3];
            for a in 0..3 {
                // Within its own cell, so that no two grains begin in contact.
                position[a] += (shift[a] - 0.5) * (self.spacing[a] - diameter);
                velocity[a] = (2.0 * kick[a] - 1.0) * speed;
            }
            Grain {
                id,
                group: FREE,
                diameter,
                density: scenario.bed.density,
                position,
                velocity,
                spin: [0.0; 3],
            }
        };
        self.sites.iter().enumerate().map(place).collect()
    }
}

fn length(d: [f64; 3]) -> f64 {
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
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

/// Steps on until the kinetic energy per free grain is under the scenario's bound and the weight is
/// carried, for at least `least` steps.
fn settle(
    sim: &mut Sim,
    scenario: &Scenario,
    plan: &BedPlan,
    least: u64,
    fall_steps: u64,
    stage: &mut Stage,
) -> Result<()> {
    let begin = sim.step_count();
    let limit = begin + (PATIENCE * fall_steps as f64) as u64 + 100 * LOOK;
    loop {
        sim.steps(LOOK).map_err(|f| stopped(&plan.name, sim, f))?;
        let energy = energy_per_grain(sim, scenario);
        let (_, weight, support) = weight_and_support(sim, scenario.gravity);
        // A bed that still breathes carries more or less than its weight.
        let carried = (support - weight).abs() <= CARRIED * weight;
        let quiet = energy < scenario.bed.settled && carried;
        let done = sim.step_count() - begin >= least && quiet;
        stage.settling(
            sim.step_count(),
            energy,
            scenario.bed.settled,
            support / weight,
            fall_steps,
        );
        if done {
            return Ok(());
        }
        if sim.step_count() > limit {
            return Err(Error::Unsettled {
                bed: plan.name.clone(),
                step: sim.step_count(),
                energy,
                bound: scenario.bed.settled,
                carried: support / weight,
            });
        }
    }
}

/// Kinetic energy per free grain over a grain's mean weight times its mean diameter.
pub fn energy_per_grain(sim: &Sim, scenario: &Scenario) -> f64 {
    let free = sim.group.iter().filter(|&&g| g == FREE).count().max(1) as f64;
    let weight = sphere_mass(scenario.mean_diameter(), scenario.bed.density) * scenario.gravity;
    sim.kinetic_energy() / free / (weight * scenario.mean_diameter())
}

/// Freezes the grains whose centres lie below the base's height, takes the floor away where the bed
/// has none, and numbers all grains in spatial order. The contacts that stay keep their springs, seen
/// from the grain that now has the lower number.
fn freeze_base(old: &mut Sim, bed: &Bed) -> std::result::Result<Sim, Fault> {
    let mean = 2.0 * old.position.iter().map(|x| x[3]).sum::<f64>() / old.count().max(1) as f64;
    let order = spatial_order(&old.position, mean);
    let bonds = old.bonds();
    let mut new = old.clone();
    if !bed.floor {
        new.obstacles.truncate(1);
    }
    let mut place = vec![0u32; old.count()];
    for (k, &from) in order.iter().enumerate() {
        place[from] = k as u32;
        let frozen = old.position[from][2] < bed.base;
        new.group[k] = if frozen { FROZEN } else { FREE };
        new.position[k] = old.position[from];
        new.velocity[k] = old.velocity[from];
        new.spin[k] = old.spin[from];
        new.force[k] = old.force[from];
        new.torque[k] = old.torque[from];
        new.image[k] = old.image[from];
        if frozen {
            new.velocity[k] = [0.0, 0.0, 0.0, old.velocity[from][3]];
            new.spin[k] = [0.0; 4];
        }
    }
    let frozen = |k: u32| new.group[k as usize] == FROZEN;
    let mut kept = Vec::with_capacity(bonds.len());
    for bond in bonds {
        match bond {
            Bond::Pair { i, j, spring } => {
                let (a, b) = (place[i as usize], place[j as usize]);
                if frozen(a) && frozen(b) {
                    continue;
                }
                let turned = [-spring[0], -spring[1], -spring[2]];
                kept.push(if a < b {
                    Bond::Pair { i: a, j: b, spring }
                } else {
                    Bond::Pair {
                        i: b,
                        j: a,
                        spring: turned,
                    }
                });
            }
            Bond::Touch {
                i,
                obstacle,
                spring,
            } => {
                let i = place[i as usize];
                let body = new.obstacles.get(obstacle as usize);
                if body.is_some_and(|body| !frozen(i) || body.inverse_mass > 0.0) {
                    kept.push(Bond::Touch {
                        i,
                        obstacle,
                        spring,
                    });
                }
            }
        }
    }
    new.resume(&kept)?;
    Ok(new)
}
