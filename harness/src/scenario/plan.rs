//! What a scenario amounts to: units, numbers of grains, beds to pour and drags to run.

use super::{Scenario, UnitSystem};
use crate::units::Units;

/// Packing fraction that plans assume before a bed has been poured.
pub const PACKING_GUESS: f64 = 0.6;

/// A bed to pour: its intruder and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct BedPlan {
    /// Name of the bed and its files.
    pub name: String,
    /// Centre of the intruder.
    pub center: [f64; 3],
}

/// One drag to run in a bed.
#[derive(Clone, Debug, PartialEq)]
pub struct RunPlan {
    /// Name of the run and its folder.
    pub name: String,
    /// Place of its bed among the bed plans.
    pub bed: usize,
    /// Speed of the intruder.
    pub speed: f64,
    /// Its Froude number.
    pub froude: f64,
    /// Travel.
    pub distance: f64,
    /// Steps.
    pub steps: u64,
    /// Travel at which averaging begins.
    pub discard: f64,
    /// Steps after which a snapshot is taken, ascending.
    pub snapshots: Vec<u64>,
}

impl RunPlan {
    /// The first step that is averaged: the first that ends beyond the discarded travel.
    pub fn first_averaged(&self, dt: f64) -> u64 {
        let travel = |n: u64| n as f64 * dt * self.speed;
        let mut first = (self.discard / (self.speed * dt)) as u64;
        while first > 0 && travel(first) > self.discard {
            first -= 1;
        }
        while travel(first) <= self.discard && first < self.steps {
            first += 1;
        }
        first.max(1)
    }
}

impl Scenario {
    /// The resolved scenario as TOML, every default written out.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a scenario has only string keys and finite numbers")
    }

    /// Mean grain diameter.
    pub fn mean_diameter(&self) -> f64 {
        0.5 * (self.bed.diameters[0] + self.bed.diameters[1])
    }

    /// What one unit of each kind of number stands for.
    pub fn units(&self) -> Units {
        let names = match self.units {
            UnitSystem::Reduced => [
                "d",
                "sqrt(d/g)",
                "sqrt(g d)",
                "rho d^3 g",
                "rho d^4 g",
                "rho d^4 g",
            ],
            UnitSystem::Si => ["m", "s", "m/s", "N", "N m", "J"],
        };
        let [length, time, speed, force, torque, energy] = names.map(str::to_string);
        Units {
            length,
            time,
            speed,
            force,
            torque,
            energy,
        }
    }

    /// Mean volume of a grain: the mean of pi/6 diameter^3 over the uniform distribution.
    fn mean_volume(&self) -> f64 {
        let [a, b] = self.bed.diameters;
        std::f64::consts::PI / 6.0 * 0.25 * (a + b) * (a * a + b * b)
    }

    /// Number of grains, given or from the fill height.
    pub fn grain_count(&self) -> usize {
        let [x, y, _] = self.bed.size;
        match (self.bed.grains, self.bed.fill_height) {
            (Some(n), _) => n,
            (None, Some(height)) => {
                let ball = crate::sim::sphere_mass(self.intruder.diameter, 1.0);
                ((x * y * height - ball) * PACKING_GUESS / self.mean_volume()) as usize
            }
            (None, None) => 0,
        }
    }

    /// Height of the free surface expected at a packing fraction of 0.6.
    pub fn expected_surface(&self) -> f64 {
        let [x, y, _] = self.bed.size;
        let ball = crate::sim::sphere_mass(self.intruder.diameter, 1.0);
        (self.grain_count() as f64 * self.mean_volume() / PACKING_GUESS + ball) / (x * y)
    }

    /// Froude number of a speed: 2 V sqrt(2 D/g)/(D + d) (Kumar 2018, eq. 4).
    pub fn froude(&self, speed: f64) -> f64 {
        2.0 * speed * self.fall_time() / (self.intruder.diameter + self.mean_diameter())
    }

    fn fall_time(&self) -> f64 {
        (2.0 * self.intruder.diameter / self.gravity).sqrt()
    }

    pub(super) fn heights(&self) -> Vec<f64> {
        match (&self.intruder.height, &self.intruder.depth) {
            (Some(heights), _) => heights.values(),
            (None, Some(depths)) => {
                let surface = self.expected_surface();
                depths.values().iter().map(|h| surface - h).collect()
            }
            (None, None) => vec![],
        }
    }

    /// Speeds with their Froude numbers, whichever of the two was given kept as it is.
    pub(super) fn speeds(&self) -> Vec<(f64, f64)> {
        match (&self.intruder.speed, &self.intruder.froude) {
            (Some(speeds), _) => speeds
                .values()
                .iter()
                .map(|&v| (v, self.froude(v)))
                .collect(),
            (None, Some(numbers)) => {
                let width = self.intruder.diameter + self.mean_diameter();
                let per_froude = width / (2.0 * self.fall_time());
                numbers
                    .values()
                    .iter()
                    .map(|&fr| (fr * per_froude, fr))
                    .collect()
            }
            (None, None) => vec![],
        }
    }

    /// The beds to pour.
    pub fn beds(&self) -> Vec<BedPlan> {
        let heights = self.heights();
        let [x, y, _] = self.bed.size;
        heights
            .iter()
            .enumerate()
            .map(|(k, &z)| BedPlan {
                name: if heights.len() == 1 {
                    "bed".into()
                } else {
                    format!("bed-{}", k + 1)
                },
                center: [0.5 * x, 0.5 * y, z],
            })
            .collect()
    }

    /// The drags to run, by bed and then speed.
    pub fn runs(&self) -> Vec<RunPlan> {
        let (beds, speeds, distances) = (self.beds(), self.speeds(), self.drag.distance.values());
        let mut runs = Vec::new();
        for (bed, plan) in beds.iter().enumerate() {
            for (k, &(speed, froude)) in speeds.iter().enumerate() {
                let distance = distances[if distances.len() == 1 { 0 } else { k }];
                let run = format!("run-{}", k + 1);
                let name = if beds.len() == 1 {
                    run
                } else {
                    format!("{}-{run}", plan.name)
                };
                let default = if 0.1 * distance > self.intruder.diameter {
                    0.1 * distance
                } else {
                    self.intruder.diameter
                };
                let steps = (distance / (speed * self.drag.dt)).round() as u64;
                let wanted = self.measure.snapshots;
                let share = |k: u64| (u128::from(steps) * u128::from(k)).div_ceil(wanted.into());
                let mut snapshots: Vec<u64> = (1..=wanted).map(|k| share(k) as u64).collect();
                snapshots.dedup();
                runs.push(RunPlan {
                    name,
                    bed,
                    speed,
                    froude,
                    distance,
                    steps,
                    snapshots,
                    discard: self.drag.discard.unwrap_or(default),
                });
            }
        }
        runs
    }
}
