//! The README's second command builds nothing of its first command once more.

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

use bitgrain_tests::root;
use serde_json::Value;

/// What a cargo command would build, each unit with all that makes it another one for cargo: package, target, mode,
/// platform, features, profile, and the units that it depends on.
fn units(arguments: &[&str]) -> BTreeMap<String, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| env!("CARGO").into());
    let out = Command::new(cargo)
        .args(arguments)
        .args(["--offline", "--unit-graph", "-Zunstable-options"])
        .current_dir(root())
        // The stable cargo tells it so.
        .env("RUSTC_BOOTSTRAP", "1")
        .output()
        .expect("cargo starts");
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    let graph: Value = serde_json::from_slice(&out.stdout).expect("a graph of units");
    let units = graph["units"].as_array().expect("units");
    let mut keys: Vec<Option<String>> = vec![None; units.len()];
    (0..units.len())
        .map(|unit| (key(unit, units, &mut keys), name(&units[unit])))
        .collect()
}

/// A unit and all below it, as a digest.
fn key(unit: usize, units: &[Value], keys: &mut Vec<Option<String>>) -> String {
    if let Some(key) = &keys[unit] {
        return key.clone();
    }
    let whole = &units[unit];
    let below = whole["dependencies"].as_array().expect("dependencies");
    let below = below
        .iter()
        .map(|one| one["index"].as_u64().expect("a place") as usize);
    let below: BTreeSet<String> = below.map(|one| key(one, units, keys)).collect();
    let own = [
        "pkg_id", "target", "profile", "platform", "mode", "features",
    ];
    let own = own.map(|what| whole[what].to_string());
    let key = blake3::hash(format!("{own:?} {below:?}").as_bytes()).to_string();
    keys[unit] = Some(key.clone());
    key
}

/// For people.
fn name(unit: &Value) -> String {
    let package = unit["pkg_id"].as_str().unwrap_or_default();
    let package = package.rsplit('#').next().unwrap_or_default();
    let [kind, features] = [&unit["target"]["kind"], &unit["features"]];
    format!("{package} {kind} {} {features}", unit["mode"])
}

#[test]
fn the_second_command_builds_nothing_of_the_first_again() {
    let first = units(&["build", "--release"]);
    let second = units(&["test", "--workspace", "--release", "--no-run"]);
    let again = first.iter().filter(|(key, _)| !second.contains_key(*key));
    // Of the command's own program there is another one for tests.
    let again = again
        .map(|(_, name)| name)
        .filter(|name| !name.contains("[\"bin\"]"));
    let again: Vec<&String> = again.collect();
    assert!(
        again.is_empty(),
        "the tests ask for other features of these, or of what they need; ask for the same in harness/Cargo.toml: \
         {again:#?}"
    );
    assert!(first.len() > 100 && second.len() > first.len());
}

/// Crates that take long to build, and that a first run does not need. `cargo tree --invert` says by way of whom one
/// comes.
#[test]
fn the_first_command_needs_no_dear_crate() {
    let first = units(&["build", "--release"]);
    let count = |package: &str| {
        first
            .values()
            .filter(|name| name.starts_with(package))
            .count()
    };
    // `half` asks for it from its version 2.5 on: the lock file has an earlier one.
    assert_eq!(count("zerocopy-derive@"), 0);
    assert_eq!(count("parquet@") + count("criterion@"), 0);
    // Macros are read by one version of it, built once.
    assert_eq!(count("syn@"), 1, "{first:#?}");
}
