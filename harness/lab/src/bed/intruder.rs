//! The body round which a bed is made.

use crate::scenario::{BedPlan, CheckedScenario, IntruderShape};
use bitgrain_kernel::Obstacle;
use bitgrain_sim::simulation::sphere_mass;

/// The intruder of a plan, at rest.
pub(super) fn intruder(scenario: &CheckedScenario, plan: &BedPlan) -> Obstacle<f64> {
    let radius = 0.5 * plan.diameter;
    match scenario.intruder.shape {
        IntruderShape::Cylinder => Obstacle::cylinder(plan.center, [0.0, 1.0, 0.0], radius),
        IntruderShape::Bar => {
            let half = 0.5 * scenario.intruder_length(plan.diameter);
            Obstacle::finite_cylinder(plan.center, [0.0, 1.0, 0.0], radius, half)
        }
        IntruderShape::Sphere => Obstacle {
            inverse_mass: scenario
                .intruder
                .density
                .map_or(0.0, |density| 1.0 / sphere_mass(plan.diameter, density)),
            ..Obstacle::sphere(plan.center, radius)
        },
    }
}
