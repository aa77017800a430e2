//! Obstacles: rigid bodies that push grains, and the force the grains put on them. What they are is in `shape.rs`,
//! what moves them in `motion.rs`, and how in `rigid_body.rs`.

use crate::math::real::{Real, smaller};
use crate::math::vec3::{Vec3, add, cross, dot, length_bound, scale, sub};
use crate::state::domain::Domain;
use crate::state::facet::Facet;
use crate::state::mesh::{FACETS_MAX, Mesh};
use crate::state::motion::Motion;
use crate::state::shape::{Nearest, Shape, divide};
use crate::state::turning::{Orientation, is_upright, to_body, to_world, upright};

/// A rigid body.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Obstacle<R> {
    /// What it is.
    pub shape: Shape<R>,
    /// Its centre (the centre of mass of one that moves freely), a point of its axis, or a point of its plane (length,
    /// inside the box).
    pub point: Vec3<R>,
    /// Crossings of each periodic axis so far.
    pub image: [i32; 3],
    /// Unit quaternion `(w, x, y, z)` that turns the shape from its own axes to those of the world.
    pub orientation: Orientation<R>,
    /// Velocity of `point` (length / time).
    pub velocity: Vec3<R>,
    /// Angular velocity in the axes of the world (radians / time).
    pub angular_velocity: Vec3<R>,
    /// 1 / mass as it enters the effective mass of its contacts; 0 is infinitely heavy.
    pub inverse_mass: R,
    /// Whether the curvature `1/c` of its surface counts in the effective radius of a contact, `1 / (1/r + 1/c)`: `c`
    /// is twice the radius of a bar, its negative inside a drum, and the radius of a half ball. If not, only that of
    /// a ball counts, and other surfaces are flat.
    pub curved: bool,
    /// Number of its material, for a law that tells materials apart.
    pub material: u8,
    /// What moves it.
    pub motion: Motion<R>,
    /// Sum of the contact forces of the grains on it, by ascending grain id.
    pub force: Vec3<R>,
    /// Torque of those forces about `point`.
    pub torque: Vec3<R>,
}

/// Where a grain meets a surface of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting<R> {
    /// Unit vector from the obstacle's surface to the grain's centre.
    pub normal: Vec3<R>,
    /// Vector from the obstacle's point to the grain's centre.
    pub offset: Vec3<R>,
    /// Depth of the overlap; below zero the distance.
    pub overlap: R,
    /// Radius of curvature of the surface, as it counts in the effective radius; 0 for flat.
    pub curvature: R,
    /// How much of the law's force counts: less than 1 only where triangles of a mesh meet at a hollow crease that
    /// reaches into the grain, or where the grain touches the mesh elsewhere.
    pub share: R,
}

impl<R: Real> Obstacle<R> {
    /// A resting, infinitely heavy body of this shape, about this point (length) and along the axes of the world.
    pub fn new(shape: Shape<R>, point: Vec3<R>) -> Self {
        Self {
            shape,
            point,
            image: [0; 3],
            orientation: upright(),
            velocity: [R::ZERO; 3],
            angular_velocity: [R::ZERO; 3],
            inverse_mass: R::ZERO,
            curved: false,
            material: 0,
            motion: Motion::Prescribed,
            force: [R::ZERO; 3],
            torque: [R::ZERO; 3],
        }
    }

    /// A resting, infinitely heavy ball of this radius (length).
    pub fn sphere(center: Vec3<R>, radius: R) -> Self {
        Self::new(Shape::Sphere { radius }, center)
    }

    /// A resting, infinitely heavy, endless bar of this radius (length); `axis` of any length but zero.
    pub fn cylinder(center: Vec3<R>, axis: Vec3<R>, radius: R) -> Self {
        let axis = unit(axis);
        Self::new(Shape::Cylinder { axis, radius }, center)
    }

    /// A resting, infinitely heavy bar of this radius and half length (length); `axis` of any length but zero.
    pub fn finite_cylinder(center: Vec3<R>, axis: Vec3<R>, radius: R, half_length: R) -> Self {
        let axis = unit(axis);
        let shape = Shape::FiniteCylinder {
            axis,
            radius,
            half_length,
        };
        Self::new(shape, center)
    }

    /// A resting, infinitely heavy bar with half balls as ends, by their radius and half the distance between their
    /// centres (length); `axis` of any length but zero.
    pub fn capsule(center: Vec3<R>, axis: Vec3<R>, radius: R, half_length: R) -> Self {
        let axis = unit(axis);
        let shape = Shape::Capsule {
            axis,
            radius,
            half_length,
        };
        Self::new(shape, center)
    }

    /// A resting, infinitely heavy box with these halves of its edges (length).
    pub fn cuboid(center: Vec3<R>, half: Vec3<R>) -> Self {
        Self::new(Shape::Box { half }, center)
    }

    /// A resting, infinitely heavy drum by its inner radius and half its inner length (length), in which grains live;
    /// `axis` of any length but zero.
    pub fn drum(center: Vec3<R>, axis: Vec3<R>, radius: R, half_length: R) -> Self {
        let axis = unit(axis);
        let shape = Shape::Drum {
            axis,
            radius,
            half_length,
        };
        Self::new(shape, center)
    }

    /// A resting, infinitely heavy mesh of these triangles, which [`arrange`](crate::arrange) has put in order; among
    /// those of the world they are the ones from number `first` on.
    pub fn mesh(center: Vec3<R>, own: &[Facet<R>], first: u32) -> Self {
        let mesh = Mesh(own);
        let shape = Shape::Mesh {
            first,
            count: u32::try_from(own.len()).unwrap_or(u32::MAX),
            reach: mesh.reach(),
            name: mesh.name(),
        };
        Self::new(shape, center)
    }

    /// A resting, infinitely heavy wall; `normal` of any length but zero points to the grains.
    pub fn plane(point: Vec3<R>, normal: Vec3<R>) -> Self {
        let normal = unit(normal);
        Self::new(Shape::Plane { normal }, point)
    }

    /// Whether these triangles are those that a mesh was made of; of another shape nothing is asked.
    pub(crate) fn has_facets(&self, facets: &[Facet<R>]) -> bool {
        let Shape::Mesh {
            first,
            count,
            reach,
            name,
        } = self.shape
        else {
            return true;
        };
        let mesh = Mesh::of(facets, first, count);
        let is_whole = mesh.0.len() == count as usize && count as usize <= FACETS_MAX;
        is_whole && mesh.reach() == reach && mesh.name() == name
    }

    /// How far from `point` (or the bar's axis) the surface reaches at most (length).
    pub fn reach(&self) -> R {
        self.shape.reach()
    }

    /// The direction of its shape in the axes of the world; zero if it has none.
    pub fn direction(&self) -> Vec3<R> {
        let own = self.shape.direction();
        match self.is_turned() {
            true => to_world(self.orientation, own),
            false => own,
        }
    }

    /// Whether its orientation changes where its surface is.
    #[inline(always)]
    fn is_turned(&self) -> bool {
        !is_upright(self.orientation) && !self.shape.is_endless()
    }

    /// Whether it is as obstacles were before they turned, moved freely and had ends: files of that time can hold it.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        let alike = Self {
            image: self.image,
            velocity: self.velocity,
            inverse_mass: self.inverse_mass,
            force: self.force,
            torque: self.torque,
            ..Self::new(self.shape, self.point)
        };
        let is_old = matches!(
            self.shape,
            Shape::Sphere { .. } | Shape::Cylinder { .. } | Shape::Plane { .. }
        );
        is_old && *self == alike
    }

    /// Whether it turns or has turned: what a digest has to say then.
    pub(crate) fn has_turned(&self) -> bool {
        !is_upright(self.orientation) || self.angular_velocity != [R::ZERO; 3]
    }

    /// Bound of the speed that its turning gives to the place of its surface (length / time). A surface of revolution
    /// that turns about itself stays where it is; what is endless may not turn otherwise.
    pub(crate) fn swing(&self) -> R {
        let spin = self.angular_velocity;
        if spin == [R::ZERO; 3] {
            return R::ZERO;
        }
        let across = match self.shape {
            Shape::Sphere { .. } => return R::ZERO,
            Shape::Box { .. } | Shape::Mesh { .. } => spin,
            _ => {
                let axis = self.direction();
                sub(spin, scale(axis, dot(spin, axis)))
            }
        };
        if self.shape.is_endless() {
            // Rounding is no tilt.
            let is_tilt = dot(across, across) > dot(spin, spin) * R::EPSILON;
            return if is_tilt { R::MAX } else { R::ZERO };
        }
        length_bound(across) * self.reach()
    }

    /// How deep a grain of this radius may overlap it: a quarter of the smaller diameter.
    #[inline(always)]
    pub(crate) fn depth_allowed(&self, radius: R) -> R {
        let own = self.shape.thinnest();
        let least = if own > R::ZERO {
            smaller(radius, own)
        } else {
            radius
        };
        least * R::HALF
    }

    /// The radius at whose end a law lets the force on a ball act; 0 of another shape.
    #[inline(always)]
    pub(crate) fn ball_radius(&self) -> R {
        match self.shape {
            Shape::Sphere { radius } => radius,
            _ => R::ZERO,
        }
    }

    /// The nearest place of a turned body, by an offset in the axes of the world: one copy of it, for small machines.
    #[inline(never)]
    fn meet_turned(&self, surface: u32, offset: Vec3<R>, radius: R) -> Nearest<R> {
        let q = self.orientation;
        let own = self.shape.meet(surface, to_body(q, offset), radius);
        let normal = to_world(q, own.normal);
        Nearest { normal, ..own }
    }

    /// The velocity (length / time) and the spin (radians / time) with which it enters a contact with a grain of this
    /// radius that meets it so. A ball turns as a grain does, about the law's lever; elsewhere the surface moves as it
    /// does where it is nearest.
    #[inline(always)]
    pub fn contact_motion(&self, met: &Meeting<R>, radius: R) -> (Vec3<R>, Vec3<R>) {
        let (velocity, spin) = (self.velocity, self.angular_velocity);
        if self.ball_radius() > R::ZERO || spin == [R::ZERO; 3] {
            return (velocity, spin);
        }
        let nearest = sub(met.offset, scale(met.normal, radius - met.overlap));
        (add(velocity, cross(spin, nearest)), [R::ZERO; 3])
    }

    /// Whether it is a mesh.
    pub(crate) fn is_mesh(&self) -> bool {
        matches!(self.shape, Shape::Mesh { .. })
    }

    /// Its triangles, and the offset of a grain in its own axes; none if it is no mesh.
    pub(crate) fn in_mesh<'f>(
        &self,
        facets: &'f [Facet<R>],
        offset: Vec3<R>,
    ) -> Option<(Mesh<'f, R>, Vec3<R>)> {
        let Shape::Mesh { first, count, .. } = self.shape else {
            return None;
        };
        let own = match self.is_turned() {
            true => to_body(self.orientation, offset),
            false => offset,
        };
        Some((Mesh::of(facets, first, count), own))
    }

    /// Where a grain meets a triangle of its mesh: one copy of it, for small machines.
    #[inline(never)]
    fn meet_mesh(
        &self,
        surface: u32,
        facets: &[Facet<R>],
        offset: Vec3<R>,
        radius: R,
    ) -> Meeting<R> {
        let (mesh, own) = self.in_mesh(facets, offset).unwrap_or((Mesh(&[]), offset));
        let (met, share) = mesh.meet(surface, own, radius);
        Meeting {
            normal: match self.is_turned() {
                true => to_world(self.orientation, met.normal),
                false => met.normal,
            },
            offset,
            overlap: met.overlap,
            curvature: R::ZERO,
            share,
        }
    }

    /// Where a grain at `position` with this radius meets one of its surfaces, by its number below
    /// [`Shape::surfaces`]; `facets` are the triangles of the world.
    #[inline(always)]
    pub fn meet(
        &self,
        surface: u32,
        facets: &[Facet<R>],
        domain: &Domain<R>,
        position: Vec3<R>,
        radius: R,
    ) -> Meeting<R> {
        let offset = match self.shape {
            Shape::Plane { .. } => sub(position, self.point),
            _ => domain.separation(position, self.point),
        };
        if let Shape::Mesh { .. } = self.shape {
            return self.meet_mesh(surface, facets, offset, radius);
        }
        let meeting = if self.is_turned() {
            self.meet_turned(surface, offset, radius)
        } else {
            self.shape.meet(surface, offset, radius)
        };
        Meeting {
            normal: meeting.normal,
            offset,
            overlap: meeting.overlap,
            curvature: match self.shape {
                Shape::Sphere { radius } => radius,
                _ if self.curved => meeting.curvature,
                _ => R::ZERO,
            },
            share: R::ONE,
        }
    }
}

pub(crate) fn unit<R: Real>(v: Vec3<R>) -> Vec3<R> {
    divide(v, dot(v, v).sqrt())
}

#[cfg(all(test, feature = "fixed"))]
mod tests {
    use super::*;
    use crate::fixed_point::I32F32;

    /// In fixed point squares of slow spins vanish, and a search must know of the way that a surface turns by.
    #[test]
    fn a_slow_turn_counts_in_what_a_surface_goes_by() {
        let slow = I32F32::from_f64(1e-6);
        let body = Obstacle {
            angular_velocity: [I32F32::ZERO, slow, I32F32::ZERO],
            ..Obstacle::cuboid([I32F32::ZERO; 3], [I32F32::ONE; 3])
        };
        assert!(slow * slow == I32F32::ZERO && body.swing() >= slow);
    }
}
