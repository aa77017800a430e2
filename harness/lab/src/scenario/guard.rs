//! The time step against what it must resolve: waves in the grains, and collisions.

use super::Scenario;
use super::refusal::Check;
use bitgrain_sim::format::short;
use bitgrain_sim::law::{CONTACT_FRACTION_MAX, RAYLEIGH_FRACTION_MAX};

impl Scenario {
    /// Shortest Rayleigh time among the smallest grain and the intruder.
    pub fn rayleigh_time(&self) -> f64 {
        let times = self.sizes().into_iter();
        let times = times.map(|(radius, density)| self.law.rayleigh_time(radius, density));
        times.fold(f64::INFINITY, |a, b| if b < a { b } else { a })
    }

    /// The highest speed at which bodies meet, and whose it is: that of a drag, or of a grain that falls
    /// through the height of the bed as it is poured (the lattice it falls from is less than twice as
    /// high).
    pub fn fastest(&self) -> (f64, &'static str) {
        let mut fastest = (0.0, "the drag");
        for diameter in self.intruder.diameter.values() {
            for passage in self.passages(diameter) {
                if passage.motion.speed > fastest.0 {
                    fastest = (passage.motion.speed, passage.release.whose());
                }
            }
            if self.bed.file.is_none() {
                let fall = (2.0 * self.gravity * self.expected_surface(diameter)).sqrt();
                if fall > fastest.0 {
                    fastest = (fall, "a fall through the bed");
                }
            }
        }
        fastest
    }

    /// Duration of a collision of two of the smallest grains at the highest speed.
    pub fn shortest_contact(&self) -> f64 {
        let (speed, _) = self.fastest();
        self.law.shortest_contact(speed, self.sizes().into_iter())
    }

    pub(super) fn check_time_step(&self) -> Check {
        let (dt, sizes) = (self.drag.dt, self.sizes());
        self.law
            .check_time_step(dt, sizes.iter().copied())
            .and_then(|()| {
                let sizes = sizes.iter().copied();
                self.law.check_contact_duration(dt, sizes, self.fastest())
            })
            .map_err(|problem| ("drag.dt".to_string(), problem))
    }

    /// The time step over the two times that bound it, in a line.
    pub fn time_step_line(&self) -> String {
        let (dt, unit) = (self.drag.dt, &self.units().time);
        let (rayleigh, contact) = (self.rayleigh_time(), self.shortest_contact());
        let (speed, what) = self.fastest();
        format!(
            "time step {} {unit}: {} of the Rayleigh time, {} {unit} (at most {RAYLEIGH_FRACTION_MAX}); {} of \
             the duration of a collision at the speed of {what}, {} {unit} at {} {} (at most \
             {CONTACT_FRACTION_MAX})",
            short(dt),
            short(dt / rayleigh),
            short(rayleigh),
            short(dt / contact),
            short(contact),
            short(speed),
            self.units().speed
        )
    }
}
