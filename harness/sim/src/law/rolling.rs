//! Resistance to rolling, as files give it: an option of both laws, beyond Kumar 2018 (eqs. 1, 2) and Guillard 2014
//! (eq. A1), which have none.

use bitgrain_kernel::contact::{Materials, Rolling, RollingResistance, RollingSpring};
use serde::{Deserialize, Serialize};

use super::parameters::{Springs, Sprung, WrongKey, not_negative};

/// What resists rolling.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum RollingSpec {
    /// Spring, damper and slider, as LAMMPS' `sds`.
    Sds {
        /// Stiffness (force / length), zero or more.
        k: f64,
        /// Damping (force / speed), zero or more.
        gamma: f64,
        /// Coefficient of rolling friction, zero or more.
        mu: f64,
    },
    /// An elastic and plastic spring, as LIGGGHTS' `epsd2`.
    Epsd2 {
        /// Coefficient of rolling friction, zero or more.
        mu: f64,
    },
}

impl RollingSpec {
    /// The resistance as it is computed.
    ///
    /// # Errors
    /// The key that is wrong, such as `rolling.mu`, and what was expected of it.
    pub fn build(&self) -> Result<RollingResistance<f64>, WrongKey> {
        let (spring, k, gamma, mu) = match *self {
            Self::Sds { k, gamma, mu } => (RollingSpring::Sds, k, gamma, mu),
            Self::Epsd2 { mu } => (RollingSpring::Epsd2, 0.0, 0.0, mu),
        };
        for (key, number) in [("k", k), ("gamma", gamma), ("mu", mu)] {
            not_negative(key, number)
                .map_err(|(key, problem)| (format!("rolling.{key}"), problem))?;
        }
        Ok(RollingResistance {
            spring,
            k,
            gamma,
            mu,
        })
    }
}

impl<L: Sprung> Sprung for Rolling<f64, L> {
    fn springs(&self, materials: Materials) -> Springs {
        self.law.springs(materials)
    }
}
