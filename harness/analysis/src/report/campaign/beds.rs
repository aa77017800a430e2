//! Drags that were measured through several beds: the mean, and whether beds or blocks give its error.

use super::super::text::{escape, exact};
use super::shown::{Shown, intruder, material};
use crate::analysis::{Curve, ErrorOf, Point};
use bitgrain_sim::format::number_with_error;

/// The table of such drags; empty if every speed has one bed.
pub(super) fn table(shown: &Shown) -> String {
    let row = |curve: &Curve, p: &Point| {
        let error_of = match p.error_of {
            ErrorOf::Beds => "spread of the beds",
            ErrorOf::Blocks => "blocks within the runs",
        };
        format!(
            "<tr><th scope=\"row\">{}, {}</th><td>{}</td><td>{}</td><td>{}</td><td>{error_of}</td></tr>\n",
            escape(&material(&curve.material)),
            escape(&intruder(curve)),
            exact(p.froude),
            p.beds,
            number_with_error(p.drag.value, p.drag.error),
        )
    };
    let several = |curve: &'_ Curve| -> String {
        let own = curve.points.iter().filter(|p| p.beds > 1);
        own.map(|p| row(curve, p)).collect()
    };
    let rows: String = shown.analysis.curves.iter().map(several).collect();
    if rows.is_empty() {
        return rows;
    }
    let force = escape(&shown.label("", "drag"));
    format!(
        "<section>\n<h2>Means over beds</h2>\n<p>A bed remembers how it was poured for longer than a slow drag lasts: \
         where the spread of several beds is larger than the errors of their runs, it is the error.</p>\n<div \
         class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Means over beds\"><table>\n<thead><tr>\
         <th scope=\"col\">Intruder</th><th scope=\"col\">Fr</th><th scope=\"col\">Beds</th>\
         <th scope=\"col\">Drag{force}</th><th scope=\"col\">Error from</th></tr></thead>\n<tbody>\n{rows}</tbody>\n\
         </table></div>\n</section>\n"
    )
}
