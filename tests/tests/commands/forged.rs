//! Changed results with a rebuilt manifest are found by execution, and each refusal says what to do.

use std::path::Path;

use bitgrain::manifest::{FileRecord, Manifest};
use bitgrain_tests::wee::Room;
use bitgrain_tests::{assert_named, differing};

use crate::{CAMP, FURNISHED, PROGRAM};

/// Makes a manifest fit what lies in its folder, closing hash and all, and says no more of what is finished.
pub(crate) fn remake_manifest(root: &Path) {
    remake_with(root, &[]);
}

/// The same with these files too, which are made up; returns the closing hash.
fn remake_with(root: &Path, made_up: &[&str]) -> String {
    let mut manifest = Manifest::of(root).unwrap().unwrap();
    let mut names: Vec<String> = manifest.files.into_iter().map(|entry| entry.path).collect();
    for name in made_up {
        let path = root.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "{\n  \"reason\": \"run-1 stopped at step 5\"\n}\n").unwrap();
        names.push(name.to_string());
    }
    names.sort();
    let there = |name: &String| Some(FileRecord::of(name, &std::fs::read(root.join(name)).ok()?));
    manifest.files = names.iter().filter_map(there).collect();
    std::fs::write(root.join("manifest.json"), manifest.text()).unwrap();
    Manifest::of(root).unwrap().unwrap().closing
}

/// The same of a member in `camp`, whose closing hash goes into the campaign's manifest.
pub(crate) fn remake_member(room: &Room, member: &str, made_up: &[&str]) {
    let closing = remake_with(&room.path(&format!("camp/members/{member}")), made_up);
    let mut whole = Manifest::of(&room.path("camp")).unwrap().unwrap();
    let mut stages = whole.stages.iter_mut();
    stages.find(|stage| stage.name == member).unwrap().link = closing;
    room.write("camp/manifest.json", whole.text());
    remake_manifest(&room.path("camp"));
}

/// A forger who rebuilds the manifest is found by execution, and by a closing hash kept elsewhere.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_forged_manifest_proves_nothing() {
    let room = FURNISHED.copy();
    let honest = Manifest::of(&room.path("run")).unwrap().unwrap();
    let stage = &honest.stages[2].link;
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

/// A summary lacks no key that the run gives.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_summary_without_a_key_is_told() {
    let room = FURNISHED.copy();
    for name in [
        "summary.json",
        "runs/run-1/summary.json",
        "runs/run-2/summary.json",
    ] {
        let name = format!("run/{name}");
        let text = String::from_utf8(room.read(&name)).unwrap();
        let kept = text
            .lines()
            .filter(|line| !line.contains("\"large_overlaps\""));
        room.write(
            &name,
            kept.map(|line| format!("{line}\n")).collect::<String>(),
        );
        assert_ne!(room.read(&name), text.as_bytes());
    }
    remake_manifest(&room.path("run"));
    let told = room.says("verify run", 3);
    assert!(
        told.contains("summary.json of its folder: missing or not as it was written"),
        "{told}"
    );
}

/// The files in a manifest are those that the scenario gives: no run writes others, and those of a stage that failed
/// are not there once it is finished.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn files_that_no_scenario_gives_are_told() {
    for folder in [
        FURNISHED.path("run"),
        FURNISHED.path("camp/members/mu0.3"),
        CAMP.out().join("members/mu0.1"),
    ] {
        assert_named(&folder);
    }
    let of_a_run = [
        "beds/bed-2.data",
        "beds/bed.data.gz",
        "failure.json",
        "notes.txt",
        "runs/run-1/checkpoints/000000000100.safetensors",
        "runs/run-1/failure.json",
        "runs/run-1/forces.partial.csv",
        "runs/run-1/frames/000000002000.csv",
        "runs/run-1/latest.safetensors",
        "runs/run-1/load.csv",
        "runs/run-1/plane.csv",
        "runs/run-1/snapshots/grains.000000000100.vtk",
        "runs/run-3/forces.csv",
    ];
    let room = FURNISHED.copy();
    remake_with(&room.path("run"), &of_a_run);
    let told = room.says("verify run --sample 1", 3);
    for name in of_a_run {
        assert!(
            told.contains(&format!("manifest.json: {name} in manifest.json is ")),
            "{name}: {told}"
        );
    }
    // What is left out is missed, though no piece of it is executed.
    std::fs::remove_file(room.path("run/runs/run-1/angles.csv")).unwrap();
    remake_manifest(&room.path("run"));
    let told = room.says("verify run --segment run-2", 3);
    assert!(
        told.contains("runs/run-1/angles.csv is missing in manifest.json"),
        "{told}"
    );

    let room = FURNISHED.copy();
    remake_member(&room, "mu0.5", &["runs/run-1/plane.csv"]);
    let of_a_campaign = [
        "extra.csv",
        "members/mu0.5/scenario.toml",
        "tasks/mu0.5/run-1/forces.csv",
    ];
    remake_with(&room.path("camp"), &of_a_campaign);
    let told = room.says("verify camp --sample 1", 3);
    for name in of_a_campaign.into_iter().chain(["runs/run-1/plane.csv"]) {
        assert!(
            told.contains(&format!(
                "manifest.json: {name} in manifest.json is no file"
            )),
            "{name}: {told}"
        );
    }
}

/// What has ended well did not fail, whoever says so: the same command puts that right.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_forged_failure_is_no_row() {
    let room = FURNISHED.copy();
    for name in ["failure.json", "runs/run-1/failure.json"] {
        remake_member(&room, "mu0.3", &[name]);
        let told = room.says("verify camp --sample 1", 3);
        let wrong = format!(
            "mu0.3: manifest.json: {name} in manifest.json is of a stage that has not ended well"
        );
        assert!(told.contains(&wrong), "{told}");
        room.done("sweep weecamp.toml --out camp");
        let differ = differing(&room.files("camp"), &FURNISHED.files("camp"));
        assert!(differ.is_empty(), "{differ:?}");
    }
}

/// What is expected is what was executed, not what a manifest says of it.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_is_expected_is_executed() {
    let room = FURNISHED.copy();
    let honest = Manifest::of(&room.path("run")).unwrap().unwrap();
    let (closing, link) = (&honest.closing, &honest.stages[2].link);
    room.done(&format!("verify run --segment run-2 --expect {link}"));
    for words in [
        format!("run --segment run-2 --expect {closing}"),
        format!("run --segment run-1 --expect {link}"),
        format!("run --segment run-2:0-10 --expect {link}"),
        format!(
            "camp --sample 1 --expect {}",
            Manifest::of(&room.path("camp")).unwrap().unwrap().closing
        ),
    ] {
        let told = room.says(&format!("verify {words}"), 3);
        assert!(
            told.contains("nothing that was executed ends with it: a closing hash takes"),
            "{told}"
        );
    }
    room.done("run wee.toml --set law.mu=0.4 --out other --only run-2");
    let mut other = Manifest::of(&room.path("other")).unwrap().unwrap();
    other.stages[2].link = link.clone();
    room.write("other/manifest.json", other.text());
    for scope in ["--segment run-2", "--sample 9"] {
        let told = room.says(&format!("verify other {scope} --expect {link}"), 3);
        assert!(
            told.contains("run-2: its link in manifest.json is not the last one of its execution"),
            "{told}"
        );
    }
}

/// Words of somebody else in a scenario or a campaign are not theirs.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn comments_of_others_are_told() {
    let room = FURNISHED.copy();
    for (name, verify) in [
        ("run/scenario.toml", "verify run --sample 1"),
        ("camp/campaign.toml", "verify camp --sample 1"),
    ] {
        let text = String::from_utf8(room.read(name)).unwrap();
        room.write(name, text + "# the drag is 99999\n");
        remake_manifest(room.path(name).parent().unwrap());
        let told = room.says(verify, 3);
        assert!(told.contains(&format!("{name}: not as a ")), "{told}");
    }
}

/// Members share beds, which are poured again once; the files beside each are looked at.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn the_files_beside_a_shared_bed_are_compared() {
    let room = Room::new(PROGRAM);
    let grids = [
        "[[grid]]\nname = \"a\"\nspeed = 1.2\n",
        "[[grid]]\nname = \"b\"\nset = { \"measure.digest_every\" = 150 }\nspeed = 1.2\n",
    ];
    room.write(
        "share.toml",
        format!(
            "name = \"share\"\nbase = \"wee.toml\"\n{}{}",
            grids[0], grids[1]
        ),
    );
    room.done("sweep share.toml --out camp");
    let manifest = Manifest::of(&room.path("camp")).unwrap().unwrap();
    let told = room.done("verify camp");
    assert_eq!(told.matches(": bed: steps 0 to ").count(), 1, "{told}");
    let member = &manifest.stages[1].name;
    let data = format!("camp/members/{member}/beds/bed.data");
    room.edit(&data, "atoms", "atoms ");
    remake_member(&room, member, &[]);
    let told = room.says("verify camp", 3);
    assert!(
        told.contains(&format!("{member}: bed: "))
            && told.contains("bed.data is missing or not as"),
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
    remake_member(&room, "mu0.3", &[]);
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
    // What is not marked as a result is of others, and stays.
    let told = room.says("run --resume run", 2);
    assert!(
        told.contains("angles.csv") && told.contains("move it away"),
        "{told}"
    );
    std::fs::remove_file(room.path(&format!("run/{name}"))).unwrap();
    room.done("run --resume run");
    room.done("verify run");
    assert!(room.files("run").iter().all(|(name, bytes)| {
        FURNISHED
            .files("run")
            .get(name)
            .is_none_or(|want| want == bytes)
    }));
}
