//! The limit of a drag as the speed goes to zero.

use serde::{Deserialize, Serialize};

use super::linear::solve;
use super::offset_power::{EXPONENTS, GRID, at_exponent, best, check_points, exponents, jacobian};
use super::{Datum, Refusal, chance};

/// How often the exponents that fit are narrowed down for the interval of the limit.
const ROUNDS: usize = 4;

/// Exponents at which it is then looked for.
const PROFILE: usize = 200;

/// What `y` goes to as x goes to zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// The offset `a` of the best `a + b x^c`.
    pub value: f64,
    /// Its standard error: half of `high - low`, or that of the covariance if that is larger.
    pub error: f64,
    /// Least offset whose best chi-square over b and c is within one (scaled) of the least.
    pub low: f64,
    /// Largest such offset.
    pub high: f64,
    /// The best exponent, however well it is known.
    pub exponent: f64,
    /// Whether an end of [`EXPONENTS`] is among the exponents that fit so well: then `low` or `high` is that
    /// of this end, and would lie farther out.
    pub open: bool,
    /// Chi-square of the best curve.
    pub chi_square: f64,
    /// Points less three.
    pub degrees_of_freedom: usize,
    /// Chance of a chi-square so large or larger.
    pub probability: f64,
}

/// The part of a range of exponents that fits: from the first to the last of a grid whose chi-square is at
/// most this, and the best, each widened by one ratio of the grid.
fn accepted(data: &[Datum], range: [f64; 2], best: f64, most: f64) -> Result<[f64; 2], Refusal> {
    let [mut from, mut to] = [best; 2];
    for exponent in exponents(range[0], range[1], GRID) {
        if at_exponent(data, exponent)?.chi_square <= most {
            from = if exponent < from { exponent } else { from };
            to = if exponent > to { exponent } else { to };
        }
    }
    let ratio = libm::exp(libm::log(range[1] / range[0]) / (GRID as f64 - 1.0));
    let [least, largest] = [from / ratio, to * ratio];
    Ok([
        if least > range[0] { least } else { range[0] },
        if largest < range[1] {
            largest
        } else {
            range[1]
        },
    ])
}

/// The limit of `y` as x goes to zero, by `a + b x^c` with whatever exponents fit.
///
/// Its interval is that of all offsets whose best chi-square, over b and over all c of [`EXPONENTS`], is
/// above the least by at most one (times the reduced chi-square if that is above 1).
/// Refused: points that are not numbers; x not above zero; fewer than
/// [`POINTS_MIN`](super::offset_power::POINTS_MIN) values of x; an error beyond half of the value.
pub fn extrapolated(data: &[Datum]) -> Result<Limit, Refusal> {
    let limit = limit(data)?;
    let told = limit.error.is_finite() && limit.error <= limit.value.abs() / 2.0;
    if !told {
        return Err(Refusal(format!(
            "the limit at x = 0 is {:.3} with an error of {:.2}, beyond half of it: more or longer runs at small x \
             are wanted",
            limit.value, limit.error
        )));
    }
    Ok(limit)
}

/// The limit, however well it is known.
fn limit(data: &[Datum]) -> Result<Limit, Refusal> {
    check_points(data)?;
    let best = best(data)?;
    let degrees = data.len() - 3;
    let reduced = best.at.chi_square / degrees as f64;
    let factor = if reduced > 1.0 { reduced } else { 1.0 };
    let most = best.at.chi_square + factor;
    let value = best.at.values[0];
    let [mut from, mut to] = EXPONENTS;
    for _ in 0..ROUNDS {
        [from, to] = accepted(data, [from, to], best.exponent, most)?;
    }
    let mut open = false;
    for end in EXPONENTS {
        open |= at_exponent(data, end)?.chi_square <= most;
    }
    let (mut low, mut high) = (value, value);
    for exponent in exponents(from, to, PROFILE).chain([best.exponent]) {
        let at = at_exponent(data, exponent)?;
        if at.chi_square <= most {
            let half = (at.covariance[0][0] * (most - at.chi_square)).sqrt();
            let (least, largest) = (at.values[0] - half, at.values[0] + half);
            low = if least < low { least } else { low };
            high = if largest > high { largest } else { high };
        }
    }
    let half = (high - low) / 2.0;
    let linear = solve(
        &jacobian(data, &best.at, best.exponent),
        &best.at.residuals,
        data,
    );
    let linear = linear.map_or(0.0, |l| (factor * l.covariance[0][0]).sqrt());
    let error = if linear > half && !best.at_end {
        linear
    } else {
        half
    };
    Ok(Limit {
        value,
        error,
        low,
        high,
        exponent: best.exponent,
        open,
        chi_square: best.at.chi_square,
        degrees_of_freedom: degrees,
        probability: chance::chi_square_tail(best.at.chi_square, degrees),
    })
}

#[cfg(test)]
mod tests {
    use super::super::offset_power::offset_power;
    use super::super::offset_power::tests::drags;
    use super::super::synthetic::noisy;
    use super::*;

    /// The interval of the limit holds the truth as often as one standard error does, 68 % and a little more
    /// since errors are never scaled down; also if the exponent is known too badly to be reported.
    #[test]
    fn the_limit_is_within_its_interval_two_times_in_three() {
        for (part, exponent_too) in [(0.01, true), (0.15, false)] {
            let data = drags(15, part);
            let (mut held, mut refused) = (0, 0);
            for seed in 0..200 {
                let set = noisy(&data, 1.0, seed);
                let limit = limit(&set).unwrap();
                held += u32::from((limit.low..limit.high).contains(&440.0));
                assert!(limit.error >= (limit.high - limit.low) / 2.0 && limit.low <= limit.value);
                refused += u32::from(offset_power(&set).is_err());
            }
            // Three standard errors of 200 about 0.72 are 0.1.
            assert!((124..164).contains(&held), "{held} of 200");
            assert_eq!(refused < 20, exponent_too, "{refused}");
        }
    }

    #[test]
    fn the_limit_of_exact_points_is_theirs() {
        let limit = extrapolated(&drags(12, 0.02)).unwrap();
        assert!(
            (limit.value - 440.0).abs() < 1e-7 && (limit.exponent - 0.6).abs() < 1e-9,
            "{limit:?}"
        );
        assert!(limit.low < 440.0 && limit.high > 440.0 && !limit.open);
        // If the model is nearly linear in its numbers the interval is that of the covariance.
        let sharp = drags(60, 1e-4);
        let (limit, fit) = (extrapolated(&sharp).unwrap(), offset_power(&sharp).unwrap());
        let ratio = (limit.high - limit.low) / 2.0 / fit.parameters[0].error;
        assert!((0.97..1.01).contains(&ratio), "{ratio}");
    }

    #[test]
    fn what_points_cannot_carry_is_refused() {
        let told = |d: &[Datum]| extrapolated(d).unwrap_err().to_string();
        let few = "an offset and an exponent take five points or more at different x; there are 4";
        assert_eq!(told(&drags(12, 0.01)[..4]), few);
        let vague = told(&drags(6, 0.3));
        assert!(
            vague.starts_with("the limit at x = 0 is") && vague.contains("beyond half of it"),
            "{vague}"
        );
        let bad = Datum {
            y: f64::NAN,
            ..drags(12, 0.01)[0]
        };
        assert!(told(&[bad; 5]).contains("no number"));
    }
}
