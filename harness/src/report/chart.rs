//! Charts of a report: the force of a drag against time, and the drags against Froude number.

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

use super::text::{escape, number, typeset};
use crate::series::SeriesRow;
use crate::summary::RunSummary;
use crate::units::Units;

/// Size of a drawing: three times that of the smallest screen it must be read on, because
/// coordinates are whole numbers and curves would show steps at a coarser scale.
const SIZE: (u32, u32) = (1440, 930);
/// Text sizes are divided by 1.24 on their way into the SVG: this is 44 there, 15 at a third.
const FONT: f64 = 54.56;
const INK: RGBColor = RGBColor(22, 27, 34);
const THIN: RGBColor = RGBColor(104, 119, 138);
const GRID: RGBColor = RGBColor(228, 228, 224);
const BAND: RGBColor = RGBColor(241, 237, 226);
/// Points of all curves of a page together: a page of many runs stays small.
const POINTS: usize = 60_000;

type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;
type Area<'b> = DrawingArea<SVGBackend<'b>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis, Axis>>;

/// An axis with round tick values.
#[derive(Clone)]
pub(super) struct Axis {
    /// Where it begins.
    pub lo: f64,
    /// Where it ends.
    pub hi: f64,
    /// Values of the ticks and their labels.
    pub ticks: Vec<(f64, String)>,
}

/// An axis from `lo` to `hi` with about `count` ticks at multiples of 1, 2 or 5 times a power of
/// ten. Powers come from decimal text: the same bits on every platform.
pub(super) fn axis(lo: f64, hi: f64, count: usize) -> Axis {
    let (lo, hi) = if drawable(lo) && drawable(hi) && hi - lo > 1e-100 {
        (lo, hi)
    } else {
        (0.0, 1.0)
    };
    let raw = (hi - lo) / count.max(1) as f64;
    let text = format!("{raw:e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mantissa: f64 = mantissa.parse().unwrap_or(1.0);
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let (factor, exponent) = match mantissa {
        ..1.5 => (1, exponent),
        ..3.0 => (2, exponent),
        ..7.0 => (5, exponent),
        _ => (1, exponent + 1),
    };
    let step: f64 = format!("{factor}e{exponent}").parse().unwrap_or(raw);
    let first = (lo / step - 1e-6).ceil() as i64;
    let last = (hi / step + 1e-6).floor() as i64;
    let decimals = usize::try_from(-exponent).unwrap_or(0);
    let label = |x: f64| match exponent {
        -4..6 => format!("{x:.decimals$}").replace('-', "\u{2212}"),
        _ => number(x),
    };
    let ticks = (first..=last)
        .map(|k| k as f64 * step)
        .map(|x| (x, label(x)))
        .collect();
    Axis { lo, hi, ticks }
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let part = (value - self.lo) / (self.hi - self.lo);
        limit.0 + (part * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let shown = if hint.weight().allow_light_points() {
            0
        } else {
            self.ticks.len()
        };
        self.ticks.iter().take(shown).map(|t| t.0).collect()
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.lo..self.hi
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let tick = self.ticks.iter().find(|t| t.0 == *value);
        tick.map_or(String::new(), |t| t.1.clone())
    }
}

/// Finite, and small enough that a range of such numbers is finite too.
pub(super) fn drawable(x: f64) -> bool {
    x.abs() < 1e100
}

/// One point of a force curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    time: f64,
    steps: f64,
    drag: f64,
    average: f64,
}

/// Drag of each row and its average from the start, weighted by steps.
fn points(rows: &[SeriesRow]) -> Vec<Point> {
    let (mut before, mut steps, mut sum) = (0, 0.0, 0.0);
    let mut out = Vec::with_capacity(rows.len());
    for row in rows {
        let weight = row.step.saturating_sub(before) as f64;
        before = row.step;
        let drag = row.force_mean[0];
        if weight == 0.0 || !drawable(row.time) || !drawable(drag) {
            continue;
        }
        steps += weight;
        sum += weight * drag;
        out.push(Point {
            time: row.time,
            steps: weight,
            drag,
            average: sum / steps,
        });
    }
    out
}

/// At most `limit` points: means over equal groups, the last of which may be smaller. The average
/// from the start stays that of all rows.
fn reduced(points: &[Point], limit: usize) -> Vec<Point> {
    let group = points.len().div_ceil(limit.max(1)).max(1);
    let mean = |group: &[Point]| {
        let last = *group.last()?;
        let steps: f64 = group.iter().map(|p| p.steps).sum();
        let drag = group.iter().map(|p| p.steps * p.drag).sum::<f64>() / steps;
        Some(Point {
            steps,
            drag,
            ..last
        })
    };
    points.chunks(group).filter_map(mean).collect()
}

/// Time at which the intruder had travelled so far, on the lines between rows.
fn time_at(rows: &[SeriesRow], travel: f64) -> Option<f64> {
    let mut before = (0.0, 0.0);
    for row in rows {
        if row.distance >= travel {
            let (time, distance) = before;
            let part = (travel - distance) / (row.distance - distance);
            let part = if part.is_finite() { part } else { 1.0 };
            return Some(time + part * (row.time - time)).filter(|t| drawable(*t));
        }
        before = (row.time, row.distance);
    }
    rows.last().map(|r| r.time).filter(|t| drawable(*t))
}

/// Drag against time of one of `runs` drags: thin the series, thick its average from the start,
/// shaded the averaging window. `None` where there is nothing to draw.
pub(super) fn force(
    run: &RunSummary,
    rows: &[SeriesRow],
    units: &Units,
    runs: usize,
) -> Option<String> {
    let limit = (POINTS / runs.max(1)).clamp(200, 1500);
    let curve = reduced(&points(rows), limit);
    let end = curve.last()?.time;
    let low = curve.iter().fold(0.0, |a: f64, p| a.min(p.drag));
    let high = curve.iter().fold(0.0, |a: f64, p| a.max(p.drag));
    let x = axis(0.0, end, 6);
    let y = padded(low, high);
    let window = time_at(rows, run.window_start).zip(time_at(rows, run.window_end));
    let labels = [
        format!("time t ({})", typeset(&units.time)),
        format!("drag F ({})", typeset(&units.force)),
    ];
    let title = format!("Drag against time at Froude number {}", number(run.froude));
    Some(svg(&title, |area| {
        let mut chart = chart(area, &x, &y)?;
        if let Some((from, to)) = window {
            let band = [(from.min(x.hi), y.lo), (to.min(x.hi), y.hi)];
            chart.draw_series([Rectangle::new(band, BAND.filled())])?;
        }
        mesh(&mut chart, &labels)?;
        let thin = curve.iter().map(|p| (p.time, p.drag));
        chart.draw_series(LineSeries::new(thin, THIN.stroke_width(3)))?;
        if let Some((from, _)) = window {
            chart.draw_series(dashes(from, &y))?;
        }
        let thick = curve.iter().map(|p| (p.time, p.average));
        chart.draw_series(LineSeries::new(thick, INK.stroke_width(9)))?;
        Ok(())
    }))
}

/// Means of the drag with standard errors against Froude number, a marker shape for each of `beds`.
/// `None` where there is nothing to draw.
pub(super) fn froude(runs: &[RunSummary], beds: &[&str], units: &Units) -> Option<String> {
    let good = |r: &&RunSummary| drawable(r.froude) && drawable(r.drag.mean);
    let runs: Vec<&RunSummary> = runs.iter().filter(good).collect();
    runs.first()?;
    let error = |r: &RunSummary| Some(r.drag.standard_error).filter(|e| drawable(*e));
    let reach = |r: &RunSummary| error(r).unwrap_or(0.0);
    let low = runs
        .iter()
        .fold(0.0, |a: f64, r| a.min(r.drag.mean - reach(r)));
    let high = runs
        .iter()
        .fold(0.0, |a: f64, r| a.max(r.drag.mean + reach(r)));
    let x = axis(
        0.0,
        runs.iter().fold(0.0, |a: f64, r| a.max(r.froude)) * 1.06,
        6,
    );
    let y = padded(low, high);
    let labels = [
        "Froude number Fr (dimensionless)".to_owned(),
        format!("drag F ({})", typeset(&units.force)),
    ];
    Some(svg("Drag against Froude number", |area| {
        let mut chart = chart(area, &x, &y)?;
        mesh(&mut chart, &labels)?;
        for run in &runs {
            let at = (run.froude, run.drag.mean);
            if let Some(e) = error(run) {
                chart.draw_series(error_bar(at, e, x.hi * 0.008))?;
            }
            let shape = beds.iter().position(|b| *b == run.bed).unwrap_or(0);
            draw_marker(&mut chart, at, shape)?;
        }
        Ok(())
    }))
}

/// A range with zero in it and room above and below the data.
fn padded(low: f64, high: f64) -> Axis {
    let room = 0.07 * (high - low);
    let low = if low < 0.0 { low - room } else { low };
    axis(low, if high > 0.0 { high + room } else { high }, 6)
}

/// Draws into a string and puts it in the form the page holds: as wide as its column, with a title.
fn svg(title: &str, draw: impl FnOnce(&Area) -> Drawn) -> String {
    let mut out = String::new();
    {
        let area = SVGBackend::with_string(&mut out, SIZE).into_drawing_area();
        draw(&area)
            .and_then(|()| area.present())
            .expect("a string takes every drawing");
    }
    let body = out.split_once('>').map_or("", |(_, body)| body);
    let (width, height) = SIZE;
    let title = escape(title);
    format!(
        "<svg class=\"chart\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-label=\"{title}\"><title>{title}</title>{body}"
    )
}

fn chart<'a, 'b>(
    area: &'a Area<'b>,
    x: &Axis,
    y: &Axis,
) -> Result<Chart<'a, 'b>, DrawingAreaErrorKind<std::io::Error>> {
    let longest = y.ticks.iter().map(|t| t.1.chars().count()).max();
    let labels = 26 * u32::try_from(longest.unwrap_or(1)).unwrap_or(1);
    ChartBuilder::on(area)
        .margin_top(24)
        .margin_right(56)
        .margin_bottom(6)
        .margin_left(22)
        .x_label_area_size(140)
        .y_label_area_size(100 + labels)
        .build_cartesian_2d(x.clone(), y.clone())
}

/// Grid, axes, tick labels and axis labels.
fn mesh(chart: &mut Chart, labels: &[String; 2]) -> Drawn {
    let text = ("sans-serif", FONT).into_font().color(&INK);
    chart
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(2))
        .light_line_style(TRANSPARENT)
        .axis_style(INK.stroke_width(3))
        .set_all_tick_mark_size(14)
        .label_style(text.clone())
        .axis_desc_style(text)
        .x_desc(&labels[0])
        .y_desc(&labels[1])
        .draw()
}

/// A dashed vertical line over the whole height.
fn dashes(x: f64, y: &Axis) -> Vec<PathElement<(f64, f64)>> {
    let piece = (y.hi - y.lo) / 47.0;
    let at = |k: usize| y.lo + piece * k as f64;
    let dash = |k| PathElement::new([(x, at(k)), (x, at(k + 1))], INK.stroke_width(4));
    (0..47).step_by(2).map(dash).collect()
}

/// A bar of one standard error each way with caps.
fn error_bar(at: (f64, f64), error: f64, cap: f64) -> Vec<PathElement<(f64, f64)>> {
    let (x, y) = at;
    let line = |from, to| PathElement::new([from, to], INK.stroke_width(5));
    let across = |y| line((x - cap, y), (x + cap, y));
    vec![
        line((x, y - error), (x, y + error)),
        across(y - error),
        across(y + error),
    ]
}

/// Corners of the marker of a bed; none for a circle.
fn corners(shape: usize) -> &'static [(i32, i32)] {
    match shape % 4 {
        0 => &[],
        1 => &[(-12, -12), (12, -12), (12, 12), (-12, 12)],
        2 => &[(0, -16), (15, 11), (-15, 11)],
        _ => &[(0, -18), (15, 0), (0, 18), (-15, 0)],
    }
}

/// Every other four shapes are open.
fn fill(shape: usize) -> RGBColor {
    if (shape / 4).is_multiple_of(2) {
        INK
    } else {
        WHITE
    }
}

fn draw_marker(chart: &mut Chart, at: (f64, f64), shape: usize) -> Drawn {
    let corners = corners(shape);
    if corners.is_empty() {
        chart.draw_series([Circle::new(at, 13, fill(shape).filled())])?;
        chart.draw_series([Circle::new(at, 13, INK.stroke_width(5))])?;
        return Ok(());
    }
    let closed: Vec<_> = corners.iter().chain(&corners[..1]).copied().collect();
    let inner = Polygon::new(corners, fill(shape).filled());
    let outer = PathElement::new(closed, INK.stroke_width(5));
    chart.draw_series([EmptyElement::at(at) + inner + outer])?;
    Ok(())
}

/// The marker of a bed for the legend.
pub(super) fn marker(shape: usize) -> String {
    let RGBColor(r, g, b) = fill(shape);
    let style = format!("fill=\"rgb({r},{g},{b})\" stroke=\"#161b22\" stroke-width=\"5\"");
    let corners = corners(shape);
    let points: Vec<String> = corners.iter().map(|(x, y)| format!("{x},{y}")).collect();
    let body = match corners.is_empty() {
        true => format!("<circle r=\"13\" {style}/>"),
        false => format!("<polygon points=\"{}\" {style}/>", points.join(" ")),
    };
    format!("<svg class=\"key\" viewBox=\"-22 -22 44 44\" aria-hidden=\"true\">{body}</svg>")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(step: u64, time: f64, drag: f64) -> SeriesRow {
        SeriesRow {
            step,
            time,
            distance: 2.0 * time,
            force_mean: [drag, 0.0, 0.0],
            ..SeriesRow::default()
        }
    }

    #[test]
    fn the_average_from_the_start_weighs_rows_by_their_steps() {
        let rows = [row(10, 1.0, 6.0), row(40, 4.0, 2.0), row(60, 6.0, -1.0)];
        let average: Vec<f64> = points(&rows).iter().map(|p| p.average).collect();
        assert_eq!(average, [6.0, 3.0, 100.0 / 60.0]);
    }

    #[test]
    fn rows_that_are_no_numbers_are_left_out() {
        let rows = [
            row(0, 0.0, 9.0),
            row(1, 1.0, 4.0),
            row(2, 2.0, f64::NAN),
            row(3, 3.0, 2.0),
        ];
        let average: Vec<f64> = points(&rows).iter().map(|p| p.average).collect();
        assert_eq!(average, [4.0, 3.0]);
    }

    #[test]
    fn a_long_series_becomes_means_of_equal_groups() {
        let rows: Vec<SeriesRow> = (1..=3000)
            .map(|k| row(k, k as f64, (k % 2) as f64))
            .collect();
        let all = points(&rows);
        let few = reduced(&all, 1500);
        assert_eq!(few.len(), 1500);
        assert!(few.iter().all(|p| p.drag == 0.5));
        assert_eq!(few.last().unwrap().average, all.last().unwrap().average);
        assert_eq!(reduced(&all[..1500], 1500), &all[..1500]);
        assert!(reduced(&[], 1500).is_empty());
    }

    #[test]
    fn the_window_begins_between_rows() {
        let rows = [row(1, 1.0, 0.0), row(2, 2.0, 0.0)];
        assert_eq!(time_at(&rows, 0.0), Some(0.0));
        assert_eq!(time_at(&rows, 3.0), Some(1.5));
        assert_eq!(time_at(&rows, 9.0), Some(2.0));
        assert_eq!(time_at(&[], 9.0), None);
    }

    #[test]
    fn ticks_are_round_numbers() {
        let labels = |lo, hi| -> Vec<String> {
            let ticks = axis(lo, hi, 5).ticks;
            ticks.into_iter().map(|t| t.1).collect()
        };
        assert_eq!(labels(0.0, 100.0), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(
            labels(-0.2, 0.25),
            ["\u{2212}0.2", "\u{2212}0.1", "0.0", "0.1", "0.2"]
        );
        assert_eq!(labels(0.0, 1e-7).len(), 6);
        assert_eq!(labels(f64::NAN, 1.0), labels(0.0, 1.0));
        assert_eq!(labels(3.0, 3.0), labels(0.0, 1.0));
    }
}
