//! What the page is made of.

use std::path::PathBuf;
use std::process::Command;

use bitgrain_tests::page::{PARTS, assembled, known_digests, parts, start, unpacked};
use bitgrain_tests::{golden, notices, root};

use super::{command, page};

/// Bytes of the page: it is sent and kept as one file.
const SIZE_MAX: u64 = 1_500_000;

/// What the page keeps under a name.
fn kept(name: &str) -> Vec<u8> {
    let all = parts(&std::fs::read_to_string(page()).unwrap());
    unpacked(&all[PARTS.iter().position(|part| *part == name).unwrap()])
}

#[test]
fn the_page_is_what_its_sources_say() {
    let text = std::fs::read_to_string(page()).unwrap();
    let recipe = "`cargo run --release -p bitgrain-tests --bin page` puts new scripts into it, harness/page/build \
                  makes it anew";
    assert!(assembled(&parts(&text)) == text, "{recipe}");
    let notices = std::fs::read(root().join(notices::PAGE.file)).unwrap();
    assert!(kept("notices-packed") == notices, "{recipe}");
    assert!((text.len() as u64) < SIZE_MAX, "{} bytes", text.len());
    // Nothing of the machine that built them.
    for module in ["module-plain", "module-wide"] {
        let bytes = kept(module);
        for path in ["registry/src", "harness/sim", "library/core"] {
            let found = bytes
                .windows(path.len())
                .any(|part| part == path.as_bytes());
            assert!(!found, "{module} names files: {path}");
        }
    }
    let long = text.lines().filter(|line| !line.contains("<script type="));
    let long: Vec<&str> = long.filter(|line| line.chars().count() > 240).collect();
    assert!(long.is_empty(), "{long:?}");
}

/// The digests that the page has of the command are the command's.
#[test]
#[ignore = "half a minute"]
fn the_beds_and_their_digests_are_those_of_the_recipe() {
    let beds = start::BODIES.map(|kind| serde_json::to_string(&start::start(kind)).unwrap());
    for (kind, text) in start::BODIES.iter().zip(&beds) {
        assert!(kept(&format!("bed-{kind}")) == text.as_bytes(), "{kind}");
    }
    let all = parts(&std::fs::read_to_string(page()).unwrap());
    assert_eq!(all[5], known_digests(&beds));
}

/// Both modules in the page, and both built anew, give the command's digests of beds and of other cases.
#[test]
#[ignore = "builds two modules with Debian's compiler, and needs Node"]
fn modules_built_anew_give_the_same_digests() {
    let folder = tempfile::tempdir().unwrap();
    // One as it is in the page, the other optimised less, which takes a minute less: that changes no bit either.
    for (module, optimised) in [("plain", "fat"), ("wide", "off")] {
        let build = Command::new(root().join("harness/page/build"))
            .arg(module)
            .env("CARGO_PROFILE_RELEASE_LTO", optimised)
            .status();
        assert!(build.expect("the script starts").success());
    }
    let mut modules = Vec::new();
    for (name, built) in [("module-plain", "plain.wasm"), ("module-wide", "wide.wasm")] {
        let path = folder.path().join(name);
        std::fs::write(&path, kept(name)).unwrap();
        modules.push(path);
        modules.push(root().join("target/page").join(built));
    }
    let mut cases: Vec<(PathBuf, u64)> = ["collapse.json", "rig.json", "materials.json"]
        .map(|name| (golden("cases").join(name), 2000))
        .into();
    for kind in start::BODIES {
        let path = folder.path().join(kind);
        std::fs::write(&path, kept(&format!("bed-{kind}"))).unwrap();
        cases.push((path, 1000));
    }
    for (case, steps) in &cases {
        let lines = command(case, *steps, steps / 4);
        let expected: Vec<String> = lines
            .iter()
            .map(|(step, of)| format!("{step} {of}"))
            .collect();
        for module in &modules {
            let run = Command::new("node")
                .arg(root().join("tests/rigs/page/run.mjs"))
                .args([module, case])
                .args([steps.to_string(), (steps / 4).to_string()])
                .output()
                .expect("node starts");
            let said = String::from_utf8_lossy(&run.stderr);
            assert!(run.status.success(), "{}: {said}", module.display());
            let given = String::from_utf8(run.stdout).unwrap();
            let given: Vec<&str> = given.lines().collect();
            assert_eq!(
                given,
                expected,
                "{} of {}",
                module.display(),
                case.display()
            );
        }
    }
}
