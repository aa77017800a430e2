//! What users' scripts and kept digests depend on: recipes of beds, resolved scenarios, and every key and header on
//! disk. A Rust name may change; these may not.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use bitgrain::bed::recipe::Recipe;
use bitgrain::scenario::{self, CheckedScenario};
use bitgrain::{campaign, scenario::parse};
use bitgrain_tests::root;
use serde_json::Value;

use crate::FURNISHED;

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(root().join("golden/formats"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description("cargo test -p bitgrain-tests --release --test commands formats::");
    settings.bind(|| insta::assert_snapshot!(name, text));
}

/// BLAKE3 of the text of a scenario, and of the recipe of each of its beds.
fn digests(name: &str, scenario: &CheckedScenario, out: &mut String) {
    let text = blake3::hash(scenario.to_toml().as_bytes()).to_hex();
    let _ = writeln!(out, "{name} {}", &text[..32]);
    for plan in scenario.beds() {
        let digest = Recipe::new(scenario, plan).digest();
        let _ = writeln!(out, "{name}/{} {}", plan.name, &digest[..32]);
    }
}

/// Texts of scenarios are inputs of keys, those of recipes name beds and begin chains.
#[test]
fn scenarios_and_recipes_keep_their_texts() {
    let mut out = String::new();
    for (name, text) in scenario::SHIPPED {
        let whole = parse(text, name, &[], &root()).unwrap();
        digests(name, &whole, &mut out);
    }
    for (name, _) in campaign::SHIPPED {
        let plan = campaign::load(name, &[]).unwrap();
        for member in &plan.members {
            digests(
                &format!("{name}/{}", member.name),
                &member.scenario,
                &mut out,
            );
        }
    }
    let quick = scenario::load("quick", &[]).unwrap();
    let recipe = Recipe::new(&quick, &quick.beds()[0]).text();
    snapshot("recipes", &format!("{out}\nrecipe of quick:\n{recipe}"));
}

/// Paths of all keys of a JSON value; those of lists end in `[]`, and names of parts are one.
fn json_keys(value: &Value, path: &str, out: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, inner) in map {
                json_keys(inner, &format!("{path}.{key}"), out);
            }
        }
        Value::Array(list) => {
            for inner in list {
                json_keys(inner, &format!("{path}[]"), out);
            }
        }
        _ => {
            out.insert(path.to_string());
        }
    }
}

/// Paths of all keys of a TOML table.
fn toml_keys(table: &toml::Table, path: &str, out: &mut BTreeSet<String>) {
    for (key, value) in table {
        match value {
            toml::Value::Table(inner) => toml_keys(inner, &format!("{path}.{key}"), out),
            _ => {
                out.insert(format!("{path}.{key}"));
            }
        }
    }
}

/// The name of a file without its numbers, so that files of one kind are one.
fn kind(name: &str) -> String {
    let letters = name
        .chars()
        .map(|c| if c.is_ascii_digit() { '#' } else { c });
    let mut text: String = letters.collect();
    while text.contains("##") {
        text = text.replace("##", "#");
    }
    text
}

/// The signature of a file: its keys, or its head.
fn head(name: &str, bytes: &[u8]) -> BTreeSet<String> {
    let mut keys = BTreeSet::new();
    let text = String::from_utf8_lossy(bytes);
    match name.rsplit('.').next() {
        Some("json") => json_keys(&serde_json::from_slice(bytes).unwrap(), "", &mut keys),
        Some("toml") => toml_keys(&text.parse().unwrap(), "", &mut keys),
        Some("csv") => keys.extend(
            text.lines()
                .find(|line| !line.starts_with('#'))
                .map(String::from),
        ),
        Some("dump") => keys.extend(
            text.lines()
                .filter(|line| line.starts_with("ITEM:"))
                .map(String::from),
        ),
        Some("vtk") => keys.extend(
            text.lines()
                .filter(|line| line.starts_with(char::is_uppercase))
                .map(kind),
        ),
        Some("safetensors") => {
            let length = u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
            let outer: Value = serde_json::from_slice(&bytes[8..8 + length]).unwrap();
            keys.extend(outer.as_object().unwrap().keys().cloned());
            let text = outer["__metadata__"]["bitgrain"].as_str().unwrap();
            json_keys(&serde_json::from_str(text).unwrap(), "", &mut keys);
            let course = outer["course"]["data_offsets"].as_array().unwrap();
            let [from, to] = [0, 1].map(|k| course[k].as_u64().unwrap() as usize + 8 + length);
            json_keys(
                &serde_json::from_slice(&bytes[from..to]).unwrap(),
                "course",
                &mut keys,
            );
        }
        _ => {}
    }
    keys
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn files_keep_their_keys_and_headers() {
    let mut kinds: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for folder in ["run", "camp"] {
        for (name, bytes) in FURNISHED.files(folder) {
            let kind = kind(&format!("{folder}/{name}"));
            kinds.entry(kind).or_default().extend(head(&name, &bytes));
        }
    }
    let mut text = String::new();
    for (kind, keys) in kinds.iter().filter(|(_, keys)| !keys.is_empty()) {
        let _ = writeln!(text, "{kind}");
        for key in keys {
            let _ = writeln!(text, "    {key}");
        }
    }
    snapshot("files", &text);
}
