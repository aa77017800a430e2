//! The table of what the papers say and what a run or a campaign measured of it.

use super::text::escape;
use crate::claims::Verdict;
use crate::claims::book::{Book, Claim, Measured};

/// The claims that the run or campaign of this name measured.
fn own<'a>(book: &'a Book, by: &str) -> Vec<(&'a Claim, &'a Measured)> {
    let measured = |claim: &'a Claim| Some((claim, claim.measured.iter().find(|m| m.by == by)?));
    book.claim.iter().filter_map(measured).collect()
}

/// How many of them have this verdict.
pub(super) fn count(book: &Book, by: &str, verdict: Verdict) -> usize {
    let own = own(book, by).into_iter();
    own.filter(|(claim, m)| claim.agreement(m) == verdict)
        .count()
}

/// A row for each claim that was measured by the run or campaign of this name.
pub(super) fn section(book: &Book, by: &str) -> String {
    let own = own(book, by);
    if own.is_empty() {
        return String::new();
    }
    let count = |wanted| count(book, by, wanted);
    let rows: String = own.iter().map(|(claim, m)| row(claim, m)).collect();
    format!(
        "<section>\n<h2>Beside the paper</h2>\n<p>{} statements agree, {} disagree, {} are not resolved by \
         these runs. A number agrees if it lies within the tolerance and its standard error is no larger than that, \
         and disagrees if it lies outside by more than two standard errors; a bound is kept by a standard error, \
         or broken by two.</p>\n<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Statements\">\
         <table class=\"statements\">\n<thead><tr><th scope=\"col\">Statement</th><th scope=\"col\">Verdict</th>\
         <th scope=\"col\">Paper</th><th scope=\"col\">Here</th><th scope=\"col\">From</th></tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table></div>\n</section>\n",
        count(Verdict::Agrees),
        count(Verdict::Disagrees),
        count(Verdict::NotResolved)
    )
}

fn row(claim: &Claim, measured: &Measured) -> String {
    let word = verdict_cell(claim.agreement(measured));
    format!(
        "<tr><th scope=\"row\"><b>{}</b><small>{}: {}</small></th><td>{word}</td><td>{}</td><td>{}</td>\
         <td>{}</td></tr>\n",
        escape(&claim.statement),
        escape(&claim.source),
        escape(&claim.measures),
        escape(&claim.expected()).replace("+-", "&plusmn;"),
        escape(&measured.number()),
        escape(&measured.note)
    )
}

/// A verdict, in bold if there is one.
fn verdict_cell(verdict: Verdict) -> String {
    match verdict {
        Verdict::NotResolved => verdict.text().to_owned(),
        _ => format!("<b>{}</b>", verdict.text()),
    }
}
