//! The book of claims: every number in it that was measured comes from a golden, and is reproduced.

use bitgrain::claims::Verdict;
use bitgrain::claims::book::{Book, table};
use bitgrain::claims::evidence::{DIRECT, Evidence, record_direct};
use bitgrain::disk::write_whole;
use bitgrain_tests::{golden, printed};

use crate::PROGRAM;

/// Goldens that the book's measurements come from.
const GOLDENS: [&str; 4] = [
    "guillard-small/summary.json",
    "guillard-medium/summary.json.gz",
    "kumar-small/results.csv.gz",
    "kumar-middle/results.csv.gz",
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
    assert_eq!(papers.iter().filter(|p| **p == "Kumar 2018").count(), 52);
    assert_eq!(papers.iter().filter(|p| **p == "Guillard 2014").count(), 26);
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
        let begin = format!("{:<13} {} ", claim.verdict().text(), claim.id);
        assert!(line.starts_with(&begin), "{line}");
        assert!(line.contains(&claim.expected()), "{line}");
    }
    let text = printed(PROGRAM, folder.path(), &["claims", "--full"], 0);
    assert_eq!(text, table(&book));
    for claim in &book.claim {
        assert_eq!(text.matches(&claim.statement).count(), 1, "{}", claim.id);
    }
    let count = |wanted| book.claim.iter().filter(|c| c.verdict() == wanted).count();
    let line = format!(
        "{} agree, {} disagree, {} are not resolved",
        count(Verdict::Agrees),
        count(Verdict::Disagrees),
        count(Verdict::NotResolved)
    );
    assert!(text.trim_end().ends_with(&line), "{line}");
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
