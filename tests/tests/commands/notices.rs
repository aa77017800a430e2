//! The notices beside the command and the live page name the crates that these link, and no others.
#![cfg(target_os = "linux")]

use bitgrain_tests::notices::{COMMAND, PAGE, Product, linked, text};
use bitgrain_tests::root;

const RECIPE: &str =
    "`cargo run -p bitgrain-tests --bin notices` rewrites it, with `-- page` that of the page";

#[test]
fn notices_name_what_is_linked() {
    check(&COMMAND, 50);
    check(&PAGE, 30);
}

/// Looks at the notices of a product that links at least so many crates.
fn check(product: &Product, least: usize) {
    let written = std::fs::read_to_string(root().join(product.file)).expect(RECIPE);
    let rows = written
        .lines()
        .filter(|line| line.starts_with("| "))
        .skip(2);
    let rows: Vec<String> = rows.map(str::to_string).collect();
    let linked = linked(product);
    assert!(linked.len() > least);
    let expected: Vec<String> = linked
        .iter()
        .map(|l| format!("| {} | {} | {} |", l.name, l.version, l.licence))
        .collect();
    assert_eq!(rows, expected, "{RECIPE}");
    // Every one has a text, or shares one.
    let heads: Vec<&str> = written
        .lines()
        .filter_map(|line| line.strip_prefix("## "))
        .collect();
    for l in &linked {
        let own = format!("{} {}", l.name, l.version);
        let has = |head: &&&str| head.split(", ").any(|word| word == own);
        assert!(heads.iter().any(|head| has(&head)), "{own}: {RECIPE}");
    }
    assert_eq!(written, text(product), "{RECIPE}");
}
