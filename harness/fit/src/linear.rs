//! Weighted least squares of curves that are linear in their numbers, by Householder's QR.
//!
//! Rows are divided by their errors and columns by their lengths, then turned into a triangle by
//! reflections (Golub and Van Loan, Matrix Computations, section 5.3): the normal equations, which lose
//! twice the digits, are never formed.

use super::{Datum, Exact, Fit, Found, Refusal, check, chi_square, enough};

/// Most numbers that a fit has.
pub const NUMBERS_MAX: usize = 6;

/// Part of a column's length that must be left when what the columns before it explain is taken out.
pub(crate) const RANK_LEAST: f64 = 1e-10;

/// What a number is multiplied by in the model.
#[derive(Clone, Debug, PartialEq)]
pub struct Column<'a> {
    /// The number's name.
    pub name: &'a str,
    /// One value for each point.
    pub values: Vec<f64>,
}

/// Numbers that fit best, with the inverse that their errors come from.
pub(crate) struct Solution {
    pub values: Vec<f64>,
    /// From the points' errors alone.
    pub covariance: Vec<Vec<f64>>,
    pub residuals: Vec<f64>,
    pub chi_square: f64,
}

/// Best numbers of columns for `y`, at least as many points as columns; `Err(k)` if column `k` depends
/// on those before it.
pub(crate) fn solve(columns: &[Vec<f64>], y: &[f64], data: &[Datum]) -> Result<Solution, usize> {
    let (rows, n) = (data.len(), columns.len());
    let weigh = |values: &[f64]| -> Vec<f64> {
        values.iter().zip(data).map(|(v, d)| v / d.error).collect()
    };
    let length = |v: &[f64]| v.iter().map(|a| a * a).sum::<f64>().sqrt();
    let mut matrix: Vec<Vec<f64>> = columns.iter().map(|c| weigh(c)).collect();
    let mut right = weigh(y);
    let mut lengths = vec![0.0; n];
    for (column, of) in matrix.iter_mut().zip(&mut lengths) {
        *of = length(column);
        // A column of zeros stays one and is found below.
        if *of > 0.0 {
            column.iter_mut().for_each(|a| *a /= *of);
        }
    }
    for j in 0..n {
        let left = if j < rows {
            length(&matrix[j][j..])
        } else {
            0.0
        };
        // Also if it is not a number.
        if left.is_nan() || left < RANK_LEAST {
            return Err(j);
        }
        let (done, later) = matrix.split_at_mut(j + 1);
        let mirror = &mut done[j][j..];
        let diagonal = if mirror[0] > 0.0 { -left } else { left };
        mirror[0] -= diagonal;
        let square: f64 = mirror.iter().map(|a| a * a).sum();
        for column in later.iter_mut().chain([&mut right]) {
            let part: f64 = mirror.iter().zip(&column[j..]).map(|(a, b)| a * b).sum();
            let twice = 2.0 * part / square;
            column[j..]
                .iter_mut()
                .zip(mirror.iter())
                .for_each(|(b, a)| *b -= twice * a);
        }
        mirror[0] = diagonal;
    }
    // R^-1, row i from below; matrix[j][i] is R_ij for i <= j.
    let mut inverse = vec![vec![0.0; n]; n];
    for j in 0..n {
        inverse[j][j] = 1.0 / matrix[j][j];
        for i in (0..j).rev() {
            let sum: f64 = (i + 1..=j).map(|k| matrix[k][i] * inverse[k][j]).sum();
            inverse[i][j] = -sum / matrix[i][i];
        }
    }
    let mut values = vec![0.0; n];
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| matrix[k][i] * values[k]).sum();
        values[i] = (right[i] - sum) / matrix[i][i];
    }
    let row = |i: usize, j: usize| {
        inverse[i]
            .iter()
            .zip(&inverse[j])
            .map(|(a, b)| a * b)
            .sum::<f64>()
    };
    let entry = |i: usize, j: usize| row(i, j) / lengths[i] / lengths[j];
    values.iter_mut().zip(&lengths).for_each(|(v, l)| *v /= l);
    let model = |k: usize| {
        columns
            .iter()
            .zip(&values)
            .map(|(c, v)| c[k] * v)
            .sum::<f64>()
    };
    let residuals: Vec<f64> = (0..rows).map(|k| y[k] - model(k)).collect();
    Ok(Solution {
        covariance: (0..n)
            .map(|i| (0..n).map(|j| entry(i, j)).collect())
            .collect(),
        chi_square: chi_square(&residuals, data),
        values,
        residuals,
    })
}

/// Best numbers of any columns, at most [`NUMBERS_MAX`]: `y = sum of number times column`.
///
/// Refused: points that are not numbers; fewer points than numbers, or as many if that is not permitted;
/// columns that are not one value for each point; columns that no point distinguishes from each other.
pub fn columns(
    data: &[Datum],
    model: &str,
    columns: &[Column],
    exact: Exact,
) -> Result<Fit, Refusal> {
    check(data)?;
    if columns.is_empty() || columns.len() > NUMBERS_MAX {
        let why = format!(
            "a fit has 1 to {NUMBERS_MAX} numbers, not {}",
            columns.len()
        );
        return Err(Refusal(why));
    }
    for column in columns {
        if column.values.len() != data.len() || !column.values.iter().all(|v| v.is_finite()) {
            let why = format!(
                "the column of {} is not one finite value for each of {} points",
                column.name,
                data.len()
            );
            return Err(Refusal(why));
        }
    }
    enough(data.len(), columns.len(), exact)?;
    let values: Vec<Vec<f64>> = columns.iter().map(|c| c.values.clone()).collect();
    let y: Vec<f64> = data.iter().map(|d| d.y).collect();
    let names: Vec<&str> = columns.iter().map(|c| c.name).collect();
    let found = solve(&values, &y, data).map_err(|k| {
        let why = match k {
            0 => "its column is zero at every point".to_owned(),
            _ => format!("the points do not tell it from {}", names[..k].join(", ")),
        };
        Refusal(format!("{} of {model} is not determined: {why}", names[k]))
    })?;
    let found = Found {
        model,
        names: &names,
        values: found.values,
        covariance: found.covariance,
        residuals: found.residuals,
        chi_square: found.chi_square,
        beside: 0,
    };
    found.finish(exact)
}

/// `a + b x`, from three points or more at two x or more.
pub fn line(data: &[Datum]) -> Result<Fit, Refusal> {
    let ones = Column {
        name: "a",
        values: vec![1.0; data.len()],
    };
    let slope = Column {
        name: "b",
        values: data.iter().map(|d| d.x).collect(),
    };
    columns(data, "a + b x", &[ones, slope], Exact::Refused)
}

/// `a`: the weighted mean of two points or more.
pub fn constant(data: &[Datum]) -> Result<Fit, Refusal> {
    let ones = Column {
        name: "a",
        values: vec![1.0; data.len()],
    };
    columns(data, "a", &[ones], Exact::Refused)
}

/// `a + b x^2`, from three points or more at two x or more.
pub fn parabola(data: &[Datum]) -> Result<Fit, Refusal> {
    let ones = Column {
        name: "a",
        values: vec![1.0; data.len()],
    };
    let square = Column {
        name: "b",
        values: data.iter().map(|d| d.x * d.x).collect(),
    };
    columns(data, "a + b x^2", &[ones, square], Exact::Refused)
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{assert_spread, exact, noisy, normal, spread, unscaled};
    use super::*;

    fn data() -> Vec<Datum> {
        exact(
            &spread(0.2, 8.0, 12),
            |x| 3.0 - 0.7 * x,
            |y| 0.05 * y.abs() + 0.1,
        )
    }

    #[test]
    fn exact_points_give_back_their_line() {
        let fit = line(&data()).unwrap();
        assert!((fit.parameters[0].value - 3.0).abs() < 1e-12, "{fit:?}");
        assert!((fit.parameters[1].value + 0.7).abs() < 1e-12);
        assert!(fit.chi_square < 1e-20 && fit.probability > 0.999 && fit.scale == 1.0);
        let curve = exact(&spread(0.2, 8.0, 9), |x| 2.0 + 5.0 * x * x, |_| 0.3);
        let fit = parabola(&curve).unwrap();
        assert!((fit.parameters[1].value - 5.0).abs() < 1e-12, "{fit:?}");
    }

    /// The textbook's sums for a line with weights, and the mean's.
    #[test]
    fn errors_are_those_of_the_closed_forms() {
        let data = noisy(&data(), 1.0, 1);
        let sum = |of: &dyn Fn(&Datum) -> f64| {
            data.iter()
                .map(|d| of(d) / (d.error * d.error))
                .sum::<f64>()
        };
        let (s, sx, sxx) = (sum(&|_| 1.0), sum(&|d| d.x), sum(&|d| d.x * d.x));
        let (sy, sxy) = (sum(&|d| d.y), sum(&|d| d.x * d.y));
        let det = s * sxx - sx * sx;
        let fit = line(&data).unwrap();
        let factor = fit.scale * fit.scale;
        let want = [(sxx * sy - sx * sxy) / det, (s * sxy - sx * sy) / det];
        let spread = [[sxx / det, -sx / det], [-sx / det, s / det]];
        for i in 0..2 {
            assert!((fit.parameters[i].value - want[i]).abs() < 1e-10);
            for j in 0..2 {
                assert!((fit.covariance[i][j] / factor / spread[i][j] - 1.0).abs() < 1e-10);
            }
        }
        let mean = constant(&data).unwrap();
        assert!((mean.parameters[0].value - sy / s).abs() < 1e-12);
        assert!((mean.parameters[0].error / mean.scale - (1.0 / s).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn numbers_scatter_as_their_errors_say() {
        assert_spread(200, |seed| {
            unscaled(&line(&noisy(&data(), 1.0, seed)).unwrap())
        });
        // Points that scatter three times as far as their errors say: scaled errors are right.
        let many = exact(
            &spread(0.2, 8.0, 100),
            |x| 3.0 - 0.7 * x,
            |y| 0.05 * y.abs() + 0.1,
        );
        assert_spread(200, |seed| {
            let fit = line(&noisy(&many, 3.0, seed)).unwrap();
            assert!(
                fit.probability < 1e-6 && (2.3..3.7).contains(&fit.scale),
                "{}",
                fit.scale
            );
            (
                fit.parameters.iter().map(|p| p.value).collect(),
                fit.covariance,
            )
        });
    }

    /// Chances of right models are uniform: a tenth below 0.1, half below a half, of 400 sets.
    #[test]
    fn chances_are_chances() {
        let chances = (0..400).map(|seed| line(&noisy(&data(), 1.0, seed)).unwrap().probability);
        let chances: Vec<f64> = chances.collect();
        let below = |p: f64| chances.iter().filter(|c| **c < p).count();
        assert!(
            (24..57).contains(&below(0.1)) && (170..231).contains(&below(0.5)),
            "{}",
            below(0.1)
        );
    }

    #[test]
    fn six_numbers_of_crooked_columns_are_found() {
        let data = exact(&spread(0.1, 10.0, 40), |x| x, |_| 0.5);
        let powers = |k: i32| {
            data.iter()
                .map(|d| libm::pow(d.x, 0.4 * f64::from(k)))
                .collect()
        };
        let names = ["a", "b", "c", "d", "e", "f"];
        let crooked: Vec<Column> = (0..6)
            .map(|k| Column {
                name: names[k as usize],
                values: powers(k),
            })
            .collect();
        let truth = [3.0, -1.0, 2.0, 0.5, -0.25, 0.125];
        let y = |k: usize| {
            crooked
                .iter()
                .zip(truth)
                .map(|(c, t)| c.values[k] * t)
                .sum::<f64>()
        };
        let data: Vec<Datum> = data
            .iter()
            .enumerate()
            .map(|(k, d)| Datum { y: y(k), ..*d })
            .collect();
        let fit = columns(&data, "six", &crooked, Exact::Refused).unwrap();
        for (p, t) in fit.parameters.iter().zip(truth) {
            assert!((p.value - t).abs() < 1e-10, "{p:?} {t}");
        }
        // Residuals of a best fit are at right angles to every column.
        let off: Vec<Datum> = data
            .iter()
            .enumerate()
            .map(|(k, d)| Datum {
                y: d.y + normal(9, k),
                ..*d
            })
            .collect();
        let fit = columns(&off, "six", &crooked, Exact::Refused).unwrap();
        for column in &crooked {
            let dot: f64 = column
                .values
                .iter()
                .zip(&fit.residuals)
                .map(|(c, r)| c * r)
                .sum();
            let size: f64 = column.values.iter().map(|c| c.abs()).sum();
            assert!(dot.abs() < 1e-11 * size, "{dot} {size}");
        }
    }

    #[test]
    fn what_points_cannot_carry_is_refused() {
        let told = |r: Result<Fit, Refusal>| r.unwrap_err().to_string();
        let two = &data()[..2];
        assert_eq!(
            told(line(two)),
            "a fit of 2 numbers takes 3 points or more; there are 2"
        );
        assert_eq!(
            told(constant(&two[..1])),
            "a fit of 1 number takes 2 points or more; there are 1"
        );
        let same = [two[0]; 4];
        assert_eq!(
            told(line(&same)),
            "b of a + b x is not determined: the points do not tell it from a"
        );
        let column = |name, value: f64, n: usize| Column {
            name,
            values: vec![value; n],
        };
        let of = |c: &[Column], e| columns(two, "m", c, e);
        assert_eq!(
            told(of(&[], Exact::Refused)),
            "a fit has 1 to 6 numbers, not 0"
        );
        let short = "the column of a is not one finite value for each of 2 points";
        assert_eq!(told(of(&[column("a", 1.0, 1)], Exact::Refused)), short);
        assert_eq!(told(of(&[column("a", f64::NAN, 2)], Exact::Refused)), short);
        let zero = "a of m is not determined: its column is zero at every point";
        assert_eq!(told(of(&[column("a", 0.0, 2)], Exact::Refused)), zero);
        assert!(
            told(line(
                &[Datum {
                    error: -1.0,
                    ..two[0]
                }; 3]
            ))
            .contains("above zero")
        );
        let huge = [1e200, 2e200, 3e200].map(|y| Datum {
            x: y,
            y,
            error: 1e-200,
        });
        assert!(told(line(&huge)).len() > 20);
        // Two points make a line if that is permitted: errors are the points' own.
        let slope = Column {
            name: "b",
            values: vec![two[0].x, two[1].x],
        };
        let fit = of(&[column("a", 1.0, 2), slope], Exact::Permitted).unwrap();
        assert_eq!(
            (fit.degrees_of_freedom, fit.probability, fit.scale),
            (0, 1.0, 1.0)
        );
        assert!(fit.reduced_chi_square == 0.0 && fit.parameters[0].error > 0.0);
        assert!(
            of(
                &[
                    column("a", 1.0, 2),
                    column("b", 1.0, 2),
                    column("c", 1.0, 2)
                ],
                Exact::Permitted
            )
            .is_err()
        );
    }
}
