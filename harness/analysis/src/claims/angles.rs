//! Curves by angle round the cylinder: how far they lie apart, and how much of a shape they hold.

use crate::analysis::Value;
use bitgrain_sim::coarse_graining::load::{POINTS, WIDTH};

/// A difference counts as one from this many errors on.
const TOLD: f64 = 5.0;

/// How far curves by angle lie apart.
pub(super) struct Apart {
    /// The largest value of their mean.
    pub peak: Value,
    /// Their spread beyond the errors over their mean, both as root mean squares over the angles; none if the mean is
    /// not distinct from zero: then noise alone would make the spread.
    pub over: Option<Value>,
}

/// How far two curves or more lie apart.
pub(super) fn spread(curves: &[Vec<Value>]) -> Apart {
    let n = curves.len() as f64;
    let (mut seen, mut known, mut fourth, mut square) = (0.0, 0.0, 0.0, 0.0);
    let mut peak = Value::new(0.0, 1.0);
    for m in 0..POINTS {
        let at: Vec<Value> = curves.iter().map(|c| c[m]).collect();
        let mean = at.iter().map(|v| v.value).sum::<f64>() / n;
        let own: f64 = at.iter().map(|v| v.error * v.error).sum();
        seen += at
            .iter()
            .map(|v| (v.value - mean) * (v.value - mean))
            .sum::<f64>()
            / (n - 1.0);
        known += own / n;
        fourth += at.iter().map(|v| libm::pow(v.error, 4.0)).sum::<f64>() / n;
        square += mean * mean - own / (n * n);
        if mean.abs() > peak.value {
            peak = Value::new(mean.abs(), own.sqrt() / n);
        }
    }
    if peak.value < TOLD * peak.error || square <= 0.0 {
        return Apart { peak, over: None };
    }
    // Numbers of unequal variance count as fewer, and neighbouring angles as one.
    let angles = known * known / fourth / POINTS as f64 * SQUARES;
    let points = POINTS as f64;
    let (seen, known, square) = (seen / points, known / points, square / points);
    let left = if seen > known { seen - known } else { 0.0 };
    // Error of a mean of squares of numbers with this variance of noise, of so many.
    let noise = |known: f64, left: f64, count: f64| {
        ((2.0 * known * known + 4.0 * known * left) / count).sqrt()
    };
    let own = noise(known, left, angles * (n - 1.0));
    let spread = left.sqrt();
    // The error of a root, unless it is near zero.
    let (slope, most) = (0.5 * own / spread, own.sqrt());
    let error = if slope < most { slope } else { most };
    let mean = square.sqrt();
    let mean = Value::new(mean, 0.5 * noise(known / n, square, angles) / mean);
    let over = Some(Value::new(spread, error).over(mean));
    Apart { peak, over }
}

/// How many angles are independent of each other in a mean of squares: the Gaussian's own correlation, squared, is
/// that much long.
const SQUARES: f64 = ROOT_TWO_PI / WIDTH;
/// sqrt(2 pi).
const ROOT_TWO_PI: f64 = 2.506_628_274_631;
