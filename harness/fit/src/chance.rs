//! How likely a chi-square or a ratio of variances is by chance.
//!
//! The tails are statrs's, which takes logarithms from the platform; results are rounded to ten digits, so
//! that they are the same on another, except for about one in a hundred thousand that lies at an edge.

use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal, StudentsT};
use statrs::function::{beta, gamma};

use bitgrain_sim::format::round10;

/// Chance of a chi-square so large or larger with this many degrees of freedom; 1 without any.
pub fn chi_square_tail(chi_square: f64, degrees: usize) -> f64 {
    if degrees == 0 || chi_square <= 0.0 {
        return 1.0;
    }
    let tail = gamma::checked_gamma_ur(degrees as f64 / 2.0, chi_square / 2.0);
    round10(tail.unwrap_or(0.0))
}

/// Chance of a ratio of variances so large or larger, with this many degrees of freedom above and below the
/// line, both above zero.
pub fn fisher_tail(ratio: f64, above: usize, below: usize) -> f64 {
    if ratio <= 0.0 || above == 0 || below == 0 {
        return 1.0;
    }
    let (n, d) = (above as f64, below as f64);
    // Not one less the other part: small tails keep their digits.
    let tail = beta::checked_beta_reg(d / 2.0, n / 2.0, d / (d + n * ratio));
    round10(tail.unwrap_or(0.0))
}

/// The ratio of variances that is exceeded with the chance `1 - part`; infinite without degrees of freedom.
pub fn fisher_quantile(part: f64, above: usize, below: usize) -> f64 {
    let known = FisherSnedecor::new(above as f64, below as f64);
    known.map_or(f64::INFINITY, |d| round10(d.inverse_cdf(part)))
}

/// The value that a Student t stays below with the chance `part`; infinite without degrees of freedom.
pub fn student_quantile(part: f64, degrees: usize) -> f64 {
    let known = StudentsT::new(0.0, 1.0, degrees as f64);
    known.map_or(f64::INFINITY, |d| round10(d.inverse_cdf(part)))
}

/// Errors by which the largest of so many independent normal numbers is off its true value by chance as seldom as one
/// alone is by two: 2 for one, 2.5 for four, 3.2 for 32 (Sidak, J. Am. Stat. Assoc. 62, 626, 1967). For numbers that
/// vary together it is a little too much.
pub fn beyond(of: usize) -> f64 {
    let normal = Normal::standard();
    let alone = normal.cdf(2.0);
    match of {
        0 | 1 => 2.0,
        n => round10(normal.inverse_cdf(libm::pow(alone, 1.0 / n as f64))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: f64, b: f64) {
        assert!((a - b).abs() < 2e-9 * b.abs(), "{a} {b}");
    }

    /// Closed forms: two degrees of freedom make a chi-square exponential; F(1, n) is t squared; the t of
    /// one degree is Cauchy's; and F(2, n) is `(1 + 2 f / n)^(-n/2)`.
    #[test]
    fn tails_are_those_of_closed_forms() {
        for x in [0.1, 1.0, 7.0, 60.0] {
            near(chi_square_tail(x, 2), libm::exp(-x / 2.0));
            near(chi_square_tail(x, 4), libm::exp(-x / 2.0) * (1.0 + x / 2.0));
            near(fisher_tail(x, 2, 9), libm::pow(1.0 + 2.0 * x / 9.0, -4.5));
        }
        assert_eq!(
            (chi_square_tail(0.0, 3), chi_square_tail(9.0, 0)),
            (1.0, 1.0)
        );
        assert_eq!(chi_square_tail(1e9, 3), 0.0);
        assert_eq!(
            (fisher_tail(-1.0, 2, 3), fisher_tail(1.0, 0, 3)),
            (1.0, 1.0)
        );
    }

    #[test]
    fn quantiles_are_those_of_closed_forms() {
        near(
            student_quantile(0.975, 1),
            libm::tan(0.475 * std::f64::consts::PI),
        );
        for n in [1, 4, 10, 55, 1000] {
            let t = student_quantile(0.975, n);
            near(fisher_quantile(0.95, 1, n), t * t);
            near(fisher_tail(t * t, 1, n), 0.05);
            near(
                fisher_quantile(0.95, 2, n),
                n as f64 / 2.0 * (libm::pow(0.05, -2.0 / n as f64) - 1.0),
            );
        }
        assert_eq!(fisher_quantile(0.95, 1, 0), f64::INFINITY);
        assert_eq!(student_quantile(0.975, 0), f64::INFINITY);
    }

    /// All of n numbers stay below the quantile with the chance of one below two errors.
    #[test]
    fn the_largest_of_several_is_allowed_more() {
        assert_eq!((beyond(0), beyond(1)), (2.0, 2.0));
        let one = Normal::standard().cdf(2.0);
        for n in [2, 4, 32, 384, 100_000] {
            let all = libm::pow(Normal::standard().cdf(beyond(n)), n as f64);
            assert!((all - one).abs() < 1e-6, "{n}: {all}");
        }
        assert!((beyond(4) - 2.5).abs() < 0.05 && (beyond(32) - 3.2).abs() < 0.05);
    }
}
