//! Hertz contact with a displacement-stored tangential spring: Kumar 2018, eqs. 1 and 2.
//!
//! Symbols follow the paper: `delta` overlap, `R` effective radius, `m` effective mass, `s`
//! tangential spring. The order of evaluation written here is part of the bit contract.

use super::law::{Law, Materials, NormalForce, NormalState, TangentialForce, TangentialState};
use super::rolling::SpringInPlane;
use crate::math::real::{Real, magnitude};
use crate::math::vec3::{add, dot, either, scale, sub};

/// `F_n = sqrt(R delta) (K_n delta - m gamma_n v_n)` and
/// `F_t = -sqrt(R delta) (K_t s + m gamma_t v_t)` with `|F_t| <= mu |F_n|`.
///
/// The normal force may pull while a contact opens. When the cap applies, spring and damper together
/// are held to it and the spring is shortened so that the same formula returns the capped force; a spring
/// of length exactly zero then gives no tangential force at all (the rule of LAMMPS'
/// `gran/hertz/history`, whose numbers the paper reports). Levers are the full radii, so a pair's
/// angular momentum is conserved only up to overlap times `F_t`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct HertzHistory<R> {
    /// Normal stiffness `K_n` (pressure), positive. Kumar eq. 3: `4 G / (3 (1 - nu))`.
    pub kn: R,
    /// Tangential stiffness `K_t` (pressure), zero or more. Kumar eq. 3: `4 G / (2 - nu)`.
    pub kt: R,
    /// Normal damping `gamma_n` (1 / (time length)), zero or more.
    pub gamma_n: R,
    /// Tangential damping `gamma_t` (1 / (time length)), zero or more.
    pub gamma_t: R,
    /// Friction coefficient, zero or more.
    pub mu: R,
}

impl<R: Real> Law<R> for HertzHistory<R> {
    fn stiffness(&self, _: Materials) -> Option<[R; 2]> {
        Some([self.kn, self.kt])
    }

    #[inline(always)]
    fn normal_force(&self, c: &NormalState<R>) -> NormalForce<R> {
        let contact_radius = (c.radius_effective * c.overlap).sqrt();
        let damped = (c.mass_effective * self.gamma_n) * c.speed;
        NormalForce {
            force: contact_radius * (self.kn * c.overlap - damped),
            contact_radius,
            damping: c.mass_effective * self.gamma_t,
            lever_arm_i: c.radius_i,
            lever_arm_j: c.radius_j,
        }
    }

    #[inline(always)]
    fn tangential_force(
        &self,
        normal_force: &NormalForce<R>,
        state: &TangentialState<R>,
    ) -> TangentialForce<R> {
        let s = state.spring;
        // q = K_t s + m gamma_t v_t, so that F_t = -sqrt(R delta) q.
        let damp = scale(state.velocity, normal_force.damping);
        let q = add(scale(s, self.kt), damp);
        let ft = normal_force.contact_radius * dot(q, q).sqrt();
        let cap = self.mu * magnitude(normal_force.force);
        let slides = ft > cap;
        let f = if slides { cap / ft } else { R::ONE };
        let f = f.carry(ft);

        let per_kt = if self.kt > R::ZERO {
            R::ONE / self.kt
        } else {
            R::ZERO
        };
        let shrunk = sub(scale(q, f), damp);
        let shrunk = if R::FIXED_POINT && self.kt > R::ZERO {
            // The inverse of a stiffness has few digits there.
            shrunk.map(|x| x / self.kt)
        } else {
            scale(shrunk, per_kt)
        };
        let hold = slides && state.length2 == R::ZERO;
        let g = if hold {
            R::ZERO
        } else {
            -(normal_force.contact_radius * f)
        };
        TangentialForce {
            force: scale(q, g),
            spring: either(slides && !hold, shrunk, s),
        }
    }
}

impl<R: Real> SpringInPlane<R> for HertzHistory<R> {
    #[inline(always)]
    fn tangential_stiffness(&self, normal: &NormalForce<R>) -> R {
        self.kt * normal.contact_radius
    }
}
