//! Where the cylinder's axis lies in its bed: base and surface are not as far from it unless it is in the middle.

use bitgrain_sim::format::short;

/// How far the axis may lie off the middle of the bed and still count as in the middle, over D: the bed settles higher
/// or lower than it was planned by about half of that.
const MIDDLE: f64 = 0.5;

/// Distances of the axis from the ends of its settled bed, mean over runs (lengths).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Height above the floor.
    pub floor: f64,
    /// Depth below the free surface, a lid not counted.
    pub surface: f64,
}

impl Place {
    /// How far the axis lies above the middle of the bed.
    pub fn above_middle(&self) -> f64 {
        0.5 * (self.floor - self.surface)
    }

    /// Whether an axis of a cylinder of this diameter lies in the middle, to half of that.
    pub fn is_middle(&self, diameter: f64) -> bool {
        self.above_middle().abs() <= MIDDLE * diameter
    }

    /// `7.3 D above the floor and 7.1 D below the surface`.
    pub fn words(&self, diameter: f64) -> String {
        let over = |length: f64| short((10.0 * length / diameter).round() / 10.0);
        format!(
            "{} D above the floor and {} D below the surface",
            over(self.floor),
            over(self.surface)
        )
    }
}
