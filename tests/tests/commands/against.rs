//! A run is compared with another one, and the commands for first steps.

use std::process::Command;

use bitgrain::checkpoint;
use bitgrain::manifest::{FileRecord, Manifest};
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

    let before = (room.files("new"), room.files("beds"));
    for asked in ["--against run", &format!("--expect {}", manifest.closing)] {
        let told = room.done(&format!("run wee.toml --out new {asked}"));
        assert!(told.contains("nothing was executed"), "{told}");
        assert!(
            told.contains("links 0 were executed by this call, 0 taken"),
            "{told}"
        );
        assert!(told.contains("executed again: all "), "{told}");
        // Whoever needs no proof is told that there is none.
        let told = room.says(
            &format!("run wee.toml --out new {asked} --found-is-enough"),
            3,
        );
        assert!(
            told.contains("links 0 were executed by this call, 0 taken"),
            "{told}"
        );
        assert!(!told.contains("executed again: all "), "{told}");
    }
    assert!(before == (room.files("new"), room.files("beds")));

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
}

/// A drag that only one of two runs has is a difference.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_with_fewer_drags_differs() {
    let room = FURNISHED.copy();
    room.done("run wee.toml --out fewer --set intruder.speed=0.6");
    for (scenario, other) in [("", "fewer"), (" --set intruder.speed=0.6", "run")] {
        let told = room.says(
            &format!("run wee.toml --out one-{other}{scenario} --against {other}"),
            3,
        );
        assert!(told.contains("run-2: different at step"), "{told}");
    }
}

/// Words that name nothing which a run could be compared with are refused before any work.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_names_no_other_run_is_refused() {
    let room = FURNISHED.copy();
    // A run is not compared with itself, nor nothing with something.
    for own in ["run", "camp/../run", "run/runs/run-1/chain.csv"] {
        let told = room.says(&format!("run --resume run --against {own}"), 2);
        assert!(
            told.contains("is the run that it would be compared with"),
            "{told}"
        );
    }
    for asked in ["--against run", &format!("--expect {}", "0".repeat(64))] {
        let told = room.says(&format!("run {asked}"), 2);
        assert!(told.contains("has nothing to compare"), "{told}");
    }
    let told = room.says("run wee.toml --out none --expect 12", 2);
    assert!(told.contains("`12` is no link"), "{told}");
    let told = room.says("run wee.toml --out none --against nothing", 2);
    assert!(told.contains("is neither the folder of a run"), "{told}");
    assert!(!room.path("none").exists());
}

/// What was found is executed again: states that nobody computed confirm nothing, nor does a bed of the library.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_was_found_confirms_nothing_by_itself() {
    let room = FURNISHED.copy();
    let told =
        room.done("run wee.toml --out fresh --beds fresh-beds --against run --found-is-enough");
    assert!(!told.contains("executed by this call"), "{told}");
    let told = room.done("run wee.toml --out shared --against run");
    assert!(
        told.contains("taken from the library of beds, 0 found in the folder"),
        "{told}"
    );
    assert!(told.contains("bed: steps 0 to "), "{told}");
    let told = room.says(
        "run wee.toml --out shared-2 --against run --found-is-enough",
        3,
    );
    assert!(told.contains("without --found-is-enough"), "{told}");

    // A state half way that was changed, its manifest made to fit: every link is as it was.
    let manifest = Manifest::of(&room.path("shared")).unwrap().unwrap();
    let names = manifest.files.iter().map(|file| file.path.clone());
    let mut kept = names.filter(|name| name.starts_with("runs/run-2/checkpoints/"));
    let path = room.path("shared").join(kept.next().unwrap());
    let (mut sim, note) = checkpoint::read_noted(&path).unwrap();
    sim.velocity[7][0] = sim.velocity[7][0].next_up();
    std::fs::write(&path, checkpoint::pack(&mut sim, &note).unwrap()).unwrap();
    let text = std::fs::read(room.path("shared/manifest.json")).unwrap();
    let mut manifest = Manifest::parse(std::str::from_utf8(&text).unwrap()).unwrap();
    for entry in &mut manifest.files {
        let bytes = room.read(&format!("shared/{}", entry.path));
        *entry = FileRecord::of(&entry.path, &bytes);
    }
    room.write("shared/manifest.json", manifest.text());
    let link = &manifest.stages[2].link;
    for asked in ["--against run", &format!("--expect {link}")] {
        let told = room.says(&format!("run wee.toml --out shared {asked}"), 3);
        assert!(
            told.contains("pieces that were found do not hold"),
            "{told}"
        );
    }
}

/// Files with the names that a comparison writes stay as they are unless a comparison left them.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn foreign_files_are_not_replaced_by_a_comparison() {
    let room = FURNISHED.copy();
    for name in ["difference.json", "difference.safetensors"] {
        for (folder, text) in [
            ("new", "mine"),
            ("new", "{}"),
            ("run", "{\"version\": \"1\"}"),
        ] {
            room.write(&format!("{folder}/{name}"), text);
            let told = room.says(
                &format!("run wee.toml --out {folder} --against camp/members/mu0.5"),
                2,
            );
            assert!(
                told.contains(&format!("{folder}/{name}: has the name of a file")),
                "{told}"
            );
            assert_eq!(room.read(&format!("{folder}/{name}")), text.as_bytes());
            std::fs::remove_file(room.path(&format!("{folder}/{name}"))).unwrap();
        }
        assert!(room.files("new").is_empty());
        #[cfg(unix)]
        {
            let link = room.path(&format!("new/{name}"));
            std::os::unix::fs::symlink(room.path("run/summary.json"), &link).unwrap();
            room.says("run wee.toml --out new --against run", 2);
            assert!(link.is_symlink() && !room.files("run")["summary.json"].is_empty());
            std::fs::remove_file(link).unwrap();
        }
    }
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
