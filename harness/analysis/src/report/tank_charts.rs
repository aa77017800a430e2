//! Charts of bars in tanks.

use super::fieldmap;
use super::plot::marker;
use super::scatter::{Line, Mark, Range, scatter};
use super::sections::span;
use super::tank_views::speed_map;
use super::text::escape;
use bitgrain_lab::summary::{DragSummary, Summary, Tank};
use bitgrain_lab::tank_tables::{BarRow, RING, VelocityRow};
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::format::short;

/// The tables of a drag.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TankSeries {
    /// The load along the bar.
    pub bar: Vec<BarRow>,
    /// How the grains of the ring go round.
    pub velocity: Vec<VelocityRow>,
}

/// The runs with what was measured of their tanks.
pub(super) fn tanks(summary: &Summary) -> impl Iterator<Item = (&DragSummary, &Tank)> + Clone {
    let runs = summary.runs.iter();
    runs.filter_map(|run| Some((run, run.tank.as_ref()?)))
}

/// A mean as a mark.
fn mark(x: f64, value: Mean, over: f64, shape: usize) -> Mark {
    let (mean, error) = (value.mean / over, value.standard_error / over.abs());
    Mark {
        at: (x, mean),
        bar: (mean - error, mean + error),
        shape,
        hollow: !value.converged,
    }
}

/// Scale of the drag: rho g h D L.
fn drag_scale(run: &DragSummary, tank: &Tank) -> f64 {
    tank.pressure * run.diameter * tank.length
}

/// Drag and lift of each half turn.
pub(super) fn half_turns(summary: &Summary) -> String {
    if tanks(summary).all(|(_, tank)| tank.half_turns.len() < 2) {
        return String::new();
    }
    let mut sets: [(Vec<Mark>, Vec<Line>); 2] = Default::default();
    for (shape, (run, tank)) in tanks(summary).enumerate() {
        let mut lines: [Vec<(f64, f64)>; 2] = Default::default();
        for (k, half) in tank.half_turns.iter().enumerate() {
            let both = [
                mark((k + 1) as f64, half.drag, drag_scale(run, tank), shape),
                mark((k + 1) as f64, half.lift, tank.buoyancy, shape),
            ];
            for ((set, line), mark) in sets.iter_mut().zip(&mut lines).zip(both) {
                line.push(mark.at);
                set.0.push(mark);
            }
        }
        for (set, points) in sets.iter_mut().zip(lines) {
            set.1.push(Line {
                points,
                heavy: false,
            });
        }
    }
    let names = ["drag F/(\u{3c1} g h D L)", "lift over buoyancy"];
    let mut figures = String::new();
    for ((marks, lines), name) in sets.iter().zip(names) {
        let labels = ["half turn".to_owned(), format!("{name} (dimensionless)")];
        let title = format!("{name} by half turn");
        let chart = scatter(&title, &labels, marks, lines, [Range::FromZero; 2]);
        let chart =
            chart.unwrap_or_else(|| "<p class=\"none\">No half turn was done.</p>".to_owned());
        figures.push_str(&format!("<figure>{chart}</figure>\n"));
    }
    format!(
        "<section>\n<h2>Half a turn and after</h2>\n<p>Means of each half turn, of the first from the beginning of the \
         averaging window. Bars: one standard error each way; hollow: it did not converge.</p>\n{}\
         <div class=\"grid\">\n{figures}</div>\n</section>\n",
        legend(summary)
    )
}

/// Which marker is which run, if there are several.
fn legend(summary: &Summary) -> String {
    if summary.runs.len() < 2 {
        return String::new();
    }
    let key = |(k, (run, _)): (usize, (&DragSummary, &Tank))| {
        format!(
            "<span>{}{}, h/D = {}, V = {}</span>",
            marker(k, false),
            escape(&run.name),
            short(run.depth / run.diameter),
            short(run.speed)
        )
    };
    let keys: String = tanks(summary).enumerate().map(key).collect();
    format!("<p class=\"legend\">{keys}</p>\n")
}

/// Drag and lift over what they scale with, against depth, if there are several depths.
pub(super) fn comparison(summary: &Summary) -> String {
    let depth = |run: &DragSummary| run.depth / run.diameter;
    let mut depths: Vec<f64> = tanks(summary).map(|(run, _)| depth(run)).collect();
    depths.sort_by(f64::total_cmp);
    depths.dedup();
    if depths.len() < 2 {
        return String::new();
    }
    let names = ["drag F/(\u{3c1} g h D L)", "lift over buoyancy"];
    let mut figures = String::new();
    for (which, name) in names.into_iter().enumerate() {
        let each = tanks(summary).enumerate();
        let marks: Vec<Mark> = each
            .map(|(k, (run, tank))| match which {
                0 => mark(depth(run), run.drag, drag_scale(run, tank), k),
                _ => mark(depth(run), run.lift, tank.buoyancy, k),
            })
            .collect();
        let labels = [
            "depth h/D (dimensionless)".to_owned(),
            format!("{name} (dimensionless)"),
        ];
        let chart = scatter(
            &format!("{name} against depth"),
            &labels,
            &marks,
            &[],
            [Range::FromZero; 2],
        );
        figures.push_str(&format!("<figure>{}</figure>\n", chart.unwrap_or_default()));
    }
    format!(
        "<section>\n<h2>Against depth</h2>\n<p>Means of the first half turn (Guillard 2014, Figs. 3 and 4).</p>\n{}\
         <div class=\"grid\">\n{figures}</div>\n</section>\n",
        legend(summary)
    )
}

/// How the grains of the ring that the bar sweeps go round.
pub(super) fn velocities(summary: &Summary, series: &[TankSeries]) -> String {
    let mut figures = String::new();
    for (k, (run, tank)) in tanks(summary).enumerate() {
        let rows = series.get(k).map_or(&[][..], |s| s.velocity.as_slice());
        let bed = summary.beds.iter().find(|bed| bed.name == run.bed);
        let surface = bed.map_or(f64::NAN, |bed| bed.surface);
        for after in [false, true] {
            let map = speed_map(
                run,
                tank,
                rows,
                surface,
                after,
                &format!("v{k}{}", u8::from(after)),
            );
            let Some(map) = map else {
                continue;
            };
            let when = if after {
                "after the first half turn"
            } else {
                "first half turn"
            };
            figures.push_str(&format!(
                "<figure>{map}<figcaption><b>{}</b>, {when}.</figcaption></figure>\n",
                escape(&run.name)
            ));
        }
    }
    if figures.is_empty() {
        return String::new();
    }
    format!(
        "<section>\n<h2>Velocity</h2>\n<p>Mean speed with which grains go round, over that of the bar at the same \
         radius: 0 at rest with the tank, 1 with the bar. Seen from the axis of the tank, in the ring from {} to {} of \
         the bar&rsquo;s half length, both halves together; the bar moves to the right. Across: the angle from the bar \
         times the mean radius of the ring, from a quarter turn behind it to a quarter turn ahead. Dashed: free \
         surface of the settled bed.</p>\n{}<div class=\"grid\">\n{figures}</div>\n</section>\n",
        RING[0],
        RING[1],
        fieldmap::key("speed round the axis over that of the bar", 1.0),
    )
}

/// Drag and lift by the distance from the bar's middle.
pub(super) fn along_bar(summary: &Summary, series: &[TankSeries]) -> String {
    let names = ["drag f/(\u{3c1} g h D)", "lift over buoyancy of the part"];
    let mut sets: [(Vec<Mark>, Vec<Line>); 2] = Default::default();
    for (k, (run, tank)) in tanks(summary).enumerate() {
        let rows = series.get(k).map_or(&[][..], |s| s.bar.as_slice());
        let scales = [
            drag_scale(run, tank) / tank.length,
            tank.buoyancy / tank.length,
        ];
        type Column = fn(&BarRow) -> Option<f64>;
        let columns: [[Column; 2]; 2] = [
            [|r| r.drag, |r| r.drag_after],
            [|r| r.lift, |r| r.lift_after],
        ];
        for ((set, scale), columns) in sets.iter_mut().zip(scales).zip(columns) {
            for (when, of) in columns.into_iter().enumerate() {
                let points: Vec<(f64, f64)> = rows
                    .iter()
                    .filter_map(|row| Some((0.5 * (row.from + row.to), of(row)? / scale)))
                    .collect();
                set.0.extend(points.iter().map(|at| Mark {
                    hollow: when == 1,
                    ..Mark::bare(*at, k)
                }));
                set.1.push(Line {
                    points,
                    heavy: when == 0,
                });
            }
        }
    }
    let mut figures = String::new();
    for ((marks, lines), name) in sets.iter().zip(names) {
        let labels = [
            "distance from the middle over L".to_owned(),
            format!("{name} (dimensionless)"),
        ];
        if let Some(chart) = scatter(
            &format!("{name} along the bar"),
            &labels,
            marks,
            lines,
            [Range::FromZero; 2],
        ) {
            figures.push_str(&format!("<figure>{chart}</figure>\n"));
        }
    }
    if figures.is_empty() {
        return String::new();
    }
    let direct = span(tanks(summary).filter_map(|(_, tank)| tank.direct), "");
    format!(
        "<section>\n<h2>Along the bar</h2>\n<p>Drag and lift over length, both halves together. Filled: the first half \
         turn; hollow: what comes after it. Eq. 1 takes the load for the same all along the bar: summed part by part \
         against the motion of each half the drag of the first half turn is {direct} of that of eq. 1.</p>\n\
         <div class=\"grid\">\n{figures}</div>\n</section>\n"
    )
}
