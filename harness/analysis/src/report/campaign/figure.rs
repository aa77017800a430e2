//! A chart of several series with its key and its words.

use super::super::plot::{SHAPES, marker};
use super::super::scatter::{Line, Mark, Range, scatter};
use super::super::text::escape;
use crate::analysis::Value;

/// Points with one marker.
pub(super) struct Series {
    /// Their name in the key, plain text.
    pub name: String,
    /// Where they are.
    pub points: Vec<(f64, Value)>,
    /// Which of them are less sure than the others, by place; those left out are not.
    pub hollow: Vec<bool>,
}

impl Series {
    pub(super) fn new(name: String, points: impl IntoIterator<Item = (f64, Value)>) -> Self {
        Self {
            name,
            points: points.into_iter().collect(),
            hollow: Vec::new(),
        }
    }

    /// The same with these points hollow.
    pub(super) fn with_hollow(self, hollow: impl IntoIterator<Item = bool>) -> Self {
        Self {
            hollow: hollow.into_iter().collect(),
            ..self
        }
    }
}

/// Adds points to the series of that name, which may be a new one.
pub(super) fn add(
    all: &mut Vec<Series>,
    name: String,
    points: impl IntoIterator<Item = (f64, Value)>,
) {
    match all.iter_mut().find(|s| s.name == name) {
        Some(own) => own.points.extend(points),
        None => all.push(Series::new(name, points)),
    }
}

/// The least and largest x of some series; `None` if a line has no room between them.
pub(super) fn ends(series: &[Series]) -> Option<[f64; 2]> {
    let all = || series.iter().flat_map(|s| s.points.iter().map(|p| p.0));
    let from = all().fold(f64::INFINITY, f64::min);
    let to = all().fold(0.0, f64::max);
    (from < to).then_some([from, to])
}

/// What a figure is.
pub(super) struct Figure<'a> {
    /// Its name for screen readers.
    pub title: &'a str,
    /// Of the axes, plain text.
    pub labels: [&'a str; 2],
    /// Its axes.
    pub ranges: [Range; 2],
    /// What is in it.
    pub series: &'a [Series],
    /// And through it.
    pub lines: &'a [Line],
    /// What is below it, HTML.
    pub caption: &'a str,
}

impl Figure<'_> {
    /// As HTML; empty if there is nothing to draw.
    pub(super) fn html(&self) -> String {
        let mark = |(k, series): (usize, &Series)| -> Vec<Mark> {
            let one = |(place, (x, v)): (usize, &(f64, Value))| Mark {
                at: (*x, v.value),
                bar: (v.value - v.error, v.value + v.error),
                shape: k % SHAPES,
                hollow: series.hollow.get(place).is_some_and(|hollow| *hollow),
            };
            series.points.iter().enumerate().map(one).collect()
        };
        let marks: Vec<Mark> = self.series.iter().enumerate().flat_map(mark).collect();
        let labels = self.labels.map(str::to_owned);
        let Some(svg) = scatter(self.title, &labels, &marks, self.lines, self.ranges) else {
            return String::new();
        };
        let there =
            |(_, series): &(usize, &Series)| !series.name.is_empty() && !series.points.is_empty();
        let key = |(k, series): (usize, &Series)| {
            let hollow = !series.hollow.is_empty() && series.hollow.iter().all(|hollow| *hollow);
            let marker = marker(k, hollow);
            format!("<span>{marker}{}</span>", escape(&series.name))
        };
        let keys: String = self
            .series
            .iter()
            .enumerate()
            .filter(there)
            .map(key)
            .collect();
        let keys = match keys.is_empty() {
            true => keys,
            false => format!("<div class=\"legend\">{keys}</div>"),
        };
        format!(
            "<figure>{keys}{svg}<figcaption>{}</figcaption></figure>\n",
            self.caption
        )
    }
}

/// Points of a curve from one x to another, in equal ratios.
pub(super) fn traced(from: f64, to: f64, of: impl Fn(f64) -> f64, heavy: bool) -> Line {
    const POINTS: usize = 80;
    let at = |k: usize| from * libm::pow(to / from, k as f64 / POINTS as f64);
    let points = (0..=POINTS).map(at).map(|x| (x, of(x))).collect();
    Line { points, heavy }
}

/// A straight line between two x.
pub(super) fn straight(from: f64, to: f64, of: impl Fn(f64) -> f64, heavy: bool) -> Line {
    Line {
        points: vec![(from, of(from)), (to, of(to))],
        heavy,
    }
}

/// A section with figures, or a sentence if there are none.
pub(super) fn section(title: &str, words: &str, figures: &str, none: &str) -> String {
    let body = match figures.is_empty() {
        true => format!("<p class=\"none\">{none}</p>\n"),
        false => format!("{words}<div class=\"grid\">\n{figures}</div>\n"),
    };
    format!("<section>\n<h2>{title}</h2>\n{body}</section>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_without_points_have_no_key_and_nothing_is_no_figure() {
        let value = Value::new(2.0, 0.1);
        let draw = |series: &[Series]| {
            Figure {
                title: "t",
                labels: ["x", "y"],
                ranges: [Range::FromZero; 2],
                series,
                lines: &[],
                caption: "words",
            }
            .html()
        };
        assert_eq!(draw(&[Series::new("a".into(), [])]), "");
        let both = [
            Series::new("a < b".into(), [(1.0, value)]),
            Series::new("none".into(), []),
        ];
        let html = draw(&both);
        assert!(html.contains("a &lt; b</span>") && !html.contains("none</span>"));
    }
}
