//! The loose lattice that grains fall from.

use bitgrain_kernel::Domain;

use super::FREE;
use crate::random::{Purpose, uniforms};
use crate::scenario::{BedPlan, Scenario};
use crate::sim::Grain;

/// Distance of the sites over the largest diameter: near enough that the fall is short, a third of
/// the volume filled.
const SPACING: f64 = 1.05;

/// Sites far enough apart for the largest grains, round the intruder, filled from below.
pub(super) struct Lattice {
    pub sites: Vec<[f64; 3]>,
    spacing: [f64; 3],
    pub top: f64,
}

impl Lattice {
    pub fn new(scenario: &Scenario, plan: &BedPlan) -> Self {
        let [x, y, _] = scenario.bed.size;
        let most = scenario.bed.diameters[1];
        let fit = |length: f64| (length / (SPACING * most)).floor().max(1.0);
        let (nx, ny) = (fit(x), fit(y));
        let spacing = [x / nx, y / ny, SPACING * most];
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

    pub fn grains(&self, scenario: &Scenario) -> Vec<Grain> {
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
