//! The section of a page with the means over the seeds: both forms of C_d, and the lift by place of the axis.

use super::scaling::subject;
use super::text::escape;
use crate::claims::Group;
use crate::claims::means::{HEADS, Means, ODD, means};
use bitgrain_lab::summary::Summary;

/// The names of the columns in HTML, with and without the last.
fn heads(odd: bool) -> String {
    let names = HEADS.into_iter().chain(odd.then_some(ODD));
    let cell = |name: &str| {
        let name = name
            .replace("h~", "h\u{303}")
            .replace("C_d", "C<sub>d</sub>");
        format!("<th scope=\"col\">{name}</th>")
    };
    names.map(cell).collect()
}

fn row(means: &Means, diameter: f64) -> String {
    let mut cells = means.cells(diameter).into_iter();
    let way = escape(&cells.next().unwrap_or_default());
    let cells: String = cells
        .map(|cell| format!("<td>{}</td>", escape(&cell)))
        .collect();
    format!("<tr><th scope=\"row\">{way}</th>{cells}</tr>\n")
}

/// The section; empty without a point.
pub(super) fn section(summary: &Summary, groups: &[Group]) -> String {
    let all: Vec<(&Group, Vec<Means>)> = groups.iter().map(|g| (g, means(summary, g))).collect();
    if all.iter().all(|(_, rows)| rows.is_empty()) {
        return String::new();
    }
    let odd = all
        .iter()
        .any(|(_, rows)| rows.iter().any(|row| row.odd.is_some()));
    let bodies: String = all
        .iter()
        .map(|(group, rows)| {
            let rows: String = rows.iter().map(|m| row(m, group.diameter)).collect();
            format!(
                "<tbody>\n<tr class=\"group\"><th colspan=\"{}\" scope=\"rowgroup\">{}</th></tr>\n{rows}</tbody>\n",
                HEADS.len() + usize::from(odd),
                subject(group, summary)
            )
        })
        .collect();
    let last = match odd {
        true => {
            " Last: how much of the curve of eq. 4 the odd part of the normal stress holds, that is, what lifts."
        }
        false => "",
    };
    format!(
        "<section>\n<h2>Means over the seeds</h2>\n<p>C<sub>d</sub> is the drag over &rho; g h\u{303} D L, as in the \
         paper, and over D L times the weight measured above the axis. That weight is less with a pressure gradient: h \
         reaches to the tops of the highest grains, and &rho; is that of the flowing bed, which is denser than the \
         settled one that h is of. The axis lies this many D above the floor and below the surface: where it is not in \
         the middle, base and surface may make a lift of their own.{last}</p>\n<div class=\"wide\" tabindex=\"0\" \
         role=\"region\" aria-label=\"Means over the seeds\"><table>\n<thead><tr>{}</tr></thead>\n{bodies}\
         </table></div>\n</section>\n",
        heads(odd)
    )
}
