//! Powers with an offset: `y = a + b x^c`, and the angle of the drag against the Froude number, which has
//! the same form (Kumar 2018, eq. 7).
//!
//! By variable projection (Golub and Pereyra, SIAM J. Numer. Anal. 10, 413, 1973): for each c the best a and
//! b are linear least squares; the chi-square that is left is minimised over c on a fixed grid, then by
//! golden section, then by Gauss-Newton steps to the last digits.

use std::f64::consts::PI;

use super::linear::{Solution, solve};
use super::{Datum, Exact, Fit, Found, Refusal, distinct, transformed};
use super::{check, check_decades, check_exponent, check_positive};

/// Exponents that are searched.
pub const EXPONENTS: [f64; 2] = [0.05, 4.0];

/// Fewest values of x that three numbers take.
pub const POINTS_MIN: usize = 5;

/// Exponents of the grid, in equal ratios.
pub(crate) const GRID: usize = 80;

/// The best curve over all exponents.
pub(crate) struct Best {
    pub exponent: f64,
    pub at: Solution,
    /// Whether it lies at an end of [`EXPONENTS`].
    pub at_end: bool,
}

/// Exponents in equal ratios, both ends included.
pub(crate) fn exponents(from: f64, to: f64, n: usize) -> impl Iterator<Item = f64> {
    let step = libm::log(to / from) / (n as f64 - 1.0);
    (0..n).map(move |k| match k {
        0 => from,
        k if k + 1 == n => to,
        k => from * libm::exp(step * k as f64),
    })
}

/// Best a and b for one exponent; x are above zero and not all alike.
pub(crate) fn at_exponent(data: &[Datum], exponent: f64) -> Result<Solution, Refusal> {
    let columns = [
        vec![1.0; data.len()],
        data.iter().map(|d| libm::pow(d.x, exponent)).collect(),
    ];
    let y: Vec<f64> = data.iter().map(|d| d.y).collect();
    solve(&columns, &y, data).map_err(|_| {
        Refusal(format!(
            "the points do not tell x^{exponent:.3} from a constant"
        ))
    })
}

/// The grid, the golden section, and the last digits.
pub(crate) fn best(data: &[Datum]) -> Result<Best, Refusal> {
    let grid: Vec<f64> = exponents(EXPONENTS[0], EXPONENTS[1], GRID).collect();
    let (mut least, mut found) = (f64::INFINITY, 0);
    for (k, &exponent) in grid.iter().enumerate() {
        let left = at_exponent(data, exponent)?.chi_square;
        if left < least {
            (least, found) = (left, k);
        }
    }
    let [mut low, mut high] = [
        grid[found.saturating_sub(1)],
        grid[(found + 1).min(GRID - 1)],
    ];
    let golden = (5.0f64.sqrt() - 1.0) / 2.0;
    let [mut left, mut right] = [high - golden * (high - low), low + golden * (high - low)];
    let mut values = [
        at_exponent(data, left)?.chi_square,
        at_exponent(data, right)?.chi_square,
    ];
    for _ in 0..50 {
        if values[0] < values[1] {
            (high, right, values[1]) = (right, left, values[0]);
            left = high - golden * (high - low);
            values[0] = at_exponent(data, left)?.chi_square;
        } else {
            (low, left, values[0]) = (left, right, values[1]);
            right = low + golden * (high - low);
            values[1] = at_exponent(data, right)?.chi_square;
        }
    }
    let mut exponent = if values[0] < values[1] { left } else { right };
    let at_end = EXPONENTS
        .iter()
        .any(|end| (exponent / end - 1.0).abs() < 1e-6);
    if at_end {
        exponent = grid[found];
    }
    let mut at = at_exponent(data, exponent)?;
    for _ in 0..20 {
        let step = match solve(&jacobian(data, &at, exponent), &at.residuals, data) {
            Ok(step) if !at_end => step.values[2],
            _ => break,
        };
        // A step refines the last digits: golden section gives eight.
        if step.is_nan() || step.abs() > 1e-4 * exponent {
            break;
        }
        let next = at_exponent(data, exponent + step)?;
        if next.chi_square > at.chi_square {
            break;
        }
        (exponent, at) = (exponent + step, next);
    }
    Ok(Best {
        exponent,
        at,
        at_end,
    })
}

/// Derivatives of the curve by a, b and c.
pub(crate) fn jacobian(data: &[Datum], at: &Solution, exponent: f64) -> [Vec<f64>; 3] {
    let power: Vec<f64> = data.iter().map(|d| libm::pow(d.x, exponent)).collect();
    let bent = data
        .iter()
        .zip(&power)
        .map(|(d, p)| at.values[1] * p * libm::log(d.x));
    let bent = bent.collect();
    [vec![1.0; data.len()], power, bent]
}

/// Refuses points that do not suffice for a curve with three numbers.
pub(crate) fn check_points(data: &[Datum]) -> Result<(), Refusal> {
    check(data)?;
    check_positive(data, "x")?;
    let there = distinct(data);
    if there < POINTS_MIN {
        return Err(Refusal(format!(
            "an offset and an exponent take five points or more at different x; there are {there}"
        )));
    }
    Ok(())
}

/// `a + b x^c`, fitted for the exponent.
///
/// Refused: points that are not numbers; x not above zero; fewer than [`POINTS_MIN`] values of x; a range of
/// x below [`DECADES_MIN`](super::DECADES_MIN); a best exponent at an end of [`EXPONENTS`]; a y that does
/// not change with x; a standard error of c beyond [`EXPONENT_ERROR_MAX`](super::EXPONENT_ERROR_MAX).
pub fn offset_power(data: &[Datum]) -> Result<Fit, Refusal> {
    check_points(data)?;
    check_decades(data, "x")?;
    let best = best(data)?;
    if best.at_end {
        let [low, high] = EXPONENTS;
        return Err(Refusal(format!(
            "the best exponent lies at the end {:.2} of those searched, {low} to {high}: the points do not \
             determine it",
            best.exponent
        )));
    }
    let linear = solve(
        &jacobian(data, &best.at, best.exponent),
        &best.at.residuals,
        data,
    );
    let linear = linear.map_err(|_| {
        Refusal(
            "y does not change with x: it has no exponent; a constant describes the points".into(),
        )
    })?;
    let found = Found {
        model: "a + b x^c",
        names: &["a", "b", "c"],
        values: vec![best.at.values[0], best.at.values[1], best.exponent],
        covariance: linear.covariance,
        residuals: best.at.residuals,
        chi_square: best.at.chi_square,
        beside: 0,
    };
    let fit = found.finish(Exact::Refused)?;
    check_exponent(fit.parameters[2].error)?;
    Ok(fit)
}

/// The angle of the drag, in radians, against the Froude number: `theta = Y1 Fr^Y2 + pi / Y3` (Kumar 2018,
/// eq. 7).
///
/// Refused: anything that [`offset_power`] refuses; an angle at rest with an error beyond half of it, which
/// leaves Y3 undetermined.
pub fn angle_law(data: &[Datum]) -> Result<Fit, Refusal> {
    let fit = offset_power(data)?;
    let (value, error) = (fit.parameters[0].value, fit.parameters[0].error);
    if error > value.abs() / 2.0 {
        return Err(Refusal(format!(
            "the angle at Fr = 0 is {value:.3} with an error of {error:.2}, beyond half of it: pi / Y3 is not \
             determined"
        )));
    }
    let divisor = PI / value;
    let rows = [
        vec![0.0, 1.0, 0.0],
        vec![0.0, 0.0, 1.0],
        vec![-divisor / value, 0.0, 0.0],
    ];
    let covariance = transformed(&rows, &fit.covariance);
    let values = [fit.parameters[1].value, fit.parameters[2].value, divisor];
    let named = ["Y1", "Y2", "Y3"].iter().zip(values).enumerate();
    let parameters = named.map(|(k, (name, value))| super::Parameter {
        name: (*name).to_owned(),
        value,
        error: covariance[k][k].sqrt(),
    });
    Ok(Fit {
        model: "Y1 Fr^Y2 + pi/Y3".into(),
        parameters: parameters.collect(),
        covariance,
        ..fit
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::super::synthetic::{assert_spread, exact, noisy, spread, unscaled};
    use super::*;

    pub fn drags(n: usize, part: f64) -> Vec<Datum> {
        exact(
            &spread(0.05, 5.0, n),
            |x| 440.0 + 310.0 * libm::pow(x, 0.6),
            |y| part * y,
        )
    }

    #[test]
    fn exact_points_give_back_their_curve() {
        for truth in [0.07, 0.38, 0.6, 1.0, 2.0, 3.9] {
            let curve = exact(
                &spread(0.1, 6.0, 15),
                |x| 2.0 - 0.5 * libm::pow(x, truth),
                |_| 0.01,
            );
            // Small exponents are found, but their errors are too large to report.
            let found = best(&curve).unwrap();
            assert!(
                (found.exponent - truth).abs() < 1e-10 && !found.at_end,
                "{truth}: {}",
                found.exponent
            );
            assert!(
                (found.at.values[0] - 2.0).abs() < 1e-8 && (found.at.values[1] + 0.5).abs() < 1e-8
            );
        }
        let fit = offset_power(&drags(12, 0.01)).unwrap();
        for (p, truth) in fit.parameters.iter().zip([440.0, 310.0, 0.6]) {
            assert!((p.value - truth).abs() < 1e-10 * truth, "{p:?}");
        }
    }

    #[test]
    fn numbers_scatter_as_their_errors_say() {
        let data = drags(30, 0.01);
        assert_spread(200, |seed| {
            unscaled(&offset_power(&noisy(&data, 1.0, seed)).unwrap())
        });
    }

    /// An offset of pi / 2.45 and a fall as 0.15 Fr^0.38, as the law has it.
    #[test]
    fn the_law_of_angles_is_found_with_its_errors() {
        let law = |fr: f64| PI / 2.45 - 0.15 * libm::pow(fr, 0.38);
        let data = exact(&spread(0.05, 10.0, 24), law, |_| 0.002);
        let fit = angle_law(&data).unwrap();
        for (p, truth) in fit.parameters.iter().zip([-0.15, 0.38, 2.45]) {
            assert!((p.value - truth).abs() < 1e-9, "{p:?}");
        }
        assert_eq!(
            (fit.parameters[2].name.as_str(), fit.model.as_str()),
            ("Y3", "Y1 Fr^Y2 + pi/Y3")
        );
        assert_spread(200, |seed| {
            unscaled(&angle_law(&noisy(&data, 1.0, seed)).unwrap())
        });
        let zero = exact(
            &spread(0.05, 10.0, 24),
            |fr| 0.5 * libm::pow(fr, 0.5),
            |_| 0.01,
        );
        let told = angle_law(&zero).unwrap_err().to_string();
        assert!(
            told.starts_with("the angle at Fr = 0 is")
                && told.ends_with("pi / Y3 is not determined"),
            "{told}"
        );
    }

    #[test]
    fn what_points_cannot_carry_is_refused() {
        let told = |d: &[Datum]| offset_power(d).unwrap_err().to_string();
        let all = drags(12, 0.01);
        let few = "an offset and an exponent take five points or more at different x; there are 4";
        assert_eq!(told(&all[..4]), few);
        let narrow = exact(&spread(1.0, 1.51, 8), |x| x, |y| 0.01 * y);
        assert!(
            told(&narrow).ends_with("0.3 decades or more in x; the points span 0.18"),
            "{}",
            told(&narrow)
        );
        let vague = drags(12, 0.15);
        assert!(
            told(&vague).starts_with("the exponent's standard error is 0."),
            "{}",
            told(&vague)
        );
        let end = |at: &str| {
            format!(
                "the best exponent lies at the end {at} of those searched, 0.05 to 4: the points do not determine it"
            )
        };
        let steep = exact(&spread(0.5, 4.0, 9), |x| 1.0 + libm::pow(x, 6.0), |_| 0.1);
        assert_eq!(told(&steep), end("4.00"));
        let log = exact(&spread(0.5, 4.0, 9), |x| 9.0 + libm::log(x), |_| 0.01);
        assert_eq!(told(&log), end("0.05"));
        let flat = exact(&spread(0.5, 4.0, 9), |_| 4.0, |_| 0.01);
        assert!(told(&flat).len() > 20, "{}", told(&flat));
        let zero = exact(&[0.0, 1.0, 2.0, 3.0, 4.0], |x| x, |_| 0.01);
        assert!(told(&zero).contains("a power takes x above zero"));
    }
}
