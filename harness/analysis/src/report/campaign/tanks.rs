//! Charts of bars in tanks beside the experiment (Guillard 2014, section II, Figs. 3 and 4).

use super::super::plot::SHAPES;
use super::super::scatter::Range;
use super::figure::{Figure, Series, add, ends, section, straight};
use super::shown::Shown;
use crate::analysis::Value;
use crate::claims::tank::{Drag, drags};

/// The claim with the drag over rho g h D L that the experiment has.
const DRAG: &str = "guillard-tank-drag";

/// Drag and lift against depth; empty without a bar in a tank.
pub(super) fn figures(shown: &Shown) -> String {
    let drags = drags(shown.table);
    if drags.is_empty() {
        return String::new();
    }
    let series = |of: fn(&Drag) -> Value| {
        let mut all: Vec<Series> = Vec::new();
        for drag in &drags {
            add(&mut all, drag.bar(), [(drag.depth, of(drag))]);
        }
        // No more bars in a chart than there are markers.
        all.truncate(SHAPES);
        all
    };
    let paper = shown.book.claim.iter().find(|claim| claim.id == DRAG);
    let paper = paper.and_then(|claim| claim.value);
    let coefficients = series(|drag| drag.drag);
    let line = paper.zip(ends(&coefficients));
    let line = line.map(|(own, [from, to])| straight(from, to, |_| own, false));
    let thin = paper.map_or(String::new(), |own| {
        format!(" Line: {own}, as in the experiment.")
    });
    let figure = |title, label, series: &[Series], lines: &[_], caption: &str| {
        Figure {
            title,
            labels: ["depth of the axis over diameter h/D", label],
            ranges: [Range::FromZero; 2],
            series,
            lines,
            caption,
        }
        .html()
    };
    let both = figure(
        "Drag against depth",
        "drag F/(\u{3c1} g h D L)",
        &coefficients,
        line.as_slice(),
        &format!("Drag over &rho; g h D L (eq. 1).{thin}"),
    ) + &figure(
        "Lift against depth",
        "lift over buoyancy",
        &series(|drag| drag.lift),
        &[],
        "Lift over the buoyancy of the bar (eq. 3). In the experiment that of thick bars grows with depth, and from \
         10&nbsp;D on no longer (Fig. 6).",
    );
    section(
        "Bars in tanks: drag and lift against depth",
        "<p>Bars of these lengths L, turned about the tank&rsquo;s axis at &Omega; (rad/s); first half turn. Error bars: \
         one standard error each way.</p>\n",
        &both,
        "There is no drag to show.",
    )
}
