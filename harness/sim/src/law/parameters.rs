//! What the harness must know of a contact law beside its forces.

use bitgrain_kernel::contact::{Materials, PairLaws};

/// The key that is wrong, and what was expected of it.
pub type Wrong = (&'static str, String);

/// A key that is wrong, such as `pairs[1].mu`, and what was expected of it.
pub type WrongKey = (String, String);

/// The parameters of a law as files give them.
pub trait LawParameters {
    /// Friction coefficient.
    fn mu(&self) -> f64;

    /// Shear modulus and Poisson's ratio of the material, for the speed of waves in it.
    fn moduli(&self) -> (f64, f64);

    /// Stiffness as the law's own key gives it (pressure), for lists.
    fn stated_stiffness(&self) -> f64;

    /// Keys with damping rates (1 / (time length)) that a time step must resolve.
    fn damping_rates(&self) -> Vec<(&'static str, f64)> {
        Vec::new()
    }
}

/// What the springs of a law's contacts store, and the levers of its tangential force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Springs {
    /// Normal stiffness (pressure): `K_n sqrt(R delta) delta`.
    pub kn: f64,
    /// Tangential stiffness (pressure): `K_t sqrt(R delta)` times the spring.
    pub kt: f64,
    /// Part of the overlap that a lever is shorter by than the radius.
    pub short: f64,
    /// Friction coefficient of a law whose spring and damper are held to the cap together.
    pub joint_cap: Option<f64>,
}

/// A law whose springs are Hertz': as the energy budget assumes.
pub trait Sprung {
    /// Its springs between two materials.
    fn springs(&self, materials: Materials) -> Springs;
}

impl<L: Copy + Sprung> Sprung for PairLaws<'_, L> {
    fn springs(&self, materials: Materials) -> Springs {
        self.of(materials).springs(materials)
    }
}

pub(super) fn positive(key: &'static str, value: f64) -> Result<(), Wrong> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err((key, format!("is {value}; expected a positive number")))
    }
}

pub(super) fn not_negative(key: &'static str, value: f64) -> Result<(), Wrong> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err((key, format!("is {value}; expected zero or more")))
    }
}
