//! How large the bed is across, and its intruder.

use super::{Container, IntruderShape, Scenario};

impl Scenario {
    /// Area of the bed as seen from above (length^2).
    pub fn bed_area(&self) -> f64 {
        let [x, y, _] = self.bed.size;
        match self.bed.container {
            Container::Periodic => x * y,
            Container::Tank => std::f64::consts::PI / 4.0 * x * x,
        }
    }

    /// Length of an intruder of this diameter: of a cylinder the box along y, of a sphere its diameter.
    pub fn intruder_length(&self, diameter: f64) -> f64 {
        match self.intruder.shape {
            IntruderShape::Sphere => diameter,
            IntruderShape::Cylinder => self.bed.size[1],
            IntruderShape::Bar => self.intruder.length.unwrap_or(0.0),
        }
    }

    /// Volume of an intruder of this diameter in the box.
    pub fn intruder_volume(&self, diameter: f64) -> f64 {
        match self.intruder.shape {
            IntruderShape::Sphere => bitgrain_sim::simulation::sphere_mass(diameter, 1.0),
            IntruderShape::Cylinder | IntruderShape::Bar => {
                std::f64::consts::PI / 4.0 * diameter * diameter * self.intruder_length(diameter)
            }
        }
    }
}
