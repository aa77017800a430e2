//! What obstacle contacts take from their obstacles, as parts tell each other and the whole world.

use bitgrain_kernel::phases::{ObstacleShare, sum_on_obstacles};
use bitgrain_kernel::{Motion, Obstacle, TOUCHING, obstacle_of};
use serde::{Deserialize, Serialize};

use crate::notes::by_grain;

/// An obstacle contact of a grain at a place of the whole world.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Share {
    pub grain: u32,
    /// Of its obstacle, with the touching bit.
    pub word: u32,
    pub share: ObstacleShare<f64>,
}

impl Share {
    /// The obstacle, if the grain touches it.
    pub fn touched(&self) -> Option<u32> {
        (self.word & TOUCHING != 0).then(|| obstacle_of(self.word))
    }
}

/// Whether the forces on an obstacle move it.
pub(super) fn is_free(body: &Obstacle<f64>) -> bool {
    matches!(body.motion, Motion::Free(_))
}

/// Sets force and torque on the obstacles that move freely to the sums of what all parts told.
pub(super) fn sum_on_free<'p>(
    obstacles: &mut [Obstacle<f64>],
    pushes: impl Iterator<Item = &'p Vec<Share>>,
) {
    let pushes = by_grain(pushes, |push| push.grain);
    let mut sums = obstacles.to_vec();
    sum_on_obstacles(&mut sums, pushes.iter().map(|push| push.share));
    for (body, sum) in obstacles.iter_mut().zip(sums) {
        if is_free(body) {
            (body.force, body.torque) = (sum.force, sum.torque);
        }
    }
}
