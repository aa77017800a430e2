//! How a bed changes as it flows, and whether it follows its base: packing and drag in successive parts
//! of the travel, and the speed of the far grains by height.

use super::scaling::{legend, shape, subject};
use super::scatter::{Line, Mark, Range, scatter};
use super::text::typeset;
use crate::claims::{FAR_FIELD_LEAST, Group};
use bitgrain_lab::flow::FlowRow;
use bitgrain_lab::summary::Summary;

/// What a run recorded of its flow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FlowSeries {
    /// The flow series.
    pub rows: Vec<FlowRow>,
    /// Layers of the far field: lower and upper height, mean speed over the speed asked for.
    pub profile: Vec<(f64, f64, f64)>,
}

/// Parts into which the travel is cut.
const PARTS: usize = 10;

/// Means over equal parts of the rows: middle of the travel, and what `of` gives.
fn parts(rows: &[FlowRow], of: impl Fn(&FlowRow) -> f64) -> Vec<(f64, f64)> {
    let count = rows.len().min(PARTS);
    let part = |k: usize| {
        let (from, end) = (k * rows.len() / count, (k + 1) * rows.len() / count);
        let part = &rows[from..end];
        let before = if k == 0 { 0.0 } else { rows[from - 1].distance };
        let middle = 0.5 * (before + part[part.len() - 1].distance);
        let sum = part.iter().map(&of).sum::<f64>();
        (middle, sum / part.len() as f64)
    };
    (0..count).map(part).collect()
}

/// The section with three charts of each group.
pub(super) fn section(summary: &Summary, groups: &[Group], courses: &[FlowSeries]) -> String {
    let mut figures = String::new();
    for group in groups {
        let name = subject(group, summary);
        let charts = [
            (
                packing_chart(group, summary, courses),
                "Packing fraction in successive tenths of the travel.",
            ),
            (
                drag_chart(group, summary, courses),
                "Drag over D L and the measured pressure, in the same tenths.",
            ),
            (
                far_chart(group, summary, courses),
                "Mean speed of the grains far from the intruder over the speed asked for, by height, \
                 from displacements in the averaging window. Thick line: 1, a bed \
                 that follows its base. Thin line: 0.95, below which it slips.",
            ),
        ];
        for (chart, words) in charts {
            if let Some(svg) = chart {
                figures.push_str(&format!(
                    "<figure>{svg}<figcaption>{name}. {words} A line for each run.</figcaption>\
                     </figure>\n"
                ));
            }
        }
    }
    if figures.is_empty() {
        figures = "<p class=\"none\">No series of the flow.</p>\n".to_owned();
    }
    format!(
        "<section>\n<h2>The bed as it flows</h2>\n{}<div class=\"grid\">\n{figures}</div>\n\
         </section>\n",
        legend(groups)
    )
}

/// A line with markers for each run of a group, from what `of` takes from its course.
fn lines(
    group: &Group,
    courses: &[FlowSeries],
    of: impl Fn(usize, &FlowSeries) -> Vec<(f64, f64)>,
) -> (Vec<Mark>, Vec<Line>) {
    let (mut marks, mut lines) = (Vec::new(), Vec::new());
    for point in &group.points {
        for &k in &point.runs {
            let points = courses.get(k).map_or(vec![], |course| of(k, course));
            marks.extend(points.iter().map(|p| Mark::bare(*p, shape(point.way))));
            lines.push(Line {
                points,
                heavy: false,
            });
        }
    }
    (marks, lines)
}

fn packing_chart(group: &Group, summary: &Summary, courses: &[FlowSeries]) -> Option<String> {
    let labels = [
        format!("travel ({})", typeset(&summary.units.length)),
        "packing fraction \u{3c6} (dimensionless)".to_owned(),
    ];
    let (marks, lines) = lines(group, courses, |_, c| parts(&c.rows, |row| row.packing));
    let ranges = [Range::FromZero, Range::Tight];
    scatter(
        "Packing fraction against travel",
        &labels,
        &marks,
        &lines,
        ranges,
    )
}

fn drag_chart(group: &Group, summary: &Summary, courses: &[FlowSeries]) -> Option<String> {
    let labels = [
        format!("travel ({})", typeset(&summary.units.length)),
        "drag F/(P D L) (dimensionless)".to_owned(),
    ];
    let (marks, lines) = lines(group, courses, |k, course| {
        let run = summary.runs.get(k);
        let bed = run.and_then(|run| summary.beds.iter().find(|bed| bed.name == run.bed));
        let Some(rig) = bed.and_then(|bed| bed.rig.as_ref()) else {
            return vec![];
        };
        parts(&course.rows, |row| {
            row.drag / (row.pressure * rig.diameter * rig.length)
        })
    });
    let ranges = [Range::FromZero; 2];
    scatter(
        "Drag over pressure against travel",
        &labels,
        &marks,
        &lines,
        ranges,
    )
}

fn far_chart(group: &Group, summary: &Summary, courses: &[FlowSeries]) -> Option<String> {
    let labels = [
        "far grains over base (dimensionless)".to_owned(),
        format!("height z ({})", typeset(&summary.units.length)),
    ];
    // Few grains lie above the settled surface, between the lid's.
    let surface = |run: &bitgrain_lab::summary::DragSummary| {
        let bed = summary.beds.iter().find(|bed| bed.name == run.bed);
        bed.map_or(f64::INFINITY, |bed| bed.surface)
    };
    let (marks, mut lines) = lines(group, courses, |run, course| {
        let surface = surface(&summary.runs[run]);
        let layers = course.profile.iter();
        layers
            .filter(|(_, high, _)| *high <= surface)
            .map(|(low, high, speed)| (*speed, 0.5 * (low + high)))
            .collect()
    });
    let top = marks.iter().fold(0.0, |a: f64, m| a.max(m.at.1));
    let bound = |x| Line {
        points: vec![(x, 0.0), (x, top)],
        heavy: x == 1.0,
    };
    lines.extend([bound(1.0), bound(FAR_FIELD_LEAST)]);
    let ranges = [Range::Tight, Range::FromZero];
    scatter(
        "Speed of the far grains by height",
        &labels,
        &marks,
        &lines,
        ranges,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_is_cut_into_tenths() {
        let row = |k: u64| FlowRow {
            distance: k as f64,
            packing: k as f64,
            ..FlowRow::default()
        };
        let rows: Vec<FlowRow> = (1..=43).map(row).collect();
        let cut = parts(&rows, |row| row.packing);
        assert_eq!(cut.len(), PARTS);
        assert_eq!(cut[0], (2.0, 2.5));
        // Rows 39 to 43.
        assert_eq!(cut[9], (40.5, 41.0));
        assert_eq!(parts(&rows[..3], |row| row.packing).len(), 3);
        assert!(parts(&[], |row| row.packing).is_empty());
    }
}
