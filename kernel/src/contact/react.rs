//! One contact by itself: the definition that a block of contacts follows.

use super::kept::{ContactMemory, Kept};
use super::law::{Law, Materials, NormalState, TangentialState, Torque, TurningState, has_torque};
use super::slide::{slide, surface_spin};
use crate::math::real::Real;
use crate::math::vec3::{Vec3, dot};

/// How two bodies touch. `i` is the grain that is pushed, `j` its partner.
#[derive(Clone, Copy, Debug)]
pub struct Contact<R> {
    /// Unit vector from the partner to the grain.
    pub normal: Vec3<R>,
    /// Depth of the overlap (length); zero or less if the bodies do not touch.
    pub overlap: R,
    /// Radius of the grain.
    pub radius_i: R,
    /// Radius of the partner; 0 for a surface that counts as flat.
    pub radius_j: R,
    /// Effective radius `r_i r_j / (r_i + r_j)`; `r_i` on a flat surface.
    pub radius_effective: R,
    /// Effective mass `1 / (1/m_i + 1/m_j)`; the other's mass if one is infinitely heavy.
    pub mass_effective: R,
    /// One over the mass of the grain and of its partner; 0 if it is infinitely heavy.
    pub inverse_masses: [R; 2],
    /// Materials of the grain and its partner.
    pub materials: Materials,
    /// Velocity of the grain's centre less the partner's.
    pub velocity: Vec3<R>,
    /// Spin of the grain (radians per time).
    pub spin_i: Vec3<R>,
    /// Spin of the partner as its surface slides: zero if `velocity` has what its turning adds.
    pub spin_j: Vec3<R>,
    /// Angular velocity of the partner.
    pub turning_j: Vec3<R>,
}

/// What a contact does, and what it leaves behind.
#[derive(Clone, Copy, Debug)]
pub struct Reaction<R> {
    /// Normal force on the grain along the contact's normal; negative when it pulls.
    pub normal: R,
    /// Tangential force on the grain.
    pub tangential: Vec3<R>,
    /// Tangential spring and words after this evaluation.
    pub kept: Kept<R>,
    /// Lever of the tangential force about the grain's centre.
    pub lever_arm_i: R,
    /// Lever about the partner's centre.
    pub lever_arm_j: R,
    /// Torque on the grain beside that of the tangential force; its opposite acts on the partner.
    pub torque: Vec3<R>,
}

impl<R: Real> Contact<R> {
    /// The contact along its normal.
    #[inline(always)]
    fn along_normal(&self, memory: ContactMemory<R>) -> NormalState<R> {
        NormalState {
            overlap: self.overlap,
            speed: dot(self.velocity, self.normal),
            radius_i: self.radius_i,
            radius_j: self.radius_j,
            radius_effective: self.radius_effective,
            mass_effective: self.mass_effective,
            inverse_masses: self.inverse_masses,
            materials: self.materials,
            memory,
        }
    }

    /// Whether it acts by a law that has left these words of it.
    #[inline(always)]
    pub fn acts<L: Law<R>>(&self, law: &L, memory: ContactMemory<R>) -> bool {
        match L::ACTS_APART {
            true => law.acts(&self.along_normal(memory)),
            false => self.overlap > R::ZERO,
        }
    }
}

/// What a law gives for one contact that acts, with what it kept of it advanced over `dt`: the definition that a
/// block of contacts follows function by function. It is no method of the law, so that no law can answer differently
/// here than there.
///
/// With `dt = 0` and nothing kept the spring stays empty: the evaluation at step 0.
#[inline(always)]
pub fn react<R: Real, L: Law<R>>(law: &L, c: &Contact<R>, kept: Kept<R>, dt: R) -> Reaction<R> {
    let contact = c.along_normal(kept.memory);
    let normal_force = law.normal_force(&contact);
    let turn = surface_spin(
        c.spin_i,
        normal_force.lever_arm_i,
        c.spin_j,
        normal_force.lever_arm_j,
    );
    let slide = slide(c.normal, c.velocity, contact.speed, turn, kept.spring, dt);
    let state = TangentialState {
        contact,
        velocity: slide.velocity,
        spring: slide.spring,
        length2: slide.length2,
    };
    let tangential_force = law.tangential_force(&normal_force, &state);
    let mut torque = Torque {
        torque: [R::ZERO; 3],
        memory: kept.memory,
    };
    if const { has_torque::<R, L>() } {
        torque = law.torque(
            &normal_force,
            &TurningState {
                contact,
                normal: c.normal,
                velocity: slide.velocity,
                tangential: tangential_force.force,
                spin_i: c.spin_i,
                spin_j: c.turning_j,
                dt,
            },
        );
        for word in torque.memory.iter_mut().skip(L::MEMORY) {
            *word = R::ZERO;
        }
    }
    Reaction {
        normal: normal_force.force,
        tangential: tangential_force.force,
        kept: Kept {
            spring: tangential_force.spring,
            memory: torque.memory,
        },
        lever_arm_i: normal_force.lever_arm_i,
        lever_arm_j: normal_force.lever_arm_j,
        torque: torque.torque,
    }
}

#[cfg(test)]
mod tests {
    use super::{Contact, Kept, Law, Reaction, Vec3};
    use crate::contact::{HertzHistory, HertzTsuji};
    use crate::math::vec3::{add, cross, dot, scale, sub};
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
                inverse_masses: [0.5 / mass_effective; 2],
                materials: [0; 2],
                velocity,
                spin_i,
                spin_j,
                turning_j: spin_j,
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

    fn tsuji() -> HertzTsuji<f64> {
        HertzTsuji::new(1e5, 0.3, 0.6, 0.4)
    }

    /// A time step that springs may advance by, and the springs that a case begins with.
    const DT: f64 = 1e-4;

    fn spring() -> impl Strategy<Value = Vec3<f64>> {
        prop::array::uniform3(-0.02..0.02f64)
    }

    /// [`react`] to a contact of which the law has kept a spring.
    fn react(law: &impl Law<f64>, c: &Contact<f64>, spring: Vec3<f64>, dt: f64) -> Reaction<f64> {
        let kept = Kept {
            spring,
            ..Kept::NOTHING
        };
        super::react(law, c, kept, dt)
    }

    fn size(v: Vec3<f64>) -> f64 {
        dot(v, v).sqrt()
    }

    /// Velocity of the grain's surface over the partner's, in the tangent plane.
    fn slip(c: &Contact<f64>, lever_arm_i: f64, lever_arm_j: f64) -> Vec3<f64> {
        let turn = add(scale(c.spin_i, lever_arm_i), scale(c.spin_j, lever_arm_j));
        let along = scale(c.normal, dot(c.velocity, c.normal));
        add(sub(c.velocity, along), cross(c.normal, turn))
    }

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
            materials: [c.materials[1], c.materials[0]],
            spin_i: c.spin_j,
            spin_j: c.spin_i,
            turning_j: c.spin_i,
            ..*c
        };
        let (a, b) = (
            react(law, c, s, DT),
            react(law, &turned, scale(s, -1.0), DT),
        );
        prop_assert_eq!(a.normal.to_bits(), b.normal.to_bits());
        prop_assert_eq!(bits(a.tangential), bits(scale(b.tangential, -1.0)));
        prop_assert_eq!(bits(a.kept.spring), bits(scale(b.kept.spring, -1.0)));
        prop_assert_eq!(
            (a.lever_arm_i, a.lever_arm_j),
            (b.lever_arm_j, b.lever_arm_i)
        );
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
            turning_j: turn(c.turning_j),
            ..*c
        };
        let (a, b) = (react(law, c, s, DT), react(law, &turned, turn(s), DT));
        prop_assert_eq!(a.normal.to_bits(), b.normal.to_bits());
        prop_assert_eq!(turn(a.tangential), b.tangential);
        prop_assert_eq!(turn(a.kept.spring), b.kept.spring);
        prop_assert_eq!(
            (a.lever_arm_i, a.lever_arm_j),
            (b.lever_arm_i, b.lever_arm_j)
        );
        Ok(())
    }

    /// Force and spring are numbers, and both lie in the tangent plane.
    ///
    /// Rounding leaves a few units in the last place of what was projected: the spring, and the
    /// slip over a damping time, which is less than 0.02 here. 1e-13 is some hundred of them.
    fn is_tangent(
        law: &impl Law<f64>,
        c: &Contact<f64>,
        s: Vec3<f64>,
    ) -> Result<(), TestCaseError> {
        let r = react(law, c, s, DT);
        let numbers = r.tangential.iter().chain(&r.kept.spring);
        prop_assert!(numbers.chain([&r.normal]).all(|x| x.is_finite()));
        let slip = size(slip(c, r.lever_arm_i, r.lever_arm_j));
        let length = size(s) + 0.02 * slip;
        let off = dot(r.kept.spring, c.normal).abs();
        prop_assert!(off <= 1e-13 * length, "spring off its plane by {:e}", off);
        // By either law a unit of length gives a force below 1e5 here; ten times that is ample.
        let off = dot(r.tangential, c.normal).abs();
        prop_assert!(
            off <= 1e-13 * 1e6 * length,
            "force off its plane by {:e}",
            off
        );
        Ok(())
    }

    /// At step 0 an empty spring stays empty, whatever slides.
    fn stays_empty(law: &impl Law<f64>, c: &Contact<f64>) -> Result<(), TestCaseError> {
        let r = react(law, c, [0.0; 3], 0.0);
        prop_assert_eq!(r.kept.spring, [0.0; 3]);
        Ok(())
    }

    /// Damping takes energy out: along the normal its power is never positive, and a contact that
    /// begins without a spring is never pushed the way it slides.
    fn dissipates(law: &impl Law<f64>, c: &Contact<f64>) -> Result<(), TestCaseError> {
        let still = Contact {
            velocity: [0.0; 3],
            spin_i: [0.0; 3],
            spin_j: [0.0; 3],
            turning_j: [0.0; 3],
            ..*c
        };
        for speed in [-2.0, -0.1, 0.1, 2.0] {
            let moving = Contact {
                velocity: scale(c.normal, speed),
                ..still
            };
            let elastic = react(law, &still, [0.0; 3], 0.0).normal;
            let whole = react(law, &moving, [0.0; 3], 0.0).normal;
            prop_assert!((whole - elastic) * speed < 0.0);
        }
        for dt in [0.0, DT] {
            let r = react(law, c, [0.0; 3], dt);
            let slip = slip(c, r.lever_arm_i, r.lever_arm_j);
            prop_assert!(dot(r.tangential, slip) <= 0.0);
            // Without sliding the friction is damping alone, so it is not zero.
            prop_assert!(dt == 0.0 || size(slip) < 1e-6 || size(r.tangential) > 0.0);
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        #[test]
        fn laws_are_symmetric(c in contact(), s in spring()) {
            exchanges(&HISTORY, &c, s)?;
            exchanges(&tsuji(), &c, s)?;
            turns(&HISTORY, &c, s)?;
            turns(&tsuji(), &c, s)?;
        }

        #[test]
        fn springs_lie_in_the_tangent_plane_hertz_history(c in contact(), s in spring()) {
            is_tangent(&HISTORY, &c, s)?;
        }

        #[test]
        fn springs_lie_in_the_tangent_plane_hertz_tsuji(c in contact(), s in spring()) {
            is_tangent(&tsuji(), &c, s)?;
        }

        #[test]
        fn an_empty_spring_stays_empty_at_step_0(c in contact()) {
            stays_empty(&HISTORY, &c)?;
            stays_empty(&tsuji(), &c)?;
        }

        #[test]
        fn damping_takes_energy_out_hertz_history(c in contact()) {
            dissipates(&HISTORY, &c)?;
        }

        #[test]
        fn damping_takes_energy_out_hertz_tsuji(c in contact()) {
            dissipates(&tsuji(), &c)?;
        }

        /// Spring and damper together stay on the cap, and the spring that is left gives the capped
        /// force by the same formula. 1e-12 and 1e-9 are for the rounding of either way.
        #[test]
        fn friction_is_capped_hertz_history(c in contact(), s in spring()) {
            let r = react(&HISTORY, &c, s, DT);
            let cap = HISTORY.mu * r.normal.abs();
            let length = size(r.tangential);
            prop_assert!(length <= cap * (1.0 + 1e-12), "{} above {}", length, cap);
            let h = (c.radius_effective * c.overlap).sqrt();
            let vt = slip(&c, r.lever_arm_i, r.lever_arm_j);
            for k in 0..3 {
                let damped = c.mass_effective * HISTORY.gamma_t * vt[k];
                let again = -h * (HISTORY.kt * r.kept.spring[k] + damped);
                let room = 1e-9 * (cap + h * HISTORY.kt);
                let now = r.tangential[k];
                prop_assert!((again - now).abs() <= room, "{} {}", again, now);
            }
        }

        /// The spring alone is held to the cap; damping may add to it, but only if nothing
        /// slides. 1e-12 is for the rounding of the shortened spring.
        #[test]
        fn friction_is_capped_hertz_tsuji(c in contact(), s in spring()) {
            let law = tsuji();
            let r = react(&law, &c, s, DT);
            let cap = law.mu * r.normal.abs();
            let kt = law.kt * (c.radius_effective * c.overlap).sqrt();
            let pull = kt * size(r.kept.spring);
            prop_assert!(pull <= cap * (1.0 + 1e-12), "{} above {}", pull, cap);
            let grown = add(s, scale(slip(&c, r.lever_arm_i, r.lever_arm_j), DT));
            let whole = kt * size(sub(grown, scale(c.normal, dot(grown, c.normal))));
            if whole > cap * (1.0 + 1e-9) {
                let length = size(r.tangential);
                prop_assert!((length - cap).abs() <= cap * 1e-12, "{} on {}", length, cap);
            }
        }
    }
}
