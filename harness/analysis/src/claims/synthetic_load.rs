//! Made-up loads on a cylinder, for tests.

use super::load::{PointLoad, RunLoad};
use crate::analysis::Value;
use crate::fit::synthetic::normal;
use bitgrain_sim::coarse_graining::load::{POINTS, theta, weights};

/// A load of the form in appendix B: `P_0 15 cos(theta)` in front, more by the part `off` of that, and a part
/// `rho g D 20 sin(theta)` there with a gradient.
pub(super) fn load(depth: f64, gradient: bool, off: f64) -> PointLoad {
    let at = |m: usize| {
        let front = libm::cos(theta(m)).max(0.0);
        let asymmetric = match gradient {
            true => 20.0 * front * libm::sin(theta(m)) / depth,
            false => 0.0,
        };
        Value::new((1.0 + off) * 15.0 * front + asymmetric, 0.05)
    };
    let normal: Vec<Value> = (0..POINTS).map(at).collect();
    let lift = 0.5 * 20.0 * 2.0 / 3.0 / depth;
    PointLoad {
        depth,
        pressure: depth,
        asked: depth,
        gradient,
        runs: vec![RunLoad {
            seed: 1,
            pressure: depth,
            normal: normal.clone(),
        }],
        tangential: vec![Value::new(0.5, 0.1); POINTS],
        tangential_part: Value::new(if gradient { 0.06 } else { 0.04 }, 0.01),
        // In closed form; the asymmetric part has no share in either.
        simple_lift: Value::new((1.0 + off) * 10.0 / std::f64::consts::PI, 0.1),
        drag: Value::new((1.0 + off) * 3.75 * std::f64::consts::PI, 0.1),
        normal_lift: Value::new(if gradient { lift } else { 0.0 }, 0.1),
        lift: Value::new(30.0, 1.0),
        normal,
    }
}

/// A load with these errors by angle, and noise of that size, which neighbouring angles share: forces of independent
/// contacts, shared out as eq. A4 does.
pub(super) fn noisy(mut load: PointLoad, error: impl Fn(f64) -> f64, seed: u64) -> PointLoad {
    let own = 100 * seed + load.depth as u64;
    let contacts: Vec<(f64, [f64; POINTS])> = (0..POINTS)
        .map(|j| (normal(own, j), weights(theta(j))))
        .collect();
    for m in 0..POINTS {
        let sum = |of: &dyn Fn(f64, f64) -> f64| {
            contacts
                .iter()
                .map(|(push, w)| of(*push, w[m]))
                .sum::<f64>()
        };
        let noise = sum(&|push, w| push * w) / sum(&|_, w| w * w).sqrt();
        let error = error(theta(m));
        load.normal[m] = Value::new(load.normal[m].value + error * noise, error);
    }
    load.runs.clear();
    load
}
