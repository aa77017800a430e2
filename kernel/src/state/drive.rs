//! Velocities at which a body arrives somewhere: set-up by the host, between steps.

use crate::math::real::Real;
use crate::math::vec3::Vec3;
use crate::state::obstacle::Obstacle;
use crate::state::turning::{Orientation, after};

impl<R: Real> Obstacle<R> {
    /// Gives it the velocity and the angular velocity at which it goes `way` (length) and turns to an orientation, the
    /// shorter way round, in so many steps of `dt`; then the host stops it. It arrives to the rounding of as many
    /// additions and turns. For set-up, not within a step: it takes an arc tangent.
    pub fn drive_to(&mut self, way: Vec3<R>, orientation: Orientation<R>, steps: u32, dt: R) {
        let count = f64::from(if steps > 0 { steps } else { 1 });
        let dt = dt.to_f64();
        for a in 0..3 {
            self.velocity[a] = R::from_f64(way[a].to_f64() / (count * dt));
        }
        let [w, x, y, z] = self.orientation;
        let [w, x, y, z] = after(orientation, [w, -x, -y, -z]).map(R::to_f64);
        let sine = libm::sqrt((x * x + y * y) + z * z);
        let sign = if w < 0.0 { -1.0 } else { 1.0 };
        // The angle is four times the arc tangent of sine / (1 + cosine).
        let angle = 4.0 * libm::atan(sine / (1.0 + sign * w)) / count;
        let spin = sign * angle / (dt * sine);
        let spin = if sine > 0.0 { spin } else { 0.0 };
        self.angular_velocity = [x, y, z].map(|x| R::from_f64(x * spin));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3::dot;
    use crate::state::domain::Domain;
    use crate::state::turning::normalized;

    /// From any pose to any other one, the shorter way round.
    #[test]
    fn a_driven_body_arrives() {
        let poses = [
            normalized([0.3, -0.4, 0.5, 0.6]),
            normalized([-0.9, 0.1, 0.2, -0.3]),
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ];
        let mut body = Obstacle::cuboid([1.0, 2.0, 3.0], [0.5; 3]);
        let (steps, dt) = (500, 1e-3);
        for (k, pose) in poses.into_iter().enumerate() {
            let (from, way) = (body.point, [0.5, -1.0, 0.1 * k as f64]);
            body.drive_to(way, pose, steps, dt);
            let turned = dot(body.angular_velocity, body.angular_velocity).sqrt();
            assert!(turned * f64::from(steps) * dt < 3.2, "half a turn at most");
            for _ in 0..steps {
                body.drift(&Domain::open(), dt);
            }
            let same = |a: f64, b: f64| (a - b).abs() < 1e-12;
            assert!((0..3).all(|a| same(body.point[a], from[a] + way[a])));
            let sign = if body.orientation[0] * pose[0] + body.orientation[2] * pose[2] < 0.0 {
                -1.0
            } else {
                1.0
            };
            let near = body.orientation.iter().zip(pose);
            let mut near = near.map(|(a, b)| (a * sign - b).abs());
            assert!(
                near.all(|off| off < 1e-12),
                "{:?} {pose:?}",
                body.orientation
            );
        }
        body.drive_to([0.0; 3], body.orientation, steps, dt);
        assert_eq!((body.velocity, body.angular_velocity), ([0.0; 3], [0.0; 3]));
    }
}
