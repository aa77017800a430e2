//! What moves an obstacle: its host, or the forces on it.

use crate::math::real::Real;
use crate::math::vec3::Vec3;
use crate::obstacle_defect::ObstacleDefect;

/// What moves an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum Motion<R> {
    /// The host alone: velocity and angular velocity stay until it changes them.
    Prescribed,
    /// The forces on it; its mass is `1 / inverse_mass`.
    Free(FreeMotion<R>),
}

/// What moves a free body besides its contacts, and how it answers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FreeMotion<R> {
    /// Moments of inertia about its own axes, which are its principal axes (mass length^2), positive.
    pub inertia: Vec3<R>,
    /// Acceleration besides that of the forces (length / time^2).
    pub gravity: Vec3<R>,
    /// A force of the host on `point` (mass length / time^2), which it may change between steps.
    pub force: Vec3<R>,
    /// A torque of the host (mass length^2 / time^2), likewise.
    pub torque: Vec3<R>,
    /// Along which axes of the world it answers forces; along the others its velocity stays as the host sets it.
    pub integrates: [bool; 3],
    /// Whether it answers torques; if not, its angular velocity stays as the host sets it.
    pub spins: bool,
}

impl<R: Real> FreeMotion<R> {
    /// Free along and about all axes, without a force of the host.
    #[must_use]
    pub fn new(inertia: Vec3<R>, gravity: Vec3<R>) -> Self {
        Self {
            inertia,
            gravity,
            force: [R::ZERO; 3],
            torque: [R::ZERO; 3],
            integrates: [true; 3],
            spins: true,
        }
    }
}

impl<R: Real> Motion<R> {
    /// What is wrong if a body with this inverse mass, which may be endless, cannot move so.
    pub(crate) fn flaw(&self, inverse_mass: R, is_endless: bool) -> Option<ObstacleDefect> {
        let Self::Free(free) = self else {
            return None;
        };
        let finite = [free.gravity, free.force, free.torque];
        let finite = finite.iter().flatten().all(|x| x.is_finite());
        let inert = |x: &R| *x > R::ZERO && x.is_finite() && (R::ONE / *x).is_finite();
        let heavy = inverse_mass > R::ZERO && (R::ONE / inverse_mass).is_finite();
        let turns = !free.spins || !is_endless && free.inertia.iter().all(inert);
        match (R::FIXED_POINT, finite, heavy, turns) {
            (true, ..) => Some(ObstacleDefect::Range),
            (_, false, ..) => Some(ObstacleDefect::Number),
            (_, _, false, _) => Some(ObstacleDefect::Weightless),
            (.., false) => Some(ObstacleDefect::Inertia),
            _ => None,
        }
    }
}
