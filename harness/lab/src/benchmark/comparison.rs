//! Our curves beside points of others.

use serde::Deserialize;

use crate::benchmark::result::{Comparison, Curve, Source};

/// Points that others published.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Published {
    /// Where they come from.
    pub source: String,
    /// Their curves.
    pub curves: Vec<PublishedCurve>,
}

/// One published curve.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PublishedCurve {
    /// Number of the test.
    pub test: u32,
    /// What it shows.
    pub quantity: String,
    /// Of which material; `any` if it is that of all.
    pub material: String,
    /// Young's modulus of the partner over the sphere's own, if the test has several.
    pub stiffness_ratio: Option<f64>,
    /// Whose it is.
    pub by: String,
    /// Its points.
    pub points: Vec<(f64, f64)>,
}

impl Published {
    /// Those of a test for this quantity and material.
    pub fn of<'a>(
        &'a self,
        (test, quantity, material): (u32, &'a str, &'a str),
        stiffness_ratio: f64,
    ) -> impl Iterator<Item = &'a PublishedCurve> {
        self.curves.iter().filter(move |curve| {
            curve.test == test
                && curve.quantity == quantity
                && (curve.material == material || curve.material == "any")
                && curve
                    .stiffness_ratio
                    .is_none_or(|ratio| ratio == stiffness_ratio)
        })
    }
}

impl Published {
    /// Largest less smallest value of all points of a test for this quantity by these authors.
    pub fn span(&self, test: u32, quantity: &str, by: &str) -> f64 {
        let curves = self
            .curves
            .iter()
            .filter(|curve| curve.test == test && curve.quantity == quantity && curve.by == by);
        let values = curves.flat_map(|curve| &curve.points).map(|p| p.1);
        let ends = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| {
            (
                if y < low { y } else { low },
                if y > high { y } else { high },
            )
        });
        ends.1 - ends.0
    }
}

impl PublishedCurve {
    /// To draw it; `own` is how the benchmark's own publication is called.
    pub fn curve(&self, own: &str) -> Curve {
        Curve {
            source: match self.by == own {
                true => Source::Published(self.by.clone()),
                false => Source::Other(self.by.clone()),
            },
            points: self.points.clone(),
        }
    }
}

/// A point of our curve, and whether the contact slid at every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Along the axis.
    pub x: f64,
    /// Its value.
    pub y: f64,
    /// Whether the contact slid throughout.
    pub slides: bool,
}

/// The value between two neighbours, on the line through them; it slides if both do. `None` outside the curve.
fn between(curve: &[Point], x: f64) -> Option<Point> {
    let pair = curve.windows(2).find(|pair| {
        let (a, b) = (pair[0].x, pair[1].x);
        (a <= x && x <= b) || (b <= x && x <= a)
    })?;
    let part = match pair[1].x == pair[0].x {
        true => 0.0,
        false => (x - pair[0].x) / (pair[1].x - pair[0].x),
    };
    Some(Point {
        x,
        y: pair[0].y + part * (pair[1].y - pair[0].y),
        slides: pair[0].slides && pair[1].slides,
    })
}

/// Compares our curve with published points, those where it slides throughout and the others apart. Points beyond the
/// ends of our curve are left out. Differences are given over `span`.
pub(super) fn compare(
    (quantity, material): (&'static str, &str),
    ours: &[Point],
    theirs: &PublishedCurve,
    span: f64,
) -> Vec<Comparison> {
    let found = |p: &(f64, f64)| between(ours, p.0).map(|own| (own.slides, (own.y - p.1).abs()));
    let off: Vec<(bool, f64)> = theirs.points.iter().filter_map(found).collect();
    let part = |slides: bool, range: &'static str| {
        let part: Vec<f64> = off.iter().filter(|d| d.0 == slides).map(|d| d.1).collect();
        let largest = part
            .iter()
            .fold(0.0, |a: f64, b| if *b > a { *b } else { a });
        (!part.is_empty()).then(|| Comparison {
            quantity,
            material: material.to_owned(),
            with: theirs.by.clone(),
            range,
            points: part.len(),
            span,
            mean: part.iter().sum::<f64>() / part.len() as f64 / span,
            largest: largest / span,
        })
    };
    let parts = [
        part(true, "slides throughout"),
        part(false, "sticks for a time"),
    ];
    parts.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_compared_on_the_line_between_ours() {
        let point = |x, y, slides| Point { x, y, slides };
        // Descending curves are curves too.
        let ours = [
            point(3.0, 6.0, true),
            point(2.0, 4.0, true),
            point(1.0, 2.0, false),
        ];
        let theirs = PublishedCurve {
            test: 1,
            quantity: "q".into(),
            material: "m".into(),
            stiffness_ratio: None,
            by: "them".into(),
            points: vec![(2.5, 5.5), (1.5, 3.0), (1.25, 1.5), (9.0, 9.0)],
        };
        let found = compare(("q", "m"), &ours, &theirs, 5.0);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].points, found[0].span), (1, 5.0));
        assert!((found[0].mean - 0.5 / 5.0).abs() < 1e-15);
        assert_eq!(found[1].points, 2);
        assert!((found[1].largest - 1.0 / 5.0).abs() < 1e-15);
        assert!((found[1].mean - 0.5 / 5.0).abs() < 1e-15);
    }
}
