//! Time steps that do not resolve the waves and the collisions of a simulation.

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::time_step::{ShortestTimes, shortest_times};

use crate::law::{CONTACT_FRACTION_MAX, RAYLEIGH_FRACTION_MAX, Sprung, WithLaw};
use crate::owned_world::OwnedWorld;
use crate::simulation::Simulation;

struct Times<'w>(&'w mut OwnedWorld<f64>);

impl WithLaw for Times<'_> {
    type Output = ShortestTimes;

    fn run<L: Law<f64> + Sprung>(self, law: &L) -> ShortestTimes {
        shortest_times(&self.0.world(), law)
    }
}

impl Simulation {
    /// The shortest times that a step must resolve, as bodies are and move now.
    pub fn shortest_times(&mut self) -> ShortestTimes {
        let law = self.law.clone();
        law.with(Times(self))
    }

    /// What is wrong with the time step, in words, and what would do; `None` if it resolves these times.
    pub fn long_step(&self, times: &ShortestTimes) -> Option<String> {
        if times.are_resolved_by(self.dt) {
            return None;
        }
        let [rayleigh, collision] = times.fractions(self.dt);
        let wave = RAYLEIGH_FRACTION_MAX * times.rayleigh;
        let limit = wave.min(CONTACT_FRACTION_MAX * times.collision);
        Some(format!(
            "is {}, {rayleigh:.3} of the shortest Rayleigh time and {collision:.3} of the shortest collision; from \
             {RAYLEIGH_FRACTION_MAX} and {CONTACT_FRACTION_MAX} of them on restitution is off and collisions make \
             energy: take at most {limit:.3e}, or softer grains",
            self.dt
        ))
    }
}
