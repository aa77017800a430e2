//! Charts of what the runs of flowing beds say together: drag against pressure, lift against depth and
//! against the size of the cylinder.

use super::inputs::pressure_unit;
use super::plot::marker;
use super::scatter::{Line, Mark, Range, scatter};
use super::text::{escape, typeset};
use crate::claims::guillard::is_thin;
use crate::claims::{Group, Way, drag_slope, lift_coefficient, plateau};
use bitgrain_lab::scenario::DRAG_COEFFICIENT;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::{number_with_error, short};

/// Lift over buoyancy with a pressure gradient, D/d = 3.3 (Guillard 2014, section IV, after eq. 4; Fig. 8(b)).
const LIFT: f64 = 30.0;

/// Number of the marker of a way.
pub(super) fn shape(way: Way) -> usize {
    match way {
        Way::Own => 0,
        Way::Lid => 1,
        Way::LidAlone => 4,
    }
}

/// The ways that are there, with their markers.
pub(super) fn legend(groups: &[Group]) -> String {
    let there = |way: &Way| {
        groups
            .iter()
            .any(|g| g.points.iter().any(|p| p.way == *way))
    };
    let key = |way: Way| {
        format!(
            "<span>{}{}</span>",
            marker(shape(way), false),
            escape(way.name())
        )
    };
    let keys: String = Way::ALL.into_iter().filter(there).map(key).collect();
    format!("<p class=\"legend\">{keys}</p>\n")
}

/// Which cylinder and speed a chart is about, and which place of its axis under lids.
pub(super) fn subject(group: &Group, summary: &Summary) -> String {
    let unit = escape(&typeset(&summary.units.speed));
    let axis = group.axis.map_or(String::new(), |z| {
        format!(
            ", axis {}&nbsp;D above the floor",
            short(z / group.diameter)
        )
    });
    format!(
        "<b>D/d&nbsp;=&nbsp;{}</b>, speed {}&nbsp;{unit}{axis}",
        short(group.over_grain),
        short(group.speed)
    )
}

/// The section with all three charts.
pub(super) fn section(summary: &Summary, groups: &[Group]) -> String {
    let mut figures = String::new();
    let mut add = |chart: Option<String>, caption: String| {
        if let Some(svg) = chart {
            figures.push_str(&format!(
                "<figure>{svg}<figcaption>{caption}</figcaption></figure>\n"
            ));
        }
    };
    for group in groups {
        let name = subject(group, summary);
        let bars = bars(group);
        add(
            drag_chart(group, summary),
            format!("{name}. {} {bars}", slope_text(group)),
        );
        add(
            lift_chart(group),
            format!("{name}. {} {bars}", plateau_text(group)),
        );
    }
    add(
        size_chart(groups),
        "C<sub>l</sub>, the lift over buoyancy with a pressure gradient, against the size of the \
         cylinder. Filled: mean of a plateau; hollow: the deepest point, if there is no plateau. Bars: \
         least and largest of the runs of these points."
            .to_owned(),
    );
    format!(
        "<section>\n<h2>Drag and lift against depth</h2>\n{}<p>Hollow: the error of one of the runs did not \
         converge.</p>\n<div class=\"grid\">\n{figures}</div>\n\
         </section>\n",
        legend(groups)
    )
}

/// What the bars of a group's charts are.
fn bars(group: &Group) -> String {
    let several = |p: &&crate::claims::Point| p.lift.deviation.is_some();
    let count = group.points.iter().filter(several).count();
    let words = match count {
        0 => "one standard error of the run each way",
        n if n == group.points.len() => "one standard deviation over the seeds each way",
        _ => {
            "one standard deviation over the seeds each way, of a single run one standard error of it"
        }
    };
    format!("Bars: {words}.")
}

fn slope_text(group: &Group) -> String {
    let fit = drag_slope(group).map_or(String::new(), |fit| {
        format!(
            "Thick line: least squares through the origin, all points with equal weight, with a slope \
             C<sub>d</sub>&nbsp;=&nbsp;{}. ",
            number_with_error(fit.slope, fit.error)
        )
    });
    format!("{fit}Thin line: C<sub>d</sub>&nbsp;=&nbsp;{DRAG_COEFFICIENT}, as in the paper.")
}

fn drag_chart(group: &Group, summary: &Summary) -> Option<String> {
    let unit = typeset(pressure_unit(&summary.units));
    let labels = [
        format!("pressure \u{3c1} g h\u{303} ({unit})"),
        format!("drag F/(D L) ({unit})"),
    ];
    let mark = |p: &crate::claims::Point| Mark {
        at: (p.pressure, p.drag.mean),
        bar: (p.drag.mean - p.drag.bar(), p.drag.mean + p.drag.bar()),
        shape: shape(p.way),
        hollow: !p.converged[0],
    };
    let marks: Vec<Mark> = group.points.iter().map(mark).collect();
    let end = marks.iter().fold(0.0, |a: f64, m| a.max(m.at.0));
    let line = |slope: f64, heavy| Line {
        points: vec![(0.0, 0.0), (end, slope * end)],
        heavy,
    };
    let mut lines = vec![line(DRAG_COEFFICIENT, false)];
    lines.extend(drag_slope(group).map(|fit| line(fit.slope, true)));
    scatter(
        "Drag against pressure",
        &labels,
        &marks,
        &lines,
        [Range::FromZero; 2],
    )
}

fn plateau_text(group: &Group) -> String {
    let thin = match paper(group) {
        true => format!(
            " Thin line: {LIFT}, as in the paper with a gradient (section IV, after eq. 4)."
        ),
        false => String::new(),
    };
    let thick = match plateau(&group.with_gradient(true)) {
        Some(flat) => format!(
            "Thick line: the plateau of the deepest {} points, {}.",
            flat.points,
            number_with_error(flat.lift, flat.error)
        ),
        None => {
            "No plateau is drawn: it takes two depths or more whose lifts agree and are distinct from \
             zero and from a growth with depth."
                .to_owned()
        }
    };
    thick + &thin
}

/// Whether the paper gives a number of the lift on this cylinder.
fn paper(group: &Group) -> bool {
    is_thin(group) && !group.with_gradient(true).is_empty()
}

fn lift_chart(group: &Group) -> Option<String> {
    let labels = [
        "effective depth over diameter h\u{303}/D (dimensionless)".to_owned(),
        "lift over buoyancy (dimensionless)".to_owned(),
    ];
    let over = |depth: f64| depth / group.diameter;
    let mark = |p: &crate::claims::Point| Mark {
        at: (over(p.effective_depth), p.lift.mean),
        bar: (p.lift.mean - p.lift.bar(), p.lift.mean + p.lift.bar()),
        shape: shape(p.way),
        hollow: !p.converged[1],
    };
    let marks: Vec<Mark> = group.points.iter().map(mark).collect();
    let points = group.with_gradient(true);
    let flat = plateau(&points).and_then(|flat| {
        let first = points.get(points.len().checked_sub(flat.points)?)?;
        let ends = [first.effective_depth, points.last()?.effective_depth];
        Some(Line {
            points: ends.map(|h| (over(h), flat.lift)).to_vec(),
            heavy: true,
        })
    });
    let mut lines: Vec<Line> = flat.into_iter().collect();
    if paper(group) {
        let end = marks.iter().fold(0.0, |a: f64, m| a.max(m.at.0));
        lines.push(Line {
            points: vec![(0.0, LIFT), (end, LIFT)],
            heavy: false,
        });
    }
    scatter(
        "Lift against depth",
        &labels,
        &marks,
        &lines,
        [Range::FromZero; 2],
    )
}

/// C_l against D/d, if there are several cylinders.
fn size_chart(groups: &[Group]) -> Option<String> {
    let found: Vec<_> = groups.iter().filter_map(lift_coefficient).collect();
    let first = found.first()?;
    if found.iter().all(|c| c.over_grain == first.over_grain) {
        return None;
    }
    let labels = [
        "cylinder over grain D/d (dimensionless)".to_owned(),
        "lift over buoyancy (dimensionless)".to_owned(),
    ];
    let marks: Vec<Mark> = found
        .iter()
        .map(|c| Mark {
            at: (c.over_grain, c.mean),
            bar: (c.least, c.most),
            shape: 0,
            hollow: !c.saturated,
        })
        .collect();
    scatter(
        "Lift against the size of the cylinder",
        &labels,
        &marks,
        &[],
        [Range::FromZero; 2],
    )
}

#[cfg(test)]
mod tests {
    use super::{DRAG_COEFFICIENT, LIFT};
    use crate::claims::book::Book;

    /// The paper's lines are the numbers that the book has of it.
    #[test]
    fn the_papers_lines_are_the_books() {
        let book = Book::shipped();
        for (id, drawn) in [
            ("guillard-drag", DRAG_COEFFICIENT),
            ("guillard-lift-thirty", LIFT),
        ] {
            let claim = book.claim.iter().find(|claim| claim.id == id).unwrap();
            assert_eq!(claim.value, Some(drawn), "{id}");
        }
    }
}
