//! Charts of bars in tanks beside the experiment (Guillard 2014, section II, Figs. 3 and 4).

use super::super::plot::SHAPES;
use super::super::scatter::Range;
use super::figure::{Figure, Series, ends, section, straight};
use super::shown::Shown;
use crate::analysis::Value;
use crate::claims::tank::{Drag, drags};
use bitgrain_sim::format::short;

/// The claim with the drag over rho g h D L that the experiment has.
const DRAG: &str = "guillard-tank-drag";

/// Drag and lift against depth; empty without a bar in a tank.
pub(super) fn figures(shown: &Shown) -> String {
    let drags = drags(shown.table);
    if drags.is_empty() {
        return String::new();
    }
    let paper = shown.book.claim.iter().find(|claim| claim.id == DRAG);
    let paper = paper.and_then(|claim| claim.value);
    let thin = paper.map_or(String::new(), |own| {
        format!(" Line: {own}, as in the experiment.")
    });
    let drag = format!("Drag (eq. 1) over &rho; g h D L (eq. 2).{thin}");
    let lift = "Lift over the buoyancy of the bar (eq. 3). In the experiment that of thick bars grows with depth, and \
                from 10&nbsp;D on no longer (Fig. 6).";
    let both = charts(
        ["Drag against depth", "drag F/(\u{3c1} g h D L)"],
        &series(&drags, |drag| drag.drag),
        paper,
        &drag,
    ) + &charts(
        ["Lift against depth", "lift over buoyancy"],
        &series(&drags, |drag| drag.lift),
        None,
        lift,
    );
    section(
        "Bars in tanks: drag and lift against depth",
        "<p>Bars of these diameters D and lengths L, turned about the tank&rsquo;s axis at &Omega; (rad/s); first half \
         turn. Error bars: one standard error each way. Hollow: the error of the drag did not converge.</p>\n",
        &both,
        "There is no drag to show.",
    )
}

/// Charts of a quantity against depth, with the paper's number as a line; no more bars in one than there are markers.
fn charts([title, label]: [&str; 2], all: &[Series], paper: Option<f64>, caption: &str) -> String {
    let chart = |some: &[Series]| {
        let line = paper.zip(ends(some));
        let line = line.map(|(own, [from, to])| straight(from, to, |_| own, false));
        Figure {
            title,
            labels: ["depth of the axis over diameter h/D", label],
            ranges: [Range::FromZero; 2],
            series: some,
            lines: line.as_slice(),
            caption,
        }
        .html()
    };
    all.chunks(SHAPES).map(chart).collect()
}

/// One quantity of the drags by depth, a series for each bar and speed.
fn series(drags: &[Drag], of: fn(&Drag) -> Value) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    for drag in drags {
        let name = format!("D = {}, {}", short(drag.diameter()), drag.bar());
        let (point, hollow) = ((drag.depth, of(drag)), !drag.converged);
        match all.iter_mut().find(|series| series.name == name) {
            Some(own) => {
                own.points.push(point);
                own.hollow.push(hollow);
            }
            None => all.push(Series::new(name, [point]).with_hollow([hollow])),
        }
    }
    all
}
