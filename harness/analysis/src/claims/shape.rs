//! How much of a known shape a curve by angle holds.

use crate::analysis::Value;
use bitgrain_sim::coarse_graining::load::{POINTS, WIDTH, theta};

/// Correlation of the noise at two angles of a load. Each contact's force is shared out by a Gaussian of width
/// [`WIDTH`] (Guillard 2014, eq. A4), and contacts at different angles are independent: the products of two such
/// Gaussians sum to one that is wider by a root of two.
fn correlation(m: usize, n: usize) -> f64 {
    let turn = 2.0 * std::f64::consts::PI;
    let off = theta(m) - theta(n);
    let off = (off - turn * (off / turn).round()) / (2.0 * WIDTH);
    libm::exp(-(off * off))
}

/// The factor by which `shape` fits a curve by angle best, by least squares with these weights. Its standard error
/// follows from the errors of the curve and from their correlation.
///
/// Weights of the inverse covariance itself would give a smaller error, but that matrix is nearly singular: the
/// Gaussian leaves hardly anything of short waves.
pub(super) fn share(curve: &[Value], shape: &[f64], weights: &[f64]) -> Value {
    let weighted: Vec<f64> = shape.iter().zip(weights).map(|(x, w)| x * w).collect();
    let all = || weighted.iter().zip(curve);
    let both: f64 = all().map(|(x, v)| x * v.value).sum();
    let own: f64 = weighted.iter().zip(shape).map(|(a, b)| a * b).sum();
    let noise: Vec<f64> = all().map(|(x, v)| x * v.error).collect();
    let mut variance = 0.0;
    for (m, a) in noise.iter().enumerate() {
        for (n, b) in noise.iter().enumerate() {
            variance += a * b * correlation(m, n);
        }
    }
    Value::new(both, variance.sqrt()).divided(own)
}

/// Weights that count each angle alike.
pub(super) const ALIKE: [f64; POINTS] = [1.0; POINTS];

#[cfg(test)]
mod tests {
    use super::super::synthetic_load::{load, noisy};
    use super::*;
    use libm::{cos, sin};

    fn by_angle(of: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..POINTS).map(|m| of(theta(m))).collect()
    }

    /// Shapes that are orthogonal over the turn do not see each other.
    #[test]
    fn a_shape_is_found_among_others() {
        let at = |t: f64| Value::new(3.0 * sin(t) + 5.0 * cos(t) + 1.0, 0.1);
        let curve: Vec<Value> = (0..POINTS).map(|m| at(theta(m))).collect();
        assert!((share(&curve, &by_angle(sin), &ALIKE).value - 3.0).abs() < 1e-12);
        assert!((share(&curve, &by_angle(cos), &ALIKE).value - 5.0).abs() < 1e-12);
    }

    /// Over the whole turn the correlation leaves as many independent angles in a sum as its length goes into the
    /// turn, sqrt(pi)/WIDTH, if the shape hardly changes over that length.
    #[test]
    fn the_correlation_of_neighbours_widens_the_error() {
        let flat = vec![Value::new(1.0, 0.1); POINTS];
        let found = share(&flat, &ALIKE, &ALIKE);
        let independent = std::f64::consts::PI.sqrt() / WIDTH;
        assert!((found.error * independent.sqrt() / 0.1 - 1.0).abs() < 1e-6);
        // Without it the error would be 2.2 times too small.
        assert!(found.error > 2.2 * 0.1 / (POINTS as f64).sqrt());
    }

    /// The factor of a sine lies within two errors as often as a normal number does, whatever the errors by angle.
    #[test]
    fn errors_are_those_of_correlated_noise() {
        let errors: [fn(f64) -> f64; 2] = [|_| 0.05, |t| 0.02 + 0.2 * cos(t) * cos(t)];
        for error in errors {
            let inside = (0..1000).filter(|seed| {
                let own = noisy(load(16.0, false, -1.0), error, *seed);
                let found = share(&own.normal, &by_angle(sin), &ALIKE);
                found.value.abs() <= 2.0 * found.error
            });
            // 954 of a thousand; 24 are 3.6 standard deviations of that.
            let inside = inside.count();
            assert!((930..=978).contains(&inside), "{inside}");
        }
    }
}
