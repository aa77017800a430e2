//! Drag against the Froude number in three regimes that join: nearly constant, linear, quadratic.
//!
//! `F = a + b x^c` (or `a` alone) up to x1, from there a line of slope s up to x2, from there `q x^2` more.
//! Where the breakpoints lie is found by least chi-square over x1, x2 and c: for each the other numbers are
//! linear least squares. A crossover has the interval of all places for which the best chi-square over
//! everything else is at most `least (1 + F_0.95(1, nu) / nu)`, nu the degrees of freedom (Seber and Wild,
//! Nonlinear Regression, 1989, section 5.4): the scatter about the curve itself is the measure, not the
//! points' errors, which are only weights in it.
//!
//! That chi-square is not smooth in the breakpoints is why the errors of x1 and x2 in the covariance are worth
//! less than these intervals; with few points it has several least values far from each other.
//!
//! **What it takes**, measured on synthetic drags: crossovers at 1 and 5, 30 x^2 above, x in equal ratios from
//! 0.1 to 10, 5 % normal noise on every point. Root mean square of x1 off 1 and x2 off 5; the number of points
//! stands for points times (5 % / error)^2, so that 80 speeds known to 1.25 % do what 1280 points do:
//!
//! | points | 500, then 130 x | 440 + 310 x^0.6, then 30 x (c given) | the same, then 130 x (c given) |
//! |-------:|:---------------:|:------------------------------------:|:------------------------------:|
//! |     40 |  0.12, 0.41     |  0.28, 0.21                          |  2.2, 1.5                      |
//! |     80 |  0.08, 0.29     |  0.16, 0.15                          |  2.0, 1.3                      |
//! |    160 |  0.06, 0.19     |  0.09, 0.10                          |  1.7, 1.0                      |
//! |    320 |  0.04, 0.12     |  0.06, 0.06                          |  0.9, 0.5                      |
//! |    640 |  0.03, 0.08     |  0.04, 0.05                          |  0.6, 0.3                      |
//! |   1280 |  0.02, 0.06     |  0.03, 0.03                          |  0.4, 0.07                     |
//! |   5000 |  0.01, 0.03     |  0.01, 0.02                          |  0.04, 0.04                    |
//!
//! Errors fall as one over the root of the number once the right breakpoints are found at all. In the last
//! column the slope changes at x1 from 186 to 130 only: below some 2500 points a curve with its first breakpoint
//! anywhere up to 4 fits as well in some sets, and in 36, 22 and 12 % of those of 20, 40 and 80 points the best
//! breakpoints leave a regime without points, which is refused. Fitting the exponent makes that worse (x1 off by
//! 0.5 with 1280 points, 0.05 with 5000) and the easier shape hardly from 320 points on (0.05, 0.07). With x in
//! equal steps instead, a plateau's crossovers are 0.06 and 0.08 off with 320 points.
//!
//! The intervals hold the truth in 92 to 98 % of sets of the first two shapes with any number of points,
//! and of the last from 320 on; with fewer, in 87 to 94 % of those of the last that are not refused.

use serde::{Deserialize, Serialize};

pub use super::breakpoints::{CONFIDENCE, Crossover, First};

use super::breakpoints::{Search, least, within};
use super::linear::{Solution, constant, line, parabola, solve};
use super::offset_power::EXPONENTS;
use super::segments::Table;
use super::{Datum, Exact, Fit, Found, Refusal, chance, check, check_positive, distinct};
use bitgrain_sim::format::short;

/// Fewest values of x for three regimes of which the first is flat; one more for each of b and c.
pub const POINTS_MIN: usize = 8;

/// Fewest values of x in a regime; one more in a first one that is not flat.
pub const POINTS_OF_A_REGIME: usize = 2;

/// Chance below which a simpler curve is rejected.
pub const SIGNIFICANCE: f64 = 0.05;

/// A curve with fewer regimes beside that with three.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simpler {
    /// What it is.
    pub model: String,
    /// How many numbers it has.
    pub numbers: usize,
    /// Its least chi-square.
    pub chi_square: f64,
    /// Chance of three regimes being so much better or more by noise alone, by the F test; an approximation,
    /// as breakpoints are not ordinary numbers: if a plateau and a line are the truth it is below 0.05 in one
    /// set of twelve, not of twenty.
    pub probability: f64,
}

/// Three regimes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Regimes {
    /// The curve: a, (b, c), s, q, x1, x2.
    pub fit: Fit,
    /// c of the first regime, fitted or given; none if that is flat.
    pub exponent: Option<f64>,
    /// From the first regime to the line: x1.
    pub first: Crossover,
    /// From the line to the quadratic: x2.
    pub second: Crossover,
    /// Curves with fewer regimes.
    pub simpler: Vec<Simpler>,
    /// Whether each of them is worse beyond [`SIGNIFICANCE`].
    pub needed: bool,
}

impl Regimes {
    /// Crossovers with their intervals in words, and whether fewer regimes would do. The covariance's errors of
    /// the crossovers are not reported: chi-square is not smooth in them.
    pub fn text(&self) -> String {
        let end = |x: Option<f64>| x.map_or("open".to_string(), short);
        let one = |c: &Crossover| format!("{} ({} to {})", short(c.at), end(c.low), end(c.high));
        let needed = match self.needed {
            true => "",
            false => "; fewer regimes fit as well",
        };
        let (first, second) = (one(&self.first), one(&self.second));
        format!("crossovers {first} and {second}, 95 % intervals in brackets{needed}")
    }

    /// The curve at x.
    pub fn value(&self, x: f64) -> f64 {
        let curve = Curve {
            breakpoints: [self.first.at, self.second.at],
            exponent: self.exponent,
            fitted: false,
        };
        let point = Datum {
            x,
            y: 0.0,
            error: 1.0,
        };
        let columns = curve.columns(&[point]);
        let numbers = self.fit.parameters.iter();
        columns
            .iter()
            .zip(numbers)
            .map(|(c, p)| c[0] * p.value)
            .sum()
    }
}

/// Each regime fitted alone, without regard to the others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegimeFits {
    /// `a` of the points up to x1.
    pub first: Result<Fit, Refusal>,
    /// `a + b x` of those from x1 to x2.
    pub second: Result<Fit, Refusal>,
    /// `a + b x^2` of those from x2 on.
    pub third: Result<Fit, Refusal>,
}

/// Fits each regime alone, as the paper does with the crossovers 1 and 5: a constant up to x1, a line from
/// x1 to x2, a parabola without a linear term from x2 on (Kumar 2018). A point on a crossover counts in both
/// of its regimes.
pub fn regime_fits(data: &[Datum], x1: f64, x2: f64) -> RegimeFits {
    let within = |low: f64, high: f64| -> Vec<Datum> {
        let inside = |d: &&Datum| d.x.is_nan() || (d.x >= low && d.x <= high);
        data.iter().filter(inside).copied().collect()
    };
    RegimeFits {
        first: constant(&within(f64::NEG_INFINITY, x1)),
        second: line(&within(x1, x2)),
        third: parabola(&within(x2, f64::INFINITY)),
    }
}

/// A curve of three pieces.
#[derive(Clone, Copy)]
struct Curve {
    breakpoints: [f64; 2],
    /// None if the first piece is flat.
    exponent: Option<f64>,
    /// Whether the exponent is one of the fitted numbers.
    fitted: bool,
}

impl Curve {
    /// Columns of a, (b), s and q.
    fn columns(&self, data: &[Datum]) -> Vec<Vec<f64>> {
        let [x1, x2] = self.breakpoints;
        let of = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { data.iter().map(|d| f(d.x)).collect() };
        let mut all = vec![of(&|_| 1.0)];
        if let Some(c) = self.exponent {
            all.push(of(&|x| libm::pow(if x < x1 { x } else { x1 }, c)));
        }
        let upto = |x: f64| if x < x2 { x } else { x2 };
        all.push(of(&|x| if x > x1 { upto(x) - x1 } else { 0.0 }));
        all.push(of(&|x| if x > x2 { x * x - x2 * x2 } else { 0.0 }));
        all
    }

    /// The same with the derivatives by (c), x1 and x2 for the numbers found.
    fn jacobian(&self, data: &[Datum], values: &[f64]) -> Vec<Vec<f64>> {
        let [x1, x2] = self.breakpoints;
        let mut all = self.columns(data);
        let of = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { data.iter().map(|d| f(d.x)).collect() };
        let (slope, bend) = (values[values.len() - 2], values[values.len() - 1]);
        let mut steep = 0.0;
        if let Some(c) = self.exponent {
            let b = values[1];
            steep = b * c * libm::pow(x1, c - 1.0);
            let term = |x: f64| b * libm::pow(x, c) * libm::log(x);
            if self.fitted {
                all.push(of(&|x| term(if x < x1 { x } else { x1 })));
            }
        }
        all.push(of(&|x| if x > x1 { steep - slope } else { 0.0 }));
        all.push(of(&|x| if x > x2 { slope - 2.0 * bend * x2 } else { 0.0 }));
        all
    }

    /// The curve after these steps of (c), x1 and x2, unless they are more than last digits or lead out of
    /// what is searched.
    fn stepped(&self, steps: &[f64], ends: [f64; 2]) -> Option<Curve> {
        let (power, steps) = steps.split_at(usize::from(self.fitted));
        let breakpoints = [
            self.breakpoints[0] + steps[0],
            self.breakpoints[1] + steps[1],
        ];
        let exponent = self.exponent.map(|c| c + power.first().unwrap_or(&0.0));
        let small = breakpoints
            .iter()
            .zip(self.breakpoints)
            .all(|(to, from)| (to / from - 1.0).abs() < 0.01);
        let ordered = ends[0] <= breakpoints[0]
            && breakpoints[0] <= breakpoints[1]
            && breakpoints[1] <= ends[1];
        let searched = |c: f64| !self.fitted || (EXPONENTS[0]..=EXPONENTS[1]).contains(&c);
        let next = Curve {
            breakpoints,
            exponent,
            ..*self
        };
        (small && ordered && exponent.is_none_or(searched)).then_some(next)
    }

    /// The last digits, by Gauss-Newton steps on breakpoints and exponent, and the best numbers there; none if
    /// the points do not distinguish them.
    fn polished(mut self, data: &[Datum], ends: [f64; 2]) -> Option<(Curve, Solution)> {
        let y: Vec<f64> = data.iter().map(|d| d.y).collect();
        let mut at = solve(&self.columns(data), &y, data).ok()?;
        for _ in 0..20 {
            let Ok(step) = solve(&self.jacobian(data, &at.values), &at.residuals, data) else {
                break;
            };
            let Some(next) = self.stepped(&step.values[at.values.len()..], ends) else {
                break;
            };
            match solve(&next.columns(data), &y, data) {
                Ok(found) if found.chi_square <= at.chi_square => (self, at) = (next, found),
                _ => break,
            }
        }
        Some((self, at))
    }
}

/// Refuses breakpoints with too few points on a side.
fn check_regimes(data: &[Datum], [x1, x2]: [f64; 2], first: First) -> Result<(), Refusal> {
    let least = POINTS_OF_A_REGIME;
    let more = least + usize::from(first != First::Flat);
    let regimes = [
        ("first", 0.0, x1, more),
        ("second", x1, x2, least),
        ("third", x2, f64::INFINITY, least),
    ];
    for (name, from, to, least) in regimes {
        let inside: Vec<Datum> = data
            .iter()
            .filter(|d| d.x >= from && d.x <= to)
            .copied()
            .collect();
        let there = distinct(&inside);
        if there < least {
            return Err(Refusal(format!(
                "the {name} of three regimes takes {least} points or more at different x; with the best crossovers, \
                 {x1:.3} and {x2:.3}, there are {there}"
            )));
        }
    }
    Ok(())
}

/// Three regimes that join.
///
/// The exponent of a first regime that is not flat is searched in
/// [`EXPONENTS`] and not judged:
/// [`offset_power`](super::offset_power::offset_power) of the first regime does that. Refused: points that
/// are not numbers; x not above zero; fewer than [`POINTS_MIN`] values of x (one more for each of b and c);
/// best crossovers that leave a regime fewer than [`POINTS_OF_A_REGIME`] values of x (three for a first one
/// that is not flat); regimes that are one.
pub fn regimes(data: &[Datum], first: First) -> Result<Regimes, Refusal> {
    regimes_beside(data, first, 0)
}

/// The same if so many other numbers were fitted to these points, such as scales of the curves that they come from.
fn regimes_beside(data: &[Datum], first: First, beside: usize) -> Result<Regimes, Refusal> {
    check(data)?;
    check_positive(data, "x")?;
    let (fewest, names): (_, &[&str]) = match first {
        First::Flat => (POINTS_MIN, &["a", "s", "q", "x1", "x2"]),
        First::Given(_) => (POINTS_MIN + 1, &["a", "b", "s", "q", "x1", "x2"]),
        First::Power => (POINTS_MIN + 2, &["a", "b", "s", "q", "c", "x1", "x2"]),
    };
    if let First::Given(c) = first
        && !(c > 0.0 && c.is_finite())
    {
        let why =
            format!("the exponent given for the first regime is {c}: one above zero is wanted");
        return Err(Refusal(why));
    }
    let there = distinct(data);
    super::enough(data.len(), names.len() + beside, Exact::Refused)?;
    if there < fewest {
        return Err(Refusal(format!(
            "three regimes take {fewest} points or more at different x; there are {there}"
        )));
    }
    let (search, breakpoints, exponent) = Search::new(data, first, names.len() + beside);
    check_regimes(data, breakpoints.x, first)?;
    let one = || Refusal("two of three regimes are one: the points do not tell them apart".into());
    let curve = Curve {
        breakpoints: breakpoints.x,
        exponent,
        fitted: first == First::Power,
    };
    let (curve, at) = curve.polished(data, search.ends).ok_or_else(one)?;
    check_regimes(data, curve.breakpoints, first)?;
    let linear =
        solve(&curve.jacobian(data, &at.values), &at.residuals, data).map_err(|_| one())?;
    let [x1, x2] = curve.breakpoints;
    let power = curve.exponent.filter(|_| curve.fitted);
    let found = Found {
        model: match first {
            First::Flat => "a + s (clamp(x, x1, x2) - x1) + q max(x^2 - x2^2, 0)",
            _ => "a + b min(x, x1)^c + s (clamp(x, x1, x2) - x1) + q max(x^2 - x2^2, 0)",
        },
        names,
        values: at
            .values
            .iter()
            .copied()
            .chain(power)
            .chain([x1, x2])
            .collect(),
        covariance: linear.covariance,
        residuals: at.residuals,
        chi_square: at.chi_square,
        beside,
    };
    let fit = found.finish(Exact::Refused)?;
    let most = within(fit.degrees_of_freedom) * fit.chi_square;
    let simpler = simpler(data, &search, first, &fit);
    Ok(Regimes {
        first: search.interval(0, x1, most),
        second: search.interval(1, x2, most),
        needed: simpler.iter().all(|s| s.probability < SIGNIFICANCE),
        simpler,
        exponent: curve.exponent,
        fit,
    })
}

/// Rounds of [`scaled_regimes`], and the relative change of chi-square at which they end.
const ROUNDS: usize = 30;
const SETTLED: f64 = 1e-9;

/// Three regimes of curves that differ by a scale each, such as a yield force: scales and regimes are fitted in turn,
/// from the scales given on, until chi-square stands still. Returns the regimes of all points over their scales, and
/// the scales, of which one is free: it is taken up by `a`.
///
/// The intervals of the crossovers hold the scales: they are as narrow as if these were known.
///
/// Refused as [`regimes`], with a degree of freedom less for each curve but one.
pub fn scaled_regimes(
    curves: &[Vec<Datum>],
    first: First,
    mut scales: Vec<f64>,
) -> Result<(Regimes, Vec<f64>), Refusal> {
    let over = |scales: &[f64]| -> Vec<Datum> {
        let own = curves.iter().zip(scales);
        let all = own.flat_map(|(data, scale)| {
            data.iter().map(move |d| Datum {
                y: d.y / scale,
                error: d.error / scale,
                ..*d
            })
        });
        all.collect()
    };
    let beside = curves.len().saturating_sub(1);
    let mut found = regimes_beside(&over(&scales), first, beside)?;
    for _ in 0..ROUNDS {
        let better = |(data, scale): (&Vec<Datum>, &f64)| {
            let (mut both, mut own) = (0.0, 0.0);
            for d in data {
                let (m, weight) = (found.value(d.x), 1.0 / (d.error * d.error));
                both += weight * d.y * m;
                own += weight * m * m;
            }
            if own > 0.0 { both / own } else { *scale }
        };
        let next: Vec<f64> = curves.iter().zip(&scales).map(better).collect();
        let Ok(refined) = regimes_beside(&over(&next), first, beside) else {
            break;
        };
        let change = (found.fit.chi_square - refined.fit.chi_square).abs();
        let settled = change <= SETTLED * found.fit.chi_square;
        (found, scales) = (refined, next);
        if settled {
            break;
        }
    }
    Ok((found, scales))
}

/// Curves with one regime or two beside the fit with three.
fn simpler(data: &[Datum], search: &Search, first: First, fit: &Fit) -> Vec<Simpler> {
    let [from, to] = search.ends;
    let alone = |f: Result<Fit, Refusal>| f.map_or(f64::INFINITY, |f| f.chi_square);
    let over = |of: &dyn Fn(&Table, f64) -> f64| {
        search.over_exponents(|t| least(from, to, |x| of(t, x)).1)
    };
    // What the first regime has beside its constant: b, and c if it is fitted.
    let (name, more) = match first {
        First::Flat => ("a", 0),
        First::Given(_) => ("a + b x^c", 1),
        First::Power => ("a + b x^c", 2),
    };
    let curves = [
        (
            name.to_owned(),
            1 + more,
            search.over_exponents(|t| t.chi_square(to, to)),
        ),
        ("a + b x".into(), 2, alone(line(data))),
        ("a + b x^2".into(), 2, alone(parabola(data))),
        (
            format!("{name}, then a line"),
            3 + more,
            over(&|t, x| t.chi_square(x, to)),
        ),
        (
            format!("{name}, then q x^2 more"),
            3 + more,
            over(&|t, x| t.chi_square(x, x)),
        ),
        (
            "a + b x, then q x^2 more".into(),
            4,
            over(&|t, x| t.chi_square(from, x)),
        ),
    ];
    let all = fit.parameters.len();
    let judged = |(model, numbers, chi_square): (String, usize, f64)| {
        let worse = (chi_square - fit.chi_square) / (all - numbers) as f64;
        let ratio = worse * fit.degrees_of_freedom as f64 / fit.chi_square;
        Simpler {
            model,
            numbers,
            chi_square,
            probability: match worse > 0.0 {
                true => chance::fisher_tail(ratio, all - numbers, fit.degrees_of_freedom),
                false => 1.0,
            },
        }
    };
    curves.into_iter().map(judged).collect()
}

#[cfg(test)]
#[path = "regimes_tests.rs"]
mod tests;
