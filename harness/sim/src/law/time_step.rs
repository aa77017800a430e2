//! The time step that a law allows: waves in the grains and collisions must be resolved.

use bitgrain_kernel::time_step::collision;
pub use bitgrain_kernel::time_step::{CONTACT_FRACTION_MAX, RAYLEIGH_FRACTION_MAX, rayleigh_time};

use super::laws::LawSpec;
use crate::grain::sphere_mass;

impl LawSpec {
    /// Duration of an undamped [`collision`] of two equal grains that meet at this speed (positive).
    ///
    /// It is proportional to the radius and falls with the fifth root of the speed.
    pub fn contact_duration(&self, speed: f64, radius: f64, density: f64) -> f64 {
        let mass = 0.5 * sphere_mass(2.0 * radius, density);
        collision(self.normal_stiffness(), 0.5 * radius, mass, speed).1
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
            RAYLEIGH_FRACTION_MAX,
        )
    }
}

/// Refuses a time step that is not positive or beyond `most` of the shortest of these Rayleigh times.
///
/// # Errors
/// What is wrong and the longest step that would do, [`RAYLEIGH_FRACTION_MAX`] of it.
pub fn check_rayleigh(dt: f64, times: impl Iterator<Item = f64>, most: f64) -> Result<(), String> {
    if !(dt > 0.0 && dt.is_finite()) {
        return Err(format!("is {dt}; expected a positive time"));
    }
    let shortest = times.fold(f64::INFINITY, |a, b| if b < a { b } else { a });
    let limit = RAYLEIGH_FRACTION_MAX * shortest;
    if dt > most * shortest {
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

    /// The duration is the integral; its end is taken out by x = 1 - y^2.
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
        let (overlap, duration) = collision(1e5, 0.25, 0.3, 2.0);
        assert!(
            (integral - duration * 2.0 / overlap).abs() < 1e-6,
            "{integral}"
        );
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
