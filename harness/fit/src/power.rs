//! Powers without an offset: `y = A x^p`.

use super::linear::solve;
use super::{Datum, Exact, Fit, Found, Refusal};
use super::{check, check_decades, check_exponent, check_positive, distinct, transformed};

/// Fewest values of x that an exponent takes.
pub const POINTS_MIN: usize = 3;

/// `A x^p` by weighted least squares of `ln y` against `ln x`, with the errors `error/y`; `what` names x in
/// the sentences.
///
/// Chi-square and its chance are those of the logarithms; residuals are nevertheless data minus model.
/// Refused: points that are not numbers; x or y not above zero; fewer than [`POINTS_MIN`] values of x; a
/// range of x below [`DECADES_MIN`](super::DECADES_MIN); a standard error of p beyond
/// [`EXPONENT_ERROR_MAX`](super::EXPONENT_ERROR_MAX).
pub fn power(data: &[Datum], what: &str) -> Result<Fit, Refusal> {
    check(data)?;
    check_positive(data, what)?;
    if let Some(k) = data.iter().position(|d| d.y <= 0.0) {
        let why = format!(
            "point {} has y = {}: a power takes y above zero",
            k + 1,
            data[k].y
        );
        return Err(Refusal(why));
    }
    let there = distinct(data);
    if there < POINTS_MIN {
        return Err(Refusal(format!(
            "an exponent takes three points or more at different {what}; there are {there}"
        )));
    }
    check_decades(data, what)?;
    let logs: Vec<Datum> = data
        .iter()
        .map(|d| Datum {
            x: libm::log(d.x),
            y: libm::log(d.y),
            error: d.error / d.y,
        })
        .collect();
    let columns = [vec![1.0; logs.len()], logs.iter().map(|d| d.x).collect()];
    let y: Vec<f64> = logs.iter().map(|d| d.y).collect();
    let found = solve(&columns, &y, &logs)
        .map_err(|_| Refusal(format!("the points' {what} do not determine an exponent")))?;
    let (factor, exponent) = (libm::exp(found.values[0]), found.values[1]);
    let jacobian = [vec![factor, 0.0], vec![0.0, 1.0]];
    let model = |d: &Datum| factor * libm::pow(d.x, exponent);
    let found = Found {
        model: "A x^p",
        names: &["A", "p"],
        values: vec![factor, exponent],
        covariance: transformed(&jacobian, &found.covariance),
        residuals: data.iter().map(|d| d.y - model(d)).collect(),
        chi_square: found.chi_square,
        beside: 0,
    };
    let fit = found.finish(Exact::Refused)?;
    check_exponent(fit.parameters[1].error)?;
    Ok(fit)
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{assert_spread, exact, noisy, spread, unscaled};
    use super::*;

    fn data() -> Vec<Datum> {
        exact(
            &spread(0.5, 4.0, 10),
            |x| 7.0 * libm::pow(x, 1.7),
            |y| 0.05 * y,
        )
    }

    #[test]
    fn exact_points_give_back_their_power() {
        let fit = power(&data(), "D + d").unwrap();
        assert!((fit.parameters[0].value - 7.0).abs() < 1e-12, "{fit:?}");
        assert!((fit.parameters[1].value - 1.7).abs() < 1e-12);
        assert!(fit.residuals.iter().all(|r| r.abs() < 1e-11));
        // Equal relative errors: the closed form of the slope's.
        let logs: Vec<f64> = data().iter().map(|d| libm::log(d.x)).collect();
        let mean = logs.iter().sum::<f64>() / 10.0;
        let squares: f64 = logs.iter().map(|l| (l - mean) * (l - mean)).sum();
        assert!((fit.parameters[1].error - 0.05 / squares.sqrt()).abs() < 1e-12);
        let factor = 7.0 * 0.05 * (0.1 + mean * mean / squares).sqrt();
        assert!((fit.parameters[0].error - factor).abs() < 1e-12);
        assert!((fit.covariance[0][1] + 7.0 * 0.0025 * mean / squares).abs() < 1e-12);
    }

    #[test]
    fn numbers_scatter_as_their_errors_say() {
        assert_spread(200, |seed| {
            unscaled(&power(&noisy(&data(), 1.0, seed), "x").unwrap())
        });
    }

    #[test]
    fn what_points_cannot_carry_is_refused() {
        let told = |d: &[Datum]| power(d, "D + d").unwrap_err().to_string();
        let all = data();
        let few = "an exponent takes three points or more at different D + d; there are 2";
        assert_eq!(told(&all[..2]), few);
        assert_eq!(told(&[all[0], all[9], all[9], all[0]]), few);
        let narrow = exact(&spread(1.0, 1.51, 5), |x| x, |y| 0.01 * y);
        let range =
            "an exponent takes a range of 0.3 decades or more in D + d; the points span 0.18";
        assert_eq!(told(&narrow), range);
        let vague = exact(&spread(1.0, 4.0, 4), |x| x, |y| 0.3 * y);
        let wanted =
            "the exponent's standard error is 0.29, beyond 0.25: more or longer runs are wanted";
        assert_eq!(told(&vague), wanted);
        let mut bad = all.clone();
        bad[3].y = -1.0;
        assert_eq!(told(&bad), "point 4 has y = -1: a power takes y above zero");
        bad[2].x = 0.0;
        assert_eq!(
            told(&bad),
            "point 3 has D + d = 0: a power takes D + d above zero"
        );
        bad[1].error = f64::NAN;
        assert_eq!(
            told(&bad),
            "point 2 of 10 has error = NaN, which is no number"
        );
    }
}
