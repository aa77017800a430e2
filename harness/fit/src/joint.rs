//! Curves of one shape, each over a scale of its own: `y = Y_k (1 + A g(x, q))`, fitted together.
//!
//! A drag over its yield force is such a curve, and no point says what that force is: dividing each drag by a force
//! that was found before treats one error of the force as many independent ones, and a law of what exceeds the force
//! loses the points that lie below it by chance. Here every scale `Y_k` is fitted with the shape, and every point
//! counts. For each A and q the scales are linear least squares; the best A and q come from a grid and then
//! Gauss-Newton steps over all numbers at once.

use super::linear::{RANK_LEAST, solve};
use super::{Datum, Exact, Fit, Found, Refusal, check, check_exponent, distinct};

/// A shape with one number `q`: it is 0 up to some x, and from there on `g(x, q)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// `max(x - from, 0)^q`: q is called `p`.
    Power {
        /// Where the curve leaves its scale.
        from: f64,
    },
    /// A line from `from` on and beyond `at` a parabola `a + b x^2`, joined there (Kumar 2018, eq. 9, with assumption
    /// (ii) of section IV). q is called `r`: the mean slope from `at` to twice that, over the line's. It is 1.5 if they
    /// are joined at equal slopes; about 1 is the best for a line that goes straight on. `from` is below `at`, and `at`
    /// above zero.
    Parabola {
        /// Where the curve leaves its scale.
        from: f64,
        /// Where the line ends.
        at: f64,
    },
}

/// Curves fitted together.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// A and q.
    pub fit: Fit,
    /// The scale of each curve, with its error.
    pub scales: Vec<(f64, f64)>,
}

/// Values of A that are tried first, in equal ratios; and of q.
const GRID: usize = 24;
const STRENGTHS: [f64; 2] = [1e-3, 1e2];
const POWERS: [f64; 2] = [0.2, 4.0];
/// The parabola may turn a curve down as well as up.
const SLOPES: [f64; 2] = [-2.0, 6.0];
/// Most Gauss-Newton steps, and how often a step is halved that makes the fit worse.
const STEPS: usize = 60;
const HALVINGS: usize = 12;
/// Relative change of chi-square at which the steps end.
const SETTLED: f64 = 1e-14;

impl Shape {
    fn names(self) -> [&'static str; 2] {
        match self {
            Shape::Power { .. } => ["A", "p"],
            Shape::Parabola { .. } => ["A", "r"],
        }
    }

    fn model(self) -> String {
        match self {
            Shape::Power { from } => format!("Y (1 + A max(x - {from}, 0)^p)"),
            Shape::Parabola { from, at } => {
                format!(
                    "Y (1 + A (max(min(x, {at}) - {from}, 0) + r max(x^2 - {at}^2, 0) / (3 {at})))"
                )
            }
        }
    }

    /// The shape and its derivative by q.
    fn at(self, x: f64, q: f64) -> [f64; 2] {
        let beyond = |from: f64| if x > from { x - from } else { 0.0 };
        match self {
            Shape::Power { from } => match beyond(from) {
                0.0 => [0.0; 2],
                off => {
                    let power = libm::pow(off, q);
                    [power, power * libm::log(off)]
                }
            },
            Shape::Parabola { from, at } => {
                let square = beyond(at) * (x + at) / (3.0 * at);
                [beyond(from).min(at - from) + q * square, square]
            }
        }
    }

    fn trials(self) -> Vec<f64> {
        let [low, high] = match self {
            Shape::Power { .. } => POWERS,
            Shape::Parabola { .. } => SLOPES,
        };
        let part = |k: usize| k as f64 / (GRID as f64 - 1.0);
        (0..GRID).map(|k| low + (high - low) * part(k)).collect()
    }

    /// The least x beyond which q shows.
    fn onset(self) -> f64 {
        match self {
            Shape::Power { from } => from,
            Shape::Parabola { at, .. } => at,
        }
    }
}

/// The points of all curves in one list, and the curve of each.
struct Points {
    data: Vec<Datum>,
    curve: Vec<usize>,
    curves: usize,
}

/// What linear least squares about some numbers give.
struct About {
    /// To the best scales, A and q.
    steps: Vec<f64>,
    /// Of the scales, from the points' errors alone.
    variances: Vec<f64>,
    /// Of A and q.
    covariance: Vec<Vec<f64>>,
    /// What is left of the points before the steps.
    residuals: Vec<f64>,
}

impl Points {
    /// Of each point the derivatives by its scale, by A and by q, and what is left of it.
    fn linear(&self, shape: Shape, numbers: &[f64]) -> [Vec<f64>; 4] {
        let [strength, q] = [numbers[self.curves], numbers[self.curves + 1]];
        let mut columns = [(); 4].map(|()| Vec::with_capacity(self.data.len()));
        for (d, &curve) in self.data.iter().zip(&self.curve) {
            let [g, by_q] = shape.at(d.x, q);
            let (scale, part) = (numbers[curve], 1.0 + strength * g);
            let own = [part, scale * g, scale * strength * by_q, d.y - scale * part];
            columns
                .iter_mut()
                .zip(own)
                .for_each(|(column, x)| column.push(x));
        }
        columns
    }

    fn chi_square(&self, shape: Shape, numbers: &[f64]) -> f64 {
        super::chi_square(&self.linear(shape, numbers)[3], &self.data)
    }

    /// The linear least squares of all numbers about these. A scale shows in the points of its own curve alone, so what
    /// it explains is taken out of those first: two columns are left. `None` if the points do not tell numbers apart.
    fn about(&self, shape: Shape, numbers: &[f64]) -> Option<About> {
        let [by_scale, mut columns @ ..] = self.linear(shape, numbers);
        let residuals = columns[2].clone();
        let mut explained = vec![[0.0; 3]; self.curves];
        let mut squares = vec![0.0; self.curves];
        for (k, (d, &curve)) in self.data.iter().zip(&self.curve).enumerate() {
            let weight = by_scale[k] / (d.error * d.error);
            squares[curve] += weight * by_scale[k];
            for (sum, column) in explained[curve].iter_mut().zip(&columns) {
                *sum += weight * column[k];
            }
        }
        for (own, square) in explained.iter_mut().zip(&squares) {
            own.iter_mut().for_each(|sum| *sum /= square);
        }
        let length = |column: &[f64]| super::chi_square(column, &self.data).sqrt();
        for (n, column) in columns.iter_mut().enumerate() {
            let whole = length(column);
            let own = self.curve.iter().zip(&by_scale);
            for (x, (&curve, by_scale)) in column.iter_mut().zip(own) {
                *x -= explained[curve][n] * by_scale;
            }
            // What is left of a number that the scales explain is rounding.
            if n < 2 && length(column) <= RANK_LEAST * whole {
                return None;
            }
        }
        let [by_strength, by_q, left] = columns;
        let shared = solve(&[by_strength, by_q], &left, &self.data).ok()?;
        let [a, q] = [shared.values[0], shared.values[1]];
        let steps = explained
            .iter()
            .map(|[by_a, by_q, own]| own - by_a * a - by_q * q);
        let covariance = &shared.covariance;
        let variance = |(own, square): (&[f64; 3], &f64)| {
            let of = |i: usize, j: usize| own[i] * covariance[i][j] * own[j];
            1.0 / square + of(0, 0) + 2.0 * of(0, 1) + of(1, 1)
        };
        Some(About {
            steps: steps.chain([a, q]).collect(),
            variances: explained.iter().zip(&squares).map(variance).collect(),
            covariance: shared.covariance,
            residuals,
        })
    }

    /// The best scales for A and q.
    fn scaled(&self, shape: Shape, strength: f64, q: f64) -> Vec<f64> {
        let mut sums = vec![[0.0; 2]; self.curves];
        for (d, &curve) in self.data.iter().zip(&self.curve) {
            let m = 1.0 + strength * shape.at(d.x, q)[0];
            let weight = m / (d.error * d.error);
            sums[curve][0] += weight * d.y;
            sums[curve][1] += weight * m;
        }
        let scales = sums.iter().map(|[y, m]| y / m);
        scales.chain([strength, q]).collect()
    }

    /// The best of a grid of A and q.
    fn start(&self, shape: Shape) -> Vec<f64> {
        let ratio = libm::log(STRENGTHS[1] / STRENGTHS[0]) / (GRID as f64 - 1.0);
        let (mut best, mut least) = (Vec::new(), f64::INFINITY);
        for q in shape.trials() {
            for k in 0..GRID {
                let strength = STRENGTHS[0] * libm::exp(ratio * k as f64);
                let numbers = self.scaled(shape, strength, q);
                let left = self.chi_square(shape, &numbers);
                if left < least {
                    (best, least) = (numbers, left);
                }
            }
        }
        best
    }

    /// Gauss-Newton steps from there, each halved until it makes nothing worse.
    fn polished(&self, shape: Shape, mut numbers: Vec<f64>) -> (Vec<f64>, f64) {
        let mut least = self.chi_square(shape, &numbers);
        for _ in 0..STEPS {
            let Some(About { steps, .. }) = self.about(shape, &numbers) else {
                break;
            };
            let mut part = 1.0;
            let better = (0..HALVINGS).find_map(|_| {
                let to: Vec<f64> = numbers
                    .iter()
                    .zip(&steps)
                    .map(|(n, step)| n + part * step)
                    .collect();
                let left = self.chi_square(shape, &to);
                part /= 2.0;
                (left <= least).then_some((to, left))
            });
            let Some((to, left)) = better else {
                break;
            };
            let settled = least - left <= SETTLED * least;
            (numbers, least) = (to, left);
            if settled {
                break;
            }
        }
        (numbers, least)
    }
}

/// Fits curves of one shape together; curves of a single point say nothing of it and are left out.
///
/// Refused: points that are not numbers; fewer than two values of x beyond the place from which q shows (three for a
/// power); no more points than numbers; an exponent known worse than
/// [`EXPONENT_ERROR_MAX`](super::EXPONENT_ERROR_MAX); points that do not tell the numbers apart.
pub fn joint(curves: &[Vec<Datum>], shape: Shape) -> Result<Joint, Refusal> {
    let mut points = Points {
        data: Vec::new(),
        curve: Vec::new(),
        curves: 0,
    };
    for own in curves.iter().filter(|own| own.len() > 1) {
        points.data.extend_from_slice(own);
        points.curve.extend(own.iter().map(|_| points.curves));
        points.curves += 1;
    }
    check(&points.data)?;
    let least = match shape {
        Shape::Power { .. } => 3,
        Shape::Parabola { .. } => 2,
    };
    let enough = |above: f64, up_to: f64, place: String| {
        let within = |d: &&Datum| d.x > above && d.x <= up_to;
        let own: Vec<Datum> = points.data.iter().filter(within).copied().collect();
        match distinct(&own) {
            there if there < least => Err(Refusal(format!(
                "a joint fit takes {least} values of x or more {place}; there are {there}"
            ))),
            _ => Ok(()),
        }
    };
    let onset = shape.onset();
    enough(onset, f64::INFINITY, format!("beyond {onset}"))?;
    if let Shape::Parabola { from, at } = shape {
        // Without points on the line its slope would be what the points beyond it leave over.
        enough(from, at, format!("from {from} to {at}"))?;
    }
    super::enough(points.data.len(), points.curves + 2, Exact::Refused)?;
    let (numbers, chi_square) = points.polished(shape, points.start(shape));
    let apart = || Refusal("the points do not tell the strength of the shape from its form".into());
    let about = points.about(shape, &numbers).ok_or_else(apart)?;
    let (scales, own) = numbers.split_at(points.curves);
    let model = shape.model();
    let found = Found {
        model: &model,
        names: &shape.names(),
        values: own.to_vec(),
        covariance: about.covariance,
        residuals: about.residuals,
        chi_square,
        beside: points.curves,
    };
    let fit = found.finish(Exact::Refused)?;
    let error = |variance: &f64| fit.scale * variance.sqrt();
    let scales = scales.iter().zip(&about.variances);
    let scales = scales.map(|(scale, v)| (*scale, error(v))).collect();
    if let Shape::Power { .. } = shape {
        check_exponent(fit.parameters[1].error)?;
    }
    Ok(Joint { fit, scales })
}

#[cfg(test)]
mod tests;
