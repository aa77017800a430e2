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
