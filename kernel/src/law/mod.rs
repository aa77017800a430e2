//! Contact laws: from how two bodies touch to the force between them.
//!
//! A law is a pure function of one contact, the same for grain on grain and grain on obstacle, with
//! no branch on the data, so that a block of contacts is evaluated in lanes. A new law is one new
//! file in this folder.

mod hertz_history;
mod hertz_tsuji;

pub use hertz_history::HertzHistory;
pub use hertz_tsuji::HertzTsuji;

use crate::real::Real;
use crate::vec3::Vec3;

/// How two bodies touch. `i` is the grain that is pushed, `j` its partner.
#[derive(Clone, Copy, Debug)]
pub struct Contact<R> {
    /// Unit vector from the partner to the grain.
    pub normal: Vec3<R>,
    /// Depth of the overlap (length); zero or less where the bodies do not touch.
    pub overlap: R,
    /// Radius of the grain.
    pub radius_i: R,
    /// Radius of the partner; 0 for a surface that counts as flat.
    pub radius_j: R,
    /// Effective radius `r_i r_j / (r_i + r_j)`; `r_i` on a flat surface.
    pub radius_effective: R,
    /// Effective mass `1 / (1/m_i + 1/m_j)`; the other's mass where one is infinitely heavy.
    pub mass_effective: R,
    /// Velocity of the grain's centre less the partner's.
    pub velocity: Vec3<R>,
    /// Spin of the grain (radians per time).
    pub spin_i: Vec3<R>,
    /// Spin of the partner.
    pub spin_j: Vec3<R>,
}

/// What a contact does, and the tangential spring that it leaves behind.
#[derive(Clone, Copy, Debug)]
pub struct Reaction<R> {
    /// Normal force on the grain along the contact's normal; negative when it pulls.
    pub normal: R,
    /// Tangential force on the grain.
    pub tangential: Vec3<R>,
    /// Tangential spring after this evaluation (length).
    pub spring: Vec3<R>,
    /// Lever of the tangential force about the grain's centre.
    pub arm_i: R,
    /// Lever about the partner's centre.
    pub arm_j: R,
}

/// A contact law.
pub trait Law<R: Real>: Copy + Send + Sync {
    /// The force of one contact, with its tangential `spring` advanced over `dt`.
    ///
    /// With `dt = 0` and an empty spring the spring stays empty: the evaluation at step 0.
    /// Where `overlap <= 0` the result is unspecified and the caller discards it.
    fn react(&self, contact: &Contact<R>, spring: Vec3<R>, dt: R) -> Reaction<R>;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3::{cross, dot, scale};
    use proptest::prelude::*;

    fn unit(v: Vec3<f64>) -> Vec3<f64> {
        scale(v, 1.0 / dot(v, v).sqrt())
    }

    fn vector() -> impl Strategy<Value = Vec3<f64>> {
        prop::array::uniform3(-3.0..3.0f64)
    }

    prop_compose! {
        fn contact()(
            direction in vector().prop_filter("a direction", |v| dot(*v, *v) > 1e-3),
            overlap in 1e-9..0.1f64,
            radius_i in 0.3..2.0f64,
            radius_j in 0.3..2.0f64,
            mass_effective in 0.01..5.0f64,
            velocity in vector(),
            spin_i in vector(),
            spin_j in vector(),
        ) -> Contact<f64> {
            Contact {
                normal: unit(direction),
                overlap,
                radius_i,
                radius_j,
                radius_effective: radius_i * radius_j / (radius_i + radius_j),
                mass_effective,
                velocity,
                spin_i,
                spin_j,
            }
        }
    }

    const HISTORY: HertzHistory<f64> = HertzHistory {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 792.0,
        gamma_t: 792.0,
        mu: 0.5,
    };

    fn bits(v: Vec3<f64>) -> [u64; 3] {
        v.map(f64::to_bits)
    }

    /// Newton's third law to the bit: seen from the partner, the force is the exact opposite.
    fn exchanges(law: &impl Law<f64>, c: &Contact<f64>, s: Vec3<f64>) -> Result<(), TestCaseError> {
        let turned = Contact {
            normal: scale(c.normal, -1.0),
            velocity: scale(c.velocity, -1.0),
            radius_i: c.radius_j,
            radius_j: c.radius_i,
            spin_i: c.spin_j,
            spin_j: c.spin_i,
            ..*c
        };
        let (a, b) = (
            law.react(c, s, 1e-4),
            law.react(&turned, scale(s, -1.0), 1e-4),
        );
        prop_assert_eq!(a.normal.to_bits(), b.normal.to_bits());
        prop_assert_eq!(bits(a.tangential), bits(scale(b.tangential, -1.0)));
        prop_assert_eq!(bits(a.spring), bits(scale(b.spring, -1.0)));
        prop_assert_eq!((a.arm_i, a.arm_j), (b.arm_j, b.arm_i));
        Ok(())
    }

    /// A quarter turn about z moves numbers between x and y and changes no product.
    fn turns(law: &impl Law<f64>, c: &Contact<f64>, s: Vec3<f64>) -> Result<(), TestCaseError> {
        let turn = |v: Vec3<f64>| [-v[1], v[0], v[2]];
        let turned = Contact {
            normal: turn(c.normal),
            velocity: turn(c.velocity),
            spin_i: turn(c.spin_i),
            spin_j: turn(c.spin_j),
            ..*c
        };
        let (a, b) = (law.react(c, s, 1e-4), law.react(&turned, turn(s), 1e-4));
        prop_assert_eq!(a.normal.to_bits(), b.normal.to_bits());
        prop_assert_eq!(turn(a.tangential), b.tangential);
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        #[test]
        fn laws_are_symmetric(c in contact(), s in prop::array::uniform3(-0.02..0.02f64)) {
            let tsuji = HertzTsuji::new(1e5, 0.3, 0.6, 0.4);
            exchanges(&HISTORY, &c, s)?;
            exchanges(&tsuji, &c, s)?;
            turns(&HISTORY, &c, s)?;
            turns(&tsuji, &c, s)?;
        }

        /// Friction stays on its cap, in the tangent plane, and is finite; 1e-9 for the rounding of
        /// a direction that is only nearly perpendicular.
        #[test]
        fn friction_is_capped(c in contact(), s in prop::array::uniform3(-0.02..0.02f64)) {
            let r = HISTORY.react(&c, s, 1e-4);
            let length = dot(r.tangential, r.tangential).sqrt();
            let cap = HISTORY.mu * r.normal.abs();
            prop_assert!(length <= cap * (1.0 + 1e-12), "{} above {}", length, cap);
            prop_assert!(dot(r.tangential, c.normal).abs() <= 1e-9 * (length + 1.0));
            prop_assert!(r.spring.iter().all(|s| s.is_finite()));
            // Spring and damper together sit on the cap: the same formula gives the capped force.
            let h = (c.radius_effective * c.overlap).sqrt();
            let turn = core::array::from_fn(|k| {
                c.spin_i[k] * c.radius_i + c.spin_j[k] * c.radius_j
            });
            let slide = cross(c.normal, turn);
            let vn = dot(c.velocity, c.normal);
            for k in 0..3 {
                let vt = c.velocity[k] - c.normal[k] * vn + slide[k];
                let again = -h * (HISTORY.kt * r.spring[k] + c.mass_effective * HISTORY.gamma_t * vt);
                let room = 1e-9 * (cap + h * HISTORY.kt);
                prop_assert!((again - r.tangential[k]).abs() <= room, "{} {}", again, r.tangential[k]);
            }
        }

        /// Damping alone takes energy out: the power of the damping force is never positive.
        #[test]
        fn damping_takes_energy_out(c in contact()) {
            let still = Contact { velocity: [0.0; 3], spin_i: [0.0; 3], spin_j: [0.0; 3], ..c };
            for speed in [-2.0, -0.1, 0.1, 2.0] {
                let moving = Contact { velocity: scale(c.normal, speed), ..still };
                let elastic = HISTORY.react(&still, [0.0; 3], 0.0).normal;
                let whole = HISTORY.react(&moving, [0.0; 3], 0.0).normal;
                prop_assert!((whole - elastic) * speed < 0.0);
            }
        }
    }
}
