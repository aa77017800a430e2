//! The page of a campaign: what its runs say together, in charts, and every fit and number.

mod around;
mod claims;
mod drags;
mod figure;
mod yields;

use super::text::{escape, exact, number_with_error, short, typeset};
use super::{head, span};
use crate::analysis::{self, Analysis, Curve, Finding, Material, Point, Value, words};
use crate::campaign::folder::Beside;
use crate::campaign::table::Table;
use crate::claims::book::Book;
use crate::files::bits;
use crate::fit::Fit;

/// What a page shows.
pub struct Shown<'a> {
    /// Name of the campaign.
    pub name: &'a str,
    /// What lies beside its table; none of a table alone.
    pub beside: Option<&'a Beside>,
    /// Its table.
    pub table: &'a Table,
    /// What that says.
    pub analysis: &'a Analysis,
    /// Claims with what it measured of them.
    pub book: &'a Book,
}

impl Shown<'_> {
    /// A quantity with the unit of a column, plain text.
    fn label(&self, name: &str, column: &str) -> String {
        match typeset(&self.table.unit(column)) {
            unit if unit.is_empty() => name.to_owned(),
            unit => format!("{name} ({unit})"),
        }
    }
}

/// One self-contained HTML page, a pure function of what it shows.
pub fn campaign_page(shown: &Shown) -> String {
    let mut out = head(&escape(shown.name), "Drags of many runs", "");
    out.push_str(&lead(shown));
    out.push_str(&drags::figures(shown));
    out.push_str(&around::figures(shown));
    out.push_str(&yields::figures(shown));
    out.push_str(&around::drifts(shown));
    out.push_str(&claims::section(shown.book, shown.name));
    out.push_str(&fits(shown.analysis));
    out.push_str(&runs(shown));
    out.push_str(&repeat(shown));
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

/// Grains in words, plain text.
fn material(m: &Material) -> String {
    greek(&analysis::material(m))
}

/// What grains are beside their friction, plain text.
fn grains(m: &Material) -> String {
    greek(&analysis::grains(m))
}

/// An intruder in words, plain text.
fn intruder(curve: &Curve) -> String {
    analysis::intruder(curve)
}

fn greek(text: &str) -> String {
    let letters = [
        ("gamma_n", "\u{3b3}_n"),
        ("mu", "\u{3bc}"),
        ("chi^2", "\u{3c7}\u{b2}"),
    ];
    letters
        .iter()
        .fold(text.to_owned(), |text, (name, letter)| {
            text.replace(name, letter)
        })
}

/// A fit or why there is none, HTML.
fn words_of(found: &Finding<Fit>) -> String {
    match found {
        Finding::Found(fit) => escape(&greek(&fit.line())),
        Finding::Refused(why) => format!("none, because {}", escape(&why.0)),
    }
}

/// What there is, in a paragraph, and what failed.
fn lead(shown: &Shown) -> String {
    let (a, table) = (shown.analysis, shown.table);
    if a.rows == 0 {
        return "<p class=\"lead\">No run is done.</p>\n".to_owned();
    }
    let range = |column: &str| {
        let all = (0..table.len()).filter_map(|row| table.real(row, column));
        span(all, &table.unit(column))
    };
    let open = match shown.beside {
        Some(beside) if beside.planned > a.rows => format!(" of {} planned", beside.planned),
        _ => String::new(),
    };
    let slid = match (a.sliding, a.plugs) {
        (0, _) => String::new(),
        (n, true) => format!(" Of {n} the bed above slid along; they count all the same."),
        (n, false) => format!(" {n} are left out because the bed above slid along."),
    };
    let failed = (0..table.len()).filter(|&row| table.text(row, "status") != "done");
    let failure = |row| {
        let cell = |column| escape(table.text(row, column));
        format!(
            "<p class=\"remark\"><b>{}/{} failed.</b> {}</p>\n",
            cell("member"),
            cell("run"),
            cell("reason")
        )
    };
    let failures: String = failed.map(failure).collect();
    format!(
        "<p class=\"lead\">Runs: {}{open}, in beds of {} grains; intruders of diameter {} at depths of {}, Froude \
         numbers {}, friction coefficients {}.{slid} Errors are standard errors; depths h are those of the \
         settled beds.</p>\n{failures}",
        a.rows,
        range("grains"),
        range("diameter"),
        range("depth"),
        range("froude"),
        range("mu"),
    )
}

fn fits(analysis: &Analysis) -> String {
    format!(
        "<section>\n<h2>Every fit</h2>\n<p>Numbers with standard errors, chi-square with its degrees of freedom and \
         the chance of one so large, or why there is no fit; <code>bitgrain analyse</code> writes covariances and \
         residuals too.</p>\n<pre tabindex=\"0\">{}</pre>\n</section>\n",
        escape(&words(analysis))
    )
}

/// A row for each run.
fn runs(shown: &Shown) -> String {
    let value = |v: &Value| {
        let text = number_with_error(v.value, v.error);
        format!(
            "<data value=\"{:?}\" title=\"{:?} \u{b1} {:?}\">{text}</data>",
            v.value, v.value, v.error
        )
    };
    let maybe = |v: &Option<Value>| v.as_ref().map_or("\u{2014}".to_owned(), value);
    let reports = shown.beside.map_or(&[][..], |beside| &beside.reports);
    let linked = |name: &str| match name.split_once('/') {
        // There is the flow round the intruder to see.
        Some((member, run)) if reports.iter().any(|own| own == member) => {
            let (member, run) = (escape(member), escape(run));
            format!("<a href=\"members/{member}/report.html\">{member}</a>/{run}")
        }
        _ => escape(name),
    };
    let row = |curve: &Curve, p: &Point| {
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{}</td><td>{}</td><td>{}</td></tr>\n",
            linked(&p.name),
            curve.material.mu,
            short(curve.diameter),
            short(p.depth),
            exact(p.froude),
            value(&p.drag),
            maybe(&p.angle),
            short(p.plug_ratio),
            maybe(&p.drift),
            escape(p.digest.get(..16).unwrap_or(&p.digest)),
        )
    };
    let rows: String = shown
        .analysis
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(move |p| row(curve, p)))
        .collect();
    let length = escape(&shown.label("", "diameter"));
    let force = escape(&shown.label("", "drag"));
    format!(
        "<section>\n<h2>The runs</h2>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" \
         aria-label=\"Runs\"><table>\n<thead><tr><th scope=\"col\">Run</th><th scope=\"col\">&mu;</th>\
         <th scope=\"col\">D{length}</th><th scope=\"col\">h{length}</th><th scope=\"col\">Fr</th>\
         <th scope=\"col\">Drag{force}</th><th scope=\"col\">Contact angle (rad)</th><th scope=\"col\">Plug \
         ratio</th><th scope=\"col\">Drift over V</th><th scope=\"col\">Digest, first 16 digits
</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n</section>\n"
    )
}

fn repeat(shown: &Shown) -> String {
    let Some(beside) = shown.beside else {
        return String::new();
    };
    format!(
        "<section>\n<h2>How to repeat it</h2>\n<p>Save the campaign below as <code>campaign.toml</code> and, in \
         the same folder, run</p>\n<pre>bitgrain sweep campaign.toml</pre>\n<p>Its whole table is \
         <code>results.csv</code>, and the same as <code>results.parquet</code>. With <code>--only \
         MEMBER/RUN</code> it does one row alone. Runs with the same {} end in the same digests.</p>\n\
         <h3>Campaign</h3>\n<pre tabindex=\"0\">{}</pre>\n</section>\n",
        escape(&bits()),
        escape(&beside.text)
    )
}
