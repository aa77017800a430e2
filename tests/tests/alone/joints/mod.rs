//! Whatever of a scenario may be chosen together works together: it runs, is interrupted and goes on, verifies and has
//! the same bytes on one thread and on three; or a sentence refuses it before anything is written, which the guide
//! quotes.
//!
//! A failure prints the line that tries it again, which is also how one combination is tried:
//! `JOINTS='OPTION + OPTION' cargo test --workspace --release --test alone joints::`.

mod cover;
mod options;
mod ways;

use bitgrain::bed::library::BedCache;
use bitgrain_tests::root;

use crate::alone;
use cover::{covering, options, pair, replay, table, verdicts};
use options::{CHOICES, Choice, named};
use ways::ask;

/// Draws the order in which choices are tried.
const SEED: u64 = 1;

/// Runs combinations, and tells all that do not hold.
fn hold(all: &[Vec<&Choice>]) {
    let beds = tempfile::tempdir().unwrap();
    let library = BedCache::new(beds.path().to_path_buf());
    let (mut wrong, mut stops) = (Vec::new(), 0);
    for choices in all {
        let held = match ask(choices) {
            Ok(asked) => asked.holds(&library),
            Err(why) => Err(format!("refused: {why}")),
        };
        match held {
            Ok(often) => stops += often,
            Err(why) => {
                let why = why.replace('\n', " ");
                println!("{why}\n    {}", replay(choices));
                wrong.push(why);
            }
        }
    }
    println!("{} run, {stops} interruptions", all.len());
    assert!(
        wrong.is_empty(),
        "{} of {} do not hold",
        wrong.len(),
        all.len()
    );
    // A bed from a file has none to be interrupted.
    assert!(
        2 * stops >= all.len(),
        "{stops} interruptions of {} runs",
        all.len()
    );
}

/// The combination that the environment asks for.
fn wanted() -> Option<Vec<&'static Choice>> {
    std::env::var("JOINTS").ok().map(|names| named(&names))
}

/// Combinations that together hold all pairs of options which are not refused, but for as many of them as are spared.
fn combinations(spared: impl Fn(usize) -> usize) -> Vec<Vec<&'static Choice>> {
    let verdicts = verdicts();
    let mut left: Vec<(usize, usize)> = verdicts.keys().copied().collect();
    left.retain(|pair| verdicts[pair].is_none());
    let spared = spared(left.len());
    let mut chosen = Vec::new();
    for taken in covering(&verdicts, SEED) {
        if left.len() <= spared {
            break;
        }
        left.retain(|(a, b)| !(taken.contains(a) && taken.contains(b)));
        chosen.push(taken.iter().map(|k| &CHOICES[*k]).collect());
    }
    chosen
}

/// Three quarters of all pairs, which the first of the combinations hold: the others bring a few each.
#[test]
#[cfg_attr(debug_assertions, ignore = "half a minute in release")]
fn most_pairs_hold_in_a_few_combinations() {
    let _alone = alone();
    hold(&combinations(|pairs| pairs / 4));
}

/// Every pair of options in at least one combination of many.
#[test]
#[ignore = "two minutes of a processor"]
fn every_pair_holds_in_a_combination_of_many() {
    let _alone = alone();
    match wanted() {
        Some(choices) => hold(&[choices]),
        None => hold(&combinations(|_| 0)),
    }
}

/// Every pair of options by itself, and every option alone.
#[test]
#[ignore = "twenty minutes of a processor"]
fn every_pair_holds_alone() {
    let _alone = alone();
    if wanted().is_some() {
        return;
    }
    let verdicts = verdicts();
    let runs = verdicts.iter().filter(|(_, why)| why.is_none());
    hold(&runs.map(|(ab, _)| pair(*ab)).collect::<Vec<_>>());
}

/// What is refused and why is what the guide says; `INSTA_UPDATE=always` writes the page's table anew.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: a second in release")]
fn the_guide_says_what_is_refused() {
    let _alone = alone();
    let path = root().join("harness/guide/src/combinations.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (head, rest) = page.split_once("<!-- made by a test -->\n").unwrap();
    let (_, tail) = rest.split_once("<!-- until here -->\n").unwrap();
    let made = format!("{}\n{}", table(&verdicts()), options());
    let want = format!("{head}<!-- made by a test -->\n{made}<!-- until here -->\n{tail}");
    if std::env::var("INSTA_UPDATE").is_ok_and(|how| how == "always") {
        std::fs::write(&path, &want).unwrap();
    }
    assert!(page == want, "{} is to say:\n{made}", path.display());
}
