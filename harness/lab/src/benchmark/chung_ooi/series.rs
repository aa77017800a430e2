//! A series of impacts of one material: its rows, its chart of a quantity, its checks.

use bitgrain_sim::error::Result;

use super::collision::Collision;
use super::rows::ImpactRow;
use crate::benchmark::comparison::{Point, Published, compare};
use crate::benchmark::result::{Chart, Check, Comparison, Curve, Source};

/// How the benchmark's own curves are called in the file of published points.
const OWN: &str = "Chung & Ooi 2011";

/// Largest deviation from theory where the law is exact.
pub(super) const TOLERANCE: f64 = 1e-3;

/// An impact that was run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Done {
    /// The impact.
    pub collision: Collision,
    /// Its row of the table.
    pub row: ImpactRow,
}

/// Impacts of one material on one kind of partner.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// What it is called in charts and checks.
    pub name: String,
    /// Its impacts, in their order along the axis.
    pub done: Vec<Done>,
}

/// A number of a row, and how charts call it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quantity {
    /// Its name in the file of published points.
    pub key: &'static str,
    /// With its unit.
    pub label: &'static str,
    /// The number.
    pub of: fn(&ImpactRow) -> Option<f64>,
}

/// Values with `parts - 1` others between each two neighbours, evenly.
pub(super) fn refined(values: &[f64], parts: u32) -> Vec<f64> {
    let mut out = Vec::new();
    for pair in values.windows(2) {
        for k in 0..parts {
            out.push(pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(parts));
        }
    }
    out.extend(values.last());
    out
}

impl Series {
    /// Runs the impacts.
    ///
    /// # Errors
    /// Of one that does not end well.
    pub fn run(name: impl Into<String>, of: impl IntoIterator<Item = Collision>) -> Result<Self> {
        let run = |collision: Collision| {
            let outcome = collision.run()?;
            Ok(Done {
                collision,
                row: ImpactRow::of(&collision, &outcome),
            })
        };
        let done: Result<Vec<Done>> = of.into_iter().map(run).collect();
        Ok(Self {
            name: name.into(),
            done: done?,
        })
    }

    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = ImpactRow> {
        self.done.iter().map(|done| done.row)
    }

    /// Those whose contacts slide at every step.
    pub fn sliding(&self) -> impl Iterator<Item = &Done> {
        self.done.iter().filter(|done| done.row.slides == 1)
    }

    /// Restitution of all against what was asked for.
    pub fn check_restitution(&self) -> Check {
        let pairs = self
            .rows()
            .map(|row| (row.restitution, row.normal_restitution));
        Check::worst(
            &self.name,
            "normal speed after over before",
            TOLERANCE,
            pairs,
        )
    }

    /// The chart of a quantity, with `theory` for contacts that slide throughout, and how far it is from the published
    /// points.
    pub fn chart(
        &self,
        number: u32,
        [x, y]: [Quantity; 2],
        theory: impl Fn(&Collision) -> f64,
        published: &Published,
    ) -> (Chart, Vec<Comparison>) {
        let point = |done: &Done| {
            let (x, y) = ((x.of)(&done.row)?, (y.of)(&done.row)?);
            let slides = done.row.slides == 1;
            Some(Point { x, y, slides })
        };
        let points: Vec<Point> = self.done.iter().filter_map(point).collect();
        let sliding = self.sliding().filter_map(|done| {
            let x = (x.of)(&done.row)?;
            Some((x, theory(&done.collision)))
        });
        let mut curves = vec![
            Curve {
                source: Source::Computed,
                points: points.iter().map(|p| (p.x, p.y)).collect(),
            },
            Curve {
                source: Source::Theory,
                points: sliding.collect(),
            },
        ];
        let mut comparisons = Vec::new();
        let first = self.done.first().map(|done| done.row);
        let (material, ratio) =
            first.map_or(("", 0.0), |row| (row.material.0, row.stiffness_ratio));
        for curve in published.of((number, y.key, material), ratio) {
            curves.push(curve.curve(OWN));
            if curve.by == OWN {
                let span = published.span(number, y.key, OWN);
                comparisons.extend(compare((y.key, &self.name), &points, curve, span));
            }
        }
        let chart = Chart {
            title: format!("Test {number}, {}", self.name),
            labels: [x.label.into(), y.label.into()],
            curves,
        };
        (chart, comparisons)
    }
}
