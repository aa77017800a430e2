//! Chi-square of a curve of three pieces for any places of the two breakpoints, from sums that are made once.
//!
//! The curve is `a + b min(x, x1)^c + s (clamp(x, x1, x2) - x1) + q max(x^2 - x2^2, 0)`. With the sums over
//! points from the first to any other of a few products, the normal equations of a, b, s and q at any
//! breakpoints are a few multiplications, however many points there are: a search can afford hundreds of
//! thousands of breakpoints. The last digits do not come from here: reported numbers are fitted by QR.

use super::Datum;

/// Part of a column's square that must be left when what the columns before it explain is taken out; with
/// less, the column has no effect.
const RANK_LEAST: f64 = 1e-10;

/// Relative accuracy of differences of sums over all points.
const ROUNDING: f64 = 1e-13;

/// Sums over points of weight times: 1, x, x^2, x^4, y, x y, x^2 y, and p, p^2, p y with `p = x^c`.
type Sums = [f64; 10];

/// The sums for one exponent.
pub(crate) struct Table {
    /// The exponent c; none if the first piece is flat.
    exponent: Option<f64>,
    /// In ascending order.
    x: Vec<f64>,
    /// Over the first 0, 1, 2, ... points.
    upto: Vec<Sums>,
    /// Sum of weight times y squared.
    squares: f64,
}

/// Points in ascending order of x, then of y and of error: sums do not depend on how they came.
pub(crate) fn sorted(data: &[Datum]) -> Vec<Datum> {
    let mut all = data.to_vec();
    all.sort_by(|a, b| {
        let by_x = a.x.total_cmp(&b.x);
        by_x.then(a.y.total_cmp(&b.y))
            .then(a.error.total_cmp(&b.error))
    });
    all
}

impl Table {
    /// Sums of points in ascending order.
    pub fn new(sorted: &[Datum], exponent: Option<f64>) -> Table {
        let weight = |d: &Datum| 1.0 / (d.error * d.error);
        // About the mean: less is lost when explained squares are taken from all.
        let total: f64 = sorted.iter().map(weight).sum();
        let mean = sorted.iter().map(|d| weight(d) * d.y).sum::<f64>() / total;
        let mut upto = vec![[0.0; 10]];
        let mut sums = [0.0; 10];
        let mut squares = 0.0;
        for d in sorted {
            let (w, y, xx) = (weight(d), d.y - mean, d.x * d.x);
            let p = exponent.map_or(0.0, |c| libm::pow(d.x, c));
            let terms = [1.0, d.x, xx, xx * xx, y, d.x * y, xx * y, p, p * p, p * y];
            sums.iter_mut().zip(terms).for_each(|(s, t)| *s += w * t);
            squares += w * y * y;
            upto.push(sums);
        }
        Table {
            exponent,
            x: sorted.iter().map(|d| d.x).collect(),
            upto,
            squares,
        }
    }

    /// Least chi-square with the breakpoints at `x1 <= x2`. If a piece has no points its numbers have no effect.
    pub fn chi_square(&self, x1: f64, x2: f64) -> f64 {
        let [one, two] = [x1, x2].map(|at| self.x.partition_point(|x| *x <= at));
        let last = self.x.len();
        let between = |a: usize, b: usize| -> Sums {
            std::array::from_fn(|k| self.upto[b][k] - self.upto[a][k])
        };
        let (low, mid, high) = (self.upto[one], between(one, two), between(two, last));
        let all = self.upto[last];
        let d = x2 - x1;
        let p = self.exponent.map_or(0.0, |c| libm::pow(x1, c));
        // Columns: 1, min(x, x1)^c, clamp - x1, max(x^2 - x2^2, 0), and y.
        let ramp = mid[1] - x1 * mid[0] + d * high[0];
        let bend = high[2] - x2 * x2 * high[0];
        let above = mid[0] + high[0];
        let matrix = [
            [all[0], 0.0, 0.0, 0.0],
            [low[7] + p * above, low[8] + p * p * above, 0.0, 0.0],
            [
                ramp,
                p * ramp,
                mid[2] - 2.0 * x1 * mid[1] + x1 * x1 * mid[0] + d * d * high[0],
                0.0,
            ],
            [
                bend,
                p * bend,
                d * bend,
                high[3] - 2.0 * x2 * x2 * high[2] + x2 * x2 * x2 * x2 * high[0],
            ],
        ];
        let right = [
            all[4],
            low[9] + p * (mid[4] + high[4]),
            mid[5] - x1 * mid[4] + d * high[4],
            high[6] - x2 * x2 * high[4],
        ];
        // Less than this of a column is what rounding leaves of points at a breakpoint.
        let floor = [
            0.0,
            0.0,
            RANK_LEAST * mid[2] + ROUNDING * all[2],
            RANK_LEAST * high[3] + ROUNDING * all[3],
        ];
        let explained = explained(&matrix, &right, &floor);
        let left = self.squares - explained;
        if left > 0.0 { left } else { 0.0 }
    }
}

/// `y^T N^-1 y` by Cholesky's decomposition of the lower half; columns that depend on others, or are no
/// longer than `floor`, are left out.
fn explained(matrix: &[[f64; 4]; 4], right: &[f64; 4], floor: &[f64; 4]) -> f64 {
    let mut lower = [[0.0; 4]; 4];
    let mut part = [0.0; 4];
    let mut sum = 0.0;
    for i in 0..4 {
        let mut left = matrix[i][i];
        let mut value = right[i];
        for j in 0..i {
            let mut entry = matrix[i][j];
            for k in 0..j {
                entry -= lower[i][k] * lower[j][k];
            }
            // The place of a column left out is zero.
            lower[i][j] = if lower[j][j] > 0.0 {
                entry / lower[j][j]
            } else {
                0.0
            };
            left -= lower[i][j] * lower[i][j];
            value -= lower[i][j] * part[j];
        }
        if left > RANK_LEAST * matrix[i][i] && left > floor[i] {
            lower[i][i] = left.sqrt();
            part[i] = value / lower[i][i];
            sum += part[i] * part[i];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::super::linear::solve;
    use super::super::synthetic::{exact, noisy, spread};
    use super::*;

    /// What QR makes of the same columns.
    fn by_qr(data: &[Datum], exponent: Option<f64>, x1: f64, x2: f64) -> f64 {
        let of = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { data.iter().map(|d| f(d.x)).collect() };
        let mut columns = vec![of(&|_| 1.0)];
        if let Some(c) = exponent {
            columns.push(of(&|x| libm::pow(if x < x1 { x } else { x1 }, c)));
        }
        columns.push(of(&|x| {
            if x > x2 {
                x2 - x1
            } else if x > x1 {
                x - x1
            } else {
                0.0
            }
        }));
        columns.push(of(&|x| if x > x2 { x * x - x2 * x2 } else { 0.0 }));
        columns.retain(|c| c.iter().any(|v| *v > 1e-9));
        let y: Vec<f64> = data.iter().map(|d| d.y).collect();
        solve(&columns, &y, data).ok().unwrap().chi_square
    }

    #[test]
    fn sums_give_the_chi_square_of_qr() {
        let points = exact(&spread(0.1, 10.0, 60), |x| 400.0 + 200.0 * x, |y| 0.05 * y);
        let mut data = noisy(&points, 1.0, 4);
        data.reverse();
        for exponent in [None, Some(0.3), Some(2.5)] {
            let table = Table::new(&sorted(&data), exponent);
            for (x1, x2) in [
                (1.0, 5.0),
                (0.3, 0.9),
                (2.0, 2.0),
                (0.5, 10.0),
                (data[20].x, data[9].x),
            ] {
                let (fast, slow) = (table.chi_square(x1, x2), by_qr(&data, exponent, x1, x2));
                assert!(
                    (fast / slow - 1.0).abs() < 1e-9,
                    "{exponent:?} {x1} {x2}: {fast} {slow}"
                );
            }
        }
        // A first piece without points is none: a line, then a line and a parabola.
        let flat = Table::new(&sorted(&data), None);
        let bent = Table::new(&sorted(&data), Some(0.5));
        let line = super::super::linear::line(&data).unwrap().chi_square;
        for table in [&flat, &bent] {
            assert!((table.chi_square(0.1, 10.0) / line - 1.0).abs() < 1e-9);
        }
    }
}
