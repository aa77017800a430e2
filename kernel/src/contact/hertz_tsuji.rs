//! Hertz contact with Tsuji damping: Guillard 2014, eq. A1 and Table I.
//!
//! Symbols follow the paper's appendix A; the slip rule and the shortened levers are those of
//! LIGGGHTS (`hertz tangential history`), whose numbers the paper reports. The order of evaluation
//! written here is part of the bit contract.

use super::law::{Law, Materials, NormalForce, NormalState, TangentialForce, TangentialState};
use super::rolling::SpringInPlane;
use crate::math::real::{Real, magnitude};
use crate::math::vec3::{add, dot, scale};

/// `F_n = k_n delta - gamma_n v_n`, `F_t = -k_t s - gamma_t v_t`, all four coefficients growing
/// with `sqrt(R delta)`; the spring alone is held to `mu |F_n|`, and a contact that slides has no
/// tangential damping.
///
/// Levers are the radii less half the overlap, so a pair's angular momentum is conserved.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct HertzTsuji<R> {
    /// `(4/3) Y`, of two bodies of one material with `Y = E / (2 (1 - nu^2))` (pressure): `k_n = kn sqrt(R delta)`.
    pub kn: R,
    /// `8 G`, likewise with `G = E / (4 (2 - nu) (1 + nu))` (pressure): `k_t = kt sqrt(R delta)`.
    pub kt: R,
    /// `-2 sqrt(5/6) beta sqrt(2 Y)`: `gamma_n = cn sqrt(m sqrt(R delta))`.
    pub cn: R,
    /// `-2 sqrt(5/6) beta sqrt(8 G)`: `gamma_t = ct sqrt(m sqrt(R delta))`.
    pub ct: R,
    /// Friction coefficient, zero or more.
    pub mu: R,
}

impl<R: Real> HertzTsuji<R> {
    /// From Young's modulus `young` (pressure, > 0), Poisson's ratio `poisson` (-1 to 0.5), the
    /// coefficient of restitution (0 to 1, 0 excluded) and the friction coefficient.
    ///
    /// `beta = ln e / sqrt(ln^2 e + pi^2)`, with the logarithm of the `libm` crate: for set-up, never
    /// inside a step. Numbers out of their ranges give coefficients that are NaN or meaningless.
    pub fn new(young: f64, poisson: f64, restitution: f64, mu: f64) -> Self {
        let y = young / (2.0 * (1.0 - poisson * poisson));
        let g = young / (4.0 * (2.0 - poisson) * (1.0 + poisson));
        Self::of_moduli(y, g, restitution, mu)
    }

    /// Of two materials, each with its Young's modulus and Poisson's ratio: `1/Y` is the sum of `(1 - nu^2) / E` of
    /// both, and `1/G` that of `2 (2 - nu) (1 + nu) / E`. Two alike give [`HertzTsuji::new`], to the bit. The numbers
    /// and their ranges are as there.
    pub fn between([a, b]: [[f64; 2]; 2], restitution: f64, mu: f64) -> Self {
        if a == b {
            return Self::new(a[0], a[1], restitution, mu);
        }
        let compliance = |[young, poisson]: [f64; 2]| (1.0 - poisson * poisson) / young;
        let shear = |[young, poisson]: [f64; 2]| 2.0 * (2.0 - poisson) * (1.0 + poisson) / young;
        let y = 1.0 / (compliance(a) + compliance(b));
        let g = 1.0 / (shear(a) + shear(b));
        Self::of_moduli(y, g, restitution, mu)
    }

    /// From the effective moduli `Y` and `G` (pressure).
    fn of_moduli(y: f64, g: f64, restitution: f64, mu: f64) -> Self {
        let ln_e = libm::log(restitution);
        let beta = ln_e / libm::sqrt(ln_e * ln_e + core::f64::consts::PI * core::f64::consts::PI);
        let c = -2.0 * libm::sqrt(5.0 / 6.0) * beta;
        Self {
            kn: R::from_f64(4.0 / 3.0 * y),
            kt: R::from_f64(8.0 * g),
            cn: R::from_f64(c * libm::sqrt(2.0 * y)),
            ct: R::from_f64(c * libm::sqrt(8.0 * g)),
            mu: R::from_f64(mu),
        }
    }
}

impl<R: Real> Law<R> for HertzTsuji<R> {
    fn stiffness(&self, _: Materials) -> Option<[R; 2]> {
        Some([self.kn, self.kt])
    }

    #[inline(always)]
    fn normal_force(&self, c: &NormalState<R>) -> NormalForce<R> {
        let contact_radius = (c.radius_effective * c.overlap).sqrt();
        let damp = (c.mass_effective * contact_radius).sqrt();
        let short = c.overlap * R::HALF;
        NormalForce {
            force: (self.kn * contact_radius) * c.overlap - (self.cn * damp) * c.speed,
            contact_radius,
            damping: self.ct * damp,
            lever_arm_i: c.radius_i - short,
            lever_arm_j: c.radius_j - short,
        }
    }

    #[inline(always)]
    fn tangential_force(
        &self,
        normal_force: &NormalForce<R>,
        state: &TangentialState<R>,
    ) -> TangentialForce<R> {
        let s = state.spring;
        let kt = self.kt * normal_force.contact_radius;
        let pull = kt * dot(s, s).sqrt();
        let cap = self.mu * magnitude(normal_force.force);
        let slides = pull > cap;
        let f = if slides { cap / pull } else { R::ONE };
        let f = f.carry(pull);
        let gamma_t = if slides {
            R::ZERO
        } else {
            normal_force.damping
        };

        let left = scale(s, f);
        let resisted = add(scale(left, kt), scale(state.velocity, gamma_t));
        TangentialForce {
            force: scale(resisted, -R::ONE),
            spring: left,
        }
    }
}

impl<R: Real> SpringInPlane<R> for HertzTsuji<R> {
    #[inline(always)]
    fn tangential_stiffness(&self, normal: &NormalForce<R>) -> R {
        self.kt * normal.contact_radius
    }
}
