//! A state as a picture.

use bitgrain_kernel::Shape;

use crate::report::{BedPicture, PictureGrain};
use bitgrain_lab::frames;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::observe::{self, INTRUDER};
use bitgrain_sim::simulation::Simulation;

/// A state as a picture, of an intruder that goes along x.
pub(super) fn picture(sim: &Simulation, name: &str, surface: f64) -> BedPicture {
    let body = &sim.obstacles[INTRUDER as usize];
    let ([x, _, z], y) = (body.point, frames::plane(sim));
    let grain = |i: usize| PictureGrain {
        position: [sim.position[i][0], sim.position[i][1], sim.position[i][2]],
        radius: sim.position[i][3],
        role: sim.role(i),
    };
    BedPicture {
        name: name.to_owned(),
        // The floor of the bed; the box goes on below it so that a leak is seen.
        lo: [sim.domain.lo()[0], sim.domain.lo()[1], 0.0],
        hi: sim.domain.hi(),
        surface,
        grains: (0..sim.count()).map(grain).collect(),
        intruder: ([x, y, z], observe::girth(body)),
        half_length: match body.shape {
            Shape::Cylinder { .. } => Some(f64::INFINITY),
            Shape::FiniteCylinder { half_length, .. } => Some(half_length),
            _ => None,
        },
        moves: Moves::Intruder,
        arrow: true,
    }
}
