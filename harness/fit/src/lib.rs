//! Curves through measured points: straight lines, powers, powers with an offset, three regimes.
//!
//! Pure functions over plain data. Every fit is by weighted least squares with the points' own standard
//! errors, says how well it fits, and is refused with a sentence if the points do not suffice: a
//! [`Refusal`] says what is missing. The same points give the same bits everywhere: loops are fixed, powers
//! and logarithms are libm's; only [`chance`] rests on the platform's, and rounds.
//!
//! **Errors.** The covariance is that of the points' errors, multiplied by the reduced chi-square if that
//! is above 1, that is if points scatter more than their errors say. It is never made smaller, so that
//! points that lie on a curve by chance do not become exact. With few degrees of freedom this makes errors
//! too large on the average, since chance scatter counts and chance agreement does not: by 9 % with ten
//! degrees of freedom, by 3 % with a hundred.

#![forbid(unsafe_code)]

mod breakpoints;
pub mod chance;
pub mod joint;
pub mod limit;
pub mod linear;
pub mod offset_power;
pub mod power;
pub mod regimes;
mod segments;
pub mod synthetic;

use serde::{Deserialize, Serialize};
use std::fmt;

use bitgrain_sim::format::{number_with_error, plural};

/// Exponents known worse than this are not reported.
pub const EXPONENT_ERROR_MAX: f64 = 0.25;

/// Least range of x that an exponent takes, in decades.
pub const DECADES_MIN: f64 = 0.3;

/// Values of x that differ by less than this part are one.
const SAME_X: f64 = 1e-9;

/// A measured point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Datum {
    /// Where it was measured, taken as exact.
    pub x: f64,
    /// What was measured.
    pub y: f64,
    /// Standard error of `y`, above zero.
    pub error: f64,
}

/// A fitted number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// Its name in the formula.
    pub name: String,
    /// Its value, in the units of the data.
    pub value: f64,
    /// Its standard error: the square root of its place in the covariance.
    pub error: f64,
}

/// A curve through points, and how well it fits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fit {
    /// The formula, such as `a + b x`.
    pub model: String,
    /// Its numbers in the order of the formula.
    pub parameters: Vec<Parameter>,
    /// Covariance of the numbers, scaled (see [`scale`](Fit::scale)).
    pub covariance: Vec<Vec<f64>>,
    /// Points less fitted numbers.
    pub degrees_of_freedom: usize,
    /// Sum over points of the square of residual over error.
    pub chi_square: f64,
    /// The same over the degrees of freedom; zero without any.
    pub reduced_chi_square: f64,
    /// Chance of a chi-square so large or larger if model and errors are right, to ten digits; 1 without
    /// degrees of freedom.
    pub probability: f64,
    /// Data minus model, in the order of the data.
    pub residuals: Vec<f64>,
    /// What errors were multiplied by: the square root of the reduced chi-square, at least 1.
    pub scale: f64,
}

impl Fit {
    /// The number of this name, if the model has it.
    pub fn parameter(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// Numbers with errors, chi-square and its chance on one line.
    pub fn line(&self) -> String {
        let shown = |p: &Parameter| format!("{} = {}", p.name, number_with_error(p.value, p.error));
        let numbers: Vec<String> = self.parameters.iter().map(shown).collect();
        let scaled = match self.scale > 1.0 {
            true => format!(", errors scaled by {:.2}", self.scale),
            false => String::new(),
        };
        let chance = match self.probability < 0.0005 {
            true => "p < 0.0005".to_owned(),
            false => format!("p = {:.2}", self.probability),
        };
        format!(
            "{}; chi^2 {:.1} of {}, {chance}{scaled}",
            numbers.join(", "),
            self.chi_square,
            self.degrees_of_freedom
        )
    }
}

/// Why points do not suffice for a fit and what would, in a plain sentence.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Refusal(pub String);

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refusal {}

/// Whether as many numbers as points may be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exact {
    /// A curve through all points is a fit: it has probability 1, and errors from the points' alone.
    Permitted,
    /// There must be more points than numbers.
    Refused,
}

/// Refuses what is not a number, and errors that are not above zero.
fn check(data: &[Datum]) -> Result<(), Refusal> {
    for (k, d) in data.iter().enumerate() {
        let n = k + 1;
        for (name, value) in [("x", d.x), ("y", d.y), ("error", d.error)] {
            if !value.is_finite() {
                let why = format!(
                    "point {n} of {} has {name} = {value}, which is no number",
                    data.len()
                );
                return Err(Refusal(why));
            }
        }
        if d.error <= 0.0 {
            let why = "errors are above zero";
            return Err(Refusal(format!(
                "point {n} (x = {}) has the error {}: {why}",
                d.x, d.error
            )));
        }
    }
    Ok(())
}

/// Refuses points for which a power of x has no meaning.
fn check_positive(data: &[Datum], what: &str) -> Result<(), Refusal> {
    match data.iter().position(|d| d.x <= 0.0) {
        None => Ok(()),
        Some(k) => Err(Refusal(format!(
            "point {} has {what} = {}: a power takes {what} above zero",
            k + 1,
            data[k].x
        ))),
    }
}

/// How many values of x there are.
fn distinct(data: &[Datum]) -> usize {
    let mut all: Vec<f64> = data.iter().map(|d| d.x).collect();
    all.sort_by(f64::total_cmp);
    let mut count = usize::from(!all.is_empty());
    let mut last = all.first().copied().unwrap_or(0.0);
    for x in all {
        if x - last > SAME_X * x.abs() {
            (count, last) = (count + 1, x);
        }
    }
    count
}

/// Refuses too narrow a range of x, which is above zero and named `what`.
fn check_decades(data: &[Datum], what: &str) -> Result<(), Refusal> {
    let least = data
        .iter()
        .fold(f64::INFINITY, |a, d| if d.x < a { d.x } else { a });
    let most = data.iter().fold(0.0, |a, d| if d.x > a { d.x } else { a });
    let decades = libm::log10(most / least);
    if decades < DECADES_MIN {
        return Err(Refusal(format!(
            "an exponent takes a range of {DECADES_MIN} decades or more in {what}; the points span {decades:.2}"
        )));
    }
    Ok(())
}

/// Refuses an exponent that is known too badly.
fn check_exponent(error: f64) -> Result<(), Refusal> {
    if error > EXPONENT_ERROR_MAX {
        return Err(Refusal(format!(
            "the exponent's standard error is {error:.2}, beyond {EXPONENT_ERROR_MAX}: more or longer runs are wanted"
        )));
    }
    Ok(())
}

/// Sum of the squares of residuals over errors.
fn chi_square(residuals: &[f64], data: &[Datum]) -> f64 {
    let pairs = residuals.iter().zip(data);
    pairs.map(|(r, d)| (r / d.error) * (r / d.error)).sum()
}

/// What a fit found, before its errors are scaled.
struct Found<'a> {
    model: &'a str,
    names: &'a [&'a str],
    values: Vec<f64>,
    /// From the points' errors alone.
    covariance: Vec<Vec<f64>>,
    residuals: Vec<f64>,
    chi_square: f64,
    /// Numbers that were fitted beside these: each takes a degree of freedom.
    beside: usize,
}

impl Found<'_> {
    /// The fit with its errors scaled and its chance.
    fn finish(self, exact: Exact) -> Result<Fit, Refusal> {
        let (points, numbers) = (self.residuals.len(), self.values.len() + self.beside);
        enough(points, numbers, exact)?;
        let degrees = points - numbers;
        let reduced = match degrees {
            0 => 0.0,
            n => self.chi_square / n as f64,
        };
        let factor = if reduced > 1.0 { reduced } else { 1.0 };
        let mut covariance = self.covariance;
        covariance.iter_mut().flatten().for_each(|c| *c *= factor);
        let parameters = self
            .names
            .iter()
            .zip(&self.values)
            .zip(&covariance)
            .enumerate();
        let parameters: Vec<Parameter> = parameters
            .map(|(k, ((name, value), row))| Parameter {
                name: (*name).to_owned(),
                value: *value,
                error: row[k].sqrt(),
            })
            .collect();
        let numbers = parameters.iter().flat_map(|p| [p.value, p.error]);
        if !numbers.chain([self.chi_square]).all(f64::is_finite) {
            return Err(Refusal(
                "the points are too large or too small for a fit in this arithmetic".into(),
            ));
        }
        Ok(Fit {
            model: self.model.to_owned(),
            parameters,
            covariance,
            degrees_of_freedom: degrees,
            chi_square: self.chi_square,
            reduced_chi_square: reduced,
            probability: chance::chi_square_tail(self.chi_square, degrees),
            residuals: self.residuals,
            scale: factor.sqrt(),
        })
    }
}

/// Refuses fewer points than a fit of this many numbers takes.
fn enough(points: usize, numbers: usize, exact: Exact) -> Result<(), Refusal> {
    let least = numbers + usize::from(exact == Exact::Refused);
    if points < least {
        let (number, point) = (plural(numbers, "number"), plural(least, "point"));
        return Err(Refusal(format!(
            "a fit of {number} takes {point} or more; there are {points}"
        )));
    }
    Ok(())
}

/// `J C J^T`: the covariance of numbers whose derivatives by the fitted ones are the rows of `J`.
fn transformed(jacobian: &[Vec<f64>], covariance: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let half: Vec<Vec<f64>> = jacobian
        .iter()
        .map(|row| covariance.iter().map(|c| dot(c, row)).collect())
        .collect();
    half.iter()
        .map(|h| jacobian.iter().map(|row| dot(h, row)).collect())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_sim::format::round10;

    #[test]
    fn numbers_are_rounded_to_ten_digits() {
        assert_eq!(round10(1.0 / 3.0), 0.333_333_333_3);
        assert_eq!(round10(-123_456.789_012_345), -123_456.789);
        assert_eq!(round10(0.0), 0.0);
        assert_eq!(round10(6.02214076e23), 6.02214076e23);
        assert!(round10(f64::NAN).is_nan());
        assert_eq!(round10(round10(2.0f64.sqrt())), round10(2.0f64.sqrt()));
    }

    #[test]
    fn points_that_are_no_numbers_are_named() {
        let good = Datum {
            x: 1.0,
            y: 2.0,
            error: 0.1,
        };
        let told = |bad: Datum| check(&[good, bad]).unwrap_err().to_string();
        assert_eq!(
            told(Datum {
                y: f64::NAN,
                ..good
            }),
            "point 2 of 2 has y = NaN, which is no number"
        );
        assert_eq!(
            told(Datum {
                x: f64::INFINITY,
                ..good
            }),
            "point 2 of 2 has x = inf, which is no number"
        );
        assert_eq!(
            told(Datum { error: 0.0, ..good }),
            "point 2 (x = 1) has the error 0: errors are above zero"
        );
        assert!(
            told(Datum {
                error: -1.0,
                ..good
            })
            .contains("above zero")
        );
        assert_eq!(check(&[good]), Ok(()));
    }

    #[test]
    fn a_fit_is_a_line_and_a_file() {
        let data = [(1.0, 3.1), (2.0, 4.9), (3.0, 7.0), (4.0, 9.2)].map(|(x, y)| Datum {
            x,
            y,
            error: 0.1,
        });
        let fit = linear::line(&data).unwrap();
        let text = fit.line().replace('\u{a0}', " ");
        assert_eq!(
            text,
            "a = 0.95 \u{b1} 0.18, b = 2.040 \u{b1} 0.065; chi^2 4.2 of 2, p = 0.12, errors scaled by 1.45"
        );
        let json = serde_json::to_string(&fit).unwrap();
        assert_eq!(serde_json::from_str::<Fit>(&json).unwrap(), fit);
        let refusal = Refusal("too few".into());
        assert_eq!(serde_json::to_string(&refusal).unwrap(), "\"too few\"");
        assert_eq!(fit.parameter("b").unwrap().value, fit.parameters[1].value);
        assert!(fit.parameter("c").is_none());
    }

    #[test]
    fn values_of_x_are_counted_once() {
        let at = |x: f64| Datum {
            x,
            y: 1.0,
            error: 1.0,
        };
        assert_eq!(distinct(&[at(2.0), at(1.0), at(2.0 + 1e-12)]), 2);
        assert_eq!(distinct(&[]), 0);
        assert_eq!(distinct(&[at(-1.0), at(0.0)]), 2);
    }
}
