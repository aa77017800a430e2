//! The book of claims as text: in a line for each claim, or in full.

use super::book::{Book, Claim, shown};
use super::combine::{Combined, Odd};
use super::verdict::Verdict;

/// The book in a line for each claim: verdict, name, the paper's number, ours, how far apart they are, and what
/// measured it.
pub fn lines(book: &Book) -> String {
    let row = |cells: [&str; 7]| {
        let [verdict, id, paper, ours, percent, errors, by] = cells;
        let line =
            format!("{verdict:<17} {id:<31} {paper:<26} {ours:<17} {percent:>7} {errors:>7}  {by}");
        line.trim_end().to_string()
    };
    let mut out = vec![row([
        "verdict", "claim", "paper", "measured", "off", "errors", "by",
    ])];
    for claim in &book.claim {
        let whole = claim.combined();
        let words = claim.verdict_words();
        let (ours, [percent, errors]) = match &whole {
            Some(w) => (shown(w.value), claim.deviation(w.value)),
            None => ("-".into(), ["-".into(), "-".into()]),
        };
        let mut by: Vec<String> = whole.iter().map(origin).collect();
        by.extend(roots(claim));
        by.extend(claim.assumes.is_some().then(|| "with an assumption".into()));
        out.push(row([
            &words,
            &claim.id,
            &claim.expected(),
            &ours,
            &percent,
            &errors,
            &by.join("; "),
        ]));
    }
    out.push(format!(
        "\n{}\nA number agrees if it lies within the paper's tolerance and its error is no larger. `off` is its \
         distance from the paper's\nnumber, `errors` the same in its own standard errors; \"agrees, 23 % off\" is \
         within the tolerance, but off by more than\nthree errors. Several measurements count as their mean, or as \
         the worst of them where a claim must hold for each.\nA claim held \"with an assumption\" that the paper \
         does not make can agree, but not disagree.\n--full says what each claim is, from where, and every \
         measurement of it.",
        counts(book)
    ));
    out.join("\n") + "\n"
}

/// How many claims of each verdict there are, and how many independent numbers.
fn counts(book: &Book) -> String {
    let count = |independent: bool, wanted: Verdict| {
        let own = book.claim.iter();
        own.filter(|claim| !independent || claim.follows_from.is_empty())
            .filter(|claim| claim.verdict() == wanted)
            .count()
    };
    let verdicts = [Verdict::Agrees, Verdict::Disagrees, Verdict::NotResolved];
    let [agree, disagree, open] = verdicts.map(|verdict| count(false, verdict));
    let [a, d, o] = verdicts.map(|verdict| count(true, verdict));
    format!(
        "{agree} agree, {disagree} disagree, {open} are not resolved.\nOf the {} that follow from no other: {a} agree, \
         {d} disagree, {o} are not resolved.",
        a + d + o
    )
}

/// What a number comes from, in a few words.
fn origin(whole: &Combined) -> String {
    let count = whole.from.len();
    match (whole.worst, &whole.from[..]) {
        (None, [only]) => only.by.clone(),
        (None, _) => match &whole.odd {
            Some(odd) => format!("mean of {count} measurements that disagree: {}", said(odd)),
            None => format!("mean of {count} measurements"),
        },
        (Some(worst), _) if whole.of == 1 => worst.by.clone(),
        (Some(worst), [_]) => format!("{}, worst of {}", worst.by, whole.of),
        (Some(worst), _) => format!(
            "{}, worst of {} in {count} measurements",
            worst.by, whole.of
        ),
    }
}

/// Which measurement disagrees with the others, and how far.
fn said(odd: &Odd) -> String {
    let chance = match odd.chance < 0.001 {
        true => "p < 0.001".to_owned(),
        false => format!("p = {:.3}", odd.chance),
    };
    let by = &odd.measured.by;
    format!("{by} lies {:.1} errors off ({chance})", odd.errors)
}

/// Which claims this one's number follows from.
fn roots(claim: &Claim) -> Option<String> {
    let ids = &claim.follows_from;
    (!ids.is_empty()).then(|| format!("follows from {}", ids.join(" and ")))
}

/// The book in full: verdict, statement, what is measured, the paper's number, all of ours together and every one.
pub fn table(book: &Book) -> String {
    let mut lines = Vec::new();
    let mut paper = "";
    for claim in &book.claim {
        if claim.paper != paper {
            paper = &claim.paper;
            lines.push(format!("\n{paper}"));
        }
        let indented = |text: String| format!("{:<17} {text}", "");
        let whole = claim.combined();
        let words = claim.verdict_words();
        lines.push(format!(
            "{words:<17} {} ({})",
            claim.statement, claim.source
        ));
        lines.push(indented(format!(
            "{}: {}",
            claim.measures,
            claim.expected()
        )));
        lines.extend(roots(claim).map(indented));
        let assumes = claim.assumes.as_ref();
        lines.extend(
            assumes.map(|said| indented(format!("assumes, what the paper does not say: {said}"))),
        );
        if let Some(w) = whole.filter(|w| w.from.len() > 1) {
            let off = claim.deviation_text(w.value);
            let off = if off.is_empty() {
                off
            } else {
                format!(" ({off})")
            };
            lines.push(indented(format!(
                "together: {}{off}; {}",
                shown(w.value),
                origin(&w)
            )));
        }
        for measured in &claim.measured {
            let said = match measured.as_value() {
                Some(value) => {
                    let off = claim.deviation_text(value);
                    let off = if off.is_empty() {
                        off
                    } else {
                        format!(" ({off})")
                    };
                    let words = claim.words(value, measured.of);
                    format!("{}{off}, {words}", measured.number())
                }
                None => format!("-, {}", Verdict::NotResolved.text()),
            };
            lines.push(indented(format!(
                "{}: {said}; {}",
                measured.by, measured.note
            )));
        }
        if claim.measured.is_empty() {
            lines.push(indented("nothing was measured".into()));
        }
    }
    lines.push(format!("\n{}", counts(book)));
    lines.join("\n").trim_start().to_string() + "\n"
}
