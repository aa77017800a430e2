//! Points with known truth and noise for the tests of the fits.

use super::{Datum, Fit};
use bitgrain_sim::random::{Purpose, uniforms};

/// A normal number of mean 0 and variance 1, by Box and Muller's method.
pub fn normal(seed: u64, k: usize) -> f64 {
    let [u, v] = uniforms::<2>(seed, Purpose::Shift, k as u32);
    (-2.0 * libm::log(1.0 - u)).sqrt() * libm::cos(2.0 * std::f64::consts::PI * v)
}

/// Values of x in equal ratios, both ends included.
pub fn spread(from: f64, to: f64, n: usize) -> Vec<f64> {
    let step = libm::log(to / from) / (n as f64 - 1.0);
    (0..n).map(|k| from * libm::exp(step * k as f64)).collect()
}

/// Points on a curve, each with the error that `error` makes of its value.
pub fn exact(x: &[f64], curve: impl Fn(f64) -> f64, error: impl Fn(f64) -> f64) -> Vec<Datum> {
    let at = |&x: &f64| Datum {
        x,
        y: curve(x),
        error: error(curve(x)),
    };
    x.iter().map(at).collect()
}

/// The same points off the curve by normal noise of `times` their errors.
pub fn noisy(data: &[Datum], times: f64, seed: u64) -> Vec<Datum> {
    let off = |(k, d): (usize, &Datum)| Datum {
        y: d.y + times * d.error * normal(seed, k),
        ..*d
    };
    data.iter().enumerate().map(off).collect()
}

/// Means and covariance of the rows.
pub fn moments(rows: &[Vec<f64>]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = rows.len() as f64;
    let width = 0..rows[0].len();
    let mean: Vec<f64> = width
        .clone()
        .map(|j| rows.iter().map(|r| r[j]).sum::<f64>() / n)
        .collect();
    let of = |i: usize, j: usize| {
        rows.iter()
            .map(|r| (r[i] - mean[i]) * (r[j] - mean[j]))
            .sum::<f64>()
            / (n - 1.0)
    };
    let covariance = width
        .clone()
        .map(|i| width.clone().map(|j| of(i, j)).collect())
        .collect();
    (mean, covariance)
}

/// Asserts that fitted numbers scatter over noisy sets as the fits' covariances say, within 15 %: a spread
/// of 200 sets is known to 5 %. `fit` gives values and covariance before scaling.
pub fn assert_spread(sets: u64, fit: impl Fn(u64) -> (Vec<f64>, Vec<Vec<f64>>)) {
    let fits: Vec<_> = (0..sets).map(fit).collect();
    let rows: Vec<Vec<f64>> = fits.iter().map(|f| f.0.clone()).collect();
    let (_, seen) = moments(&rows);
    let mean = |i: usize, j: usize| fits.iter().map(|f| f.1[i][j]).sum::<f64>() / sets as f64;
    for i in 0..seen.len() {
        let ratio = (seen[i][i] / mean(i, i)).sqrt();
        assert!((0.85..1.15).contains(&ratio), "number {i}: {ratio}");
        for j in 0..i {
            let of = |c: &dyn Fn(usize, usize) -> f64| c(i, j) / (c(i, i) * c(j, j)).sqrt();
            let (said, found) = (of(&mean), of(&|i, j| seen[i][j]));
            assert!(
                (said - found).abs() < 0.2,
                "numbers {i} and {j}: {said} {found}"
            );
        }
    }
}

#[test]
fn noise_is_normal() {
    let rows: Vec<Vec<f64>> = (0..4000).map(|k| vec![normal(5, k)]).collect();
    let (mean, covariance) = moments(&rows);
    // Four standard errors: 1/sqrt(4000), and sqrt(2) of that.
    assert!(
        mean[0].abs() < 0.064 && (covariance[0][0] - 1.0).abs() < 0.09,
        "{mean:?}"
    );
    let beyond = rows.iter().filter(|r| r[0].abs() > 1.959_964).count();
    assert!((150..250).contains(&beyond), "{beyond}");
}

/// The numbers of a fit, and their covariance as the points' errors alone have it.
pub fn unscaled(fit: &Fit) -> (Vec<f64>, Vec<Vec<f64>>) {
    let factor = fit.scale * fit.scale;
    let rows = fit.covariance.iter();
    (
        fit.parameters.iter().map(|p| p.value).collect(),
        rows.map(|r| r.iter().map(|c| c / factor).collect())
            .collect(),
    )
}
