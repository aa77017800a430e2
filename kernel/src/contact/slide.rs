//! How two surfaces slide over each other, and what that makes of their tangential spring: the same for every law.

use crate::math::real::Real;
use crate::math::vec3::{Vec3, add, cross, dot, scale, sub};

/// `w_i a_i + w_j a_j`: what the spins add to the sliding, before it is crossed with the normal.
#[inline(always)]
pub(crate) fn surface_spin<R: Real>(
    spin_i: Vec3<R>,
    lever_arm_i: R,
    spin_j: Vec3<R>,
    lever_arm_j: R,
) -> Vec3<R> {
    add(scale(spin_i, lever_arm_i), scale(spin_j, lever_arm_j))
}

/// How two surfaces slide over each other, with the spring as it is then; see [`TangentialState`].
pub(crate) struct Slide<R> {
    pub velocity: Vec3<R>,
    pub spring: Vec3<R>,
    pub length2: R,
}

/// The sliding `v_t = (v - n v_n) + n x turn`, and the spring `s + v_t dt` projected by
/// `s - n (s . n)`.
#[inline(always)]
pub(crate) fn slide<R: Real>(
    normal: Vec3<R>,
    velocity: Vec3<R>,
    speed: R,
    turn: Vec3<R>,
    spring: Vec3<R>,
    dt: R,
) -> Slide<R> {
    let along = sub(velocity, scale(normal, speed));
    let velocity = add(along, cross(normal, turn));
    let grown = add(spring, scale(velocity, dt));
    Slide {
        velocity,
        spring: sub(grown, scale(normal, dot(grown, normal))),
        length2: dot(grown, grown),
    }
}
