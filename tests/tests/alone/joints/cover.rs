//! Which choices go together, and few combinations of many choices that hold every pair which does.

use std::collections::BTreeMap;

use bitgrain::random::{Purpose, uniforms};

use super::options::{CHOICES, Choice, names};
use super::ways::ask;

/// Every pair of choices of two axes, and every choice alone (as a pair with itself): what a refusal says.
pub type Verdicts = BTreeMap<(usize, usize), Option<String>>;

/// Asks for every pair.
pub fn verdicts() -> Verdicts {
    let mut found = Verdicts::new();
    for a in 0..CHOICES.len() {
        for b in a..CHOICES.len() {
            if a == b || CHOICES[a].axis != CHOICES[b].axis {
                found.insert((a, b), ask(&pair((a, b))).err());
            }
        }
    }
    found
}

/// The choices of a pair.
pub fn pair((a, b): (usize, usize)) -> Vec<&'static Choice> {
    let mut pair = vec![&CHOICES[a], &CHOICES[b]];
    pair.dedup_by_key(|choice| choice.name);
    pair
}

/// Combinations that hold every pair that is not refused: each begins with a pair that is in none yet, and takes from
/// the other choices, in an order that the seed draws, each that brings a new pair and is not refused with the rest. It
/// gets no more drags than the pair has: choices that make several multiply.
pub fn covering(verdicts: &Verdicts, seed: u64) -> Vec<Vec<usize>> {
    let runs = |pair: &&(usize, usize)| verdicts[*pair].is_none();
    let mut left: Vec<(usize, usize)> = verdicts.keys().filter(runs).copied().collect();
    let mut all = Vec::new();
    while let Some(&(a, b)) = left.first() {
        let mut taken = vec![a, b];
        taken.dedup();
        let drags = ask(&pair((a, b))).map_or(0, |asked| asked.drags());
        let count = all.len() as u32 * CHOICES.len() as u32;
        let mut order: Vec<usize> = (0..CHOICES.len()).collect();
        order.sort_by(|x, y| {
            let drawn = |k: usize| uniforms::<1>(seed, Purpose::Sample, count + k as u32)[0];
            drawn(*x).total_cmp(&drawn(*y))
        });
        for next in order {
            let with = |k: &usize| ((*k).min(next), (*k).max(next));
            let brings = taken.iter().any(|k| left.contains(&with(k)));
            let goes = |k: &usize| verdicts.get(&with(k)).is_some_and(Option::is_none);
            if taken.contains(&next) || !brings || !taken.iter().all(goes) {
                continue;
            }
            let mut more = taken.clone();
            more.push(next);
            more.sort_unstable();
            let choices: Vec<&Choice> = more.iter().map(|k| &CHOICES[*k]).collect();
            if let Ok(asked) = ask(&choices)
                && (asked.drags() == 1 || asked.drags() <= drags)
            {
                taken = more;
            }
        }
        left.retain(|(a, b)| !(taken.contains(a) && taken.contains(b)));
        all.push(taken);
    }
    all
}

/// The part of the guide that the verdicts make: a row for each choice that others are refused with.
pub fn table(verdicts: &Verdicts) -> String {
    let pairs = verdicts.iter().filter(|((a, b), _)| a != b);
    let refused: Vec<_> = pairs
        .clone()
        .filter_map(|(pair, why)| Some((*pair, why.as_deref()?)))
        .collect();
    let (all, no) = (pairs.count(), refused.len());
    let mut text = format!(
        "Of {all} pairs of the {} options below {} are taken and {no} are refused.\n\n| option | not with | because |\n\
         | --- | --- | --- |\n",
        CHOICES.len(),
        all - no,
    );
    // The option that is refused more often has the row; options that are refused alike share one.
    let count = |k: usize| {
        refused
            .iter()
            .filter(|((a, b), _)| *a == k || *b == k)
            .count()
    };
    let mut rows: BTreeMap<(usize, &str), Vec<&str>> = BTreeMap::new();
    for ((a, b), why) in &refused {
        let (row, other) = match count(*b) > count(*a) {
            true => (*b, *a),
            false => (*a, *b),
        };
        rows.entry((row, why))
            .or_default()
            .push(CHOICES[other].name);
    }
    let mut shared: Vec<(Vec<&str>, Vec<&str>, &str)> = Vec::new();
    for ((row, why), others) in rows {
        let alike = shared
            .iter_mut()
            .find(|row| row.1 == others && row.2 == why);
        match alike {
            Some(alike) => alike.0.push(CHOICES[row].name),
            None => shared.push((vec![CHOICES[row].name], others, why)),
        }
    }
    for (row, others, why) in shared {
        let [row, others] = [row, others].map(|names| names.join("; "));
        text += &format!("| {row} | {others} | {} |\n", why.replace('|', "\\|"));
    }
    text
}

/// The options by axis, those that go together with all others among them.
pub fn options() -> String {
    let mut text = String::new();
    for choice in &CHOICES {
        let first = CHOICES.iter().find(|c| c.axis == choice.axis);
        text += match std::ptr::eq(first.unwrap(), choice) {
            true => "\n* ",
            false => "; ",
        };
        text += choice.name;
    }
    text.trim_start().to_string() + "\n"
}

/// How a combination is tried again.
pub fn replay(choices: &[&Choice]) -> String {
    format!(
        "JOINTS='{}' cargo test --workspace --release --test alone joints:: -- --include-ignored",
        names(choices)
    )
}
