//! What is refused before anything runs.

use super::limits::GRAINS_MAX;
use super::plan::STEPS_MAX;
use super::refusal::{Check, not_negative, positive, refuse};
use super::{History, IntruderShape, OneOrMany, Scenario, UnitSystem};
use bitgrain_sim::format::short;

/// Fewest steps of an averaging window: ten for each block of the standard error.
const AVERAGED_MIN: u64 = 80;

/// Fewest rows of the force series in it: with fewer, block averaging of what is sampled with them
/// cannot tell independent samples from others.
const SAMPLES_MIN: u64 = 64;

/// Most of its velocity that a contact's damping may take out in one step.
const DAMPED_MAX: f64 = 0.5;

/// Least height of a bed in mean diameters.
const THINNEST: f64 = 4.0;

impl Scenario {
    /// The key that says how high the intruder lies.
    pub(super) fn height_key(&self) -> &'static str {
        if self.intruder.height.is_some() {
            "intruder.height"
        } else {
            "intruder.depth"
        }
    }

    /// All checks of a scenario.
    ///
    /// # Errors
    /// The key that is wrong, and what is wrong with it.
    pub(super) fn check_all(&self) -> Check {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if self.name.is_empty() || !self.name.chars().all(plain) {
            return refuse(
                "name",
                "expected letters, digits, `-` and `_`: it names a folder",
            );
        }
        positive("gravity", self.gravity)?;
        self.check_counts()?;
        if !self.seeds.is_empty() && self.seed != 0 {
            return refuse("seeds", "give seed or seeds, not both");
        }
        if (1..self.seeds.len()).any(|k| self.seeds[..k].contains(&self.seeds[k])) {
            return refuse("seeds", "has a value twice; each pours its own beds");
        }
        self.check_bed()?;
        self.check_units()?;
        self.law
            .build()
            .map_err(|(key, problem)| (format!("law.{key}"), problem))?;
        self.check_intruder()?;
        self.check_box()?;
        self.check_rig()?;
        if self.measure.every == 0 {
            return refuse("measure.every", "is 0; expected at least 1 step");
        }
        if self.measure.digest_every == 0 {
            return refuse("measure.digest_every", "is 0; expected at least 1 step");
        }
        self.check_fields()?;
        self.check_drag()
    }

    fn check_units(&self) -> Check {
        if self.units == UnitSystem::Si {
            return Ok(());
        }
        let one = |key: &str, value: f64| {
            if (value - 1.0).abs() < 1e-12 {
                return Ok(());
            }
            refuse(
                key,
                format!("is {value}; in reduced units it is 1. For others set units = \"si\""),
            )
        };
        one("gravity", self.gravity)?;
        one("bed.density", self.bed.density)?;
        if (self.mean_diameter() - 1.0).abs() > 1e-12 {
            let mean = self.mean_diameter();
            return refuse(
                "bed.diameters",
                format!("have the mean {mean}; in reduced units it is 1"),
            );
        }
        Ok(())
    }

    fn check_bed(&self) -> Check {
        for length in self.bed.size {
            positive("bed.box", length)?;
        }
        let [least, most] = self.bed.diameters;
        positive("bed.diameters", least)?;
        if !(most >= least && most.is_finite()) {
            return refuse("bed.diameters", "expected the smaller first");
        }
        if most > 4.0 * least {
            return refuse(
                "bed.diameters",
                "expected the larger at most 4 times the smaller",
            );
        }
        positive("bed.density", self.bed.density)?;
        positive("bed.settled", self.bed.settled)?;
        if let Some(mu) = self.bed.pouring_mu {
            not_negative("bed.pouring_mu", mu)?;
        }
        if !(self.bed.base >= 0.0 && self.bed.base < self.bed.size[2]) {
            return refuse(
                "bed.base",
                "expected a height inside the box, or 0 for none",
            );
        }
        if self.bed.file.is_some() {
            let not_poured = "a bed from a file is not poured; leave it out";
            let bed = &self.bed;
            return match (bed.fill_height, bed.kinetic_damping, bed.pouring_mu) {
                (Some(_), ..) => refuse(
                    "bed.fill_height",
                    "a bed from a file has its own height; leave it out",
                ),
                (_, Some(_), _) => refuse("bed.halting", not_poured),
                (.., Some(_)) => refuse("bed.pouring_mu", not_poured),
                _ => Ok(()),
            };
        }
        if self.bed.base == 0.0 && !self.bed.floor {
            return refuse("bed.floor", "without a base the grains need a floor");
        }
        match (self.bed.grains, self.bed.fill_height) {
            (Some(_), Some(_)) => {
                return refuse("bed.fill_height", "give grains or fill_height, not both");
            }
            (None, None) => return refuse("bed.grains", "give grains or fill_height"),
            (None, Some(height)) => positive("bed.fill_height", height)?,
            (Some(0), None) => return refuse("bed.grains", "is 0; expected at least 1"),
            (Some(n), None) if n > GRAINS_MAX => {
                return refuse("bed.grains", format!("expected at most {GRAINS_MAX}"));
            }
            _ => {}
        }
        Ok(())
    }

    fn check_intruder(&self) -> Check {
        let i = &self.intruder;
        let diameters = i.diameter.values();
        if diameters.is_empty() {
            return refuse("intruder.diameter", "is empty; expected at least one value");
        }
        for &diameter in &diameters {
            positive("intruder.diameter", diameter)?;
        }
        if (1..diameters.len()).any(|k| diameters[..k].contains(&diameters[k])) {
            return refuse(
                "intruder.diameter",
                "has a value twice; each gets its own beds",
            );
        }
        match (i.shape, i.density) {
            // A file's density belongs to its sphere; whether it is one is checked below.
            (IntruderShape::Cylinder | IntruderShape::Bar, Some(_)) if self.bed.file.is_none() => {
                return refuse(
                    "intruder.density",
                    "is given, but a cylinder or a bar counts as an infinitely heavy wall; leave it out",
                );
            }
            (_, density) => density.map_or(Ok(()), |rho| positive("intruder.density", rho))?,
        }
        match (&i.height, &i.depth) {
            (Some(_), Some(_)) => {
                return refuse("intruder.depth", "give height or depth, not both");
            }
            (None, None) if !self.is_dropped() => {
                return refuse("intruder.height", "give height or depth");
            }
            _ => {}
        }
        self.check_motion()
    }

    fn check_box(&self) -> Check {
        let one = |values: &Option<OneOrMany>| match values {
            Some(OneOrMany::One(x)) => x.is_finite(),
            _ => false,
        };
        if self.bed.file.is_some() && !one(&self.intruder.height) {
            return refuse(
                "intruder.height",
                "expected one number: the bed's file fixes the place of the intruder",
            );
        }
        for diameter in self.intruder.diameter.values() {
            self.check_width(diameter)?;
            if self.bed.file.is_none() {
                self.check_filling(diameter)?;
            }
        }
        Ok(())
    }

    /// Whether the box is wide enough for an intruder of this diameter; a cylinder lies along y.
    fn check_width(&self, diameter: f64) -> Check {
        let [x, y, _] = self.bed.size;
        let most = self.bed.diameters[1];
        let across = if diameter > most {
            0.5 * (most + diameter)
        } else {
            most
        };
        let along_y = match self.intruder.shape {
            IntruderShape::Sphere => (diameter, across),
            IntruderShape::Cylinder | IntruderShape::Bar => (0.0, most),
        };
        for (length, axis, (body, widest)) in [(x, "x", (diameter, across)), (y, "y", along_y)] {
            if length <= body {
                return refuse(
                    "intruder.diameter",
                    format!("is {diameter}, no smaller than the box along {axis}, {length}"),
                );
            }
            if length <= 2.0 * widest {
                return refuse(
                    "bed.box",
                    format!(
                        "is {length} along {axis}; a periodic axis must be longer than {}, twice \
                         the largest contact distance",
                        2.0 * widest
                    ),
                );
            }
        }
        Ok(())
    }

    /// Whether the grains fill what a poured bed needs, round the intruder.
    fn check_filling(&self, diameter: f64) -> Check {
        let [_, _, z] = self.bed.size;
        if self.grain_count(diameter) > GRAINS_MAX {
            let problem = format!("takes more than {GRAINS_MAX} grains, the most of a bed");
            return refuse("bed.fill_height", problem);
        }
        let surface = self.expected_surface(diameter);
        let thinnest = THINNEST * self.mean_diameter();
        if surface < thinnest {
            let key = if self.bed.grains.is_some() {
                "bed.grains"
            } else {
                "bed.fill_height"
            };
            return refuse(
                key,
                format!(
                    "fills the box to a height of {surface:.3}; expected at least {thinnest}, four \
                     grains, between whose lowest and uppermost a packing fraction can be measured"
                ),
            );
        }
        if surface > 1.15 * z {
            return refuse(
                "bed.box",
                format!(
                    "has a height of {z}, but the grains would fill {surface:.1}: make it higher"
                ),
            );
        }
        if self.is_dropped() {
            return self.check_room_above(surface);
        }
        let key = self.height_key();
        let heights = self.heights(diameter);
        if heights.is_empty() {
            return refuse(key, "is empty; expected at least one value");
        }
        if (1..heights.len()).any(|k| heights[..k].contains(&heights[k])) {
            return refuse(key, "has a value twice; each gets its own bed");
        }
        for height in heights {
            // Written so that NaN is refused too.
            let inside = height - 0.5 * diameter >= 0.0 && height + 0.5 * diameter <= z;
            let buried = height - 0.5 * diameter < surface;
            if inside && !buried {
                return refuse(
                    key,
                    format!(
                        "puts the intruder's centre at z = {height}, wholly above the bed, which \
                         is expected to reach {surface:.2}"
                    ),
                );
            }
            if !inside {
                return refuse(
                    key,
                    format!(
                        "puts the intruder between z = {} and {}, but the box holds 0 to {z}: move it \
                         or make the box higher",
                        short(height - 0.5 * diameter),
                        short(height + 0.5 * diameter)
                    ),
                );
            }
        }
        Ok(())
    }

    /// A contact whose damping takes most of a velocity out in one step turns it round: with a dozen
    /// contacts a grain then gains energy.
    fn check_damping(&self) -> Check {
        let d = self.mean_diameter();
        // At an overlap of a twentieth of the diameter, effective radius a quarter of it.
        let width = (0.25 * d * 0.05 * d).sqrt();
        for (key, gamma) in self.law.parameters().damping_rates() {
            let share = gamma * width * self.drag.dt;
            if share > DAMPED_MAX {
                return refuse(
                    &format!("law.{key}"),
                    format!(
                        "is {gamma}, which damps a contact by {share:.2} of its velocity in a step at \
                         an overlap of 0.05 d; expected at most {DAMPED_MAX}: lower it or shorten \
                         drag.dt"
                    ),
                );
            }
        }
        Ok(())
    }

    fn check_drag(&self) -> Check {
        let least = 0.5 * self.bed.diameters[0];
        self.check_time_step()?;
        if self.bed.file.is_some() && self.drag.history == History::Kept {
            return refuse(
                "drag.history",
                "is \"kept\", but a bed from a file has no contact histories; leave it out",
            );
        }
        self.check_damping()?;
        self.check_lengths()?;
        for distance in &self.drag.distance.values() {
            self.check_wake(*distance)?;
        }
        for run in self.plan_drags() {
            if run.motion.speed * self.drag.dt > least {
                return refuse("drag.dt", "lets the intruder jump over a grain in one step");
            }
            let length = match run.release.is_timed() {
                true => "drag.duration",
                false => "drag.distance",
            };
            // Before anything is counted step by step.
            if run.steps() > STEPS_MAX || !(run.motion.speed * self.drag.dt).is_normal() {
                return refuse(
                    length,
                    format!(
                        "takes {:.0e} steps; expected at most {STEPS_MAX:.0e}",
                        run.steps() as f64
                    ),
                );
            }
            if !(run.discard >= 0.0 && run.discard < run.window_end) {
                let (key, given) = match self.drag.discard {
                    Some(_) => ("drag.discard", run.discard),
                    None => ("drag.distance", run.distance),
                };
                return refuse(
                    key,
                    format!(
                        "is {given}: of a distance of {}, {} is discarded, and nothing is left to average; \
                         lengthen drag.distance or shorten drag.discard",
                        run.window_end, run.discard
                    ),
                );
            }
            self.check_window(&run)?;
            self.check_fields_of(&run)?;
            let averaged = run.averaged();
            if averaged < AVERAGED_MIN {
                let key = if self.drag.discard.is_some() {
                    "drag.discard"
                } else {
                    length
                };
                return refuse(
                    key,
                    format!("leaves {averaged} steps to average; expected at least {AVERAGED_MIN}"),
                );
            }
            let samples = averaged / self.measure.every;
            if samples < SAMPLES_MIN {
                return refuse(
                    "measure.every",
                    format!(
                        "leaves {samples} rows in the averaging window of {}; expected at least \
                         {SAMPLES_MIN}: sample more often",
                        run.name
                    ),
                );
            }
        }
        Ok(())
    }
}
