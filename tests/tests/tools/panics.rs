//! No panic can be reached through the kernel's public functions, whatever their input.

#![cfg(target_os = "linux")]

use std::collections::BTreeSet;

use bitgrain_tests::root;

use crate::machines::machine::rig_of_the_kernel;

/// The function that the rig's panic handler calls, and nobody defines.
const PANICS: &str = "a_panic_is_reachable";

/// The library of all public functions needs no panic handler; with one careless function more, it does.
#[test]
#[ignore = "a minute of a processor, to build all of the kernel twice: `.ci/run panics`"]
fn no_public_function_of_the_kernel_can_panic() {
    let [careless, _] = rig_of_the_kernel("control").unwrap();
    assert!(careless.contains(&PANICS.into()), "the check cannot fail");
    let [asked, offered] = rig_of_the_kernel("").unwrap();
    assert!(!asked.contains(&PANICS.into()), "a panic can be reached");
    let tables = std::fs::read_to_string(root().join("tests/rigs/panics/src/tables.rs")).unwrap();
    let tables = tables.lines().filter_map(|line| {
        let (name, _) = line.strip_prefix("pub static ")?.split_once(':')?;
        Some(name.to_string())
    });
    let tables: BTreeSet<String> = tables.collect();
    assert!(tables.len() > 15, "{tables:?}");
    let missing: Vec<_> = tables
        .difference(&offered.into_iter().collect())
        .cloned()
        .collect();
    assert!(missing.is_empty(), "not in the library: {missing:?}");
}

/// Names after `pub fn` or `pub const fn` in a source, before its tests.
fn public_functions(source: &str) -> BTreeSet<String> {
    let code = source.split("#[cfg(test)]\nmod tests").next().unwrap();
    let mut found = BTreeSet::new();
    for line in code.lines() {
        let line = line.trim_start();
        let name = ["pub fn ", "pub const fn "]
            .iter()
            .find_map(|begin| line.strip_prefix(begin));
        if let Some(name) = name {
            let end = name
                .find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap();
            found.insert(name[..end].to_string());
        }
    }
    found
}

/// The rig is complete: each public function of the kernel is named in it.
#[test]
fn the_rig_names_every_public_function() {
    let read = |name: &str| std::fs::read_to_string(root().join(name)).unwrap();
    let rig: String = ["bodies.rs", "calls.rs", "hosts.rs", "parts.rs", "state.rs"]
        .map(|file| read(&format!("tests/rigs/panics/src/{file}")))
        .concat();
    let words: BTreeSet<&str> = rig
        .split(|c: char| !c.is_alphanumeric() && c != '_')
        .collect();
    let mut count = 0;
    let folders = [
        "",
        "conformance",
        "contact",
        "digest",
        "edit",
        "forces",
        "math",
        "neighbors",
        "owners",
        "saved",
        "state",
    ];
    let folders = folders.map(|name| std::fs::read_dir(root().join("kernel/src").join(name)));
    for entry in folders.into_iter().flat_map(Result::unwrap) {
        let path = entry.unwrap().path();
        // These two are private, and what is public in them is seen by the kernel alone.
        let private = path.ends_with("block.rs") || path.ends_with("real.rs");
        if path.extension().is_none_or(|e| e != "rs") || private {
            continue;
        }
        for name in public_functions(&std::fs::read_to_string(&path).unwrap()) {
            assert!(
                words.contains(name.as_str()),
                "{name} of {}",
                path.display()
            );
            count += 1;
        }
    }
    assert!(count > 60, "{count}");
}
