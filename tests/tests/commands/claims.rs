//! The book of claims: every number in it that was measured comes from a golden, and is reproduced.

use bitgrain::claims::book::Book;
use bitgrain::claims::evidence::{DIRECT, Evidence, record_direct};
use bitgrain::claims::{Verdict, table};
use bitgrain::disk::write_whole;
use bitgrain_tests::{golden, printed};

use crate::PROGRAM;

/// Goldens that the book's measurements come from.
const GOLDENS: [&str; 14] = [
    "guillard-small/summary.json",
    "guillard-medium/summary.json.gz",
    "guillard-axis/summary.json.gz",
    "guillard-deep/summary.json.gz",
    "guillard-cover/summary.json.gz",
    "guillard-centred/summary.json.gz",
    "guillard-wake/summary.json.gz",
    "guillard-tank-small/summary.json.gz",
    "guillard-tanks/results.csv.gz",
    "kumar-small/results.csv.gz",
    "kumar-middle/results.csv.gz",
    "kumar-table-1/results.csv.gz",
    "kumar-fig-5/results.csv.gz",
    "kumar-deep/results.csv.gz",
];

fn book() -> (Book, String) {
    let text = std::fs::read_to_string(golden("claims.toml")).unwrap();
    (Book::parse(&text, "golden/claims.toml").unwrap(), text)
}

/// The book is what its recipe makes from the goldens: with INSTA_UPDATE=always it is rewritten.
#[test]
fn what_was_measured_is_what_the_goldens_give() {
    let (mut book, before) = book();
    let written = book.clone();
    for claim in &mut book.claim {
        claim.measured.clear();
    }
    for name in GOLDENS {
        Evidence::read(&golden(name), false)
            .unwrap()
            .record(&mut book);
    }
    record_direct(&mut book);
    if std::env::var("INSTA_UPDATE").as_deref() == Ok("always") {
        // Atomically: other tests may be reading it.
        write_whole(&golden("claims.toml"), book.text(&before).as_bytes()).unwrap();
        return;
    }
    for (now, then) in book.claim.iter().zip(&written.claim) {
        assert_eq!(now, then);
    }
    // Every number of the book was measured on something.
    let measured = book.claim.iter().filter(|c| !c.measured.is_empty()).count();
    assert!(measured > 5, "{measured}");
}

/// Claims name their source and what they allow, and why.
#[test]
fn every_claim_can_be_checked() {
    let (book, _) = book();
    let papers: Vec<&str> = book.claim.iter().map(|c| &c.paper[..]).collect();
    assert_eq!(papers.iter().filter(|p| **p == "Kumar 2018").count(), 53);
    assert_eq!(papers.iter().filter(|p| **p == "Guillard 2014").count(), 34);
    let campaigns = bitgrain::campaign::SHIPPED.iter().map(|c| c.0);
    let plans: Vec<&str> = campaigns
        .chain(bitgrain::scenario::SHIPPED.iter().map(|s| s.0))
        .collect();
    for claim in &book.claim {
        for words in [&claim.source, &claim.statement, &claim.why, &claim.measures] {
            assert!(words.len() > 10, "{}: {words}", claim.id);
        }
        let place = ["section", "Fig", "eq", "Table", "abstract"];
        assert!(
            place.iter().any(|p| claim.source.contains(p)),
            "{}: {}",
            claim.id,
            claim.source
        );
        for by in &claim.tested_by {
            assert!(
                plans.contains(&&by[..]),
                "{}: no plan is called {by}",
                claim.id
            );
        }
        for measured in claim.measured.iter().filter(|m| m.by != DIRECT) {
            assert_eq!(measured.digest.len(), 64, "{}", claim.id);
        }
    }
}

/// The command prints each claim once, with its verdict: in a line, or in full.
#[test]
fn the_command_prints_the_book() {
    let folder = tempfile::tempdir().unwrap();
    let (book, _) = book();
    let short = printed(PROGRAM, folder.path(), &["claims"], 0);
    for (line, claim) in short.lines().skip(1).zip(&book.claim) {
        let whole = claim.combined();
        let words = whole.as_ref().map(|w| claim.words(w.value, w.of));
        let begin = format!(
            "{:<17} {} ",
            words.unwrap_or("not resolved".into()),
            claim.id
        );
        assert!(line.starts_with(&begin), "{line}");
        assert!(line.starts_with(claim.verdict().text()), "{line}");
        assert!(line.contains(&claim.expected()), "{line}");
        // From how many measurements it comes, and whose number it is.
        let said = match &whole {
            Some(w) if w.worst.is_none() && w.from.len() > 1 => {
                format!("mean of {} measurements", w.from.len())
            }
            Some(w) => w.worst.unwrap_or(w.from[0]).by.clone(),
            None => continue,
        };
        assert!(line.contains(&said), "{line}");
        let odd = whole.and_then(|w| w.odd);
        assert_eq!(line.contains("that disagree: "), odd.is_some(), "{line}");
        assert!(
            claim.follows_from.iter().all(|id| line.contains(id)),
            "{line}"
        );
    }
    let text = printed(PROGRAM, folder.path(), &["claims", "--full"], 0);
    assert_eq!(text, table(&book));
    for claim in &book.claim {
        assert_eq!(text.matches(&claim.statement).count(), 1, "{}", claim.id);
    }
    let verdicts = [Verdict::Agrees, Verdict::Disagrees, Verdict::NotResolved];
    let count = |roots: bool| {
        let own = book.claim.iter();
        let own = own.filter(|c| !roots || c.follows_from.is_empty());
        let own: Vec<Verdict> = own.map(|c| c.verdict()).collect();
        let of = verdicts.map(|wanted| own.iter().filter(|v| **v == wanted).count());
        (own.len(), of)
    };
    let (_, [agree, disagree, open]) = count(false);
    let (roots, [a, d, o]) = count(true);
    let line = format!(
        "{agree} agree, {disagree} disagree, {open} are not resolved.\nOf the {roots} that follow from no other: \
         {a} agree, {d} disagree, {o} are not resolved."
    );
    assert!(text.trim_end().ends_with(&line), "{line}");
    assert!(short.contains(&line), "{line}");
    // A user's own book is written to.
    let own = folder.path().join("own.toml");
    std::fs::copy(golden("claims.toml"), &own).unwrap();
    let table = golden("guillard-small/summary.json");
    let args = [
        "claims",
        table.to_str().unwrap(),
        "--book",
        own.to_str().unwrap(),
    ];
    printed(PROGRAM, folder.path(), &args, 0);
    let written = std::fs::read_to_string(&own).unwrap();
    assert_eq!(Book::parse(&written, "own").unwrap(), book);
}
