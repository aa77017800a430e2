//! The tests of kernel and `sim` catch what they should: each named mutant is one wrong piece of
//! source, and the tests named beside it must fail on it, while the unchanged copy passes.
//!
//! Kernel and `sim` are copied into a folder of their own with a workspace that builds fast; the build is kept in
//! `target/mutants`.

mod bodies;
mod keeping;
mod list;
mod materials;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use bodies::BODIES;
use keeping::KEEPING;
use list::{MUTANTS, Mutant, SIM, UNIT};
use materials::MATERIALS;

/// A workspace with what the manifests take from their own, built fast: a little
/// optimisation, as the tests step whole worlds, and no debug information.
const WORKSPACE: &str = r#"
[workspace]
resolver = "3"
members = ["kernel", "harness/sim"]

[workspace.package]
version = "0.1.0"
edition = "2024"
rust-version = "1.95"
license = "MIT OR Apache-2.0"
publish = false

[workspace.lints.rust]
unsafe_code = "deny"
unexpected_cfgs = { level = "warn", check-cfg = ["cfg(bitgrain_negative_control)"] }

[profile.dev]
opt-level = 1
debug = false
debug-assertions = true
"#;

const KERNEL: &str = "bitgrain-kernel";

fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a new folder");
    for entry in fs::read_dir(from).expect("a folder of the kernel") {
        let entry = entry.expect("a readable entry");
        let (path, copy) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy_folder(&path, &copy);
        } else {
            // Rewritten rather than copied, so that it is newer than what was built before.
            let text = fs::read(&path).expect("a readable file");
            fs::write(copy, text).expect("a new file");
        }
    }
}

/// Both crates in their own workspace.
struct Copy {
    folder: PathBuf,
    build: PathBuf,
}

impl Copy {
    fn new() -> Self {
        let root = bitgrain_tests::root();
        let tmp = Path::new(env!("CARGO_TARGET_TMPDIR"));
        let build = tmp.parent().expect("it lies in target").join("mutants");
        // Always at one place: to cargo a package elsewhere is another, and is built beside the old.
        let folder = build.join("source");
        let _ = fs::remove_dir_all(&folder);
        for part in [
            "kernel/src",
            "kernel/tests",
            "kernel/examples",
            "harness/sim/src",
            "harness/sim/benches",
            "harness/sim/examples",
        ] {
            copy_folder(&root.join(part), &folder.join(part));
        }
        for file in ["kernel/Cargo.toml", "harness/sim/Cargo.toml", "Cargo.lock"] {
            fs::copy(root.join(file), folder.join(file)).expect("a readable file");
        }
        fs::write(folder.join("Cargo.toml"), WORKSPACE).expect("a new file");
        Self { folder, build }
    }

    fn source(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    /// Runs `cargo test` on some targets, with random cases that are the same every time.
    fn test(&self, arguments: &[&str]) -> Output {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| env!("CARGO").into());
        Command::new(cargo)
            .args(["test", "--offline", "--quiet"])
            .args(arguments)
            .current_dir(&self.folder)
            .env("CARGO_TARGET_DIR", &self.build)
            .env("CARGO_TERM_COLOR", "never")
            .env("RUST_BACKTRACE", "0")
            .env("PROPTEST_CASES", "16")
            .env("PROPTEST_MAX_SHRINK_ITERS", "0")
            .env("PROPTEST_RNG_SEED", "1")
            .env_remove("RUSTFLAGS")
            .output()
            .expect("cargo starts")
    }

    /// What is wrong with the tests on this mutant, if anything.
    fn check(&self, mutant: &Mutant) -> Option<String> {
        let path = self.source(mutant.file);
        let whole = fs::read_to_string(&path).expect("a source");
        let count = whole.matches(mutant.from).count();
        if count != 1 {
            return Some(format!("its text occurs {count} times in {}", mutant.file));
        }
        fs::write(&path, whole.replace(mutant.from, mutant.to)).expect("a writable copy");
        let found = self.run(mutant);
        fs::write(&path, whole).expect("a writable copy");
        found
    }

    fn run(&self, mutant: &Mutant) -> Option<String> {
        let (target, module) = match mutant.target {
            UNIT => (vec!["-p", KERNEL, "--lib"], String::new()),
            SIM => (vec!["-p", "bitgrain-sim", "--lib"], String::new()),
            module => (
                vec!["-p", KERNEL, "--test", "kernel"],
                format!("{module}::"),
            ),
        };
        let red: Vec<String> = mutant
            .red
            .iter()
            .map(|test| format!("{module}{test}"))
            .collect();
        let built = self.test(&[target.as_slice(), &["--no-run"]].concat());
        if !built.status.success() {
            let why = String::from_utf8_lossy(&built.stderr);
            return Some(format!("it does not compile:\n{why}"));
        }
        let mut chosen = vec!["--no-fail-fast", "--", "--exact", "--format=pretty"];
        chosen.extend(red.iter().map(String::as_str));
        let ran = self.test(&[target, chosen].concat());
        let text = String::from_utf8_lossy(&ran.stdout);
        let survived = red
            .iter()
            .find(|test| !text.contains(&format!("test {test} ... FAILED\n")));
        survived.map(|test| format!("{test} does not fail:\n{text}"))
    }
}

/// All mutants.
fn all() -> impl Iterator<Item = &'static Mutant> {
    MUTANTS.iter().chain(BODIES).chain(MATERIALS).chain(KEEPING)
}

/// Found in seconds: a change that removes a mutant's text.
#[test]
fn every_mutant_has_its_text() {
    for mutant in all() {
        let file = bitgrain_tests::root().join(mutant.file);
        let whole = fs::read_to_string(file).expect("a source");
        assert_eq!(whole.matches(mutant.from).count(), 1, "{}", mutant.name);
    }
}

#[test]
#[ignore = "builds the kernel some seventy times: `.ci/run mutants`, ten minutes"]
fn every_mutant_is_caught_and_the_sources_themselves_pass() {
    let copy = Copy::new();
    let whole = copy.test(&["--lib", "--tests"]);
    assert!(
        whole.status.success(),
        "the unchanged copy fails:\n{}{}",
        String::from_utf8_lossy(&whole.stdout),
        String::from_utf8_lossy(&whole.stderr)
    );
    let survivors: Vec<String> = all()
        .filter_map(|mutant| {
            let problem = copy.check(mutant)?;
            Some(format!("{}: {problem}", mutant.name))
        })
        .collect();
    assert!(
        survivors.is_empty(),
        "not caught:\n{}",
        survivors.join("\n")
    );
}
