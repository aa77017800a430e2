//! Obstacles that move as they are told: at a velocity, or to a place within a time.

use bitgrain_kernel::{Error as KernelError, Obstacle};

use crate::simulated::Core;

/// An obstacle by its number, the point that it goes to, and the orientation that it turns to, if it turns.
pub type Drive = (usize, [f64; 3], Option<[f64; 4]>);

impl Core {
    /// Gives an obstacle a velocity for all steps to come.
    pub fn move_obstacle(&mut self, number: usize, velocity: [f64; 3]) {
        self.stop_drive(number);
        self.sim.obstacles[number].velocity = velocity;
    }

    /// Gives an obstacle an angular velocity for all steps to come.
    ///
    /// # Errors
    /// [`KernelError::BadObstacle`] if it cannot turn so.
    pub fn turn_obstacle(
        &mut self,
        number: usize,
        angular_velocity: [f64; 3],
    ) -> Result<(), KernelError> {
        let turned = Obstacle {
            angular_velocity,
            ..self.sim.obstacles[number]
        };
        turned.check_turn(number as u32)?;
        self.driven[number].turns = false;
        self.sim.obstacles[number] = turned;
        Ok(())
    }

    /// Has obstacles go to points, and turn to orientations where they are given, within `count` steps, at constant
    /// velocities, and rest there; all of them or none.
    ///
    /// # Errors
    /// [`KernelError::BadObstacle`] if one cannot turn so.
    pub fn drive(&mut self, drives: &[Drive], count: u64) -> Result<(), KernelError> {
        let dt = self.sim.dt;
        let time = count as f64 * dt;
        let mut bodies = Vec::with_capacity(drives.len());
        for (number, point, orientation) in drives {
            let mut body = self.sim.obstacles[*number];
            if let Some(orientation) = *orientation {
                let steps = u32::try_from(count).unwrap_or(u32::MAX);
                body.drive_to([0.0; 3], orientation, steps, dt);
            }
            for a in 0..3 {
                body.velocity[a] = (point[a] - body.point[a]) / time;
            }
            body.check_turn(*number as u32)?;
            bodies.push(body);
        }
        for ((number, _, orientation), body) in drives.iter().zip(bodies) {
            self.sim.obstacles[*number] = body;
            let driven = &mut self.driven[*number];
            (driven.left, driven.turns) = (count, orientation.is_some());
        }
        Ok(())
    }

    /// Ends a drive; what was not driven keeps its velocities.
    pub fn stop_drive(&mut self, number: usize) {
        let driven = &mut self.driven[number];
        let turned = std::mem::take(&mut driven.turns);
        if std::mem::take(&mut driven.left) > 0 {
            let body = &mut self.sim.obstacles[number];
            body.velocity = [0.0; 3];
            if turned {
                body.angular_velocity = [0.0; 3];
            }
        }
    }

    /// Counts steps off the drives.
    pub fn count_drives(&mut self, done: u64) {
        for number in 0..self.driven.len() {
            match self.driven[number].left {
                0 => {}
                left if left <= done => self.stop_drive(number),
                left => self.driven[number].left = left - done,
            }
        }
    }
}
