//! The loose lattice that grains fall from.

use super::groups::FREE;
use super::intruder::intruder;
use crate::scenario::{BedPlan, CheckedScenario};
use bitgrain_sim::observe::{length, offset};
use bitgrain_sim::random::{Purpose, uniforms};
use bitgrain_sim::simulation::Grain;

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
    /// `count` sites from the height `from` up, clear of the plan's intruder if there is one.
    pub fn new(
        scenario: &CheckedScenario,
        count: usize,
        from: f64,
        round: Option<&BedPlan>,
    ) -> Self {
        let [x, y, _] = scenario.bed.size;
        let most = scenario.bed.diameters[1];
        let fit = |length: f64| (length / (SPACING * most)).floor().max(1.0);
        let (nx, ny) = (fit(x), fit(y));
        let spacing = [x / nx, y / ny, SPACING * most];
        let least = scenario.bed.diameters[0];
        let shift = spacing.map(|s| 0.5 * (s - least));
        let domain = scenario.lattice_domain();
        // A grain may be anywhere in its cell.
        let across = (spacing[0] * spacing[0] + spacing[1] * spacing[1]).sqrt();
        let tank = scenario.is_tank().then_some(0.5 * (x - across));
        let inside = |at: [f64; 3]| {
            let off = [at[0] - 0.5 * x, at[1] - 0.5 * y];
            tank.is_none_or(|most| off[0] * off[0] + off[1] * off[1] <= most * most)
        };
        let clear = |at: [f64; 3]| {
            inside(at)
                && round.is_none_or(|plan| {
                    let off = offset(domain, &intruder(scenario, plan), at);
                    length(off) > 0.5 * (plan.diameter + most) + length(shift)
                })
        };
        let mut sites = Vec::with_capacity(count);
        let mut layer = 0;
        while sites.len() < count {
            let z = from + (f64::from(layer) + 0.5) * spacing[2];
            for iy in 0..ny as usize {
                if sites.len() == count {
                    break;
                }
                for ix in 0..nx as usize {
                    let at = [
                        (ix as f64 + 0.5) * spacing[0],
                        (iy as f64 + 0.5) * spacing[1],
                        z,
                    ];
                    if clear(at) && sites.len() < count {
                        sites.push(at);
                    }
                }
            }
            layer += 1;
        }
        Self {
            sites,
            spacing,
            top: from + f64::from(layer) * spacing[2],
        }
    }

    /// Grains at the sites; their names, and so their random numbers, come after `first`.
    pub fn grains(&self, scenario: &CheckedScenario, plan: &BedPlan, first: u32) -> Vec<Grain> {
        let [least, most] = scenario.bed.diameters;
        let speed = (scenario.gravity * scenario.mean_diameter()).sqrt();
        let seed = plan.seed;
        let place = |(k, site): (usize, &[f64; 3])| {
            let id = first + k as u32 + 1;
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
