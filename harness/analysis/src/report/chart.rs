//! Charts of a report: a force against travel, and the drags against Froude number.

use plotters::prelude::*;

use super::plot::{
    BAND, INK, THIN, axis, bar, chart, chart_with_top, dashes, draw_cross, draw_marker, drawable,
    mesh, padded, svg,
};
use super::text::typeset;
use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::DragSummary;
use bitgrain_sim::units::Units;

/// Points of all curves of a page together: so a page of many runs stays small.
const POINTS: usize = 40_000;

/// One point of a force curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    x: f64,
    steps: f64,
    value: f64,
    average: f64,
}

/// The number that `of` takes from each row, after its place along the axis, and the average of it
/// from the start, weighted by steps.
fn points(rows: &[SeriesRow], of: impl Fn(&SeriesRow) -> (f64, f64)) -> Vec<Point> {
    let (mut before, mut steps, mut sum) = (0, 0.0, 0.0);
    let mut out = Vec::with_capacity(rows.len());
    for row in rows {
        let weight = row.step.saturating_sub(before) as f64;
        before = row.step;
        let (x, value) = of(row);
        if weight == 0.0 || !drawable(x) || !drawable(value) {
            continue;
        }
        steps += weight;
        sum += weight * value;
        out.push(Point {
            x,
            steps: weight,
            value,
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
        let value = group.iter().map(|p| p.steps * p.value).sum::<f64>() / steps;
        Some(Point {
            steps,
            value,
            ..last
        })
    };
    points.chunks(group).filter_map(mean).collect()
}

/// Drag, or lift, against travel of one of `runs` runs, with the time along the top: thin the series, thick its
/// average from the start, shaded the averaging window. `None` if there is nothing to draw.
pub(super) fn along_travel(
    run: &DragSummary,
    rows: &[SeriesRow],
    units: &Units,
    runs: usize,
    lift: bool,
) -> Option<String> {
    let (name, k) = if lift { ("lift", 1) } else { ("drag", 0) };
    let curve = points(rows, |row| (row.distance, row.force_mean[k]));
    let limit = (POINTS / runs.max(1)).clamp(200, 1500);
    let curve = reduced(&curve, limit);
    let end = curve.last()?.x;
    let window = [run.window_start, run.window_end];
    let window = window.iter().all(|x| drawable(*x));
    let window = window.then_some((run.window_start, run.window_end));
    let low = curve.iter().fold(0.0, |a: f64, p| a.min(p.value));
    let high = curve.iter().fold(0.0, |a: f64, p| a.max(p.value));
    let x = axis(0.0, end, 6);
    let y = padded(low, high);
    let time = axis(0.0, end / run.speed, 6);
    let labels = [
        format!("travel ({})", typeset(&units.length)),
        format!("{name} F ({})", typeset(&units.force)),
    ];
    let top = format!("time ({})", typeset(&units.time));
    let title = format!("The {name} against travel of {}", run.name);
    Some(svg(&title, |area| {
        let mut chart = chart_with_top(area, &x, &y, &time, &top)?;
        if let Some((from, to)) = window {
            let band = [(from.min(x.hi), y.lo), (to.min(x.hi), y.hi)];
            chart.draw_series([Rectangle::new(band, BAND.filled())])?;
        }
        mesh(&mut chart, &labels)?;
        let thin = curve.iter().map(|p| (p.x, p.value));
        chart.draw_series(LineSeries::new(thin, THIN.stroke_width(3)))?;
        if let Some((from, _)) = window {
            chart.draw_series(dashes(from, &y))?;
        }
        for half in half_turns(run).filter(|half| *half < x.hi) {
            chart.draw_series(dashes(half, &y))?;
        }
        let thick = curve.iter().map(|p| (p.x, p.average));
        chart.draw_series(LineSeries::new(thick, INK.stroke_width(9)))?;
        Ok(())
    }))
}

/// The travels of the ends of a bar at which half a turn ends; none of other intruders.
fn half_turns(run: &DragSummary) -> impl Iterator<Item = f64> + use<> {
    let half = run
        .tank
        .as_ref()
        .map(|tank| 0.5 * run.distance / tank.turns);
    let count = run.tank.as_ref().map_or(0, |tank| tank.half_turns.len());
    let half = half.filter(|half| drawable(*half));
    half.into_iter()
        .flat_map(move |half| (1..=count).map(move |k| k as f64 * half))
}

/// Means of the drag with standard errors against Froude number, a marker shape for each of `beds`, hollow if the
/// error did not converge; a cross is the mean from the start.
/// `None` if there is nothing to draw.
pub(super) fn froude(runs: &[DragSummary], beds: &[&str], units: &Units) -> Option<String> {
    let good = |r: &&DragSummary| drawable(r.froude) && drawable(r.drag.mean);
    let runs: Vec<&DragSummary> = runs.iter().filter(good).collect();
    runs.first()?;
    let error = |r: &DragSummary| Some(r.drag.standard_error).filter(|e| drawable(*e));
    let reach = |r: &DragSummary| error(r).unwrap_or(0.0);
    let uncut = |r: &DragSummary| Some(r.drag_uncut).filter(|x| drawable(*x));
    let both = |r: &DragSummary| {
        let whole = uncut(r).unwrap_or(r.drag.mean);
        let ends = [r.drag.mean - reach(r), r.drag.mean + reach(r)];
        [ends[0].min(whole), ends[1].max(whole)]
    };
    let low = runs.iter().fold(0.0, |a: f64, r| a.min(both(r)[0]));
    let high = runs.iter().fold(0.0, |a: f64, r| a.max(both(r)[1]));
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
                chart.draw_series(bar(at.0, at.1 - e, at.1 + e, &x))?;
            }
            let shape = beds.iter().position(|b| *b == run.bed).unwrap_or(0);
            if let Some(whole) = uncut(run) {
                draw_cross(&mut chart, (run.froude, whole))?;
            }
            draw_marker(&mut chart, at, shape, !run.drag.converged)?;
        }
        Ok(())
    }))
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

    fn drags(rows: &[SeriesRow]) -> Vec<Point> {
        points(rows, |row| (row.time, row.force_mean[0]))
    }

    #[test]
    fn the_average_from_the_start_weighs_rows_by_their_steps() {
        let rows = [row(10, 1.0, 6.0), row(40, 4.0, 2.0), row(60, 6.0, -1.0)];
        let average: Vec<f64> = drags(&rows).iter().map(|p| p.average).collect();
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
        let average: Vec<f64> = drags(&rows).iter().map(|p| p.average).collect();
        assert_eq!(average, [4.0, 3.0]);
    }

    #[test]
    fn a_long_series_becomes_means_of_equal_groups() {
        let rows: Vec<SeriesRow> = (1..=3000)
            .map(|k| row(k, k as f64, (k % 2) as f64))
            .collect();
        let all = drags(&rows);
        let few = reduced(&all, 1500);
        assert_eq!(few.len(), 1500);
        assert!(few.iter().all(|p| p.value == 0.5));
        assert_eq!(few.last().unwrap().average, all.last().unwrap().average);
        assert_eq!(reduced(&all[..1500], 1500), &all[..1500]);
        assert!(reduced(&[], 1500).is_empty());
    }
}
