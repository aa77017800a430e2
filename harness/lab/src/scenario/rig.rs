//! Checks of a cylinder, of a lid, and of a bed that its base carries.

use super::limits::STEADY;
use super::refusal::{Check, positive, refuse};
use super::{IntruderShape, PouringOrder, Scenario};
use bitgrain_sim::format::short;
use bitgrain_sim::motion::Moves;

/// Drag over `rho g h~ D L` on a cylinder (Guillard 2014, Fig. 8), by which boxes are judged before
/// anything is measured.
pub const DRAG_COEFFICIENT: f64 = 10.0;

/// Friction coefficient of a flowing bed as a whole. Base and lid carry a drag of at most this part of
/// the weight, each: `C_d P D L < 2 mu P L_x L`. Half of that is allowed, so that the bed follows.
pub const BULK_FRICTION: f64 = 0.38;

/// Largest relative difference between the box and a whole number of the lid's grains.
const TILES: f64 = 1e-9;

/// Room that lid and floating grains need between the bed and the box's top, in mean diameters.
const HEADROOM: f64 = 3.0;

/// How much higher than planned a poured bed may come out, over its height: loosely packed, at 0.585.
pub(super) const HIGHER: f64 = 0.03;

/// Least averaging window of a bed that flows, in mean diameters: three rows of the flow series.
const WINDOW: f64 = 1.5;

/// A length for messages, without the last digits of a product.
fn digits(length: f64) -> f64 {
    format!("{length:.11e}").parse().unwrap_or(length)
}

impl Scenario {
    /// Shortest box along x in which a bed follows its base past a cylinder of this diameter.
    pub fn shortest_box(diameter: f64) -> f64 {
        DRAG_COEFFICIENT / BULK_FRICTION * diameter
    }

    pub(super) fn check_rig(&self) -> Check {
        self.check_tank()?;
        let cylinder = self.intruder.shape == IntruderShape::Cylinder;
        if self.bed.file.is_some() {
            let other = [
                (
                    cylinder,
                    "intruder.shape",
                    "a file holds a sphere as intruder",
                ),
                (
                    self.lid.is_some(),
                    "lid",
                    "is laid on a bed that comes to rest under it, and a file's bed is taken as it is",
                ),
                (
                    self.drag.moves == Moves::Bed,
                    "drag.moves",
                    "a file's base stays at rest",
                ),
                (
                    self.bed.pouring == PouringOrder::InTurn,
                    "bed.pouring",
                    "a file's bed is not poured",
                ),
            ];
            return match other.iter().find(|(given, ..)| *given) {
                Some((_, key, why)) => refuse(key, format!("{why}; leave it out, or bed.file")),
                None => Ok(()),
            };
        }
        if cylinder {
            self.check_cylinder()?;
        }
        if self.drag.moves == Moves::Bed && self.bed.base == 0.0 {
            return refuse(
                "bed.base",
                "is 0, but with drag.moves = \"bed\" the base carries the bed; give a height, \
                 such as 0.6 of a grain's diameter",
            );
        }
        self.check_lid()
    }

    fn check_cylinder(&self) -> Check {
        let ([x, _, _], d) = (self.bed.size, self.mean_diameter());
        let most = self.bed.diameters[1];
        for plan in self.plan_beds() {
            let lowest = plan.center[2] - 0.5 * plan.diameter;
            // Frozen centres lie below the base's height.
            let base = self.bed.base + 0.5 * most;
            if lowest <= base {
                let key = self.height_key();
                return refuse(
                    key,
                    format!(
                        "puts the cylinder's lowest point at z = {}, on the base, whose grains reach \
                         {}: raise it",
                        short(lowest),
                        short(base)
                    ),
                );
            }
            let shortest = Self::shortest_box(plan.diameter);
            if x < shortest {
                return refuse(
                    "bed.box",
                    format!(
                        "is {x} along x; round a cylinder of diameter {} the bed follows its base \
                         only in a box of C_d D/mu or longer (C_d = {DRAG_COEFFICIENT}, mu = \
                         {BULK_FRICTION} of the bed): make it {}, which is a whole number of \
                         grains, or the cylinder thinner",
                        plan.diameter,
                        digits((shortest / d).ceil() * d)
                    ),
                );
            }
            let discard = self.drag.discard.unwrap_or(f64::INFINITY);
            if discard < STEADY * plan.diameter {
                return refuse(
                    "drag.discard",
                    format!(
                        "is {discard}, before the steady state, which begins after {STEADY} \
                         diameters of the cylinder, {}: raise it, or leave it out",
                        short(STEADY * plan.diameter)
                    ),
                );
            }
        }
        Ok(())
    }

    /// A window too short for a mean of the flow.
    pub(super) fn check_window(&self, run: &super::DragPlan) -> Check {
        let (window, least) = (run.distance - run.discard, WINDOW * self.mean_diameter());
        if self.flows() && window < least {
            return refuse(
                "drag.distance",
                format!(
                    "leaves {} of travel to average after {} are discarded; a flowing bed takes {} or \
                     more",
                    short(window),
                    short(run.discard),
                    short(least)
                ),
            );
        }
        Ok(())
    }

    fn check_lid(&self) -> Check {
        let Some(lid) = &self.lid else {
            return Ok(());
        };
        let d = self.mean_diameter();
        let (key, values) = match (&lid.effective_depth, &lid.density) {
            (Some(_), Some(_)) => {
                return refuse("lid.density", "give effective_depth or density, not both");
            }
            (None, None) => {
                return refuse("lid.effective_depth", "give effective_depth or density");
            }
            (Some(depths), None) => ("lid.effective_depth", depths.values()),
            (None, Some(densities)) => ("lid.density", densities.values()),
        };
        if values.is_empty() {
            return refuse(key, "is empty; expected at least one value");
        }
        for (k, &value) in values.iter().enumerate() {
            positive(key, value)?;
            if values[..k].contains(&value) {
                return refuse(key, "has a value twice; each makes its own beds");
            }
            if lid.density.is_some() && value < self.bed.density {
                return refuse(
                    key,
                    format!(
                        "is {value}, lighter than the bed's grains, {}: such grains are not a lid; \
                         give more, or leave the lid out",
                        self.bed.density
                    ),
                );
            }
        }
        for (length, sites, axis) in [
            (self.bed.size[0], self.lid_sites()[0], "x"),
            (self.bed.size[1], self.lid_sites()[1], "y"),
        ] {
            if (length - sites as f64 * d).abs() > TILES * length {
                return refuse(
                    "bed.box",
                    format!(
                        "is {length} along {axis}, which a lid of grains of diameter {d} does not \
                         tile; the nearest length that it tiles is {}",
                        digits(sites as f64 * d)
                    ),
                );
            }
        }
        for plan in self.plan_beds() {
            let surface = self.expected_surface(plan.diameter);
            // A grain of the bed's own density adds its own layer, and the bed may come out higher.
            let depth = (1.0 + HIGHER) * surface - plan.center[2] + d;
            let own = plan.lid.filter(|lid| lid.pressure_gradient);
            if let Some(h) = own.and_then(|lid| lid.effective_depth)
                && h < depth
            {
                return refuse(
                    key,
                    format!(
                        "is {h}; a lid at least as dense as the bed's grains gives about {} or more \
                         to an intruder {} deep: ask for that or for its own depth, raise it, or ask for it \
                         without a pressure gradient",
                        short(depth),
                        short(surface - plan.center[2])
                    ),
                );
            }
            let top = (1.0 + HIGHER) * surface + HEADROOM * d;
            if top > self.bed.size[2] {
                return refuse(
                    "bed.box",
                    format!(
                        "has a height of {}; bed and lid need about {}: make it higher",
                        self.bed.size[2],
                        short(top)
                    ),
                );
            }
        }
        Ok(())
    }

    /// Radius and density of every body whose contacts bound the time step.
    pub fn sizes(&self) -> Vec<(f64, f64)> {
        let mut sizes = vec![(0.5 * self.bed.diameters[0], self.bed.density)];
        if let Some(density) = self.intruder.density {
            let diameters = self.intruder.diameter.values();
            sizes.extend(diameters.iter().map(|d| (0.5 * d, density)));
        }
        sizes
    }
}
