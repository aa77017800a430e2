//! Contact laws as files name them, checked, and the time step they allow.

use bitgrain_kernel::law::{HertzHistory, HertzTsuji};
use serde::{Deserialize, Serialize};

use crate::sim::AnyLaw;

/// Longest time step as a fraction of the Rayleigh time. Beyond a fifth, grains that are hit from
/// several sides at once gain energy from the integrator.
pub const RAYLEIGH_FRACTION_MAX: f64 = 0.2;

/// A contact law with the parameters its paper gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum LawSpec {
    /// Kumar 2018, eqs. 1 and 2.
    HertzHistory {
        /// Normal stiffness `K_n` (pressure), positive.
        kn: f64,
        /// Tangential stiffness `K_t` (pressure), zero or more.
        kt: f64,
        /// Normal damping `gamma_n` (1 / (time length)), zero or more.
        gamma_n: f64,
        /// Tangential damping `gamma_t`, zero or more.
        gamma_t: f64,
        /// Friction coefficient, zero or more.
        mu: f64,
    },
    /// Guillard 2014, eq. A1 and Table I.
    HertzTsuji {
        /// Young's modulus (pressure), positive.
        young: f64,
        /// Poisson's ratio, above -1 and at most 0.5.
        poisson: f64,
        /// Coefficient of restitution, above 0 and at most 1.
        restitution: f64,
        /// Friction coefficient, zero or more.
        mu: f64,
    },
}

impl LawSpec {
    /// The law as the kernel computes it.
    ///
    /// # Errors
    /// The key and what was expected of it.
    pub fn build(&self) -> Result<AnyLaw, (&'static str, String)> {
        match *self {
            LawSpec::HertzHistory {
                kn,
                kt,
                gamma_n,
                gamma_t,
                mu,
            } => {
                positive("kn", kn)?;
                not_negative("kt", kt)?;
                not_negative("gamma_n", gamma_n)?;
                not_negative("gamma_t", gamma_t)?;
                not_negative("mu", mu)?;
                Ok(AnyLaw::HertzHistory(HertzHistory {
                    kn,
                    kt,
                    gamma_n,
                    gamma_t,
                    mu,
                }))
            }
            LawSpec::HertzTsuji {
                young,
                poisson,
                restitution,
                mu,
            } => {
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
                let law = HertzTsuji::new(young, poisson, restitution, mu);
                Ok(AnyLaw::HertzTsuji(law))
            }
        }
    }

    /// The law with damping strong enough to take the last motion out of a bed that has fallen, in
    /// steps of `dt`, grains of diameter `d`; the forces at rest are the law's own.
    ///
    /// `hertz_history`: `gamma = 2/(d dt)` where the law has less, which damps a contact of a
    /// hundredth of `d` by a tenth in a step: stable with a dozen contacts. `hertz_tsuji`:
    /// restitution 0.1, the same fraction of critical damping at every overlap.
    ///
    /// # Panics
    /// Where [`LawSpec::build`] refuses the law.
    pub fn quenching(&self, dt: f64, d: f64) -> AnyLaw {
        let strong = 2.0 / (d * dt);
        let more = |gamma: f64| if gamma > strong { gamma } else { strong };
        let mut law = *self;
        match &mut law {
            LawSpec::HertzHistory {
                gamma_n, gamma_t, ..
            } => (*gamma_n, *gamma_t) = (more(*gamma_n), more(*gamma_t)),
            LawSpec::HertzTsuji { restitution, .. } => {
                *restitution = if *restitution < 0.1 {
                    *restitution
                } else {
                    0.1
                };
            }
        }
        law.build()
            .expect("a sound law stays sound with more damping")
    }

    /// Friction coefficient.
    pub fn mu(&self) -> f64 {
        match *self {
            LawSpec::HertzHistory { mu, .. } | LawSpec::HertzTsuji { mu, .. } => mu,
        }
    }

    /// Rayleigh time of a grain: pi r sqrt(rho / G) / (0.1631 nu + 0.8766), with the shear modulus
    /// and Poisson's ratio of the material (for `hertz_history` from Kumar 2018, eq. 3: the ratio
    /// `K_t/K_n` gives nu, held to 0 .. 0.5, and the stiffer of `K_n` and `K_t` then gives G).
    pub fn rayleigh_time(&self, radius: f64, density: f64) -> f64 {
        let (shear, poisson) = match *self {
            LawSpec::HertzHistory { kn, kt, .. } => {
                let ratio = kt / kn;
                let poisson = ((3.0 - 2.0 * ratio) / (3.0 - ratio)).clamp(0.0, 0.5);
                let poisson = if ratio >= 1.5 { 0.0 } else { poisson };
                let (normal, tangential) =
                    (0.75 * (1.0 - poisson) * kn, 0.25 * (2.0 - poisson) * kt);
                let stiffer = if tangential > normal {
                    tangential
                } else {
                    normal
                };
                (stiffer, poisson)
            }
            LawSpec::HertzTsuji { young, poisson, .. } => {
                (young / (2.0 * (1.0 + poisson)), poisson)
            }
        };
        let wave = 0.1631 * poisson + 0.8766;
        std::f64::consts::PI * radius * (density / shear).sqrt() / wave
    }

    /// Refuses a time step that is not positive or beyond [`RAYLEIGH_FRACTION_MAX`] of the shortest
    /// Rayleigh time among `sizes` (radius, density).
    ///
    /// # Errors
    /// What is wrong and the longest step that would do.
    pub fn check_time_step(
        &self,
        dt: f64,
        sizes: impl Iterator<Item = (f64, f64)>,
    ) -> Result<(), String> {
        if !(dt > 0.0 && dt.is_finite()) {
            return Err(format!("is {dt}; expected a positive time"));
        }
        let shortest = sizes
            .map(|(radius, density)| self.rayleigh_time(radius, density))
            .fold(f64::INFINITY, |a, b| if b < a { b } else { a });
        let limit = RAYLEIGH_FRACTION_MAX * shortest;
        if dt > limit {
            return Err(format!(
                "is {dt}, {:.3} of the Rayleigh time; expected at most {RAYLEIGH_FRACTION_MAX} \
                 of it, {limit:.3e}: shorten it or soften the grains",
                dt / shortest
            ));
        }
        Ok(())
    }
}

fn positive(key: &'static str, value: f64) -> Result<(), (&'static str, String)> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err((key, format!("is {value}; expected a positive number")))
    }
}

fn not_negative(key: &'static str, value: f64) -> Result<(), (&'static str, String)> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err((key, format!("is {value}; expected zero or more")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published material of Kumar 2018: E and nu of eq. 3 give back K_n and the wave speed.
    #[test]
    fn rayleigh_time_of_both_spellings_agrees() {
        let (young, poisson) = (1e6, 0.3);
        let shear = young / (2.0 * (1.0 + poisson));
        let kn = 4.0 * shear / (3.0 * (1.0 - poisson));
        let kt = 4.0 * shear / (2.0 - poisson);
        let kumar = LawSpec::HertzHistory {
            kn,
            kt,
            gamma_n: 0.0,
            gamma_t: 0.0,
            mu: 0.5,
        };
        let guillard = LawSpec::HertzTsuji {
            young,
            poisson,
            restitution: 0.5,
            mu: 0.5,
        };
        let (a, b) = (
            kumar.rayleigh_time(0.5, 1.0),
            guillard.rayleigh_time(0.5, 1.0),
        );
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }

    #[test]
    fn a_time_step_is_held_to_a_fifth_of_the_rayleigh_time() {
        let law = LawSpec::HertzHistory {
            kn: 2e8,
            kt: 2.45e8,
            gamma_n: 5e4,
            gamma_t: 5e4,
            mu: 0.5,
        };
        let limit = 0.2 * law.rayleigh_time(0.45, 1.0);
        let sizes = || [(0.5, 1.0), (0.45, 1.0)].into_iter();
        assert!(law.check_time_step(limit * 0.999, sizes()).is_ok());
        assert!(law.check_time_step(limit * 1.001, sizes()).is_err());
        assert!(law.check_time_step(f64::NAN, sizes()).is_err());
        assert!(law.check_time_step(-1e-5, sizes()).is_err());
    }
}
