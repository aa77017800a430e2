//! What a summary says of an intruder that forces moved.

use serde::{Deserialize, Serialize};

/// The way of an intruder that forces moved. Heights are above z = 0; the periods of the box that it crossed count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Released {
    /// Its mass.
    pub mass: f64,
    /// Height of the free surface before it was set going.
    pub surface: f64,
    /// Its centre as it was set going.
    pub begin: [f64; 3],
    /// Its velocity then.
    pub begin_velocity: [f64; 3],
    /// Its centre as averaging began, to a row of the series.
    pub window_begin: [f64; 3],
    /// Its centre at the end.
    pub end: [f64; 3],
    /// Its velocity then.
    pub end_velocity: [f64; 3],
    /// Lowest height of its centre at any row of the series.
    pub lowest: f64,
    /// Highest one.
    pub highest: f64,
    /// Time since which it rests: its kinetic energy by velocity is below 1e-4 of its weight times the mean diameter of
    /// the grains at every later row; none if it moved at the end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rest: Option<f64>,
}

impl Released {
    /// Depth of its lowest point below the free surface at the end, by its diameter.
    pub fn penetration(&self, diameter: f64) -> f64 {
        self.surface - (self.end[2] - 0.5 * diameter)
    }

    /// Height above the free surface from which its lowest point fell, or would have fallen to begin with its
    /// velocity.
    pub fn fallen_from(&self, diameter: f64, gravity: f64) -> f64 {
        let [_, _, w] = self.begin_velocity;
        self.begin[2] - 0.5 * diameter - self.surface + 0.5 * w * w / gravity
    }
}
