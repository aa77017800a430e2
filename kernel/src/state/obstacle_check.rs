//! Whether an obstacle is possible in a box, and what is wrong if it is not.

use crate::error::Error;
use crate::math::real::Real;
use crate::math::vec3::{dot, sub};
use crate::obstacle_defect::ObstacleDefect;
use crate::state::domain::Domain;
use crate::state::obstacle::Obstacle;
use crate::state::shape::Shape;
use crate::state::turning::{length2, to_world};

impl<R: Real> Obstacle<R> {
    /// Checks size, place, direction and motion against the box: a ball lies in it with its centre and is
    /// no larger; so does a bar across its axis; directions and orientation have length 1.
    ///
    /// A plane's normal may have no part along a periodic axis; if an axis is periodic, an endless bar
    /// must lie along one of the three axes. What is endless turns about its own direction only. What moves freely has
    /// a finite mass and positive moments of inertia, and is not endless if it turns; in fixed point nothing moves
    /// freely.
    ///
    /// # Errors
    /// [`Error::BadObstacle`] with `number`.
    pub fn check(&self, domain: &Domain<R>, number: u32) -> Result<(), Error> {
        self.check_place(domain, number, false)
    }

    /// [`Obstacle::check`]; one that `has_moved` may be beyond a closed edge, as in a run.
    pub(crate) fn check_place(
        &self,
        domain: &Domain<R>,
        number: u32,
        has_moved: bool,
    ) -> Result<(), Error> {
        let numbers = [self.point, self.velocity, self.angular_velocity];
        let finite = numbers.iter().flatten().all(|x| x.is_finite());
        let heavy = self.inverse_mass >= R::ZERO && self.inverse_mass.is_finite();
        let flaw = if !(finite && heavy && self.shape.is_sound()) {
            Some(ObstacleDefect::Number)
        } else {
            let endless = self.shape.is_endless();
            let flaw = self.crosses_badly(domain.periodic());
            let flaw = flaw.or_else(|| self.turns_badly());
            let flaw = flaw.or_else(|| self.motion.flaw(self.inverse_mass, endless));
            flaw.or_else(|| self.lies_badly(domain, has_moved))
        };
        refused(number, flaw)
    }

    /// The part of [`Obstacle::check`] that asks how it turns: for a host that changes that alone during a run.
    ///
    /// # Errors
    /// [`Error::BadObstacle`] with `number`.
    pub fn check_turn(&self, number: u32) -> Result<(), Error> {
        refused(number, self.turns_badly())
    }

    /// What is wrong with its direction.
    fn crosses_badly(&self, periodic: [bool; 3]) -> Option<ObstacleDefect> {
        match self.shape {
            Shape::Plane { normal } => {
                let faces = (0..3).any(|a| periodic[a] && normal[a] != R::ZERO);
                faces.then_some(ObstacleDefect::Facing)
            }
            Shape::Cylinder { axis, .. } => {
                let along = (0..3).filter(|&a| axis[a] != R::ZERO).count();
                (along != 1 && periodic.contains(&true)).then_some(ObstacleDefect::Askew)
            }
            _ => None,
        }
    }

    /// What is wrong if the orientation is none, or what is endless turns other than about its own direction.
    fn turns_badly(&self) -> Option<ObstacleDefect> {
        let off = length2(self.orientation) - R::ONE;
        let is_unit = off * off < R::EPSILON;
        let direction = self.shape.direction();
        let tilt = sub(to_world(self.orientation, direction), direction);
        let keeps = dot(tilt, tilt) < R::EPSILON && self.swing() == R::ZERO;
        match (self.has_turned(), is_unit) {
            (false, _) => None,
            (true, false) => Some(ObstacleDefect::Number),
            (true, true) if keeps || !self.shape.is_endless() => None,
            (true, true) => Some(ObstacleDefect::Tilted),
        }
    }

    fn lies_badly(&self, domain: &Domain<R>, has_moved: bool) -> Option<ObstacleDefect> {
        let (lo, hi, periodic) = (domain.lo(), domain.hi(), domain.periodic());
        // What is endless may be anywhere along itself; a plane, and the middle of a drum or a mesh, anywhere.
        let along = match self.shape.is_endless() {
            true => self.shape.direction(),
            false => [R::ZERO; 3],
        };
        let anywhere = matches!(
            self.shape,
            Shape::Plane { .. } | Shape::Drum { .. } | Shape::Mesh { .. }
        );
        let is_round = matches!(self.shape, Shape::Sphere { .. } | Shape::Cylinder { .. });
        (0..3).find_map(|a| {
            let inside = self.point[a] >= lo[a] && self.point[a] <= hi[a];
            let fits = !is_round || (self.reach() + self.reach()) <= hi[a] - lo[a];
            let left = has_moved && !periodic[a];
            match (anywhere || along[a] != R::ZERO, inside || left) {
                (true, _) => None,
                (_, false) => Some(ObstacleDefect::Outside),
                (_, true) => (!fits).then_some(ObstacleDefect::Large),
            }
        })
    }
}

fn refused(obstacle: u32, flaw: Option<ObstacleDefect>) -> Result<(), Error> {
    flaw.map_or(Ok(()), |flaw| Err(Error::BadObstacle { obstacle, flaw }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::motion::{FreeMotion, Motion};

    /// Each body is impossible, or would turn impossibly, for a reason of its own.
    #[test]
    fn what_is_wrong_is_said() {
        use ObstacleDefect as D;
        let domain = Domain::new([0.0; 3], [4.0; 3], [true, false, false]).unwrap();
        let (x, y, middle) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0; 3]);
        let ball = Obstacle::sphere(middle, 1.0);
        let bar = Obstacle::cylinder(middle, y, 1.0);
        let free = |inertia| Motion::Free(FreeMotion::new(inertia, [0.0; 3]));
        let (inverse_mass, tilt) = (1.0, [0.8, 0.6, 0.0, 0.0]);
        let said = |body: &Obstacle<f64>| match body.check(&domain, 7) {
            Err(Error::BadObstacle { obstacle: 7, flaw }) => Some(flaw),
            Err(other) => panic!("{other}"),
            Ok(()) => None,
        };
        for (flaw, body) in [
            (None, ball),
            (None, bar),
            (Some(D::Number), Obstacle::sphere(middle, -1.0)),
            (Some(D::Facing), Obstacle::plane(middle, x)),
            (
                Some(D::Askew),
                Obstacle::cylinder(middle, [1.0, 1.0, 0.0], 1.0),
            ),
            (
                Some(D::Tilted),
                Obstacle {
                    angular_velocity: x,
                    ..bar
                },
            ),
            (
                Some(D::Tilted),
                Obstacle {
                    orientation: tilt,
                    ..bar
                },
            ),
            (
                Some(D::Weightless),
                Obstacle {
                    motion: free([1.0; 3]),
                    ..ball
                },
            ),
            (
                Some(D::Inertia),
                Obstacle {
                    motion: free([0.0; 3]),
                    inverse_mass,
                    ..ball
                },
            ),
            (
                Some(D::Inertia),
                Obstacle {
                    motion: free([1.0; 3]),
                    inverse_mass,
                    ..bar
                },
            ),
            (
                Some(D::Outside),
                Obstacle {
                    point: [2.0, 5.0, 2.0],
                    ..ball
                },
            ),
            (Some(D::Large), Obstacle::sphere(middle, 2.5)),
        ] {
            assert_eq!(said(&body), flaw, "{body:?}");
            let turns = flaw != Some(D::Tilted);
            assert_eq!(body.check_turn(7).is_ok(), turns, "{body:?}");
        }
    }
}
