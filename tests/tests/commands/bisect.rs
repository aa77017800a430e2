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
