//! Obstacles: bodies that push grains and move as prescribed, and the force the grains put on them.

use crate::error::Error;
use crate::math::real::{Real, smaller};
use crate::math::vec3::{Vec3, dot, scale, sub};
use crate::state::domain::Domain;

/// What an obstacle is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Shape<R> {
    /// A ball about the obstacle's point.
    Sphere {
        /// Radius (length), positive.
        radius: R,
    },
    /// An endless round bar through the obstacle's point. To a grain it counts as flat, with the
    /// grain's own radius as effective radius (Guillard 2014, appendix A).
    Cylinder {
        /// Unit vector along the bar.
        axis: Vec3<R>,
        /// Radius (length), positive.
        radius: R,
    },
    /// A flat wall through the obstacle's point; grains live on the side its normal points to.
    Plane {
        /// Unit vector out of the wall.
        normal: Vec3<R>,
    },
}

/// A body with prescribed motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Obstacle<R> {
    /// What it is.
    pub shape: Shape<R>,
    /// Its centre, a point of its axis, or a point of its plane (length, inside the box).
    pub point: Vec3<R>,
    /// Crossings of each periodic axis so far.
    pub image: [i32; 3],
    /// Velocity (length / time): constant between changes by the caller.
    pub velocity: Vec3<R>,
    /// 1 / mass as it enters the effective mass of its contacts; 0 is infinitely heavy.
    pub inverse_mass: R,
    /// Sum of the contact forces of the grains on it, by ascending grain id.
    pub force: Vec3<R>,
    /// Torque of those forces about `point`.
    pub torque: Vec3<R>,
}

/// Where a grain meets an obstacle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ContactGeometry<R> {
    /// Unit vector from the obstacle's surface to the grain's centre.
    pub normal: Vec3<R>,
    /// Vector from the obstacle's point to the grain's centre.
    pub offset: Vec3<R>,
    /// Depth of the overlap.
    pub overlap: R,
    /// Radius of curvature as the law sees it; 0 for flat.
    pub radius: R,
}

impl<R: Real> Obstacle<R> {
    fn new(shape: Shape<R>, point: Vec3<R>) -> Self {
        Self {
            shape,
            point,
            image: [0; 3],
            velocity: [R::ZERO; 3],
            inverse_mass: R::ZERO,
            force: [R::ZERO; 3],
            torque: [R::ZERO; 3],
        }
    }

    /// A resting, infinitely heavy ball of this radius (length).
    pub fn sphere(center: Vec3<R>, radius: R) -> Self {
        Self::new(Shape::Sphere { radius }, center)
    }

    /// A resting, infinitely heavy bar of this radius (length); `axis` of any length but zero.
    pub fn cylinder(center: Vec3<R>, axis: Vec3<R>, radius: R) -> Self {
        let axis = unit(axis);
        Self::new(Shape::Cylinder { axis, radius }, center)
    }

    /// A resting, infinitely heavy wall; `normal` of any length but zero points to the grains.
    pub fn plane(point: Vec3<R>, normal: Vec3<R>) -> Self {
        let normal = unit(normal);
        Self::new(Shape::Plane { normal }, point)
    }

    /// Checks size, place and direction against the box: a ball lies in it with its centre and is
    /// no larger; so does a bar across its axis; directions have length 1.
    ///
    /// A plane's normal may have no part along a periodic axis; if an axis is periodic, a bar
    /// must lie along one of the three axes.
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
        let periodic = domain.periodic();
        let direction_fits = match self.shape {
            Shape::Sphere { .. } => true,
            Shape::Plane { normal } => (0..3).all(|a| !periodic[a] || normal[a] == R::ZERO),
            Shape::Cylinder { axis, .. } => {
                let along = (0..3).filter(|&a| axis[a] != R::ZERO).count();
                along == 1 || !periodic.contains(&true)
            }
        };
        let numbers = [self.point, self.velocity, self.direction()];
        let finite = numbers.iter().flatten().all(|x| x.is_finite());
        let sized = match self.shape {
            Shape::Sphere { radius } | Shape::Cylinder { radius, .. } => {
                radius > R::ZERO && radius.is_finite()
            }
            Shape::Plane { .. } => true,
        };
        let direction = self.direction();
        let length = dot(direction, direction);
        let off = length - R::ONE;
        let unit = length == R::ZERO || off * off < R::EPSILON;
        let heavy = self.inverse_mass >= R::ZERO && self.inverse_mass.is_finite();
        if direction_fits && finite && sized && heavy && unit && self.is_within(domain, has_moved) {
            Ok(())
        } else {
            Err(Error::BadObstacle { obstacle: number })
        }
    }

    fn is_within(&self, domain: &Domain<R>, has_moved: bool) -> bool {
        let (lo, hi, periodic) = (domain.lo(), domain.hi(), domain.periodic());
        let along = self.direction();
        let plane = matches!(self.shape, Shape::Plane { .. });
        (0..3).all(|a| {
            let inside = self.point[a] >= lo[a] && self.point[a] <= hi[a];
            let fits = (self.reach() + self.reach()) <= hi[a] - lo[a];
            let left = has_moved && !periodic[a];
            plane || along[a] != R::ZERO || ((inside || left) && fits)
        })
    }

    fn direction(&self) -> Vec3<R> {
        match self.shape {
            Shape::Sphere { .. } => [R::ZERO; 3],
            Shape::Cylinder { axis, .. } => axis,
            Shape::Plane { normal } => normal,
        }
    }

    /// How far from `point` (or the bar's axis) the surface reaches (length).
    pub fn reach(&self) -> R {
        match self.shape {
            Shape::Sphere { radius } | Shape::Cylinder { radius, .. } => radius,
            Shape::Plane { .. } => R::ZERO,
        }
    }

    /// How deep a grain of this radius may overlap it: a quarter of the smaller diameter.
    #[inline(always)]
    pub(crate) fn depth_allowed(&self, radius: R) -> R {
        let own = self.reach();
        let least = if own > R::ZERO {
            smaller(radius, own)
        } else {
            radius
        };
        least * R::HALF
    }

    /// Moves the obstacle by one step of `dt` and wraps it.
    pub(crate) fn advance(&mut self, domain: &Domain<R>, dt: R) {
        for a in 0..3 {
            self.point[a] = self.point[a] + self.velocity[a] * dt;
        }
        // An obstacle may leave the box through a closed edge: only grains must stay inside.
        domain.wrap(&mut self.point, &mut self.image);
    }

    /// Where a grain at `position` with this radius meets the surface.
    ///
    /// The normal is the offset divided by the distance, component by component.
    #[inline(always)]
    pub(crate) fn meet(
        &self,
        domain: &Domain<R>,
        position: Vec3<R>,
        radius: R,
    ) -> ContactGeometry<R> {
        match self.shape {
            Shape::Sphere { radius: own } => {
                let offset = domain.separation(position, self.point);
                let distance = dot(offset, offset).sqrt();
                ContactGeometry {
                    normal: divide(offset, distance),
                    offset,
                    overlap: (radius + own) - distance,
                    radius: own,
                }
            }
            Shape::Cylinder { axis, radius: own } => {
                let offset = domain.separation(position, self.point);
                let across = sub(offset, scale(axis, dot(offset, axis)));
                let distance = dot(across, across).sqrt();
                ContactGeometry {
                    normal: divide(across, distance),
                    offset,
                    overlap: (radius + own) - distance,
                    radius: R::ZERO,
                }
            }
            Shape::Plane { normal } => {
                let offset = sub(position, self.point);
                ContactGeometry {
                    normal,
                    offset,
                    overlap: radius - dot(offset, normal),
                    radius: R::ZERO,
                }
            }
        }
    }
}

fn unit<R: Real>(v: Vec3<R>) -> Vec3<R> {
    divide(v, dot(v, v).sqrt())
}

#[inline(always)]
fn divide<R: Real>(v: Vec3<R>, s: R) -> Vec3<R> {
    [v[0] / s, v[1] / s, v[2] / s]
}
