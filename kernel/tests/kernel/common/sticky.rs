//! A law of one's own that uses all that a law may: it acts at a distance once bodies have touched, keeps words, tells
//! materials and masses apart and resists twisting.

use bitgrain_kernel::contact::{
    ContactMemory, Law, NormalForce, NormalState, TangentialForce, TangentialState, Torque,
    TurningState,
};
use bitgrain_kernel::vec3::{Vec3, dot, scale};

/// A bridge that forms as bodies touch, pulls until they are `gap` apart, and twists.
#[derive(Clone, Copy, Debug)]
pub struct Sticky {
    /// Stiffness (force / length).
    pub kn: f64,
    /// Tangential stiffness (force / length).
    pub kt: f64,
    /// Where the bridge breaks (length).
    pub gap: f64,
    /// Twisting stiffness (force length).
    pub twist: f64,
    /// Friction coefficient.
    pub mu: f64,
}

/// The words: whether there is a bridge, by how far it has been twisted, and how often it was evaluated.
const BRIDGE: usize = 0;
const TWIST: usize = 1;
const AGE: usize = 2;

impl Law<f64> for Sticky {
    const KNOWS_MATERIALS: bool = true;
    const MEMORY: usize = 3;
    const ACTS_APART: bool = true;
    const TURNS: bool = true;

    fn reach(&self) -> f64 {
        self.gap
    }

    fn acts(&self, c: &NormalState<f64>) -> bool {
        let holds = c.memory[BRIDGE] > 0.0 && c.overlap > -self.gap;
        c.overlap > 0.0 || holds
    }

    fn normal_force(&self, c: &NormalState<f64>) -> NormalForce<f64> {
        let [a, b] = c.materials.map(f64::from);
        // The damping asks for the masses of both one by one.
        let [p, q] = c.inverse_masses;
        let damping = 40.0 / (1.0 + p + q);
        NormalForce {
            force: self.kn * (1.0 + 0.1 * (a + b)) * c.overlap - damping * c.speed,
            contact_radius: c.radius_effective,
            damping: 0.0,
            lever_arm_i: c.radius_i,
            lever_arm_j: c.radius_j,
        }
    }

    fn tangential_force(
        &self,
        normal: &NormalForce<f64>,
        state: &TangentialState<f64>,
    ) -> TangentialForce<f64> {
        // A bridge adds to what friction can hold.
        let pull = self.kn * self.gap * state.contact.memory[BRIDGE];
        let size = if normal.force < 0.0 {
            -normal.force
        } else {
            normal.force
        };
        let limit = self.mu * (size + pull);
        let trial = self.kt * dot(state.spring, state.spring).sqrt();
        let factor = if trial > limit { limit / trial } else { 1.0 };
        let spring = scale(state.spring, factor);
        TangentialForce {
            force: scale(spring, -self.kt),
            spring,
        }
    }

    fn torque(&self, _: &NormalForce<f64>, state: &TurningState<f64>) -> Torque<f64> {
        let old: ContactMemory<f64> = state.contact.memory;
        let spin: Vec3<f64> = [0, 1, 2].map(|a| state.spin_i[a] - state.spin_j[a]);
        let twist = old[TWIST] + dot(spin, state.normal) * state.dt;
        let mut memory = old;
        memory[BRIDGE] = 1.0;
        memory[TWIST] = twist;
        memory[AGE] = old[AGE] + state.dt;
        Torque {
            torque: scale(state.normal, -self.twist * twist),
            memory,
        }
    }
}

/// It in reduced units.
pub const STICKY: Sticky = Sticky {
    kn: 2e4,
    kt: 1e4,
    gap: 0.08,
    twist: 30.0,
    mu: 0.4,
};
