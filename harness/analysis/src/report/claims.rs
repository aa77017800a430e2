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

/// A row for each claim that was measured by the run or campaign of this name; `note` is added to the text about them.
pub(super) fn section(book: &Book, by: &str, note: &str) -> String {
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
         or broken by two. The worst of several numbers has to lie farther outside to break a claim. An agreement \
         that says how far it is off is within the tolerance, but off by more than three standard errors. A statement \
         that takes an assumption of ours is not contradicted.{note}</p>\n\
         <div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Statements\">\
         <table class=\"statements\">\n<thead><tr><th scope=\"col\">Statement</th><th scope=\"col\">Verdict</th>\
         <th scope=\"col\">Paper</th><th scope=\"col\">Here</th><th scope=\"col\">Off</th>\
         <th scope=\"col\">From</th></tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table></div>\n</section>\n",
        count(Verdict::Agrees),
        count(Verdict::Disagrees),
        count(Verdict::NotResolved)
    )
}

fn row(claim: &Claim, measured: &Measured) -> String {
    let word = verdict_cell(claim, measured);
    let off = measured.as_value().map(|value| claim.deviation_text(value));
    let assumes = claim.assumes.as_ref();
    let assumes = assumes.map_or(String::new(), |said| {
        let said = escape(said);
        format!("<small>Assumes, what the paper does not say: {said}</small>")
    });
    format!(
        "<tr><th scope=\"row\"><b>{}</b><small>{}: {}</small>{assumes}</th><td>{word}</td><td>{}</td><td>{}</td>\
         <td>{}</td><td>{}</td></tr>\n",
        escape(&claim.statement),
        escape(&claim.source),
        escape(&claim.measures),
        escape(&claim.expected()).replace("+-", "&plusmn;"),
        escape(&measured.number()),
        escape(&off.unwrap_or_default()),
        escape(&measured.note)
    )
}

/// A verdict, in bold if there is one.
fn verdict_cell(claim: &Claim, measured: &Measured) -> String {
    let Some(value) = measured.as_value() else {
        return Verdict::NotResolved.text().to_owned();
    };
    let words = claim.words(value, measured.of);
    match claim.agreement(measured) {
        Verdict::NotResolved => words,
        _ => format!("<b>{words}</b>"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::evidence::book_of_run;
    use crate::claims::synthetic::{self, Asked};

    /// A run has a row for each claim that it gives a number for, and no other.
    #[test]
    fn a_run_shows_the_claims_that_it_gives_numbers_for() {
        let run = synthetic::summary(&Asked::default());
        let book = book_of_run(&run);
        let page = section(&book, &run.scenario, " A note.");
        let rows = page.matches("<tr><th scope=\"row\">").count();
        let verdicts = [Verdict::Agrees, Verdict::Disagrees, Verdict::NotResolved];
        let counted = verdicts.map(|verdict| count(&book, &run.scenario, verdict));
        assert_eq!(rows, counted.iter().sum::<usize>());
        assert!((4..20).contains(&rows) && counted[0] >= 3, "{counted:?}");
        assert!(page.contains("A note.") && page.contains("hydrostatic pressure"));
        // C_d is made to be the paper's 10; half of it is not.
        let asked = Asked {
            drag_coefficient: 5.0,
            ..Asked::default()
        };
        let other = synthetic::summary(&asked);
        let book = book_of_run(&other);
        let agrees = count(&book, &other.scenario, Verdict::Agrees);
        assert!(agrees < counted[0], "{agrees}");
        let page = section(&book, &other.scenario, "");
        assert!(page.contains("<td>-50 %, -"), "{page}");
        assert_eq!(section(&Book::shipped(), "nobody", ""), "");
    }
}
