//! Hertz contact with a displacement-stored tangential spring: Kumar 2018, eqs. 1 and 2.
//!
//! Symbols follow the paper: `delta` overlap, `R` effective radius, `m` effective mass, `s`
//! tangential spring. The order of evaluation written here is part of the bit contract.

use super::{Contact, Law, Reaction};
use crate::real::{Real, magnitude};
use crate::vec3::{Vec3, add, cross, dot, scale, sub};

/// `F_n = sqrt(R delta) (K_n delta - m gamma_n v_n)` and
/// `F_t = -sqrt(R delta) (K_t s + m gamma_t v_t)` with `|F_t| <= mu |F_n|`.
///
/// The normal force may pull while a contact opens. Where the cap bites, spring and damper together
/// sit on it and the spring is shortened so that the same formula returns the capped force; a spring
/// of length exactly zero then gives no tangential force at all (the rule of LAMMPS'
/// `gran/hertz/history`, whose numbers the paper reports). Levers are the full radii, so a pair's
/// angular momentum is conserved only up to overlap times `F_t`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    #[inline(always)]
    fn react(&self, c: &Contact<R>, spring: Vec3<R>, dt: R) -> Reaction<R> {
        let h = (c.radius_effective * c.overlap).sqrt();
        let vn = dot(c.velocity, c.normal);
        let fn_ = h * (self.kn * c.overlap - (c.mass_effective * self.gamma_n) * vn);

        let turn = add(scale(c.spin_i, c.radius_i), scale(c.spin_j, c.radius_j));
        let vt = add(sub(c.velocity, scale(c.normal, vn)), cross(c.normal, turn));

        let grown = add(spring, scale(vt, dt));
        let empty = dot(grown, grown) == R::ZERO;
        let s = sub(grown, scale(c.normal, dot(grown, c.normal)));

        // q = K_t s + m gamma_t v_t, so that F_t = -h q.
        let damp = scale(vt, c.mass_effective * self.gamma_t);
        let q = add(scale(s, self.kt), damp);
        let ft = h * dot(q, q).sqrt();
        let cap = self.mu * magnitude(fn_);
        let slides = ft > cap;
        let f = if slides { cap / ft } else { R::ONE };

        let per_kt = if self.kt > R::ZERO {
            R::ONE / self.kt
        } else {
            R::ZERO
        };
        let shrunk = scale(sub(scale(q, f), damp), per_kt);
        let keep = !slides;
        let hold = slides && empty;
        let g = if hold { R::ZERO } else { -(h * f) };
        let mut left = [R::ZERO; 3];
        for k in 0..3 {
            let slid = if hold { s[k] } else { shrunk[k] };
            left[k] = if keep { s[k] } else { slid };
        }
        Reaction {
            normal: fn_,
            tangential: scale(q, g),
            spring: left,
            arm_i: c.radius_i,
            arm_j: c.radius_j,
        }
    }
}
