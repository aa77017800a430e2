//! Charts of several curves, each with a marker at its end.

use super::super::plot::{SHAPES, marker};
use super::super::scatter::{Line, Mark, Range, scatter};

/// Most corners of a curve.
const CORNERS: usize = 400;

/// Letters and marks of a chart.
pub(super) struct Chart<'a> {
    /// Its name for screen readers.
    pub title: &'a str,
    /// Of the axes, plain text.
    pub labels: [String; 2],
    /// Its axes.
    pub ranges: [Range; 2],
    /// What is below it, HTML.
    pub caption: String,
}

/// Curves with their names, HTML; one marker for each.
pub(super) type Named = (String, Vec<(f64, f64)>);

/// Every so many points, the last one always, so that a page stays small.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let apart = points.len().div_ceil(CORNERS).max(1);
    let kept = points.iter().step_by(apart).copied();
    let last = points.last().copied();
    let mut all: Vec<(f64, f64)> = kept.collect();
    if all.last() != last.as_ref() {
        all.extend(last);
    }
    all
}

impl Chart<'_> {
    /// Curves that end in their markers; empty without any.
    pub(super) fn curves(&self, curves: &[Named]) -> String {
        let line = |(_, points): &Named| Line {
            points: thinned(points),
            heavy: false,
        };
        let end = |(k, (_, points)): (usize, &Named)| {
            let at = *points.last()?;
            Some(Mark::bare(at, k % SHAPES))
        };
        let lines: Vec<Line> = curves.iter().map(line).collect();
        let marks: Vec<Mark> = curves.iter().enumerate().filter_map(end).collect();
        let names: Vec<&str> = curves.iter().map(|(name, _)| &name[..]).collect();
        self.figure(&names, &marks, &lines)
    }

    /// Marks and lines, with a key to the marks' shapes.
    pub(super) fn figure(&self, names: &[&str], marks: &[Mark], lines: &[Line]) -> String {
        let Some(svg) = scatter(self.title, &self.labels, marks, lines, self.ranges) else {
            return String::new();
        };
        let key = |(k, name): (usize, &&str)| format!("<span>{}{name}</span>", marker(k, false));
        let keys: String = names.iter().enumerate().map(key).collect();
        format!(
            "<figure><div class=\"legend\">{keys}</div>{svg}<figcaption>{}</figcaption></figure>\n",
            self.caption
        )
    }
}

/// A section of figures.
pub(super) fn section(title: &str, words: &str, figures: &str) -> String {
    format!(
        "<section>\n<h2>{title}</h2>\n{words}<div class=\"grid\">\n{figures}</div>\n</section>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_curves_keep_their_ends() {
        let points: Vec<(f64, f64)> = (0..2001).map(|k| (f64::from(k), 1.0)).collect();
        let few = thinned(&points);
        assert!(few.len() <= CORNERS + 1, "{}", few.len());
        assert_eq!((few[0], few.last()), (points[0], points.last()));
        assert_eq!(thinned(&points[..3]), &points[..3]);
        assert!(thinned(&[]).is_empty());
    }
}
