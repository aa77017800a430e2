//! Fields that a scenario asks for.

use super::refusal::{Check, positive, refuse};
use super::{DragPlan, Scenario};
use bitgrain_sim::coarse_graining::Sampling;
use bitgrain_sim::coarse_graining::grid::Grid;
use bitgrain_sim::coarse_graining::load::PARTS;
use bitgrain_sim::format::short;

/// Default travel between samples, in mean diameters.
const EVERY: f64 = 0.1;

/// Most points of a grid: 13 numbers each, in memory and in every checkpoint.
const POINTS_MAX: usize = 4_000_000;

/// Fewest samples in each of the parts of the window that errors come from.
const SAMPLES_MIN: u64 = 2;

impl Scenario {
    /// Points of the fields; `None` if none are asked for.
    pub fn fields_grid(&self) -> Option<Grid> {
        self.measure.fields.as_ref().map(|asked| Grid {
            counts: asked.grid,
            size: self.bed.size,
        })
    }

    /// The fields of a drag at this speed; `None` if none are asked for.
    pub fn fields_sampling(&self, speed: f64) -> Option<Sampling> {
        Some(Sampling {
            grid: self.fields_grid()?,
            window: self.fields_window(),
            every: self.fields_every(speed),
        })
    }

    /// Velocity along x of the far grains in the intruder's frame: against the direction in which it
    /// moves through them.
    pub fn far_velocity(&self, speed: f64) -> f64 {
        -self.drag.moves.forward() * speed
    }

    /// Radius of the averaging windows.
    pub fn fields_window(&self) -> f64 {
        let asked = self.measure.fields.as_ref().and_then(|f| f.window);
        asked.unwrap_or(self.mean_diameter())
    }

    /// Steps between samples of the fields at this speed.
    pub fn fields_every(&self, speed: f64) -> u64 {
        let asked = self.measure.fields.as_ref().and_then(|f| f.every);
        let own = EVERY * self.mean_diameter() / (speed * self.drag.dt);
        asked.unwrap_or(own.round() as u64).max(1)
    }

    /// A grid or a window that gives no fields.
    pub(super) fn check_fields(&self) -> Check {
        let Some(asked) = &self.measure.fields else {
            return Ok(());
        };
        let points = asked.grid.iter().try_fold(1usize, |n, k| n.checked_mul(*k));
        if !points.is_some_and(|n| (1..=POINTS_MAX).contains(&n)) {
            return refuse(
                "measure.fields.grid",
                format!(
                    "is {:?}; expected one point or more along each axis, and at most {POINTS_MAX} in all",
                    asked.grid
                ),
            );
        }
        if asked.every == Some(0) {
            return refuse("measure.fields.every", "is 0; expected at least 1 step");
        }
        let window = self.fields_window();
        positive("measure.fields.window", window)?;
        for (axis, length) in ["x", "y", "z"].iter().zip(self.bed.size) {
            let most = 0.5 * (length - self.bed.diameters[1]);
            if window > most {
                return refuse(
                    "measure.fields.window",
                    format!(
                        "is a radius of {window}, too large for the box: a window and a grain beside it must fit \
                         into its {length} along {axis}; give {} or less",
                        short(most)
                    ),
                );
            }
        }
        Ok(())
    }

    /// A drag with samples before its steady state, or too few. (For a cylinder it is checked without fields too.)
    pub(super) fn check_fields_of(&self, run: &DragPlan) -> Check {
        if self.measure.fields.is_none() {
            return Ok(());
        }
        let diameter = self.plan_beds()[run.bed].diameter;
        if run.discard < diameter {
            return refuse(
                "drag.discard",
                format!(
                    "is {}, before the steady state, of which fields are means and which begins after one diameter \
                     of the intruder, {diameter}: raise it, or leave it out",
                    run.discard
                ),
            );
        }
        let averaged = run.averaged();
        let every = self.fields_every(run.motion.speed);
        let samples = averaged / every;
        let least = SAMPLES_MIN * PARTS as u64;
        if samples < least {
            return refuse(
                "measure.fields.every",
                format!(
                    "of {every} steps leaves {samples} samples in the averaging window of {}; expected at least \
                     {least}: sample more often, or make drag.distance longer",
                    run.name
                ),
            );
        }
        Ok(())
    }
}
