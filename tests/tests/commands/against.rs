//! A run is compared with another one, and the commands for first steps.

use std::process::Command;

use bitgrain::manifest::Manifest;
use bitgrain_tests::wee::{Room, copy_all};
use bitgrain_tests::{output, root};

use crate::{FURNISHED, PROGRAM};

/// Status 0 only if every link is the same; else the first step, body and number, in words and in a file.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_is_held_against_another() {
    let room = FURNISHED.copy();
    let told = room.done("run wee.toml --out new --against run");
    assert!(
        told.contains("links of 3 stages are those of run"),
        "{told}"
    );
    assert!(told.contains("next: bitgrain verify new"), "{told}");
    let chain = "run/runs/run-2/chain.csv";
    let told = room.done(&format!("run wee.toml --out new --against {chain}"));
    assert!(told.contains("run-2: all "), "{told}");
    let manifest = Manifest::of(&room.path("run")).unwrap().unwrap();
    for link in [&manifest.closing, &manifest.stages[1].link] {
        room.done(&format!("run wee.toml --out new --against {link}"));
    }
    assert!(!room.path("new/difference.json").exists());

    let told = room.done("run wee.toml --out new --against run");
    assert!(told.contains("nothing was executed"), "{told}");

    // Half a unit in the last place of a friction coefficient.
    let changed = "run wee.toml --out other --set law.mu=0.50000000000000011";
    let told = room.says(&format!("{changed} --against run"), 3);
    assert!(
        told.contains("the same to step") && told.contains("found") && told.contains("differ"),
        "{told}"
    );
    let text = String::from_utf8(room.read("other/difference.json")).unwrap();
    let found: serde_json::Value = serde_json::from_str(&text).unwrap();
    let (equal, differ) = (found["equal"].as_u64(), found["differ"].as_u64());
    assert_eq!(equal.map(|step| step + 1), differ, "{text}");
    assert_eq!(found["stage"], "bed");
    let number = &found["number"];
    assert_ne!(number["expected"], number["found"], "{text}");
    let again = found["replay"].as_str().unwrap().strip_prefix("bitgrain ");
    room.done(again.unwrap());
    let told = room.says(&format!("{changed} --against {chain}"), 3);
    assert!(told.contains("run-2: different"), "{told}");
    let told = room.says(&format!("{changed} --against {}", manifest.closing), 3);
    assert!(told.contains("neither its closing hash"), "{told}");

    // A chain that parts in a drag: the state before it is kept, and leads there.
    let text = String::from_utf8(room.read(chain)).unwrap();
    let last = text.lines().last().unwrap();
    room.write(
        "short.csv",
        text.strip_suffix(&format!("{last}\n")).unwrap(),
    );
    let told = room.says("run wee.toml --out new --against short.csv", 3);
    assert!(told.contains("difference.safetensors"), "{told}");
    let found: serde_json::Value =
        serde_json::from_slice(&room.read("new/difference.json")).unwrap();
    assert_eq!(found["state"], "difference.safetensors");
    let again = found["replay"].as_str().unwrap();
    let again = again.strip_prefix("bitgrain ").unwrap();
    let told = room.done(&again.replace("difference.safetensors", "new/difference.safetensors"));
    let sample: serde_json::Value = serde_json::from_str(told.lines().last().unwrap()).unwrap();
    let steps = found["differ"].as_u64().unwrap() - found["equal"].as_u64().unwrap();
    assert_eq!(sample["step"], steps);
    let whole = room.done(&format!(
        "replay new --stage run-2 --from {} --steps 0",
        found["differ"]
    ));
    let whole: serde_json::Value = serde_json::from_str(&whole).unwrap();
    assert_eq!(sample["digest"], whole["digest"]);
    room.done("run wee.toml --out new --against run");
    assert!(!room.path("new/difference.safetensors").exists());

    // A drag that only one of them has is a difference.
    room.done("run wee.toml --out fewer --set intruder.speed=0.6");
    for (scenario, other) in [("", "fewer"), (" --set intruder.speed=0.6", "run")] {
        let told = room.says(
            &format!("run wee.toml --out one-{other}{scenario} --against {other}"),
            3,
        );
        assert!(told.contains("run-2: different at step"), "{told}");
    }

    // A word that names nothing is refused before any work.
    let told = room.says("run wee.toml --out none --against nothing", 2);
    assert!(told.contains("is neither the folder of a run"), "{told}");
    assert!(!room.path("none").exists());
}

/// The example of a repository with a regression check: it holds, and a change of one bit is found.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn the_regression_example_holds_and_finds_a_bit() {
    let folder = tempfile::tempdir().unwrap();
    copy_all(
        &root().join("harness/guide/regression-example"),
        folder.path(),
    );
    let check = |more: &[&str]| {
        let script = folder.path().join("check.sh");
        let mut command = Command::new("sh");
        command.arg(script).args(more).env("BITGRAIN", PROGRAM);
        command.current_dir(folder.path()).output().unwrap()
    };
    let out = check(&[]);
    let told = String::from_utf8_lossy(&out.stdout);
    assert!(
        out.status.success() && told.contains("links are those of pinned.chain.csv"),
        "{told}"
    );
    // Earlier results prove nothing about a program built since.
    let again = check(&[]);
    let told = String::from_utf8_lossy(&again.stdout);
    assert!(
        again.status.success() && !told.contains("nothing was executed"),
        "{told}"
    );
    let out = check(&["--set", "law.mu=0.50000000000000011", "--out", "changed"]);
    assert_eq!(out.status.code(), Some(2), "--out is given twice");
    let out = check(&["--set", "law.mu=0.50000000000000011"]);
    assert_eq!(out.status.code(), Some(3));
    assert!(folder.path().join("out/difference.json").exists());
}

/// `new` writes a valid scenario, `run` without a name lists the shipped ones, and completions and manual pages are
/// written.
#[test]
fn newcomers_are_served() {
    let room = Room::new(PROGRAM);
    room.done("new my-drag");
    let told = room.done("run my-drag.toml --dry-run");
    assert!(told.contains("my-drag (reduced units"), "{told}");
    let text = String::from_utf8(room.read("my-drag.toml")).unwrap();
    assert!(
        text.lines().filter(|line| line.contains('#')).count() > 20,
        "{text}"
    );
    let told = room.says("new my-drag", 2);
    assert!(told.contains("exists already"), "{told}");
    for name in ["a/b", "..", "a b"] {
        let out = output(PROGRAM, room.folder.path(), &["new", name]);
        assert_eq!(out.status.code(), Some(2), "{name}");
    }
    let told = room.done("run");
    for (name, _) in bitgrain::scenario::SHIPPED {
        assert!(
            told.lines()
                .any(|line| line.starts_with(name) && line.contains(" to ")),
            "{told}"
        );
    }
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let told = room.done(&format!("completions {shell}"));
        assert!(told.contains("verify"), "{shell}");
    }
    room.done("man man");
    let page = String::from_utf8(room.read("man/bitgrain-run.1")).unwrap();
    assert!(page.contains("resume") && page.contains(".TH"), "{page}");
}
