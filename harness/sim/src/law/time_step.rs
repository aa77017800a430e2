//! The time step that a law allows: waves in the grains and collisions must be resolved.

use super::laws::LawSpec;
use crate::grain::sphere_mass;

/// Longest time step as a fraction of the Rayleigh time. Beyond a fifth, grains that are hit from
/// several sides at once gain energy from the integrator.
pub const RAYLEIGH_FRACTION_MAX: f64 = 0.2;

/// Longest time step as a fraction of the duration of a collision. At a tenth the coefficient of
/// restitution is off by at most 0.005 under `hertz_history` as Kumar 2018 has it and by 0.022 under
/// `hertz_tsuji` at 0.6, wherever in a step bodies meet, and an elastic collision gains half a percent
/// of its energy; at a sixth these are 0.027, 0.058 and two percent.
pub const CONTACT_FRACTION_MAX: f64 = 0.1;

/// Duration of a Hertz collision times the speed, over the deepest overlap: twice the integral of
/// `1/sqrt(1 - x^(5/2))` from 0 to 1 (Landau and Lifshitz, Theory of Elasticity, section 9).
const HERTZ_DURATION: f64 = 2.943_275;

impl LawSpec {
    /// Duration of an undamped collision of two equal grains that meet at this speed (positive): 2.943
    /// times the deepest overlap over the speed, with the overlap `(5 m v^2/(4 K_n sqrt(R)))^(2/5)`,
    /// effective mass and radius (Landau and Lifshitz, Theory of Elasticity, section 9).
    ///
    /// It is proportional to the radius and falls with the fifth root of the speed.
    pub fn contact_duration(&self, speed: f64, radius: f64, density: f64) -> f64 {
        let mass = 0.5 * sphere_mass(2.0 * radius, density);
        let stiffness = self.normal_stiffness() * (0.5 * radius).sqrt();
        let deepest = libm::pow(1.25 * mass * speed * speed / stiffness, 0.4);
        HERTZ_DURATION * deepest / speed
    }

    /// Shortest duration of a collision at this speed, both grains one of `sizes` (radius, density).
    pub fn shortest_contact(&self, speed: f64, sizes: impl Iterator<Item = (f64, f64)>) -> f64 {
        sizes
            .map(|(radius, density)| self.contact_duration(speed, radius, density))
            .fold(f64::INFINITY, |a, b| if b < a { b } else { a })
    }

    /// Refuses a time step beyond [`CONTACT_FRACTION_MAX`] of the shortest collision among `sizes`
    /// (radius, density) at this speed; `what` moves as fast.
    ///
    /// # Errors
    /// What is wrong and the longest step that would do.
    pub fn check_contact_duration(
        &self,
        dt: f64,
        sizes: impl Iterator<Item = (f64, f64)>,
        (speed, what): (f64, &str),
    ) -> Result<(), String> {
        let shortest = self.shortest_contact(speed, sizes);
        let limit = CONTACT_FRACTION_MAX * shortest;
        if dt > limit {
            return Err(format!(
                "is {dt}, {:.3} of the duration of a collision at the speed of {what}, {speed:.4}; expected \
                 at most {CONTACT_FRACTION_MAX} of it, {limit:.3e}, for collisions to come out right: \
                 shorten it, soften the grains or go slower",
                dt / shortest
            ));
        }
        Ok(())
    }

    /// Rayleigh time of a grain: `pi r sqrt(rho / G) / (0.1631 nu + 0.8766)`, with the shear modulus
    /// and Poisson's ratio of the material.
    pub fn rayleigh_time(&self, radius: f64, density: f64) -> f64 {
        rayleigh_time(self.parameters().moduli(), radius, density)
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
        check_rayleigh(
            dt,
            sizes.map(|(radius, density)| self.rayleigh_time(radius, density)),
        )
    }
}

/// Rayleigh time of a grain of a material with this shear modulus and Poisson's ratio.
pub fn rayleigh_time((shear, poisson): (f64, f64), radius: f64, density: f64) -> f64 {
    let wave = 0.1631 * poisson + 0.8766;
    std::f64::consts::PI * radius * (density / shear).sqrt() / wave
}

/// Refuses a time step that is not positive or beyond [`RAYLEIGH_FRACTION_MAX`] of the shortest of these Rayleigh
/// times.
///
/// # Errors
/// What is wrong and the longest step that would do.
pub fn check_rayleigh(dt: f64, times: impl Iterator<Item = f64>) -> Result<(), String> {
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(format!("is {dt}; expected a positive time"));
    }
    let shortest = times.fold(f64::INFINITY, |a, b| if b < a { b } else { a });
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{HertzHistoryParameters, HertzTsujiParameters};

    /// The published material of Kumar 2018: E and nu of eq. 3 give back K_n and the wave speed.
    #[test]
    fn rayleigh_time_of_both_spellings_agrees() {
        let (young, poisson) = (1e6, 0.3);
        let shear = young / (2.0 * (1.0 + poisson));
        let kn = 4.0 * shear / (3.0 * (1.0 - poisson));
        let kt = 4.0 * shear / (2.0 - poisson);
        let kumar = LawSpec::HertzHistory(HertzHistoryParameters {
            kn,
            kt,
            gamma_n: 0.0,
            gamma_t: 0.0,
            mu: 0.5,
            rolling: None,
        });
        let guillard = LawSpec::HertzTsuji(HertzTsujiParameters {
            young,
            poisson,
            restitution: 0.5,
            mu: 0.5,
            rolling: None,
        });
        let (a, b) = (
            kumar.rayleigh_time(0.5, 1.0),
            guillard.rayleigh_time(0.5, 1.0),
        );
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }

    /// The constant is the integral; its end is taken out by x = 1 - y^2.
    #[test]
    fn the_duration_of_a_hertz_collision_is_an_integral() {
        let n = 100_000;
        let mut sum = 0.0;
        for k in 0..n {
            let y = (f64::from(k) + 0.5) / f64::from(n);
            let x = 1.0 - y * y;
            sum += 2.0 * y / (1.0 - x * x * x.sqrt()).sqrt();
        }
        let integral = 2.0 * sum / f64::from(n);
        assert!((integral - HERTZ_DURATION).abs() < 1e-6, "{integral}");
    }

    #[test]
    fn a_time_step_is_held_to_a_tenth_of_a_collision() {
        let law = LawSpec::HertzTsuji(HertzTsujiParameters {
            young: 5e6,
            poisson: 0.45,
            restitution: 0.6,
            mu: 0.5,
            rolling: None,
        });
        let sizes = || [(1e-3, 2500.0), (7.5e-4, 2500.0)].into_iter();
        let limit = 0.1 * law.contact_duration(2.0, 7.5e-4, 2500.0);
        let check = |dt| law.check_contact_duration(dt, sizes(), (2.0, "a fall"));
        assert!(check(limit * 0.999).is_ok());
        assert!(check(limit * 1.001).unwrap_err().contains("a fall, 2.0000"));
        // Faster by 2^5, half as long.
        let faster = law.contact_duration(64.0, 7.5e-4, 2500.0);
        assert!((faster / (10.0 * limit) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_time_step_is_held_to_a_fifth_of_the_rayleigh_time() {
        let law = LawSpec::HertzHistory(HertzHistoryParameters {
            kn: 2e8,
            kt: 2.45e8,
            gamma_n: 5e4,
            gamma_t: 5e4,
            mu: 0.5,
            rolling: None,
        });
        let limit = 0.2 * law.rayleigh_time(0.45, 1.0);
        let sizes = || [(0.5, 1.0), (0.45, 1.0)].into_iter();
        assert!(law.check_time_step(limit * 0.999, sizes()).is_ok());
        assert!(law.check_time_step(limit * 1.001, sizes()).is_err());
        assert!(law.check_time_step(f64::NAN, sizes()).is_err());
        assert!(law.check_time_step(-1e-5, sizes()).is_err());
    }
}
