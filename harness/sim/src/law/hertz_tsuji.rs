//! Guillard 2014, eq. A1 and Table I, as files give it.

use bitgrain_kernel::contact::HertzTsuji;
use serde::{Deserialize, Serialize};

use super::parameters::{LawParameters, Springs, Sprung, Wrong, not_negative, positive};

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
}

impl HertzTsujiParameters {
    /// The law as it is computed.
    ///
    /// # Errors
    /// The key that is wrong, and what was expected of it.
    pub fn build(&self) -> Result<HertzTsuji<f64>, Wrong> {
        let Self {
            young,
            poisson,
            restitution,
            mu,
        } = *self;
        positive("young", young)?;
        not_negative("mu", mu)?;
        if !(poisson > -1.0 && poisson <= 0.5) {
            let problem = format!("is {poisson}; expected above -1 and at most 0.5");
            return Err(("poisson", problem));
        }
        if !(restitution > 0.0 && restitution <= 1.0) {
            let problem = format!("is {restitution}; expected above 0 and at most 1");
            return Err(("restitution", problem));
        }
        Ok(HertzTsuji::new(young, poisson, restitution, mu))
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
        (self.young / (2.0 * (1.0 + self.poisson)), self.poisson)
    }

    fn mu(&self) -> f64 {
        self.mu
    }

    fn stated_stiffness(&self) -> f64 {
        self.young
    }
}

impl Sprung for HertzTsuji<f64> {
    fn springs(&self) -> Springs {
        Springs {
            kn: self.kn,
            kt: self.kt,
            short: 0.5,
            joint_cap: None,
        }
    }
}
