//! What a benchmark gives: tables, curves, checks that must hold, comparisons with what others published.

use serde::Serialize;

use crate::performance::StagePerformance;

/// A benchmark that was run.
#[derive(Clone, Debug, Serialize)]
pub struct Benchmark {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, beginning with a capital.
    pub title: &'static str,
    /// The publication that defines it.
    pub source: &'static str,
    /// Where the published points come from.
    pub published: String,
    /// What must be known of these numbers: a title and what it means.
    pub remarks: Vec<(&'static str, &'static str)>,
    /// Its tests.
    pub tests: Vec<Test>,
    /// How long its parts took on this machine; no result.
    #[serde(skip)]
    pub performance: Vec<StagePerformance>,
}

impl Benchmark {
    /// All checks of all tests.
    pub fn checks(&self) -> impl Iterator<Item = &Check> {
        self.tests.iter().flat_map(|test| &test.checks)
    }
}

/// One test of a benchmark.
#[derive(Clone, Debug, Serialize)]
pub struct Test {
    /// Its number in the publication, from 1.
    pub number: u32,
    /// What happens in it.
    pub title: &'static str,
    /// Its bodies and parameters, with units.
    pub setup: String,
    /// What came of it, in words; empty if the checks say all.
    pub outcome: String,
    /// Its table as a CSV file.
    #[serde(skip)]
    pub table: String,
    /// Its charts.
    #[serde(skip)]
    pub charts: Vec<Chart>,
    /// What must hold.
    pub checks: Vec<Check>,
    /// What is seen beside points of others.
    pub comparisons: Vec<Comparison>,
}

impl Test {
    /// A test without results.
    pub(super) fn new(number: u32, title: &'static str, setup: &str) -> Self {
        Self {
            number,
            title,
            setup: setup.into(),
            outcome: String::new(),
            table: String::new(),
            charts: Vec::new(),
            checks: Vec::new(),
            comparisons: Vec::new(),
        }
    }

    /// Adds charts with their comparisons, and checks.
    pub(super) fn add(
        &mut self,
        charts: impl IntoIterator<Item = (Chart, Vec<Comparison>)>,
        checks: impl IntoIterator<Item = Check>,
    ) {
        for (chart, comparisons) in charts {
            self.charts.push(chart);
            self.comparisons.extend(comparisons);
        }
        self.checks.extend(checks);
    }
}

/// Curves over one axis.
#[derive(Clone, Debug)]
pub struct Chart {
    /// What it shows, and of which material.
    pub title: String,
    /// The axes, with units.
    pub labels: [String; 2],
    /// Its curves; the first is computed.
    pub curves: Vec<Curve>,
}

/// A curve.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Where it comes from.
    pub source: Source,
    /// Points, along the axis.
    pub points: Vec<(f64, f64)>,
}

/// Where a curve comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// Our run.
    Computed,
    /// A closed form.
    Theory,
    /// The publication's own curve.
    Published(String),
    /// Another's, such as an experiment, which the publication shows.
    Other(String),
}

/// A number that theory fixes. The worst of its cases is given.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Of which material, and against what.
    pub material: String,
    /// What is compared.
    pub what: &'static str,
    /// How many cases of the test it was compared in.
    pub cases: usize,
    /// What theory gives in the worst case.
    pub expected: f64,
    /// What was measured there.
    pub measured: f64,
    /// Their difference over the number expected.
    pub deviation: f64,
    /// The largest deviation allowed.
    pub tolerance: f64,
    /// Whether there were cases and all are within it.
    pub holds: bool,
}

impl Check {
    /// The check of these pairs of numbers, expected and measured; expected ones are not zero.
    pub(super) fn worst(
        material: impl Into<String>,
        what: &'static str,
        tolerance: f64,
        pairs: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        let mut check = Self {
            material: material.into(),
            what,
            cases: 0,
            expected: f64::NAN,
            measured: f64::NAN,
            deviation: f64::NAN,
            tolerance,
            holds: false,
        };
        for (expected, measured) in pairs {
            let deviation = (measured / expected - 1.0).abs();
            // What is no number is worse than any.
            let is_worse = check.cases == 0 || deviation.is_nan() || deviation > check.deviation;
            check.cases += 1;
            if is_worse {
                check = Self {
                    expected,
                    measured,
                    deviation,
                    ..check
                };
            }
        }
        check.holds = check.deviation <= tolerance;
        check
    }
}

/// How far our curve is from points of others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// What is compared, as the table calls it.
    pub quantity: &'static str,
    /// Of which material, and against what.
    pub material: String,
    /// Whose points.
    pub with: String,
    /// Which of them: all, or those at which our contact slides at every step, or the others.
    pub range: &'static str,
    /// How many points.
    pub points: usize,
    /// Largest less smallest value of all their points of this quantity in the test: differences are given over it.
    pub span: f64,
    /// Mean size of the differences over the span.
    pub mean: f64,
    /// The largest of them over the span.
    pub largest: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_is_as_good_as_its_worst_case() {
        let check = |pairs: &[(f64, f64)]| Check::worst("m", "w", 1e-3, pairs.iter().copied());
        assert!(check(&[(1.0, 1.0005), (2.0, 2.0)]).holds);
        let off = check(&[(1.0, 1.0), (2.0, 2.01), (3.0, 3.0)]);
        assert!(!off.holds && off.cases == 3 && off.measured == 2.01);
        // Without cases, or with one that is no number, nothing was shown.
        assert!(!check(&[]).holds);
        assert!(!check(&[(1.0, f64::NAN), (1.0, 1.0)]).holds);
    }
}
