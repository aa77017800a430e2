//! Contact laws: from how two bodies touch to the force between them.
//!
//! A law is two pure functions of one contact, the same for grain on grain and grain on obstacle, with
//! no branch on the data: how hard the bodies press on each other, and how they resist sliding. A law that acts at a
//! distance, resists rolling or keeps words of its own of each contact says so by constants and has one or two
//! functions more; the others pay nothing for that. What comes before, between and after is the same for every law and
//! is written here once. A block of contacts is evaluated in lanes, function by function: short chains of operations
//! keep a processor busy when one long chain would make it wait. A new law is one new file in this folder.

use super::kept::{ContactMemory, MEMORY_MAX};
use crate::math::real::Real;
use crate::math::vec3::Vec3;

/// Numbers of the materials of two bodies, as their groups and obstacles have them.
pub type Materials = [u8; 2];

/// A contact seen along its normal: the input of [`Law::normal_force`].
#[derive(Clone, Copy, Debug)]
pub struct NormalState<R> {
    /// Depth of the overlap (length).
    pub overlap: R,
    /// Speed along the normal; negative while the bodies approach.
    pub speed: R,
    /// Radius of the grain.
    pub radius_i: R,
    /// Radius of the partner; 0 for flat.
    pub radius_j: R,
    /// Effective radius.
    pub radius_effective: R,
    /// Effective mass.
    pub mass_effective: R,
    /// One over the mass of the grain and of its partner; 0 if it is infinitely heavy.
    pub inverse_masses: [R; 2],
    /// Materials of the grain and its partner; zeros for a law that tells none apart.
    pub materials: Materials,
    /// The law's words as the last step left them.
    pub memory: ContactMemory<R>,
}

/// The normal force of a contact, and what its tangential part needs to know of it.
#[derive(Clone, Copy, Debug)]
pub struct NormalForce<R> {
    /// Normal force on the grain; negative when it pulls.
    pub force: R,
    /// `sqrt(R delta)`, the radius of Hertz's contact (length).
    pub contact_radius: R,
    /// Tangential damping, in the law's own units.
    pub damping: R,
    /// Lever of the tangential force about the grain's centre.
    pub lever_arm_i: R,
    /// Lever about the partner's centre.
    pub lever_arm_j: R,
}

/// A contact seen in its tangent plane: the input of [`Law::tangential_force`].
#[derive(Clone, Copy, Debug)]
pub struct TangentialState<R> {
    /// The same contact along its normal.
    pub contact: NormalState<R>,
    /// Velocity of the grain's surface over the partner's.
    pub velocity: Vec3<R>,
    /// Tangential spring, advanced and projected on the tangent plane (length).
    pub spring: Vec3<R>,
    /// Square of its length before the projection.
    pub length2: R,
}

/// The tangential force of a contact.
#[derive(Clone, Copy, Debug)]
pub struct TangentialForce<R> {
    /// Tangential force on the grain.
    pub force: Vec3<R>,
    /// The spring that is left (length).
    pub spring: Vec3<R>,
}

/// Two bodies that turn against each other: the input of [`Law::torque`].
#[derive(Clone, Copy, Debug)]
pub struct TurningState<R> {
    /// The same contact along its normal.
    pub contact: NormalState<R>,
    /// Unit vector from the partner to the grain.
    pub normal: Vec3<R>,
    /// Velocity of the grain's surface over the partner's.
    pub velocity: Vec3<R>,
    /// Tangential force on the grain.
    pub tangential: Vec3<R>,
    /// Spin of the grain (radians per time).
    pub spin_i: Vec3<R>,
    /// Spin of the partner; of an obstacle its angular velocity.
    pub spin_j: Vec3<R>,
    /// Time that the law's words advance by; 0 at step 0, which must leave words that are zero as they are.
    pub dt: R,
}

/// What a contact does to the turning of its bodies.
#[derive(Clone, Copy, Debug)]
pub struct Torque<R> {
    /// Torque on the grain beside that of the tangential force; its opposite acts on the partner.
    pub torque: Vec3<R>,
    /// The law's words that are left.
    pub memory: ContactMemory<R>,
}

/// A contact law. If a contact does not act its results are unspecified and the caller discards them.
pub trait Law<R: Real>: Copy + Send + Sync {
    /// Whether it tells materials apart. If not, a step does not look them up.
    const KNOWS_MATERIALS: bool = false;

    /// Words of a contact that it keeps beside the tangential spring, at most [`MEMORY_MAX`]: the first of them. What
    /// it gives for others is dropped. A world without storage for them is not started.
    const MEMORY: usize = 0;

    /// Whether [`Law::acts`] says which contacts act; if not, those that overlap.
    const ACTS_APART: bool = false;

    /// Whether contacts have a torque beside that of the tangential force.
    const TURNS: bool = false;

    /// How many materials it knows, numbered from 0; a world that has others is not started.
    fn materials(&self) -> usize {
        if Self::KNOWS_MATERIALS { 256 } else { 1 }
    }

    /// How far beyond touching bodies can act on each other (length, zero or more): pairs are looked for so far.
    fn reach(&self) -> R {
        R::ZERO
    }

    /// Normal and tangential stiffness of Hertz' contact between two materials (pressure): `F_n = k_n sqrt(R delta)
    /// delta`. They say how long a time step may be ([`shortest_times`](crate::time_step::shortest_times)); of a
    /// law that does not say them nobody knows that.
    fn stiffness(&self, materials: Materials) -> Option<[R; 2]> {
        let _ = materials;
        None
    }

    /// Whether a contact acts. What does not act gives no force and loses spring and words. Asked of pairs within reach
    /// and a little beyond, and only if [`Law::ACTS_APART`].
    #[inline(always)]
    fn acts(&self, contact: &NormalState<R>) -> bool {
        contact.overlap > R::ZERO
    }

    /// Along the normal.
    fn normal_force(&self, contact: &NormalState<R>) -> NormalForce<R>;

    /// In the tangent plane.
    fn tangential_force(
        &self,
        normal: &NormalForce<R>,
        state: &TangentialState<R>,
    ) -> TangentialForce<R>;

    /// The torque that resists rolling or twisting, and the words that are left. Called only if [`Law::TURNS`] or
    /// [`Law::MEMORY`] say so.
    #[inline(always)]
    fn torque(&self, normal: &NormalForce<R>, state: &TurningState<R>) -> Torque<R> {
        let _ = normal;
        Torque {
            torque: [R::ZERO; 3],
            memory: state.contact.memory,
        }
    }

    /// The words of a contact as its partner would keep them: of vectors that turn their sign as both change places.
    /// Words that are +0 stay so: another zero counts as kept.
    #[inline(always)]
    fn seen_by_partner(&self, memory: ContactMemory<R>) -> ContactMemory<R> {
        memory
    }
}

/// Whether [`Law::torque`] is to be called.
#[inline(always)]
pub(crate) const fn has_torque<R: Real, L: Law<R>>() -> bool {
    const { assert!(L::MEMORY <= MEMORY_MAX, "a law keeps too many words") };
    L::TURNS || L::MEMORY > 0
}
