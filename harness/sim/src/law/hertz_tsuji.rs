//! Guillard 2014, eq. A1 and Table I, as files give it.

use bitgrain_kernel::contact::{HertzTsuji, Materials};
use serde::{Deserialize, Serialize};

use super::parameters::{LawParameters, Springs, Sprung, Wrong, not_negative, positive};
use super::rolling::RollingSpec;

/// Keys of `kind = "hertz_tsuji"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HertzTsujiParameters {
    /// Young's modulus (pressure), positive.
    pub young: f64,
    /// Poisson's ratio, above -1 and at most 0.5.
    pub poisson: f64,
    /// Coefficient of restitution, above 0 and at most 1.
    pub restitution: f64,
    /// Friction coefficient, zero or more.
    pub mu: f64,
    /// Resistance to rolling; none if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling: Option<RollingSpec>,
}

/// How a material yields.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Elasticity {
    /// Young's modulus (pressure), positive.
    pub young: f64,
    /// Poisson's ratio, above -1 and at most 0.5.
    pub poisson: f64,
}

impl Elasticity {
    /// Shear modulus and Poisson's ratio.
    pub fn moduli(&self) -> (f64, f64) {
        (self.young / (2.0 * (1.0 + self.poisson)), self.poisson)
    }

    pub(super) fn check(&self) -> Result<(), Wrong> {
        let Self { young, poisson } = *self;
        positive("young", young)?;
        if !(poisson > -1.0 && poisson <= 0.5) {
            let problem = format!("is {poisson}; expected above -1 and at most 0.5");
            return Err(("poisson", problem));
        }
        Ok(())
    }
}

/// The law of two materials.
pub(super) fn between(
    materials: [Elasticity; 2],
    restitution: f64,
    mu: f64,
) -> Result<HertzTsuji<f64>, Wrong> {
    not_negative("mu", mu)?;
    if !(restitution > 0.0 && restitution <= 1.0) {
        let problem = format!("is {restitution}; expected above 0 and at most 1");
        return Err(("restitution", problem));
    }
    let numbers = materials.map(|of| [of.young, of.poisson]);
    Ok(HertzTsuji::between(numbers, restitution, mu))
}

impl HertzTsujiParameters {
    /// The law as it is computed, without its resistance to rolling.
    ///
    /// # Errors
    /// The key that is wrong, and what was expected of it.
    pub fn build(&self) -> Result<HertzTsuji<f64>, Wrong> {
        let Self {
            young,
            poisson,
            restitution,
            mu,
            ..
        } = *self;
        let elasticity = Elasticity { young, poisson };
        elasticity.check()?;
        between([elasticity; 2], restitution, mu)
    }

    /// Restitution 0.1 if the law has more: the same fraction of critical damping at every overlap.
    #[must_use]
    pub fn quenching(&self) -> Self {
        let restitution = if self.restitution < 0.1 {
            self.restitution
        } else {
            0.1
        };
        Self {
            restitution,
            ..*self
        }
    }
}

impl LawParameters for HertzTsujiParameters {
    fn moduli(&self) -> (f64, f64) {
        let Self { young, poisson, .. } = *self;
        Elasticity { young, poisson }.moduli()
    }

    fn mu(&self) -> f64 {
        self.mu
    }

    fn stated_stiffness(&self) -> f64 {
        self.young
    }
}

impl Sprung for HertzTsuji<f64> {
    fn springs(&self, _: Materials) -> Springs {
        Springs {
            kn: self.kn,
            kt: self.kt,
            short: 0.5,
            joint_cap: None,
        }
    }
}
