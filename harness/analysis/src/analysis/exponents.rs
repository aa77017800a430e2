//! Exponents of size and depth at once: `F ~ (D + d)^phi h^alpha`.

use serde::{Deserialize, Serialize};

use super::Value;
use crate::fit::linear::{Column, columns};
use crate::fit::{DECADES_MIN, Datum, EXPONENT_ERROR_MAX, Exact, Fit, Refusal};

/// Numbers that differ by less than this part are one.
const SAME: f64 = 1e-6;
/// Fewest forces for a prefactor, two exponents and their errors.
const FEWEST: usize = 4;

/// Exponents of size and depth from many forces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaled {
    /// `ln F = ln A + phi ln(D + d) + alpha ln h`.
    pub fit: Fit,
    /// `phi + alpha` with the error that their covariance gives.
    pub sum: Value,
}

/// A force on an intruder.
#[derive(Clone, Copy)]
pub(super) struct Force {
    /// D + d.
    pub size: f64,
    /// h.
    pub depth: f64,
    /// The force.
    pub value: Value,
}

/// Values that occur, ascending, each once.
pub(super) fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| near(*a, *b));
    all
}

/// Whether two sizes, depths or speeds are one.
pub(crate) fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * b.abs()
}

/// Both exponents; `what` the forces are is for refusals.
pub(super) fn scaled(forces: &[Force], what: &str) -> Result<Scaled, Refusal> {
    let positive = forces.iter().filter(|f| f.value.value > 0.0).count();
    if positive < FEWEST || positive < forces.len() {
        return Err(Refusal(format!(
            "both exponents at once take {FEWEST} {what} or more, all above zero; of {} there are {positive}",
            forces.len()
        )));
    }
    for (name, of) in [
        ("D + d", (|f| f.size) as fn(&Force) -> f64),
        ("depths h", |f| f.depth),
    ] {
        let all = distinct(forces.iter().map(of));
        let decades = libm::log10(all[all.len() - 1] / all[0]);
        if decades < DECADES_MIN {
            return Err(Refusal(format!(
                "an exponent takes a range of {DECADES_MIN} decades or more in {name}; the {what} span \
                 {decades:.2}"
            )));
        }
    }
    let data: Vec<Datum> = forces
        .iter()
        .map(|f| Datum {
            x: f.depth,
            y: libm::log(f.value.value),
            error: f.value.relative(),
        })
        .collect();
    let column = |name, of: &dyn Fn(&Force) -> f64| Column {
        name,
        values: forces.iter().map(of).collect(),
    };
    let model = [
        column("ln A", &|_| 1.0),
        column("phi", &|f| libm::log(f.size)),
        column("alpha", &|f| libm::log(f.depth)),
    ];
    let formula = "ln F = ln A + phi ln(D + d) + alpha ln h";
    let fit = columns(&data, formula, &model, Exact::Refused)?;
    let worst = fit.parameters[1..]
        .iter()
        .find(|p| p.error > EXPONENT_ERROR_MAX);
    if let Some(p) = worst {
        return Err(Refusal(format!(
            "the standard error of {} is {:.2}, beyond {EXPONENT_ERROR_MAX}: more or longer runs are wanted",
            p.name, p.error
        )));
    }
    let c = &fit.covariance;
    let sum = Value::new(
        fit.parameters[1].value + fit.parameters[2].value,
        (c[1][1] + c[2][2] + 2.0 * c[1][2]).sqrt(),
    );
    Ok(Scaled { fit, sum })
}

/// Geometric mean of positive numbers.
pub(super) fn geometric_mean(values: &[Value]) -> Value {
    let n = values.len() as f64;
    let logarithm = values.iter().map(|v| libm::log(v.value)).sum::<f64>() / n;
    let error = values
        .iter()
        .map(|v| v.relative() * v.relative())
        .sum::<f64>()
        .sqrt()
        / n;
    let mean = libm::exp(logarithm);
    Value::new(mean, mean * error)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beds that differ by a few per cent, in steps that add up to zero.
    fn forces(off: f64) -> Vec<Force> {
        let places = [
            (2.0, 8.0),
            (3.0, 8.0),
            (4.0, 8.0),
            (5.0, 8.0),
            (3.0, 4.0),
            (3.0, 14.0),
        ];
        let signs = [1.0, -1.0, -1.0, 1.0, 1.0, -1.0];
        let force = |((size, depth), sign): ((f64, f64), f64)| {
            let value = 3.0 * libm::pow(size, 1.7) * libm::pow(depth, 1.3) * (1.0 + off * sign);
            let value = Value::new(value, 0.01 * value);
            Force { size, depth, value }
        };
        places.into_iter().zip(signs).map(force).collect()
    }

    #[test]
    fn beds_that_scatter_beyond_the_errors_widen_them() {
        let clean = scaled(&forces(0.0), "forces").unwrap();
        let number = |s: &Scaled, name: &str| s.fit.parameter(name).unwrap().clone();
        assert!((number(&clean, "phi").value - 1.7).abs() < 1e-9);
        assert!((number(&clean, "alpha").value - 1.3).abs() < 1e-9);
        assert!((clean.sum.value - 3.0).abs() < 1e-9);
        let rough = scaled(&forces(0.05), "forces").unwrap();
        let phi = number(&rough, "phi");
        assert!(phi.error > 3.0 * number(&clean, "phi").error, "{phi:?}");
        assert!((phi.value - 1.7).abs() < 2.0 * phi.error, "{phi:?}");
    }

    #[test]
    fn what_forces_cannot_carry_is_refused() {
        let told = |f: &[Force]| scaled(f, "forces").unwrap_err().0;
        let few = "both exponents at once take 4 forces or more, all above zero; of 3 there are 3";
        assert_eq!(told(&forces(0.0)[..3]), few);
        let mut gone = forces(0.0);
        gone[2].value.value = -1.0;
        assert!(told(&gone).ends_with("of 6 there are 5"));
        assert!(told(&forces(0.0)[..4]).contains("0.3 decades or more in depths h"));
    }

    #[test]
    fn a_geometric_mean_has_the_mean_of_relative_errors() {
        let mean = geometric_mean(&[Value::new(2.0, 0.2), Value::new(8.0, 0.8)]);
        assert!((mean.value - 4.0).abs() < 1e-12);
        assert!((mean.relative() - 0.1 / 2.0_f64.sqrt()).abs() < 1e-12);
    }
}
