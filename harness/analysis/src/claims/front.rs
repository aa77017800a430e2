//! The normal stress at the cylinder's front (Guillard 2014, section IV, Fig. 11).

use super::load::PointLoad;
use super::points::Spread;
use super::shape::share;
use crate::analysis::Value;
use bitgrain_sim::coarse_graining::load::{POINTS, theta};

/// Mean of the two points on either side of an angle.
pub(super) fn near(load: &PointLoad, m: usize) -> Value {
    let (a, b) = (load.normal[(m + POINTS - 1) % POINTS], load.normal[m]);
    // They share nearly all of their contacts.
    Value::new(0.5 * (a.value + b.value), 0.5 * (a.error + b.error))
}

/// The points of the front half, `|theta| < pi/2`.
fn front() -> impl Iterator<Item = usize> {
    (0..POINTS).filter(|m| libm::cos(theta(*m)) > 0.0)
}

/// `A` of the best `A cos(theta)` over the front half, over P_0, each angle weighted by its error.
pub(super) fn cosine(load: &PointLoad) -> Value {
    let (mut shape, mut weights) = ([0.0; POINTS], [0.0; POINTS]);
    for m in front() {
        shape[m] = libm::cos(theta(m));
        weights[m] = load.normal[m].weight();
    }
    share(&load.normal, &shape, &weights)
}

/// What a fit `a cos(theta)` leaves of the front half, root mean square over its angles, over P_0.
fn left(load: &PointLoad, a: f64) -> f64 {
    let off = front().map(|m| load.normal[m].value - a * libm::cos(theta(m)));
    let squares: f64 = off.map(|x| x * x).sum();
    (squares / front().count() as f64).sqrt()
}

/// The amplitude of the cosine beside the stress at the angle, of several loads, for a note. The claim's number is the
/// stress at the angle: that is what the paper gives. It does not say that the load is a cosine; what the fit leaves
/// says how far it is one.
pub(super) fn beside(loads: &[&PointLoad]) -> String {
    let fits: Vec<Value> = loads.iter().map(|l| cosine(l)).collect();
    let all: Vec<(f64, f64)> = fits.iter().map(|a| (a.value, a.error)).collect();
    let rest = loads.iter().zip(&fits).map(|(l, a)| left(l, a.value));
    let (amplitude, rest) = (Spread::of(&all), rest.sum::<f64>() / loads.len() as f64);
    format!(
        "A cos(theta) over the front half has A = {:.2} +- {:.2} and leaves {rest:.2} P_0 (root mean square); the \
         number is the stress at the angle, as in the paper",
        amplitude.mean, amplitude.error
    )
}

#[cfg(test)]
mod tests {
    use super::super::synthetic_load::{load, noisy};
    use super::*;

    /// Of 1,000 loads with a known amplitude and noise that neighbouring angles share, it lies within two errors of
    /// the fit's in as many as of normal numbers, 954, to four standard deviations of that count. The errors are
    /// alike, or largest at the front, as they are in runs.
    #[test]
    fn the_amplitude_lies_within_its_errors() {
        let errors: [fn(f64) -> f64; 2] = [|_| 0.05, |t| 0.05 + 0.25 * libm::cos(t) * libm::cos(t)];
        for error in errors {
            let inside = (0..1000).filter(|seed| {
                let found = cosine(&noisy(load(16.0, false, 0.0), error, *seed));
                (found.value - 15.0).abs() <= 2.0 * found.error
            });
            let inside = inside.count();
            assert!((930..=970).contains(&inside), "{inside}");
        }
    }

    /// The fit weighs angles by their errors: the one that is off by a thousand errors of the others hardly counts if
    /// its own is as large.
    #[test]
    fn an_angle_with_a_large_error_hardly_counts() {
        let mut off = load(16.0, false, 0.0);
        assert!((cosine(&off).value - 15.0).abs() < 1e-12 && left(&off, 15.0) < 1e-12);
        off.normal[5] = Value::new(65.0, 50.0);
        assert!(
            (cosine(&off).value - 15.0).abs() < 1e-3,
            "{:?}",
            cosine(&off)
        );
        off.normal[5].error = 0.05;
        assert!((cosine(&off).value - 15.0).abs() > 1.0);
    }

    /// What is left of a load that is no cosine is told; here it is the root of one.
    #[test]
    fn what_a_cosine_leaves_is_told() {
        let mut wide = load(16.0, false, 0.0);
        for m in front() {
            // sqrt(cos), whose best cosine is 15 sum cos^(3/2)/sum cos^2 at equal weights.
            wide.normal[m].value = 15.0 * libm::cos(theta(m)).sqrt();
        }
        let sum = |power: f64| {
            front()
                .map(|m| libm::pow(libm::cos(theta(m)), power))
                .sum::<f64>()
        };
        let expected = 15.0 * sum(1.5) / sum(2.0);
        assert!((cosine(&wide).value - expected).abs() < 1e-9);
        let rest = 15.0 * 15.0 * sum(1.0) - expected * expected * sum(2.0);
        let rest = (rest / front().count() as f64).sqrt();
        assert!((left(&wide, expected) - rest).abs() < 1e-9);
        let told = beside(&[&wide, &wide]);
        assert!(told.contains(&format!("A = {expected:.2} +- ")), "{told}");
        assert!(told.contains(&format!("leaves {rest:.2} P_0")), "{told}");
    }
}
