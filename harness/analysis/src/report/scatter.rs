//! Charts of points with bars, and lines through or beside them.

use plotters::prelude::*;

use super::plot::{
    Axis, INK, THIN, axis, bar, chart, draw_marker, drawable, log_axis, mesh, padded, svg,
};

/// A point of a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    /// Where it is.
    pub at: (f64, f64),
    /// Ends of its bar; equal ones for none.
    pub bar: (f64, f64),
    /// Its marker.
    pub shape: usize,
    /// Whether it is less certain than the others.
    pub hollow: bool,
}

impl Mark {
    /// Without a bar.
    pub(super) fn bare(at: (f64, f64), shape: usize) -> Self {
        Self {
            at,
            bar: (at.1, at.1),
            shape,
            hollow: false,
        }
    }
}

/// A line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// Its corners.
    pub points: Vec<(f64, f64)>,
    /// Dark and thick, or light and thin.
    pub heavy: bool,
}

/// What a chart is to show of the range of its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Range {
    /// From zero, or from below it if there are such values.
    FromZero,
    /// The range of the values.
    Tight,
    /// The range of the values, which are above zero; equal steps are equal ratios.
    Ratios,
}

impl Range {
    fn axis(self, low: f64, high: f64) -> Axis {
        match self {
            Range::FromZero => padded(if low < 0.0 { low } else { 0.0 }, high),
            Range::Tight => {
                // Never less than a part of the values, so that noise does not fill the chart.
                let middle = 0.5 * (low + high);
                let least = 0.02 * middle.abs();
                let half = 0.57 * (high - low);
                let half = if half > least { half } else { least };
                axis(middle - half, middle + half, 6)
            }
            Range::Ratios => log_axis(low, high),
        }
    }
}

/// Draws lines and over them marks; what is not a number is left out, and what is not above zero on an axis of
/// ratios. `None` if no mark is left.
pub(super) fn scatter(
    title: &str,
    labels: &[String; 2],
    marks: &[Mark],
    lines: &[Line],
    ranges: [Range; 2],
) -> Option<String> {
    let shown = |x: f64, range: Range| drawable(x) && (range != Range::Ratios || x > 0.0);
    let fits = |at: &(f64, f64)| shown(at.0, ranges[0]) && shown(at.1, ranges[1]);
    let marks: Vec<&Mark> = marks
        .iter()
        .filter(|m| fits(&m.at) && drawable(m.bar.0) && drawable(m.bar.1))
        .collect();
    let first = marks.first()?;
    let corners = lines
        .iter()
        .flat_map(|line| &line.points)
        .filter(|p| fits(p));
    let mut all: Vec<(f64, f64)> = corners.copied().collect();
    all.extend(
        marks
            .iter()
            .flat_map(|m| [(m.at.0, m.bar.0), (m.at.0, m.bar.1), m.at])
            .filter(|p| fits(p)),
    );
    let ends = |of: fn(&(f64, f64)) -> f64| {
        all.iter()
            .map(of)
            .fold((of(&first.at), of(&first.at)), |(low, high), x| {
                (
                    if x < low { x } else { low },
                    if x > high { x } else { high },
                )
            })
    };
    let (x, y) = (ends(|p| p.0), ends(|p| p.1));
    let (x, y) = (ranges[0].axis(x.0, x.1), ranges[1].axis(y.0, y.1));
    Some(svg(title, |area| {
        let mut chart = chart(area, &x, &y)?;
        mesh(&mut chart, labels)?;
        for line in lines {
            let points = line.points.iter().copied().filter(|p| fits(p));
            let style = match line.heavy {
                true => INK.stroke_width(7),
                false => THIN.stroke_width(4),
            };
            chart.draw_series(LineSeries::new(points, style))?;
        }
        for mark in &marks {
            let (low, high) = mark.bar;
            // On an axis of ratios a bar that reaches zero reaches the edge.
            let low = if low < y.lo { y.lo } else { low };
            if low < high {
                chart.draw_series(bar(mark.at.0, low, high, &x))?;
            }
            draw_marker(&mut chart, mark.at, mark.shape, mark.hollow)?;
        }
        Ok(())
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_is_left_out_and_nothing_is_no_chart() {
        let labels = ["x (d)".to_owned(), "y (d)".to_owned()];
        let draw = |marks: &[Mark]| scatter("t", &labels, marks, &[], [Range::FromZero; 2]);
        assert!(draw(&[]).is_none());
        assert!(draw(&[Mark::bare((f64::NAN, 1.0), 0)]).is_none());
        let both = [Mark::bare((f64::NAN, 1.0), 0), Mark::bare((1.0, 1.0), 0)];
        assert_eq!(draw(&both), draw(&both[1..]));
        let barred = Mark {
            bar: (0.5, 2.0),
            ..both[1]
        };
        assert_ne!(draw(&[barred]), draw(&both[1..]));
    }

    #[test]
    fn an_axis_of_ratios_takes_bars_that_reach_zero_but_no_point_there() {
        let labels = ["x".to_owned(), "y".to_owned()];
        let draw = |marks: &[Mark]| scatter("t", &labels, marks, &[], [Range::Ratios; 2]);
        assert!(draw(&[Mark::bare((0.0, 1.0), 0)]).is_none());
        assert!(draw(&[Mark::bare((1.0, -1.0), 0)]).is_none());
        let barred = Mark {
            at: (1.0, 2.0),
            bar: (-1.0, 3.0),
            shape: 0,
            hollow: false,
        };
        let svg = draw(&[barred]).unwrap();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn a_tight_range_holds_its_values_and_is_never_nothing() {
        let axis = Range::Tight.axis(0.58, 0.62);
        assert!(axis.lo < 0.58 && axis.hi > 0.62 && axis.lo > 0.5);
        let one = Range::Tight.axis(0.6, 0.6);
        assert!(one.lo < 0.6 && one.hi > 0.6);
        assert_eq!(Range::FromZero.axis(2.0, 4.0).lo, 0.0);
    }
}
