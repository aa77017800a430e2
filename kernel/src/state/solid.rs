//! What shapes weigh: volume and moments of inertia of a body of one density.

use crate::math::real::Real;
use crate::math::vec3::Vec3;
use crate::state::shape::Shape;

impl<R: Real> Shape<R> {
    /// Its volume (length^3); none of an endless shape, a tank or a mesh.
    #[must_use]
    pub fn volume(&self) -> Option<R> {
        let pi = R::from_f64(core::f64::consts::PI);
        match *self {
            Self::Sphere { radius } => {
                Some(((pi * R::from_f64(4.0 / 3.0)) * (radius * radius)) * radius)
            }
            Self::FiniteCylinder {
                radius,
                half_length,
                ..
            } => Some((pi * (radius * radius)) * (half_length + half_length)),
            Self::Capsule {
                radius,
                half_length,
                ..
            } => {
                let ball = R::from_f64(4.0 / 3.0) * radius;
                Some((pi * (radius * radius)) * ((half_length + half_length) + ball))
            }
            Self::Box { half } => Some(((half[0] * half[1]) * half[2]) * R::from_f64(8.0)),
            Self::Cylinder { .. } | Self::Plane { .. } | Self::Drum { .. } | Self::Mesh { .. } => {
                None
            }
        }
    }

    /// Its moments of inertia about its own axes for a mass of 1, if it is of one density (length^2); none of an
    /// endless shape, a tank, a mesh, and one that lies askew to its own axes.
    #[must_use]
    pub fn inertia(&self) -> Option<Vec3<R>> {
        let fraction = |a: f64, b: f64| R::from_f64(a / b);
        let (axis, along, across) = match *self {
            Self::Sphere { radius } => {
                return Some([(radius * radius) * fraction(2.0, 5.0); 3]);
            }
            Self::Box { half } => {
                let [x, y, z] = half.map(|h| h * h);
                return Some([y + z, x + z, x + y].map(|sum| sum * fraction(1.0, 3.0)));
            }
            Self::FiniteCylinder {
                axis,
                radius,
                half_length,
            } => {
                let round = radius * radius;
                let long = half_length * half_length;
                let across = round * fraction(1.0, 4.0) + long * fraction(1.0, 3.0);
                (axis, round * R::HALF, across)
            }
            Self::Capsule {
                axis,
                radius,
                half_length,
            } => {
                // The bar's part of the volume, and that of both half balls.
                let bar = half_length + half_length;
                let balls = radius * fraction(4.0, 3.0);
                let (bar, balls) = (bar / (bar + balls), balls / (bar + balls));
                let (round, long) = (radius * radius, half_length * half_length);
                let along = bar * (round * R::HALF) + balls * (round * fraction(2.0, 5.0));
                let bar = bar * (round * fraction(1.0, 4.0) + long * fraction(1.0, 3.0));
                let shifted = long + (radius * half_length) * fraction(3.0, 4.0);
                let balls = balls * (round * fraction(2.0, 5.0) + shifted);
                (axis, along, bar + balls)
            }
            Self::Cylinder { .. } | Self::Plane { .. } | Self::Drum { .. } | Self::Mesh { .. } => {
                return None;
            }
        };
        let is_straight = axis.iter().filter(|x| **x != R::ZERO).count() == 1;
        is_straight.then(|| axis.map(|x| if x == R::ZERO { across } else { along }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::domain::Domain;
    use crate::state::obstacle::Obstacle;
    use std::vec::Vec;

    /// Places of a fine lattice within a body, by the kernel's own distance.
    fn inside(body: &Obstacle<f64>) -> (Vec<Vec3<f64>>, f64) {
        let (reach, count) = (2.2, 88);
        let edge = 2.0 * reach / f64::from(count);
        let at = |k: i32| -reach + (f64::from(k) + 0.5) * edge;
        let mut places = Vec::new();
        for x in 0..count {
            for y in 0..count {
                for z in 0..count {
                    let place = [at(x), at(y), at(z)];
                    if body.meet(0, &[], &Domain::open(), place, 0.0).overlap > 0.0 {
                        places.push(place);
                    }
                }
            }
        }
        (places, edge * edge * edge)
    }

    /// Volume and moments as sums over a lattice, whose cells at the surface are in or out: within a hundredth.
    #[test]
    fn volumes_and_moments_are_those_of_the_places_inside() {
        let axis = [0.0, 1.0, 0.0];
        for body in [
            Obstacle::sphere([0.0; 3], 1.7),
            Obstacle::cuboid([0.0; 3], [1.1, 0.7, 1.9]),
            Obstacle::finite_cylinder([0.0; 3], axis, 1.3, 1.1),
            Obstacle::capsule([0.0; 3], axis, 0.9, 1.2),
        ] {
            let (places, cell) = inside(&body);
            let volume = body.shape.volume().unwrap();
            let counted = places.len() as f64 * cell;
            assert!((counted / volume - 1.0).abs() < 0.01, "{:?}", body.shape);
            let moment = |a: usize| {
                let far =
                    |x: &Vec3<f64>| (0..3).filter(|b| *b != a).map(|b| x[b] * x[b]).sum::<f64>();
                places.iter().map(far).sum::<f64>() / places.len() as f64
            };
            let inertia = body.shape.inertia().unwrap();
            for a in 0..3 {
                assert!(
                    (moment(a) / inertia[a] - 1.0).abs() < 0.01,
                    "{a} {:?}",
                    body.shape
                );
            }
        }
        let askew = Obstacle::capsule([0.0; 3], [0.0, 1.0, 1.0], 0.9, 1.2);
        assert!(askew.shape.inertia().is_none());
    }
}
