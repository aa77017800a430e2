//! A run executed again: what holds, what does not, and where two runs part.

use std::path::{Path, PathBuf};

use bitgrain::chain::Chain;
use bitgrain::checkpoint;
use bitgrain::drag::Dragging;
use bitgrain::folder::Folder;
use bitgrain_tests::{HALF, golden, small_from_file};

use crate::{PROGRAM, RUN, copy};

fn printed(folder: &Path, args: &[&str], status: i32) -> String {
    bitgrain_tests::printed(PROGRAM, folder, args, status)
}

/// Changes a file of the run.
fn edit(folder: &Path, name: &str, change: impl FnOnce(String) -> String) {
    let path = folder.join("run").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    let new = change(text.clone());
    assert_ne!(new, text, "{name}");
    std::fs::write(path, new).unwrap();
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_run_verifies_whole_and_in_pieces() {
    let whole = printed(RUN.path(), &["verify", "run", "--threads", "2"], 0);
    let lines: Vec<&str> = whole.lines().collect();
    // What the manifest does not cover, what it does, the bed, four pieces of each drag, and the last line.
    assert_eq!(lines.len(), 12, "{whole}");
    assert!(
        lines[1].contains(" files are as they were written"),
        "{whole}"
    );
    let lines = &lines[2..];
    assert!(lines[0].starts_with("bed: steps 0 to "), "{whole}");
    assert_eq!(
        lines[1..5]
            .iter()
            .filter(|line| line.contains("tables"))
            .count(),
        1,
        "{whole}"
    );
    // Every link that was written is held once.
    let folder = RUN.path().join("run");
    let folder = Folder(&folder);
    let count = |path: PathBuf| {
        let text = std::fs::read_to_string(path).unwrap();
        Chain::parse(&text, "chain").unwrap().links.len()
    };
    let links = count(folder.bed_chain("bed"))
        + count(folder.chain("run-1"))
        + count(folder.chain("run-2"));
    assert_eq!(lines[9], format!("all {links} links of 9 pieces hold"));

    // Steps 5000 to 9000 lie in the pieces that begin at 4,167 and 8,334.
    let some = printed(
        RUN.path(),
        &["verify", "run", "--segment", "run-1:5000-9000"],
        0,
    );
    let begins: Vec<&str> = some
        .lines()
        .skip(2)
        .map(|l| l.split(" to ").next().unwrap())
        .collect();
    assert_eq!(
        begins[..2],
        ["run-1: steps 4167", "run-1: steps 8334"],
        "{some}"
    );
    let sample = ["verify", "run", "--sample", "2", "--seed", "3"];
    let (one, again) = (
        printed(RUN.path(), &sample, 0),
        printed(RUN.path(), &sample, 0),
    );
    assert!(one == again && one.lines().count() == 6, "{one}");
}

/// The last link of the summary is that of the chain, which begins where the bed's ends.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn chains_go_on_from_stage_to_stage() {
    let folder = RUN.path().join("run");
    let folder = Folder(&folder);
    let summary = bitgrain::summary::read_summary(&folder.summary()).unwrap();
    let chain = |path: PathBuf| {
        let text = std::fs::read_to_string(path).unwrap();
        Chain::parse(&text, "chain").unwrap()
    };
    let bed = chain(folder.bed_chain("bed"));
    assert_eq!(bed.end(), summary.beds[0].chain);
    for run in &summary.runs {
        let chain = chain(folder.chain(&run.name));
        assert_eq!(chain.begins, bed.end());
        assert_eq!(chain.end(), run.chain);
        let last = chain.links.last().unwrap();
        assert_eq!(last.step, run.steps);
        let parts: Vec<&String> = run.digest_parts.iter().map(|(_, part)| part).collect();
        assert_eq!(parts, last.parts.iter().collect::<Vec<_>>());
    }
}

/// Each way in which a run may not be what it says, and what is reported.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn what_does_not_hold_is_told() {
    let verify = |folder: &Path| printed(folder, &["verify", "run", "--segment", "run-1"], 3);

    let folder = copy();
    edit(folder.path(), "runs/run-1/forces.csv", |text| {
        text.replacen("1", "2", 1)
    });
    let told = verify(folder.path());
    assert!(told.contains("forces.csv of its folder"), "{told}");
    assert!(told.contains("1 of 4 pieces do not hold"), "{told}");

    // A state that is whole and sealed, but not what the steps before it give.
    let folder = copy();
    let path = folder.path().join("run").join(HALF);
    let (mut sim, note) = checkpoint::read_noted(&path).unwrap();
    sim.velocity[7][0] = sim.velocity[7][0].next_up();
    std::fs::write(&path, checkpoint::pack(&mut sim, &note).unwrap()).unwrap();
    let told = verify(folder.path());
    assert!(told.contains("steps 4167 to 8334"), "{told}");
    assert!(
        told.contains("21 links hold, but the state at the end"),
        "{told}"
    );
    assert!(
        told.contains("the link at step 8400 does not hold: "),
        "{told}"
    );
    assert!(told.contains("2 of 4 pieces do not hold"), "{told}");

    // A measured number that was changed with everything sealed again.
    let folder = copy();
    let path = folder.path().join("run").join(HALF);
    let (mut sim, mut note) = checkpoint::read_noted(&path).unwrap();
    let mut dragging = Dragging::of(&note).unwrap();
    dragging.record.series[3].force[0] += 1.0;
    note = dragging.note();
    std::fs::write(&path, checkpoint::pack(&mut sim, &note).unwrap()).unwrap();
    let told = verify(folder.path());
    assert!(told.contains("what was measured before it"), "{told}");

    // A damaged checkpoint is a finding, and does not hide the others.
    let folder = copy();
    let path = folder.path().join("run").join(HALF);
    let mut bytes = std::fs::read(&path).unwrap();
    let at = bytes.len() - 9;
    bytes[at] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    let told = verify(folder.path());
    assert!(told.contains("not a whole checkpoint: `group`"), "{told}");
    assert!(told.contains("2 of 4 pieces do not hold"), "{told}");

    let folder = copy();
    edit(folder.path(), "beds/bed.chain.csv", |text| {
        let line = text.lines().last().unwrap();
        text.replacen(line, "", 1)
    });
    let told = printed(folder.path(), &["verify", "run", "--segment", "bed"], 3);
    assert!(told.contains("not what was written"), "{told}");
}

/// Nothing of a finished run may be missing or changed, whichever command reads it.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn what_is_missing_is_told() {
    let remove = |name: &str| {
        let folder = copy();
        std::fs::remove_file(folder.path().join("run").join(name)).unwrap();
        printed(folder.path(), &["verify", "run"], 3)
    };
    let told = remove("runs/run-1/checkpoints/000000016667.safetensors");
    assert!(
        told.contains("000000016667.safetensors: cannot be read"),
        "{told}"
    );
    let told = remove("beds/bed.data");
    assert!(
        told.contains("manifest.json: beds/bed.data is missing"),
        "{told}"
    );
    let snapshot = "runs/run-1/snapshots/grains.000000008334.vtk";
    let told = remove(snapshot);
    assert!(
        told.contains(snapshot) && told.contains("missing"),
        "{told}"
    );
    let folder = copy();
    edit(folder.path(), "summary.json", |text| {
        text.replacen("\"mean\": ", "\"mean\": 1", 1)
    });
    let told = printed(folder.path(), &["verify", "run"], 3);
    assert!(
        told.contains("summary.json: not what the checkpoints give"),
        "{told}"
    );
}

/// A bed's chain depends on its recipe alone: scenarios that share the bed may have other links in their
/// drags.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_shared_bed_has_one_chain() {
    let folder = copy();
    let args = [
        "run",
        "small.toml",
        "--out",
        "seldom",
        "--set",
        "measure.digest_every=777",
    ];
    printed(folder.path(), &args, 0);
    let how = std::fs::read_to_string(folder.path().join("seldom/performance.json"));
    assert!(how.map_or(true, |how| how.contains("\"reused\"")));
    let bed =
        |out: &str| std::fs::read(folder.path().join(out).join("beds/bed.safetensors")).unwrap();
    assert!(bed("run") == bed("seldom"));
    printed(folder.path(), &["verify", "seldom", "--segment", "bed"], 0);
    // A library that is gone, or that holds something else, does not matter to a bed that lies here.
    let args = ["run", "--resume", "seldom", "--beds", "other-beds"];
    printed(folder.path(), &args, 0);
    assert!(bed("run") == bed("seldom"));
}

/// An imported bed is imported again, not poured.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn an_imported_bed_is_verified_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let bed = std::fs::read_to_string(golden("peers/bed200.data")).unwrap();
    // One of its grains is the intruder.
    let bed = bed.replacen("\n2 3 ", "\n2 2 ", 1);
    std::fs::write(folder.path().join("bed.data"), bed).unwrap();
    let text = small_from_file("bed.data", "").replacen(
        "distance = 4.0",
        "distance = 0.4\ndiscard = 0.1",
        1,
    );
    let text = text + "\n[measure]\nevery = 1\n";
    std::fs::write(folder.path().join("from.toml"), text).unwrap();
    printed(folder.path(), &["run", "from.toml", "--out", "run"], 0);
    let told = printed(folder.path(), &["verify", "run"], 0);
    assert!(told.contains("taken over again"), "{told}");
    let args = "replay run --stage bed --from 0 --steps 0 --digests";
    let line = printed(folder.path(), &args.split(' ').collect::<Vec<_>>(), 0);
    let line: serde_json::Value = serde_json::from_str(&line).unwrap();
    let chain = std::fs::read_to_string(folder.path().join("run/beds/bed.chain.csv")).unwrap();
    let chain = Chain::parse(&chain, "chain").unwrap();
    assert_eq!(line["parts"], serde_json::json!(chain.links[0].parts));
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn what_cannot_be_verified_is_refused() {
    let refused = |args: &[&str], word: &str| {
        let told = printed(RUN.path(), args, 2);
        assert!(told.contains(word), "{told}");
    };
    refused(&["verify", "nothing"], "holds no run");
    refused(
        &["verify", "run", "--segment", "run-9"],
        "there are bed, run-1, run-2",
    );
    refused(
        &["verify", "run", "--segment", "run-1:9-3"],
        "STAGE:FROM-TO",
    );
    refused(&["replay", "run", "--steps", "3"], "name its --stage");
    refused(
        &["replay", "small.toml", "--steps", "3", "--stage", "bed"],
        "is not a folder",
    );
    let late = [
        "replay",
        "run",
        "--stage",
        "run-1",
        "--from",
        "16660",
        "--steps",
        "10",
        "--digests",
    ];
    refused(&late, "the stage ends after step 16660");
    let late = [
        "replay",
        "run",
        "--stage",
        "run-1",
        "--from",
        "18446744073709551615",
        "--steps",
        "10",
    ];
    refused(&late, "does not have so many steps");
    refused(&["bisect", "run", "nothing"], "nothing: holds no chain");
    refused(&["bisect", "nothing", "run"], "nothing: holds no chain");
}

/// A stretch of a run, replayed from the checkpoint before it, repeats the run: the digests
/// of its chain, the rows of its series, the state that was kept.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_stretch_of_a_run_is_replayed() {
    let args = "replay run --stage run-1 --from 8300 --steps 300 --every 50";
    let mut args: Vec<&str> = args.split(' ').collect();
    args.extend(["--digests", "--save", "state"]);
    let text = printed(RUN.path(), &args, 0);
    let lines: Vec<serde_json::Value> = text
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines.len(), 7);
    let folder = RUN.path().join("run");
    let chain = std::fs::read_to_string(Folder(&folder).chain("run-1")).unwrap();
    let chain = Chain::parse(&chain, "chain").unwrap();
    for (line, step) in [(2, 8400), (6, 8600)] {
        let link = chain.links.iter().find(|link| link.step == step).unwrap();
        assert_eq!(lines[line]["step"], step);
        assert_eq!(lines[line]["parts"], serde_json::json!(link.parts));
    }
    let saved = checkpoint::read(&RUN.path().join("state"))
        .unwrap()
        .digest()
        .unwrap();
    assert_eq!(lines[6]["digest"], bitgrain::simulation::hex(&saved.whole));

    // With contacts, of a step at which a state was kept.
    let args = "replay run --stage run-1 --from 8334 --steps 0 --contacts";
    let text = printed(RUN.path(), &args.split(' ').collect::<Vec<_>>(), 0);
    let line: serde_json::Value = serde_json::from_str(&text).unwrap();
    let kept = checkpoint::read(&folder.join(HALF))
        .unwrap()
        .digest()
        .unwrap();
    assert_eq!(line["digest"], bitgrain::simulation::hex(&kept.whole));
    assert!(line["contacts"].as_array().unwrap().len() > 300);

    // A bed is poured again to there.
    let args = "replay run --stage bed --from 0 --steps 700 --every 350 --digests";
    let text = printed(RUN.path(), &args.split(' ').collect::<Vec<_>>(), 0);
    let steps: Vec<u64> = text
        .lines()
        .map(|l| {
            serde_json::from_str::<serde_json::Value>(l).unwrap()["step"]
                .as_u64()
                .unwrap()
        })
        .collect();
    assert_eq!(steps, [0, 350, 700]);
}
