//! What stays as it is when another quantity is varied: ratios that Kumar 2018 holds fixed.

use serde::{Deserialize, Serialize};

use crate::scenario::CheckedScenario;
use bitgrain_sim::law::{HertzHistoryParameters, LawSpec};

/// A combination that keeps the value it has in the base.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Rule {
    /// K_t/K_n, which is Poisson's ratio (Kumar 2018, eq. 3).
    #[serde(rename = "kt/kn")]
    Tangential,
    /// gamma_n/K_n^0.6, which is the curve of restitution (Kumar 2018, Figs. 2 and 20).
    #[serde(rename = "gamma_n/kn^0.6")]
    Restitution,
    /// gamma_t/gamma_n.
    #[serde(rename = "gamma_t/gamma_n")]
    TangentialDamping,
    /// dt K_n^0.4: the time step over the duration of a collision.
    #[serde(rename = "dt*kn^0.4")]
    TimeStep,
}

/// Exponent of K_n in what fixes the curve of restitution.
pub const RESTITUTION: f64 = 0.6;
/// Exponent of K_n in the duration of a Hertz collision, as its inverse.
pub const DURATION: f64 = 0.4;

/// `gamma_n/kn^0.6` for a stiffness, as `gamma_n`.
pub fn damping(ratio: f64, kn: f64) -> f64 {
    ratio * libm::pow(kn, RESTITUTION)
}

/// The keys that `rules` set if stiffness and damping are no longer those of the `base`; none if
/// they are. `damping` is the damping that was asked for, if it was.
///
/// Only `hertz_history` has such keys: of another law none is set.
pub fn followers(
    base: &CheckedScenario,
    rules: &[Rule],
    kn: f64,
    damping: Option<f64>,
) -> Vec<(&'static str, f64)> {
    let LawSpec::HertzHistory(HertzHistoryParameters {
        kn: kn_0,
        kt,
        gamma_n,
        gamma_t,
        ..
    }) = base.law
    else {
        return Vec::new();
    };
    let ratio = kn / kn_0;
    let kept = |rule| rules.contains(&rule);
    let mut keys = Vec::new();
    if kept(Rule::Tangential) {
        keys.push(("law.kt", kt * ratio));
    }
    let own = gamma_n * libm::pow(ratio, RESTITUTION);
    let normal = match damping {
        Some(asked) => asked,
        None if kept(Rule::Restitution) => {
            keys.push(("law.gamma_n", own));
            own
        }
        None => gamma_n,
    };
    if kept(Rule::TangentialDamping) {
        keys.push(("law.gamma_t", gamma_t * (normal / gamma_n)));
    }
    if kept(Rule::TimeStep) {
        keys.push(("drag.dt", base.drag.dt * libm::pow(ratio, -DURATION)));
    }
    keys
}
