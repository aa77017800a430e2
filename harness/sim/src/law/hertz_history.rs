//! Kumar 2018, eqs. 1 and 2, as files give it.

use bitgrain_kernel::contact::{HertzHistory, Materials};
use bitgrain_kernel::time_step::moduli;
use serde::{Deserialize, Serialize};

use super::parameters::{LawParameters, Springs, Sprung, Wrong, not_negative, positive};
use super::rolling::RollingSpec;

/// Keys of `kind = "hertz_history"`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HertzHistoryParameters {
    /// Normal stiffness `K_n` (pressure), positive.
    pub kn: f64,
    /// Tangential stiffness `K_t` (pressure), zero or more.
    pub kt: f64,
    /// Normal damping `gamma_n` (1 / (time length)), zero or more.
    pub gamma_n: f64,
    /// Tangential damping `gamma_t`, zero or more.
    pub gamma_t: f64,
    /// Friction coefficient, zero or more.
    pub mu: f64,
    /// Resistance to rolling; none if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling: Option<RollingSpec>,
}

impl HertzHistoryParameters {
    /// The law as it is computed, without its resistance to rolling.
    ///
    /// # Errors
    /// The key that is wrong, and what was expected of it.
    pub fn build(&self) -> Result<HertzHistory<f64>, Wrong> {
        let Self {
            kn,
            kt,
            gamma_n,
            gamma_t,
            mu,
            ..
        } = *self;
        positive("kn", kn)?;
        not_negative("kt", kt)?;
        not_negative("gamma_n", gamma_n)?;
        not_negative("gamma_t", gamma_t)?;
        not_negative("mu", mu)?;
        Ok(HertzHistory {
            kn,
            kt,
            gamma_n,
            gamma_t,
            mu,
        })
    }

    /// `gamma = 2/(d dt)` if the law has less, which damps a contact of a hundredth of `d` by a tenth in a step:
    /// stable with a dozen contacts.
    #[must_use]
    pub fn quenching(&self, dt: f64, d: f64) -> Self {
        let strong = 2.0 / (d * dt);
        let more = |gamma: f64| if gamma > strong { gamma } else { strong };
        Self {
            gamma_n: more(self.gamma_n),
            gamma_t: more(self.gamma_t),
            ..*self
        }
    }
}

impl LawParameters for HertzHistoryParameters {
    /// From Kumar 2018, eq. 3: `K_t/K_n` gives nu, held to 0 .. 0.5, and the stiffer of `K_n` and `K_t` then G.
    fn moduli(&self) -> (f64, f64) {
        moduli(self.kn, self.kt)
    }

    fn mu(&self) -> f64 {
        self.mu
    }

    fn stated_stiffness(&self) -> f64 {
        self.kn
    }

    fn damping_rates(&self) -> Vec<(&'static str, f64)> {
        vec![("gamma_n", self.gamma_n), ("gamma_t", self.gamma_t)]
    }
}

impl Sprung for HertzHistory<f64> {
    fn springs(&self, _: Materials) -> Springs {
        Springs {
            kn: self.kn,
            kt: self.kt,
            short: 0.0,
            joint_cap: Some(self.mu),
        }
    }
}
