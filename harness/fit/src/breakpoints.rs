//! Where the breakpoints of a curve of three pieces lie best, and where else they may lie.

use super::offset_power::{EXPONENTS, exponents as ratios};
use serde::{Deserialize, Serialize};

use super::segments::{Table, sorted};
use super::{Datum, chance};

/// The part of crossovers' intervals that hold the truth.
pub const CONFIDENCE: f64 = 0.95;

/// The first regime.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum First {
    /// `a`, as with friction.
    Flat,
    /// `a + b x^c`, as without.
    Power,
    /// The same with an exponent that is known from elsewhere, above zero, and not fitted.
    Given(f64),
}

/// Where one regime passes into the next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crossover {
    /// The best place.
    pub at: f64,
    /// Least place of the interval of [`CONFIDENCE`]; none if it reaches the least x of the points.
    pub low: Option<f64>,
    /// Largest place; none if it reaches the largest x of the points.
    pub high: Option<f64>,
}

/// Places of a breakpoint on the first grid, in equal ratios.
const GRID: usize = 64;

/// How often the grid's spacing is then halved for the best breakpoints.
const HALVINGS: usize = 30;

/// And for intervals.
const HALVINGS_OF_INTERVALS: usize = 14;

/// Exponents at a time, and how often the range that fits is narrowed down to.
const EXPONENT_GRID: usize = 16;
const ROUNDS: usize = 3;

/// What an interval's chi-square may be over the least.
pub(crate) fn within(degrees: usize) -> f64 {
    1.0 + chance::fisher_quantile(CONFIDENCE, 1, degrees) / degrees as f64
}

/// Where `of` is least on a range: on a grid in equal ratios, then about the best with half the spacing each
/// time.
pub(crate) fn least(from: f64, to: f64, of: impl Fn(f64) -> f64) -> (f64, f64) {
    let mut best = (from, of(from));
    let mut step = libm::log(to / from) / (GRID as f64 - 1.0);
    let look = |at: f64, best: &mut (f64, f64)| {
        let value = of(at);
        if value < best.1 {
            *best = (at, value);
        }
    };
    ratios(from, to, GRID).for_each(|at| look(at, &mut best));
    for _ in 0..HALVINGS_OF_INTERVALS {
        step /= 2.0;
        let middle = best.0;
        for k in [-1.0, 1.0] {
            let at = middle * libm::exp(k * step);
            if at > from && at < to {
                look(at, &mut best);
            }
        }
    }
    best
}

/// The best place of the other breakpoint, and the chi-square, if one is held.
fn other(table: &Table, [from, to]: [f64; 2], breakpoint: usize, at: f64) -> (f64, f64) {
    match breakpoint {
        0 => least(at, to, |x2| table.chi_square(at, x2)),
        _ => least(from, at, |x1| table.chi_square(x1, at)),
    }
}

/// Breakpoints and their chi-square.
#[derive(Clone, Copy)]
pub(crate) struct Breakpoints {
    pub x: [f64; 2],
    pub chi_square: f64,
}

/// Points and the ends of what is searched.
pub(crate) struct Search {
    sorted: Vec<Datum>,
    pub ends: [f64; 2],
    /// One for each exponent that may fit; one alone if the first regime is flat.
    tables: Vec<Table>,
}

impl Search {
    /// The best place of one breakpoint on the grid with the other's best.
    fn coarse(&self, table: &Table, breakpoint: usize) -> Breakpoints {
        let [from, to] = self.ends;
        let mut best = Breakpoints {
            x: self.ends,
            chi_square: f64::INFINITY,
        };
        for at in ratios(from, to, GRID) {
            let (other, chi_square) = other(table, self.ends, breakpoint, at);
            if chi_square < best.chi_square {
                let x = if breakpoint == 0 {
                    [at, other]
                } else {
                    [other, at]
                };
                best = Breakpoints { x, chi_square };
            }
        }
        best
    }

    /// The best breakpoints for a table: that from the best first breakpoint or from the best second one.
    fn best(&self, table: &Table) -> Breakpoints {
        let [one, two] =
            [0, 1].map(|breakpoint| self.refined(table, self.coarse(table, breakpoint)));
        if two.chi_square < one.chi_square {
            two
        } else {
            one
        }
    }

    /// The best breakpoints about these, with half the grid's spacing each time.
    fn refined(&self, table: &Table, start: Breakpoints) -> Breakpoints {
        let mut best = start;
        best.chi_square = table.chi_square(best.x[0], best.x[1]);
        let mut step = libm::log(self.ends[1] / self.ends[0]) / (GRID as f64 - 1.0);
        for _ in 0..HALVINGS {
            step /= 2.0;
            let middle = best.x;
            for i in -3..=3 {
                for j in -3..=3 {
                    let x = [(middle[0], i), (middle[1], j)];
                    let x = x.map(|(at, k)| at * libm::exp(f64::from(k) * step));
                    if self.ends[0] <= x[0] && x[0] <= x[1] && x[1] <= self.ends[1] {
                        let chi_square = table.chi_square(x[0], x[1]);
                        if chi_square < best.chi_square {
                            best = Breakpoints { x, chi_square };
                        }
                    }
                }
            }
        }
        best
    }

    /// The best breakpoints, the best exponent, and tables for those exponents that fit.
    pub fn new(data: &[Datum], first: First, numbers: usize) -> (Search, Breakpoints, Option<f64>) {
        let sorted = sorted(data);
        let ends = [sorted[0].x, sorted[sorted.len() - 1].x];
        let mut search = Search {
            sorted,
            ends,
            tables: Vec::new(),
        };
        let known = match first {
            First::Flat => Some(None),
            First::Given(c) => Some(Some(c)),
            First::Power => None,
        };
        if let Some(exponent) = known {
            let table = Table::new(&search.sorted, exponent);
            let best = search.best(&table);
            search.tables.push(table);
            return (search, best, exponent);
        }
        let factor = within(data.len() - numbers);
        let (mut range, mut best) = (EXPONENTS, (search.coarse_of(EXPONENTS[0]), EXPONENTS[0]));
        for _ in 0..ROUNDS {
            let grid: Vec<f64> = ratios(range[0], range[1], EXPONENT_GRID).collect();
            let found: Vec<Breakpoints> = grid.iter().map(|&c| search.coarse_of(c)).collect();
            for (breakpoints, &c) in found.iter().zip(&grid) {
                if breakpoints.chi_square < best.0.chi_square {
                    best = (*breakpoints, c);
                }
            }
            let most = factor * best.0.chi_square;
            let fits = found
                .iter()
                .zip(&grid)
                .filter(|(j, _)| j.chi_square <= most);
            let fits: Vec<f64> = fits.map(|(_, c)| *c).chain([best.1]).collect();
            let ratio = grid[1] / grid[0];
            let low = fits
                .iter()
                .fold(f64::INFINITY, |a, c| if *c < a { *c } else { a })
                / ratio;
            let high = fits.iter().fold(0.0, |a, c| if *c > a { *c } else { a }) * ratio;
            range = [
                if low > range[0] { low } else { range[0] },
                if high < range[1] { high } else { range[1] },
            ];
        }
        let (breakpoints, exponent) = search.best_exponent(range);
        let grid = ratios(range[0], range[1], EXPONENT_GRID);
        // The best first: it settles most questions.
        search.tables = std::iter::once(exponent)
            .chain(grid)
            .map(|c| Table::new(&search.sorted, Some(c)))
            .collect();
        (search, breakpoints, Some(exponent))
    }

    /// The best breakpoints of the grid for one exponent.
    fn coarse_of(&self, exponent: f64) -> Breakpoints {
        self.coarse(&Table::new(&self.sorted, Some(exponent)), 0)
    }

    /// The best exponent of a range, and its breakpoints.
    fn best_exponent(&self, range: [f64; 2]) -> (Breakpoints, f64) {
        let table = |c: f64| Table::new(&self.sorted, Some(c));
        let grid: Vec<f64> = ratios(range[0], range[1], EXPONENT_GRID).collect();
        let found = |c: f64| (self.best(&table(c)), c);
        let mut best = found(grid[0]);
        for next in grid[1..].iter().map(|&c| found(c)) {
            if next.0.chi_square < best.0.chi_square {
                best = next;
            }
        }
        let mut step = libm::log(grid[1] / grid[0]);
        for _ in 0..HALVINGS {
            step /= 2.0;
            let middle = best.1;
            for k in [-1.0, 1.0] {
                let c = middle * libm::exp(k * step);
                if c > range[0] && c < range[1] {
                    let next = self.refined(&table(c), best.0);
                    if next.chi_square < best.0.chi_square {
                        best = (next, c);
                    }
                }
            }
        }
        best
    }

    /// Least over the exponents of a function of a table.
    pub fn over_exponents(&self, of: impl Fn(&Table) -> f64) -> f64 {
        let values = self.tables.iter().map(of);
        values.fold(f64::INFINITY, |a, b| if b < a { b } else { a })
    }

    /// Whether any curve with this breakpoint, the first or the second, held has a chi-square of this or less.
    fn fits(&self, breakpoint: usize, at: f64, most: f64) -> bool {
        let least = |table: &Table| other(table, self.ends, breakpoint, at).1;
        self.tables.iter().any(|table| least(table) <= most)
    }

    /// The interval of a breakpoint: all its places that have a chi-square of this or less, from the first to
    /// the last.
    pub fn interval(&self, breakpoint: usize, at: f64, most: f64) -> Crossover {
        let grid: Vec<f64> = ratios(self.ends[0], self.ends[1], GRID).collect();
        let fits = |x: &f64| self.fits(breakpoint, *x, most);
        let edge = |inside: f64, outside: f64| {
            let (mut inside, mut outside) = (inside, outside);
            for _ in 0..HALVINGS_OF_INTERVALS {
                let middle = (inside * outside).sqrt();
                match fits(&middle) {
                    true => inside = middle,
                    false => outside = middle,
                }
            }
            inside
        };
        // The best place lies between two of the grid.
        let below = grid.iter().rposition(|x| *x <= at).unwrap_or(0);
        let above = grid.iter().position(|x| *x >= at).unwrap_or(GRID - 1);
        let first = grid[..=below]
            .iter()
            .position(fits)
            .filter(|k| grid[*k] < at);
        let last = grid[above..].iter().rposition(fits).map(|k| above + k);
        let last = last.filter(|k| grid[*k] > at);
        Crossover {
            at,
            low: match first {
                Some(0) => None,
                Some(k) => Some(edge(grid[k], grid[k - 1])),
                None => Some(edge(at, grid[below])),
            },
            high: match last {
                Some(k) if k + 1 == GRID => None,
                Some(k) => Some(edge(grid[k], grid[k + 1])),
                None => Some(edge(at, grid[above])),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{exact, noisy, spread};
    use super::*;

    fn search(first: First) -> (Search, Breakpoints) {
        let curve = |x: f64| match x {
            x if x < 1.0 => 500.0,
            x if x < 5.0 => 370.0 + 130.0 * x,
            x => 270.0 + 30.0 * x * x,
        };
        let points = exact(&spread(0.1, 10.0, 80), curve, |y| 0.05 * y);
        let (search, breakpoints, exponent) = Search::new(&noisy(&points, 1.0, 3), first, 7);
        assert_eq!(exponent.is_some(), first != First::Flat);
        (search, breakpoints)
    }

    /// No breakpoints of a fine grid are better than those found; for the fitted exponent, nor any exponent.
    #[test]
    fn the_best_joints_are_the_best() {
        for first in [First::Flat, First::Given(0.6), First::Power] {
            let (search, breakpoints) = search(first);
            for c in ratios(EXPONENTS[0], EXPONENTS[1], 8) {
                let exponent = match first {
                    First::Flat => None,
                    First::Given(c) => Some(c),
                    First::Power => Some(c),
                };
                let table = Table::new(&search.sorted, exponent);
                for x1 in ratios(0.1, 9.99, 100) {
                    for x2 in ratios(x1, 10.0, 100) {
                        assert!(
                            table.chi_square(x1, x2) >= breakpoints.chi_square - 1e-6,
                            "{first:?} {x1} {x2}"
                        );
                    }
                }
            }
        }
    }

    /// At the ends of an interval the curve just fits; beyond, it does not; what reaches the end of the
    /// points is open.
    #[test]
    fn intervals_end_where_the_curve_no_longer_fits() {
        let (search, breakpoints) = search(First::Flat);
        let most = 1.05 * breakpoints.chi_square;
        for breakpoint in 0..2 {
            let found = search.interval(breakpoint, breakpoints.x[breakpoint], most);
            let (low, high) = (found.low.unwrap(), found.high.unwrap());
            assert!(low < found.at && found.at < high, "{found:?}");
            for (edge, beyond) in [(low, 1.0 - 1e-4), (high, 1.0 + 1e-4)] {
                assert!(
                    search.fits(breakpoint, edge, most)
                        && !search.fits(breakpoint, edge * beyond, most),
                    "{found:?}"
                );
            }
            let open = search.interval(breakpoint, breakpoints.x[breakpoint], f64::INFINITY);
            assert_eq!((open.low, open.high), (None, None));
        }
        let close = search.interval(0, breakpoints.x[0], breakpoints.chi_square * (1.0 + 1e-9));
        let width = close.high.unwrap() - close.low.unwrap();
        assert!((0.0..0.01).contains(&width), "{close:?}");
    }
}
