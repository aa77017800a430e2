//! The table of what the paper says and what the runs show.

use super::text::escape;
use crate::claims::{Statement, Verdict, statements};
use bitgrain_lab::summary::Summary;

/// Plain text of a statement with its symbols as markup.
fn prose(text: &str) -> String {
    ["rho g h~", "h~", "C_d"]
        .iter()
        .zip(["&rho;&nbsp;g&nbsp;h\u{303}", "h\u{303}", "C<sub>d</sub>"])
        .fold(escape(text), |text, (from, to)| text.replace(from, to))
}

/// The section of the page with a row for each statement.
pub(super) fn section(summary: &Summary) -> String {
    let rows: String = statements(summary).iter().map(row).collect();
    format!(
        "<section>\n<h2>Beside the paper</h2>\n<p>What Guillard, Forterre and Pouliquen, <i>Lift forces \
         in granular media</i> (2014), say, and what these runs measured. Each mean is over the seeds; \
         its standard error is the deviation over the seeds divided by the root of their number, or the \
         block error of the runs where that is larger. Nothing agrees that rests on a bed which slips, \
         or on less than 60 grain diameters of travel.</p>\n<div class=\"wide\" tabindex=\"0\" \
         role=\"region\" aria-label=\"Statements\"><table class=\"statements\">\n<thead><tr>\
         <th scope=\"col\">Statement</th><th scope=\"col\">Verdict</th><th scope=\"col\">Measured</th>\
         <th scope=\"col\">Why</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n\
         </section>\n"
    )
}

/// A verdict, in bold where there is one.
pub(super) fn verdict_cell(verdict: Verdict) -> String {
    match verdict {
        Verdict::NotResolved => verdict.text().to_owned(),
        _ => format!("<b>{}</b>", verdict.text()),
    }
}

fn row(statement: &Statement) -> String {
    format!(
        "<tr><th scope=\"row\"><b>{}</b><small>{}</small></th><td>{}</td><td>{}</td>\
         <td>{}</td></tr>\n",
        prose(&statement.subject),
        prose(&statement.expected),
        verdict_cell(statement.verdict),
        prose(&statement.measured),
        prose(&statement.reason),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_set_and_nothing_is_taken_for_html() {
        assert_eq!(prose("C_d < 10 at h~"), "C<sub>d</sub> &lt; 10 at h\u{303}");
    }
}
