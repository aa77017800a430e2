//! The page of a campaign: what its runs say together, in charts, and every fit and number.

mod beds;
mod drags;
mod figure;
mod near_field;
mod shown;
mod tanks;
mod yields;

use shown::Shown;

use super::page::{Top, assembled, remark, row};
use super::sections::span;
use super::text::{escape, exact};
use super::{claims, loads, means, scaling};
use crate::analysis::{Analysis, Curve, Point, Value, describe};
use crate::claims::book::Book;
use crate::claims::evidence::Evidence;
use crate::claims::groups;
use bitgrain_lab::summary::LARGE_OVERLAP;
use bitgrain_sim::files::bits;
use bitgrain_sim::format::{number_with_error, short};

/// What a table says as one self-contained HTML page, a pure function of it.
pub fn campaign_page(evidence: &Evidence) -> String {
    let mut book = Book::shipped();
    evidence.record(&mut book);
    let shown = &Shown {
        name: &evidence.by,
        beside: evidence.beside.as_ref(),
        table: &evidence.table,
        analysis: &evidence.analysis,
        book: &book,
    };
    let beside = claims::section(shown.book, shown.name, "");
    let flowing = evidence.summary.as_ref().filter(|one| one.inputs.flows());
    let bars = tanks::figures(shown);
    // Kumar's laws are of spheres.
    let mut out = if let Some(summary) = flowing {
        let groups = groups(summary);
        [
            scaling::section(summary, &groups),
            means::section(summary, &groups),
            beside,
            loads::section(summary, &groups),
        ]
        .concat()
    } else if !bars.is_empty() {
        bars + &beside
    } else {
        [
            drags::figures(shown),
            beside,
            near_field::figures(shown),
            yields::figures(shown),
            near_field::drifts(shown),
            fits(shown.analysis),
        ]
        .concat()
    };
    out.push_str(&beds::table(shown));
    out.push_str(&runs(shown));
    out.push_str(&repeat(shown));
    let top = Top {
        name: shown.name,
        kind: "Drags of many runs",
        style: "",
        lead: lead(shown),
        remarks: remarks(shown),
        about: about(shown),
    };
    assembled(&top, &out)
}

/// The remarks on the numbers.
fn remarks(shown: &Shown) -> Vec<String> {
    let (a, table) = (shown.analysis, shown.table);
    let mut out = Vec::new();
    if let Some(beside) = shown.beside.filter(|beside| beside.planned > a.rows) {
        let words = format!(
            "{} of {} runs are done; everything here is about these.",
            a.rows, beside.planned
        );
        out.push(remark("A part", &words));
    }
    let failed = (0..table.len()).filter(|&row| table.text(row, "status") != "done");
    out.extend(failed.map(|row| {
        let cell = |column| escape(table.text(row, column));
        let title = format!("{}/{} failed", cell("member"), cell("run"));
        remark(&title, &cell("reason"))
    }));
    if a.sliding > 0 {
        let n = a.sliding;
        let what = match a.plugs {
            true => "are included nevertheless (<code>--plugs</code>)",
            false => "are left out",
        };
        let words = format!(
            "In {n} runs the bed above the intruder slid along with it: their drag depends on the box as much as on \
             the intruder. They {what}."
        );
        out.push(remark("Plug flow", &words));
    }
    let rows = || 0..table.len();
    let open = rows().filter(|&row| table.text(row, "drag_converged") == "false");
    let (open, all) = (open.count(), table.len());
    if open > 0 {
        let words = format!(
            "In {open} of {all} runs the averaging window is too short for the error of the mean drag: it may be \
             larger than stated. Their points are hollow."
        );
        out.push(remark("Errors that did not converge", &words));
    }
    let soft = rows().filter(|&row| {
        let deepest = table.real(row, "overlap_max");
        deepest.is_some_and(|deepest| deepest > LARGE_OVERLAP)
    });
    let soft = soft.count();
    if soft > 0 {
        let words = format!(
            "In {soft} of {all} runs grains overlap by more than {LARGE_OVERLAP} of their diameter: too soft for \
             Hertz&rsquo;s law, which assumes narrow contacts, and forces may depend on the stiffness."
        );
        out.push(remark("Soft contacts", &words));
    }
    let started = rows().filter(|&row| {
        let read = |column| table.real(row, column);
        let all = read("drag_uncut").zip(read("drag")).zip(read("drag_error"));
        all.is_some_and(|((whole, cut), error)| (whole - cut).abs() > 2.0 * error)
    });
    let started = started.count();
    if started > 0 {
        let words = format!(
            "In {started} of {all} runs the mean drag from the start is more than two standard errors off that of the \
             averaging window. Before you compare, check which of the two means the other work reports: Kumar 2018 \
             averages from the start (Fig. 4)."
        );
        out.push(remark("Start-up", &words));
    }
    out
}

/// Where the numbers come from.
fn about(shown: &Shown) -> String {
    let mut out = row(
        "Made with",
        &format!("{}: the same bits on any machine", escape(&bits())),
    );
    if shown.beside.is_some() {
        out += &row(
            "Check it",
            "<code>bitgrain verify . --sample 3</code> in the folder of this page runs parts again and compares \
             every link; without <code>--sample</code> all of it",
        );
        out += &row(
            "Files",
            "<a href=\"results.csv\">results.csv</a>: a row for each run, with units; <code>results.parquet</code>: \
             the same; <code>members</code>: each run&rsquo;s own folder and report",
        );
    }
    out
}

/// What there is, in a paragraph.
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
        (n, true) => format!(" In {n} the bed above slid along; they are included nevertheless."),
        (n, false) => format!(" {n} are left out because the bed above slid along."),
    };
    format!(
        "<p class=\"lead\">Runs: {}{open}, in beds of {} grains; intruders of diameter {} at depths of {}, Froude \
         numbers {}, friction coefficients {}.{slid} Errors are standard errors; depths h are those of the \
         settled beds.</p>\n",
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
        escape(&describe(analysis))
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
        // Its report shows the flow round the intruder.
        Some((member, run)) if reports.iter().any(|own| own == member) => {
            let (member, run) = (escape(member), escape(run));
            format!("<a href=\"members/{member}/report.html\">{member}</a>/{run}")
        }
        _ => escape(name),
    };
    let row = |curve: &Curve, p: &Point| {
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            linked(&p.name),
            curve.material.mu,
            short(curve.diameter),
            short(p.depth),
            exact(p.froude),
            value(&p.drag),
            maybe(&p.uncut),
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
        .flat_map(|curve| curve.runs.iter().map(move |p| row(curve, p)))
        .collect();
    let length = escape(&shown.label("", "diameter"));
    let force = escape(&shown.label("", "drag"));
    format!(
        "<section>\n<h2>The runs</h2>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" \
         aria-label=\"Runs\"><table>\n<thead><tr><th scope=\"col\">Run</th><th scope=\"col\">&mu;</th>\
         <th scope=\"col\">D{length}</th><th scope=\"col\">h{length}</th><th scope=\"col\">Fr</th>\
         <th scope=\"col\">Drag{force}</th><th scope=\"col\">Drag, nothing cut</th>\
         <th scope=\"col\">Contact angle (rad)</th><th scope=\"col\">Plug \
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
