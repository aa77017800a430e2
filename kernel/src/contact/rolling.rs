//! Resistance to rolling, for any law with a tangential spring such as those of Kumar 2018, eqs. 1 and 2, and of
//! Guillard 2014, eq. A1, which have none.
//!
//! Both models turn two bodies against each other with a spring that is held to a limit: `sds` as LAMMPS computes it,
//! and `epsd2` as LIGGGHTS does. The order of evaluation written here is part of the bit contract.

use super::kept::{ContactMemory, MEMORY_MAX};
use super::law::{
    Law, Materials, NormalForce, NormalState, TangentialForce, TangentialState, Torque,
    TurningState,
};
use crate::math::real::{Real, magnitude};
use crate::math::vec3::{Vec3, add, cross, dot, either, scale, sub};

/// Of what a rolling spring is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[repr(u8)]
pub enum RollingSpring {
    /// Spring, damper and slider: `f = -k r - gamma v` with `|f| <= mu |F_n|`, `r` the way that surfaces have rolled
    /// and `v = R (w_i - w_j) x n`; the torque is `R n x f`. The way keeps its length as its plane turns.
    #[default]
    Sds,
    /// `M' = k_t R^2 w` with `|M| <= mu R |F_n|`, `k_t` the tangential stiffness of the law at its present overlap and
    /// `w` the part of `w_i - w_j` across the normal; the torque is `-M`. There is no damper, and `M` does not follow
    /// its plane. On a wall `w` is longer by `(r - delta/2) / (r - delta)`.
    Epsd2,
}

/// The numbers of a resistance to rolling.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct RollingResistance<R> {
    /// The model.
    pub spring: RollingSpring,
    /// Stiffness of `sds` (force / length), zero or more; not used by `epsd2`.
    pub k: R,
    /// Damping of `sds` (force / speed), zero or more; not used by `epsd2`.
    pub gamma: R,
    /// Coefficient of the limit, zero or more; with 0 nothing resists.
    pub mu: R,
}

impl<R: Real> RollingResistance<R> {
    /// None.
    pub const NONE: Self = Self {
        spring: RollingSpring::Sds,
        k: R::ZERO,
        gamma: R::ZERO,
        mu: R::ZERO,
    };
}

/// A law whose tangential spring lies in the contact and has a stiffness: what `epsd2` is made of.
pub trait SpringInPlane<R: Real>: Law<R> {
    /// Stiffness of the tangential spring (force / length).
    fn tangential_stiffness(&self, normal: &NormalForce<R>) -> R;
}

/// A law with resistance to rolling. It keeps three words of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(C)]
pub struct Rolling<R, L> {
    /// The law.
    pub law: L,
    /// What resists rolling.
    pub resistance: RollingResistance<R>,
}

impl<R: Real> RollingResistance<R> {
    /// Torque on the grain and way that is left.
    #[inline(always)]
    fn sds(&self, turning: &Turning<R>, r: Vec3<R>, dt: R) -> (Vec3<R>, Vec3<R>) {
        let n = turning.normal;
        let v = scale(cross(turning.spin, n), turning.radius);
        let limit = self.mu * turning.load;
        // Into the plane, with its length, if it is out of it by more than rounding.
        let off = dot(r, n);
        let within = sub(r, scale(n, off));
        let (old, new) = (dot(r, r).sqrt(), dot(within, within).sqrt());
        let grown = if new > R::ZERO { old / new } else { R::ZERO };
        let is_off = magnitude(off) * self.k > limit * R::from_f64(1e-10);
        let r = either(is_off, scale(within, grown), r);
        let r = add(r, scale(v, dt));

        let f = scale(add(scale(r, self.k), scale(v, self.gamma)), -R::ONE);
        let size = dot(f, f).sqrt();
        let slides = size > limit;
        let share = if slides { limit / size } else { R::ONE };
        let share = share.carry(size);
        let held = scale(f, share);
        let short = add(held, scale(v, self.gamma));
        let short = match self.k > R::ZERO {
            true => short.map(|x| -(x / self.k)),
            false => [R::ZERO; 3],
        };
        // A damper alone does not hold what has not rolled yet.
        let is_new = dot(r, r) == R::ZERO;
        let held = either(slides && is_new, [R::ZERO; 3], held);
        let left = either(slides && !is_new, short, r);
        (scale(cross(n, held), turning.radius), left)
    }

    /// Torque on the grain and moment that is left.
    #[inline(always)]
    fn epsd2(&self, turning: &Turning<R>, m: Vec3<R>, dt: R) -> (Vec3<R>, Vec3<R>) {
        let (n, spin) = (turning.normal, turning.spin);
        let across = sub(spin, scale(n, dot(spin, n)));
        let stiffness = turning.stiffness * (turning.radius * turning.radius);
        let m = add(m, scale(across, (stiffness * turning.wall) * dt));
        let limit = (self.mu * turning.radius) * turning.load;
        let size = dot(m, m).sqrt();
        let share = if size > limit { limit / size } else { R::ONE };
        let left = scale(m, share.carry(size));
        (scale(left, -R::ONE), left)
    }
}

/// Two bodies that roll over each other.
struct Turning<R> {
    normal: Vec3<R>,
    /// Spin of the grain over its partner.
    spin: Vec3<R>,
    radius: R,
    /// Size of the normal force.
    load: R,
    /// Tangential stiffness.
    stiffness: R,
    /// What `epsd2` lengthens the spin by on a wall.
    wall: R,
}

impl<R: Real, L: SpringInPlane<R>> Law<R> for Rolling<R, L> {
    const KNOWS_MATERIALS: bool = L::KNOWS_MATERIALS;
    const MEMORY: usize = 3;
    const ACTS_APART: bool = L::ACTS_APART;
    const TURNS: bool = true;

    fn materials(&self) -> usize {
        self.law.materials()
    }

    fn reach(&self) -> R {
        self.law.reach()
    }

    fn stiffness(&self, materials: Materials) -> Option<[R; 2]> {
        self.law.stiffness(materials)
    }

    #[inline(always)]
    fn acts(&self, contact: &NormalState<R>) -> bool {
        self.law.acts(contact)
    }

    #[inline(always)]
    fn normal_force(&self, contact: &NormalState<R>) -> NormalForce<R> {
        self.law.normal_force(contact)
    }

    #[inline(always)]
    fn tangential_force(
        &self,
        normal: &NormalForce<R>,
        state: &TangentialState<R>,
    ) -> TangentialForce<R> {
        self.law.tangential_force(normal, state)
    }

    #[inline(always)]
    fn torque(&self, normal: &NormalForce<R>, state: &TurningState<R>) -> Torque<R> {
        let c = &state.contact;
        let is_wall = c.radius_j == R::ZERO;
        let longer = (c.radius_i - c.overlap * R::HALF) / (c.radius_i - c.overlap);
        let turning = Turning {
            normal: state.normal,
            spin: sub(state.spin_i, state.spin_j),
            radius: c.radius_effective,
            load: magnitude(normal.force),
            stiffness: self.law.tangential_stiffness(normal),
            wall: if is_wall { longer } else { R::ONE },
        };
        let old = [c.memory[0], c.memory[1], c.memory[2]];
        let (sds, way) = self.resistance.sds(&turning, old, state.dt);
        let (epsd2, moment) = self.resistance.epsd2(&turning, old, state.dt);
        let is_sds = self.resistance.spring == RollingSpring::Sds;
        let mut memory = [R::ZERO; MEMORY_MAX];
        // Pairs that nothing resists keep nothing, in a table too.
        let resists = self.resistance.mu > R::ZERO;
        let left = either(resists, either(is_sds, way, moment), [R::ZERO; 3]);
        (memory[0], memory[1], memory[2]) = (left[0], left[1], left[2]);
        Torque {
            torque: either(resists, either(is_sds, sds, epsd2), [R::ZERO; 3]),
            memory,
        }
    }

    #[inline(always)]
    fn seen_by_partner(&self, memory: ContactMemory<R>) -> ContactMemory<R> {
        // The way that surfaces roll is the same from both sides; a moment turns its sign.
        match self.resistance.spring {
            RollingSpring::Sds => memory,
            RollingSpring::Epsd2 => {
                let mut seen = memory;
                for word in seen.iter_mut().take(Self::MEMORY) {
                    // Less than zero, so that no word that is +0 becomes -0, which counts as kept.
                    *word = R::ZERO - *word;
                }
                seen
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::HertzTsuji;
    use crate::contact::kept::Kept;
    use proptest::prelude::*;

    fn vector(size: f64) -> impl Strategy<Value = Vec3<f64>> {
        prop::array::uniform3(-size..size)
    }

    fn length(v: Vec3<f64>) -> f64 {
        dot(v, v).sqrt()
    }

    fn head(memory: ContactMemory<f64>) -> Vec3<f64> {
        [memory[0], memory[1], memory[2]]
    }

    fn law(spring: RollingSpring, mu: f64) -> Rolling<f64, HertzTsuji<f64>> {
        let resistance = RollingResistance {
            spring,
            k: 300.0,
            gamma: 0.4,
            mu,
        };
        Rolling {
            law: HertzTsuji::new(1e5, 0.3, 0.6, 0.4),
            resistance,
        }
    }

    prop_compose! {
        fn turning()(
            direction in vector(1.0).prop_filter("a direction", |v| dot(*v, *v) > 1e-3),
            overlap in 1e-6..0.05f64,
            radii in prop::array::uniform2(0.3..2.0f64),
            flat in any::<bool>(),
            spin_i in vector(3.0),
            spin_j in vector(3.0),
            kept in vector(0.02),
            dt in prop::sample::select(&[0.0, 1e-3][..]),
        ) -> TurningState<f64> {
            let [radius_i, other] = radii;
            let radius_j = if flat { 0.0 } else { other };
            let [x, y, z] = kept;
            TurningState {
                contact: NormalState {
                    overlap,
                    speed: 0.0,
                    radius_i,
                    radius_j,
                    radius_effective: if flat { radius_i } else { radius_i * other / (radius_i + other) },
                    mass_effective: 1.0,
                    inverse_masses: [0.5; 2],
                    materials: [0; 2],
                    memory: [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0],
                },
                normal: scale(direction, 1.0 / length(direction)),
                velocity: [0.0; 3],
                tangential: [0.0; 3],
                spin_i,
                spin_j,
                dt,
            }
        }
    }

    const SPRINGS: [RollingSpring; 2] = [RollingSpring::Sds, RollingSpring::Epsd2];

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

        /// Seen from the partner the torque is the exact opposite, and so is what is kept of it.
        #[test]
        fn both_bodies_feel_the_same_torque(state in turning()) {
            for spring in SPRINGS {
                let law = law(spring, 0.2);
                let normal = law.normal_force(&state.contact);
                let turned = TurningState {
                    contact: NormalState {
                        memory: law.seen_by_partner(state.contact.memory),
                        ..state.contact
                    },
                    normal: scale(state.normal, -1.0),
                    spin_i: state.spin_j,
                    spin_j: state.spin_i,
                    ..state
                };
                let (a, b) = (law.torque(&normal, &state), law.torque(&normal, &turned));
                prop_assert_eq!(a.torque, scale(b.torque, -1.0));
                prop_assert_eq!(a.memory, law.seen_by_partner(b.memory));
            }
        }

        /// Nothing that is kept of a contact is nothing from the other side too, and words of others stay as they are.
        #[test]
        fn nothing_is_nothing_from_either_side(state in turning(), words in 0usize..4) {
            let mut memory = [0.0; MEMORY_MAX];
            memory[..words].copy_from_slice(&state.contact.memory[..words]);
            let kept = Kept { spring: [0.0; 3], memory };
            for spring in SPRINGS {
                let memory = law(spring, 0.2).seen_by_partner(memory);
                prop_assert_eq!(Kept { memory, ..kept }.words(), kept.words());
            }
        }

        /// The torque is held to `mu R |F_n|`, and never drives what turns against a spring that is empty. 1e-12 is for
        /// rounding.
        #[test]
        fn torques_are_held_to_their_limit(state in turning()) {
            for spring in SPRINGS {
                let law = law(spring, 0.2);
                let normal = law.normal_force(&state.contact);
                let limit = 0.2 * state.contact.radius_effective * magnitude(normal.force);
                let whole = law.torque(&normal, &state);
                prop_assert!(length(whole.torque) <= limit * (1.0 + 1e-12));
                let empty = TurningState {
                    contact: NormalState { memory: [0.0; 8], ..state.contact },
                    ..state
                };
                let first = law.torque(&normal, &empty);
                let power = dot(first.torque, sub(state.spin_i, state.spin_j));
                prop_assert!(power <= 0.0, "{}", power);
                // Twisting about the normal is not resisted.
                prop_assert!(dot(first.torque, state.normal).abs() <= 1e-12 * limit);
                if state.dt == 0.0 {
                    prop_assert_eq!(first.memory, [0.0; 8]);
                }
            }
        }

        /// The way of `sds` keeps its length as its plane turns, and comes into the plane.
        #[test]
        fn a_way_keeps_its_length_as_its_plane_turns(state in turning()) {
            let still = TurningState { spin_i: [0.0; 3], spin_j: [0.0; 3], ..state };
            // A limit that nothing reaches.
            let law = law(RollingSpring::Sds, 1e9);
            let normal = law.normal_force(&still.contact);
            let (old, new) = (head(still.contact.memory), head(law.torque(&normal, &still).memory));
            prop_assume!(dot(old, still.normal).abs() > 1e-3 * length(old));
            let within = sub(old, scale(still.normal, dot(old, still.normal)));
            prop_assume!(length(within) > 1e-3 * length(old));
            // Into the plane, unless what it is out of it by gives less than 1e-10 of the limit.
            let is_off = dot(old, still.normal).abs() * 300.0 > 1e-1 * magnitude(normal.force);
            prop_assert!((length(new) - length(old)).abs() < 1e-12 * length(old));
            prop_assert!(!is_off || dot(new, still.normal).abs() < 1e-12 * length(old));
        }
    }
}
