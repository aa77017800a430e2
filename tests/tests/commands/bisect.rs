//! Where two runs, or two builds, part.

use std::path::Path;

use bitgrain::checkpoint;
use bitgrain::manifest::FolderKind;
use bitgrain_tests::HALF;
use bitgrain_tests::wee::forge_manifest;

use crate::{PROGRAM, RUN, copy};

fn printed(folder: &Path, args: &[&str], status: i32) -> String {
    bitgrain_tests::printed(PROGRAM, folder, args, status)
}

/// Two runs that differ in one coefficient part at the step where a contact first slides; the same run does not part.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn two_runs_part_at_a_contact() {
    let folder = copy();
    let same = printed(
        folder.path(),
        &["bisect", "run", RUN.path().join("run").to_str().unwrap()],
        0,
    );
    assert!(same.contains("no difference"), "{same}");
    let args = [
        "run",
        "small.toml",
        "--out",
        "other",
        "--set",
        "law.mu=0.5000001",
    ];
    printed(folder.path(), &args, 0);
    let told = printed(folder.path(), &["bisect", "run", "other"], 3);
    let (_, found) = told.split_once("bed: the same to step ").expect(&told);
    let number = |word: &str| -> u64 { word.trim_end_matches(',').parse().unwrap() };
    let words: Vec<&str> = found.lines().next().unwrap().split(' ').collect();
    let (equal, differs) = (number(words[0]), number(words[words.len() - 1]));
    assert_eq!(equal + 1, differs, "{told}");
    // Compared with the slow way: both poured again, step by step.
    let state = |out: &str, step: u64| {
        let step = step.to_string();
        let args = [
            "replay",
            out,
            "--stage",
            "bed",
            "--from",
            &step,
            "--steps",
            "0",
            "--digests",
        ];
        printed(folder.path(), &args, 0)
    };
    assert_eq!(state("run", equal), state("other", equal));
    assert_ne!(state("run", differs), state("other", differs));
    for word in [
        "  parts: velocities, ",
        "  first number: velocities of grain ",
        ", tangential force ",
    ] {
        assert!(told.contains(word), "{word}: {told}");
    }
    assert_eq!(told.matches("(0x").count(), 4, "{told}");
}

/// Only what two programs wrote in this call is compared: a program that writes no run is named, and so is a folder in
/// which an earlier one left something.
#[test]
#[cfg(unix)]
fn programs_that_do_nothing_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let small = bitgrain_tests::two_drags();
    std::fs::write(folder.path().join("small.toml"), small).unwrap();
    let bisect = |a: &str, b: &str, more: &[&str]| {
        let args = [&["bisect", a, b, "--scenario", "small.toml"], more].concat();
        printed(folder.path(), &args, 2)
    };
    let told = bisect("true", PROGRAM, &[]);
    let begin =
        "true: left no finished run of small.toml in out/bisect/a: it ended with exit status: 0";
    assert!(told.contains(begin), "{told}");
    let told = bisect("echo", "echo", &[]);
    assert!(
        told.contains("standard output: run small.toml --out out/bisect/a"),
        "{told}"
    );
    let told = bisect("false", "true", &[]);
    assert!(
        told.contains("false: did not run small.toml: exit status: 1"),
        "{told}"
    );
    // Of an earlier call, or of somebody else.
    for (k, name) in ["a", "b", "beds-a", "beds-b"].into_iter().enumerate() {
        let out = format!("out-{k}");
        std::fs::create_dir(folder.path().join(&out)).unwrap();
        let place = folder.path().join(&out).join(name);
        match k {
            0 => bitgrain_tests::wee::copy_all(&RUN.path().join("run"), &place),
            1 => std::os::unix::fs::symlink("nowhere", place).unwrap(),
            _ => std::fs::write(place, "mine").unwrap(),
        }
        let told = bisect("true", "true", &["--out", &out]);
        assert!(told.contains(&format!("{out}: holds `{name}`")), "{told}");
    }
    assert!(!folder.path().join("nowhere").exists());
}

/// A run that ends before the other, or was stopped, is another one, unless that is meant.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_that_has_less_is_another_one() {
    let room = crate::FURNISHED.copy();
    room.done("run wee.toml --out part --only run-1");
    for (pair, ends) in [
        ("run part", "run-2: the second run has none"),
        ("part run", "run-2: the first run has none"),
        (
            "part part",
            "the first run: part/manifest.json does not say that it is finished",
        ),
    ] {
        let told = room.says(&format!("bisect {pair}"), 3);
        assert!(
            told.contains(ends) && !told.contains("no difference"),
            "{told}"
        );
        let told = room.done(&format!("bisect {pair} --prefix"));
        assert!(told.contains("no difference"), "{told}");
    }
    room.done("run wee.toml --out short --set drag.distance=1.45");
    let told = room.says("bisect run short", 3);
    assert!(
        told.contains("run-1: the first run ends at step "),
        "{told}"
    );
    room.done("bisect run short --prefix");
}

/// Two builds and one scenario: one of them is this program with another coefficient.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn two_builds_part_at_a_contact() {
    use std::os::unix::fs::PermissionsExt;
    let folder = copy();
    let other = folder.path().join("other-build");
    let script = format!(
        "#!/bin/sh\ncase \"$1\" in run) exec '{PROGRAM}' \"$@\" --set law.mu=0.6 ;; esac\nexec '{PROGRAM}' \"$@\"\n"
    );
    std::fs::write(&other, script).unwrap();
    std::fs::set_permissions(&other, std::fs::Permissions::from_mode(0o755)).unwrap();
    let other = other.to_str().unwrap();
    let args = [
        "bisect",
        PROGRAM,
        other,
        "--scenario",
        "small.toml",
        "--set",
        "seed=2",
    ];
    let told = printed(folder.path(), &args, 3);
    assert!(told.contains("bed: the same to step "), "{told}");
    assert!(told.contains("  first contact: "), "{told}");

    // A record that its program does not reproduce is reported as such: from half way on this one is another's.
    let path = folder.path().join("run").join(HALF);
    let (mut sim, note) = checkpoint::read_noted(&path).unwrap();
    sim.velocity[7][0] = sim.velocity[7][0].next_up();
    std::fs::write(&path, checkpoint::pack(&mut sim, &note).unwrap()).unwrap();
    for step in [12_501, 16_667] {
        let name = format!("run/runs/run-1/checkpoints/{step:012}.safetensors");
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
    // Its manifest would not have it, so that it is made again too, without what comes after.
    let run = folder.path().join("run");
    let files = bitgrain_tests::results(&run).into_keys();
    let after = |name: &String| name.contains("run-1") && !name.contains("00008334");
    for name in files
        .filter(after)
        .filter(|name| !name.contains("00004167"))
    {
        std::fs::remove_file(run.join(name)).unwrap();
    }
    forge_manifest(&run, FolderKind::Run, &["bed", "run-1", "run-2"]);
    printed(folder.path(), &["run", "--resume", "run"], 0);
    let original = RUN.path().join("run");
    let told = printed(
        folder.path(),
        &["bisect", original.to_str().unwrap(), "run"],
        2,
    );
    for word in [
        "run: has a link at step 8400 of run-1 that ",
        "--program-b",
        "velocities",
    ] {
        assert!(told.contains(word), "{word}: {told}");
    }
}
