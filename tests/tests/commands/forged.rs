//! Changed results with a rebuilt manifest are found by execution, and each refusal says what to do.

use std::path::Path;

use bitgrain::manifest::{FileRecord, Manifest};

use crate::FURNISHED;

/// Makes a manifest fit what lies in its folder, closing hash and all, and says no more of what is finished.
fn remake_manifest(root: &Path) {
    let mut manifest = Manifest::of(root).unwrap().unwrap();
    let mut entries = Vec::new();
    for entry in &manifest.files {
        if let Ok(bytes) = std::fs::read(root.join(&entry.path)) {
            entries.push(FileRecord::of(&entry.path, &bytes));
        }
    }
    manifest.files = entries;
    std::fs::write(root.join("manifest.json"), manifest.text()).unwrap();
}

/// A forger who rebuilds the manifest is found by execution, and by a closing hash kept elsewhere.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_forged_manifest_proves_nothing() {
    let room = FURNISHED.copy();
    let honest = Manifest::of(&room.path("run")).unwrap().unwrap();
    room.done(&format!(
        "verify run --expect {} --sample 1",
        honest.closing
    ));
    let stage = &honest.stages[2].link;
    room.done(&format!("verify run --expect {stage} --sample 1"));
    room.done(&format!(
        "run wee.toml --out again --expect {} --expect {stage}",
        honest.closing
    ));
    let other = "0".repeat(64);
    let told = room.says(&format!("run wee.toml --out again --expect {other}"), 3);
    assert!(told.contains("neither its closing hash"), "{told}");

    let name = "runs/run-1/forces.csv";
    let text = String::from_utf8(room.read(&format!("run/{name}"))).unwrap();
    let forged = text.replacen(",-", ",", 1);
    assert_ne!(text, forged);
    room.write(&format!("run/{name}"), &forged);
    let mut manifest = honest.clone();
    let entry = manifest.files.iter_mut().find(|entry| entry.path == name);
    *entry.unwrap() = FileRecord::of(name, forged.as_bytes());
    room.write("run/manifest.json", manifest.text());
    // Its own manifest vouches for it, and its drags of another piece are executed.
    let told = room.done("verify run --segment run-2");
    assert!(!told.contains(&honest.closing), "{told}");
    let told = room.says("verify run", 3);
    assert!(
        told.contains("forces.csv of its folder: missing or not as it was written"),
        "{told}"
    );
    let told = room.says(
        &format!("verify run --segment run-2 --expect {}", honest.closing),
        3,
    );
    assert!(told.contains("neither its closing hash"), "{told}");
}

/// A summary as versions wrote it that had no error of the uncut mean, no drag by travel and no large overlaps.
fn of_an_earlier_version(text: &str) -> String {
    let mut kept = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let key = line.trim_start();
        if key.starts_with("\"drag_by_travel\"") {
            // The list goes on to its bracket.
            lines.find(|line| line.trim_start().starts_with(']'));
        } else if !key.starts_with("\"drag_uncut_error\"") && !key.starts_with("\"large_overlaps\"")
        {
            kept.push(line);
        }
    }
    kept.join("\n") + "\n"
}

/// Runs of earlier versions verify, whose summaries lack what was added since; a number that is there must hold.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn runs_of_earlier_versions_verify() {
    let room = FURNISHED.copy();
    let files = [
        "summary.json",
        "runs/run-1/summary.json",
        "runs/run-2/summary.json",
    ];
    for name in files.map(|name| format!("run/{name}")) {
        let text = String::from_utf8(room.read(&name)).unwrap();
        let earlier = of_an_earlier_version(&text);
        assert!(
            text.lines().count() >= earlier.lines().count() + 5,
            "{name}"
        );
        room.write(&name, earlier);
    }
    remake_manifest(&room.path("run"));
    let told = room.done("verify run");
    assert!(told.contains("and its tables are as written"), "{told}");
    room.edit(
        "run/runs/run-1/summary.json",
        "\"overlap_max\": 0.",
        "\"overlap_max\": 1.",
    );
    remake_manifest(&room.path("run"));
    let told = room.says("verify run", 3);
    assert!(
        told.contains("summary.json of its folder: missing or not as it was written"),
        "{told}"
    );
}

/// Nor does it help a forger to remove what a finished run must have: the manifest says that it is finished.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_a_finished_run_must_have_is_missed() {
    for root in ["run", "camp/members/mu0.5"] {
        let verify = format!("verify {}", root.split('/').next().unwrap());
        let room = FURNISHED.copy();
        for name in [
            "summary.json",
            "runs/run-1/summary.json",
            "runs/run-1/checkpoints/000000004167.safetensors",
        ] {
            std::fs::remove_file(room.path(&format!("{root}/{name}"))).unwrap();
        }
        let forces = format!("{root}/runs/run-1/forces.csv");
        let text = String::from_utf8(room.read(&forces)).unwrap();
        room.write(&forces, text.replace(",-", ",1"));
        remake_manifest(&room.path(root));
        let told = room.says(&verify, 3);
        assert!(
            told.contains("run-1: cannot be run again") && told.contains("pieces do not hold"),
            "{told}"
        );
        // The summary alone.
        let room = FURNISHED.copy();
        std::fs::remove_file(room.path(&format!("{root}/summary.json"))).unwrap();
        remake_manifest(&room.path(root));
        let told = room.says(&verify, 3);
        assert!(told.contains("summary.json: not what"), "{told}");
    }
}

/// Frames may be missing, as of a run that was made without; those that are there are what the run gives.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn forged_frames_are_found() {
    let name = "run/runs/run-2/frames/000000000695.csv";
    let room = FURNISHED.copy();
    let text = String::from_utf8(room.read(name)).unwrap();
    room.write(name, text.replacen(",free", ",base", 1));
    remake_manifest(&room.path("run"));
    let told = room.says("verify run --segment run-2", 3);
    assert!(
        told.contains("000000000695.csv is not as it was written"),
        "{told}"
    );
    std::fs::remove_file(room.path(name)).unwrap();
    remake_manifest(&room.path("run"));
    room.done("verify run");
    room.done("report run");
}

/// A link that a forger wrote into a manifest is compared with the stage's own, and a member's summary with
/// its checkpoints.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn forged_ends_are_found() {
    let room = FURNISHED.copy();
    let mut manifest = Manifest::of(&room.path("run")).unwrap().unwrap();
    let link = "1".repeat(64);
    manifest.stages[1].link = link.clone();
    let name = manifest.stages[1].name.clone();
    room.write("run/manifest.json", manifest.text());
    let told = room.says(&format!("verify run --expect {link}"), 3);
    assert!(
        told.contains(&format!("{name}: its link in manifest.json is not")),
        "{told}"
    );

    let room = FURNISHED.copy();
    let member = "camp/members/mu0.3";
    room.edit(
        &format!("{member}/summary.json"),
        "\"mean\": ",
        "\"mean\": 1",
    );
    remake_manifest(&room.path(member));
    let closing = Manifest::of(&room.path(member)).unwrap().unwrap().closing;
    let mut whole = Manifest::of(&room.path("camp")).unwrap().unwrap();
    let stage = whole.stages.iter_mut().find(|stage| stage.name == "mu0.3");
    stage.unwrap().link = closing;
    room.write("camp/manifest.json", whole.text());
    let told = room.says("verify camp", 3);
    assert!(
        told.contains("mu0.3: ") && told.contains("not what the checkpoints give"),
        "{told}"
    );
}

/// Each cause has its own advice.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn advice_fits_the_cause() {
    let room = FURNISHED.copy();
    let other = "0".repeat(64);
    let told = room.says(&format!("verify run --sample 1 --expect {other}"), 3);
    assert!(
        told.contains("copied wrongly") && !told.contains("bit contract"),
        "{told}"
    );
    room.write("run/runs-notes.txt", "mine");
    room.write("run/beds-old/notes.txt", "mine");
    let told = room.done("verify run --sample 1");
    for name in ["beds-old/notes.txt", "runs-notes.txt"] {
        assert!(told.contains(name), "{told}");
    }

    room.done("run wee.toml --out part --only run-1");
    let told = room.says("verify part", 3);
    assert!(
        told.contains("run --resume") && !told.contains("bit contract"),
        "{told}"
    );

    // A file that is too large to be read was not changed.
    let told = room.says("verify run --max-input 0", 2);
    assert!(
        told.contains("--max-input") && !told.contains("changed"),
        "{told}"
    );

    // Its manifest says otherwise, and its entry is of a file that always comes out the same.
    let name = "runs/run-1/angles.csv";
    room.write(&format!("run/{name}"), "mine");
    remake_manifest(&room.path("run"));
    std::fs::remove_file(room.path("run/runs/run-1/summary.json")).unwrap();
    let told = room.says("run --resume run", 3);
    assert!(told.contains("move manifest.json away"), "{told}");
    assert_eq!(room.read(&format!("run/{name}")), b"mine");
    std::fs::rename(room.path("run/manifest.json"), room.path("away")).unwrap();
    room.done("run --resume run");
    room.done("verify run");
    assert!(room.files("run").iter().all(|(name, bytes)| {
        FURNISHED
            .files("run")
            .get(name)
            .is_none_or(|want| want == bytes)
    }));
}
