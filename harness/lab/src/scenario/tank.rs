//! A bar in a tank (Guillard 2014, section II): what is asked of both, and how far the bar goes before it meets its
//! own wake.
//!
//! The paper turns the tank and holds the bar. Here the tank is at rest and the bar turns: seen from the tank the two
//! are one motion, but for the centrifugal and Coriolis forces of a turning tank, which are of the order of
//! `Omega^2 R` against g: 1e-4 in the paper. A tank at rest lacks them, and so is nearer to the quasi-static limit.

use super::refusal::{Check, positive, refuse};
use super::{Container, IntruderShape, Scenario};
use bitgrain_sim::format::short;
use bitgrain_sim::motion::Moves;

/// Least gap between a bar and the grains that are glued to the wall and the floor of its tank, in grains of the
/// largest diameter: in a narrower one a few grains jam, and bear forces of many times the bed's weight.
const GAP: f64 = 3.0;

impl Scenario {
    /// Whether the bed is in a tank.
    pub fn is_tank(&self) -> bool {
        self.bed.container == Container::Tank
    }

    /// Whether beds have the further numbers of a [`Rig`](crate::summary::Rig).
    pub fn has_rig(&self) -> bool {
        self.flows() || self.is_tank()
    }

    /// Travel of the ends of a bar in half a turn, after which it meets its own wake; none without a bar.
    pub fn half_turn(&self) -> Option<f64> {
        let length = self.intruder.length.filter(|_| self.is_tank())?;
        Some(0.5 * std::f64::consts::PI * length)
    }

    /// Travel at which the averaging window of a drag of this distance ends.
    pub(super) fn window_end(&self, distance: f64) -> f64 {
        match self.half_turn() {
            Some(half) if half < distance => half,
            _ => distance,
        }
    }

    /// Rate at which a bar turns whose ends have this speed (radians over time).
    pub fn turning_rate(&self, speed: f64) -> f64 {
        2.0 * speed / self.intruder.length.unwrap_or(f64::INFINITY)
    }

    /// `Omega^2 R / g` at the wall of the tank: the size of the forces that a turning tank has and one at rest lacks.
    pub fn centrifugal(&self, speed: f64) -> f64 {
        let rate = self.turning_rate(speed);
        rate * rate * (0.5 * self.bed.size[0]) / self.gravity
    }

    /// A way so long that the intruder meets its own wake, if that is not asked for.
    pub(super) fn check_wake(&self, distance: f64) -> Check {
        let (longest, what) = match self.half_turn() {
            Some(half) => (half, "half a turn of the bar's ends"),
            None => (self.bed.size[0], "one box length"),
        };
        if distance <= longest || self.drag.own_wake {
            return Ok(());
        }
        refuse(
            "drag.distance",
            format!(
                "is {distance}, beyond {what}, {longest}: the intruder would meet its own wake; if that is intended, \
                 set drag.own_wake = true"
            ),
        )
    }

    pub(super) fn check_tank(&self) -> Check {
        let bar = self.intruder.shape == IntruderShape::Bar;
        if let (false, Some(length)) = (bar, self.intruder.length) {
            let problem = format!("is {length}, but only a bar has a length; leave it out");
            return refuse("intruder.length", problem);
        }
        match (bar, self.is_tank()) {
            (false, false) => return Ok(()),
            (true, false) => {
                let problem = "a bar turns in a tank: set bed.container = \"tank\", or take a sphere or a cylinder";
                return refuse("intruder.shape", problem);
            }
            (false, true) => {
                let problem =
                    "is \"tank\", in which only a bar turns so far: set intruder.shape = \"bar\"";
                return refuse("bed.container", problem);
            }
            (true, true) => {}
        }
        let not_here = [
            (self.bed.file.is_some(), "bed.file", "a file holds no tank"),
            (
                self.lid.is_some(),
                "lid",
                "is a square lattice on a bed that repeats, and a tank is round",
            ),
            (
                self.drag.moves == Moves::Bed,
                "drag.moves",
                "the bar turns, and the tank is at rest: seen from the tank that is the same motion",
            ),
            (
                self.measure.fields.is_some(),
                "measure.fields",
                "fields are of motions along x; a tank has its own table, velocity.csv",
            ),
            (!self.bed.floor, "bed.floor", "a tank has a floor"),
        ];
        if let Some((_, key, why)) = not_here.iter().find(|(given, ..)| *given) {
            return refuse(key, format!("{why}; leave it out"));
        }
        if self.bed.base == 0.0 {
            return refuse(
                "bed.base",
                "is 0, but the rough floor and wall of a tank are grains that near to them; give a length, such as \
                 0.6 of a grain's diameter",
            );
        }
        self.check_bar()
    }

    fn check_bar(&self) -> Check {
        let ([x, y, _], most) = (self.bed.size, self.bed.diameters[1]);
        if x != y {
            let problem =
                format!("is {x} by {y}; a tank is as wide along x as along y, its inner diameter");
            return refuse("bed.box", problem);
        }
        let Some(length) = self.intruder.length else {
            return refuse("intruder.length", "is missing; a bar has a length");
        };
        positive("intruder.length", length)?;
        let widest = x - 2.0 * (self.bed.base + (0.5 + GAP) * most);
        if length > widest {
            return refuse(
                "intruder.length",
                format!(
                    "is {length} in a tank of diameter {x}; at most {} leaves {GAP} grains between its ends and those \
                     of the wall",
                    short(widest)
                ),
            );
        }
        for plan in self.plan_beds() {
            let lowest = plan.center[2] - 0.5 * plan.diameter;
            let least = self.bed.base + (0.5 + GAP) * most;
            if lowest < least {
                return refuse(
                    self.height_key(),
                    format!(
                        "puts the bar's lowest point at z = {}; grains do not jam between it and the floor at {} or \
                         more, which leaves {GAP} grains above those of the floor: raise it",
                        short(lowest),
                        short(least)
                    ),
                );
            }
            if plan.diameter > length {
                let problem = format!(
                    "is {length}, shorter than the bar's diameter, {}",
                    plan.diameter
                );
                return refuse("intruder.length", problem);
            }
        }
        Ok(())
    }
}
