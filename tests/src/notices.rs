//! Notices of the crates that are linked into the command, the Python package or the live page: names, versions,
//! licences, and the texts of these.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use crate::root;

const LINUX: &str = "x86_64-unknown-linux-gnu";

/// What crates are linked into.
#[derive(Clone, Copy, Debug)]
pub struct Product {
    /// Where its notices lie, from the repository's root.
    pub file: &'static str,
    /// What the notices call it.
    name: &'static str,
    /// The manifest of its workspace, and its package there.
    manifest: &'static str,
    package: &'static str,
    /// The argument of the program `notices` that chooses it.
    argument: &'static str,
    /// The system that the crates are linked for: others need a few others.
    target: &'static str,
}

/// The command.
pub const COMMAND: Product = Product {
    file: "harness/THIRD-PARTY.md",
    name: "`bitgrain`",
    manifest: "Cargo.toml",
    package: "bitgrain",
    argument: "",
    target: LINUX,
};

/// The Python package.
pub const PYTHON: Product = Product {
    file: "harness/python/THIRD-PARTY.md",
    name: "the Python package `bitgrain`",
    manifest: "harness/python/Cargo.toml",
    package: "bitgrain-python",
    argument: " -- python",
    target: LINUX,
};

/// The live page.
pub const PAGE: Product = Product {
    file: "harness/page/THIRD-PARTY.md",
    name: "the live page of `bitgrain`",
    manifest: "harness/page/Cargo.toml",
    package: "bitgrain-page",
    argument: " -- page",
    target: "wasm32-unknown-unknown",
};

/// A crate that is linked into a product.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Linked {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Its licences, as it states them.
    pub licence: String,
}

fn cargo(args: &[&str]) -> String {
    let cargo = std::env::var("CARGO").unwrap_or("cargo".into());
    let out = Command::new(cargo)
        .args(args)
        .args(["--offline", "--locked"])
        .current_dir(root())
        .output()
        .expect("cargo starts");
    let told = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{args:?}: {told}");
    String::from_utf8(out.stdout).expect("cargo prints text")
}

/// The foreign crates that a product links: not those that only build it or test it. From `Cargo.lock`, without
/// a network.
pub fn linked(product: &Product) -> Vec<Linked> {
    let tree = "tree -e normal,no-proc-macro --prefix none --format {p}|{l} --target";
    let own = ["-p", product.package, "--manifest-path", product.manifest];
    let args: Vec<&str> = tree.split(' ').chain([product.target]).chain(own).collect();
    let mut found = BTreeSet::new();
    for line in cargo(&args).lines() {
        let line = line.trim_end_matches(" (*)");
        let (package, licence) = line.split_once('|').expect("a package and its licence");
        let mut words = package.split(' ');
        let (name, version) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
        // Our own crates have a path behind their version.
        if words.next().is_none() {
            found.insert(Linked {
                name: name.into(),
                version: version.trim_start_matches('v').into(),
                licence: licence.replace('/', " OR "),
            });
        }
    }
    found.into_iter().collect()
}

/// The folder of each package in Cargo's store, by name and version.
fn folders(product: &Product) -> BTreeMap<(String, String), PathBuf> {
    let metadata = cargo(&[
        "metadata",
        "--format-version",
        "1",
        "--filter-platform",
        product.target,
        "--manifest-path",
        product.manifest,
    ]);
    let metadata: Value = serde_json::from_str(&metadata).expect("cargo prints JSON");
    let packages = metadata["packages"].as_array().expect("a list").iter();
    let word = |package: &Value, key: &str| package[key].as_str().unwrap_or("").to_string();
    let folder = |path: String| {
        Path::new(&path)
            .parent()
            .unwrap_or(Path::new(""))
            .to_path_buf()
    };
    packages
        .map(|p| {
            (
                (word(p, "name"), word(p, "version")),
                folder(word(p, "manifest_path")),
            )
        })
        .collect()
}

/// The licence texts in a folder. Of several to choose from it is the MIT licence alone, if that is among them.
fn texts(folder: &Path, licence: &str) -> Vec<String> {
    let files = std::fs::read_dir(folder).expect("cargo has the sources of what it built");
    let mut names: Vec<String> = files
        .flatten()
        .filter(|file| file.path().is_file())
        .map(|file| file.file_name().to_string_lossy().into_owned())
        .filter(|name| {
            let name = name.to_uppercase();
            let kinds = [
                "LICENSE",
                "LICENCE",
                "COPYING",
                "NOTICE",
                "UNLICENSE",
                "COPYRIGHT",
            ];
            kinds.iter().any(|kind| name.starts_with(kind))
        })
        .collect();
    names.sort();
    let mit = names.iter().any(|name| name.to_uppercase().contains("MIT"));
    if mit && licence.contains(" OR ") {
        names.retain(|name| {
            let name = name.to_uppercase();
            name.contains("MIT") || name.starts_with("NOTICE")
        });
    }
    let read = |name: &String| std::fs::read_to_string(folder.join(name)).unwrap_or_default();
    let line = |text: String| -> String {
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        lines.join("\n").trim_matches('\n').to_string()
    };
    names
        .iter()
        .map(read)
        .map(line)
        .filter(|text| !text.is_empty())
        .collect()
}

/// The notices: a table of the crates, and each text once with the crates that have it.
pub fn text(product: &Product) -> String {
    let (linked, folders) = (linked(product), folders(product));
    let Product {
        name,
        argument,
        target,
        ..
    } = product;
    let mut out = format!(
        "# Third-party notices\n\nCrates linked into {name} for {target}, with what they are licensed under, and \
         the texts of these licences. The Rust standard library is linked too (MIT OR Apache-2.0). Written by \
         `cargo run -p bitgrain-tests --bin notices{argument}`.\n\n| crate | version | licence |\n| --- | --- | --- |\n"
    );
    let mut by_text: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let own = |file: &str| std::fs::read_to_string(root().join(file)).unwrap_or_default();
    let apache = own("LICENSE-APACHE");
    let mit = own("LICENSE-MIT");
    let mit: Vec<&str> = mit
        .lines()
        .filter(|line| !line.contains("Copyright (c)"))
        .collect();
    for Linked {
        name,
        version,
        licence,
    } in &linked
    {
        let _ = writeln!(out, "| {name} | {version} | {licence} |");
        let mut found = folders
            .get(&(name.clone(), version.clone()))
            .map_or(Vec::new(), |folder| texts(folder, licence));
        if found.is_empty() && licence.contains("Apache-2.0") {
            // It brings no text; that of this licence is the same everywhere.
            found.push(apache.trim_matches('\n').to_string());
        }
        if found.is_empty() && licence == "MIT" {
            // Its authors left out text and year.
            let text = mit.join("\n");
            found.push(format!(
                "Copyright (c) the authors of {name}\n\n{}",
                text.trim_matches('\n')
            ));
        }
        assert!(
            !found.is_empty(),
            "{name} {version} brings no text of {licence}"
        );
        for text in found {
            by_text
                .entry(text)
                .or_default()
                .push(format!("{name} {version}"));
        }
    }
    let mut all: Vec<(Vec<String>, String)> = by_text.into_iter().map(|(t, c)| (c, t)).collect();
    all.sort();
    for (crates, text) in all {
        let text = text.replace("```", "'''");
        let _ = write!(out, "\n## {}\n\n```text\n{text}\n```\n", crates.join(", "));
    }
    out
}
