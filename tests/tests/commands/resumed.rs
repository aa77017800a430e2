//! What a call goes on from may be forged: nothing that was found confirms a result, or goes into the library.

use std::path::Path;

use bitgrain::checkpoint;
use bitgrain::drag::Dragging;
use bitgrain::manifest::{FileRecord, Manifest};
use bitgrain_tests::wee::{Room, copy_all};

use crate::FURNISHED;

/// The checkpoints of run-1.
const KEPT: [&str; 3] = ["000000001389", "000000002778", "000000004167"];

fn kept(number: usize) -> String {
    format!("v/runs/run-1/checkpoints/{}.safetensors", KEPT[number])
}

/// A finished run in `run` and in `v`, and the last link of run-1.
fn room() -> (Room, String) {
    let room = FURNISHED.copy();
    copy_all(&room.path("run"), &room.path("v"));
    let manifest = Manifest::of(&room.path("v")).unwrap().unwrap();
    let link = manifest.link("run-1").unwrap().to_string();
    (room, link)
}

/// Makes the manifest of `v` that of the files that are wanted; run-1 is finished or not.
fn remake(room: &Room, finished: bool, wanted: impl Fn(&str) -> bool, more: &[&str]) {
    let root = room.path("v");
    let mut manifest = Manifest::of(&root).unwrap().unwrap();
    let names = manifest.files.iter().map(|entry| &entry.path[..]);
    let mut names: Vec<String> = names
        .chain(more.iter().copied())
        .map(String::from)
        .collect();
    names.sort();
    let gone = |name: &&String| !wanted(name);
    for name in names.iter().filter(gone) {
        std::fs::remove_file(root.join(name)).unwrap();
    }
    let there = names.iter().filter(|name| wanted(name));
    manifest.files = there
        .map(|name| FileRecord::of(name, &std::fs::read(root.join(name)).unwrap()))
        .collect();
    for stage in manifest
        .stages
        .iter_mut()
        .filter(|stage| stage.name == "run-1")
    {
        stage.finished = finished;
    }
    manifest.finished = finished;
    std::fs::write(root.join("manifest.json"), manifest.text()).unwrap();
}

/// A state of run-1 with a force ten times as large in its first row, at another step if one is given.
fn forge(from: &Path, to: &Path, step: Option<u64>) {
    let (mut sim, note) = checkpoint::read_noted(from).unwrap();
    let mut dragging = Dragging::of(&note).unwrap();
    dragging.record.series[0].force[0] *= 10.0;
    dragging.step = step.unwrap_or(dragging.step);
    let bytes = checkpoint::pack(&mut sim, &dragging.note()).unwrap();
    std::fs::write(to, bytes).unwrap();
}

/// A forged state beside honest ones, at the step of a kept one, ahead of its links, and beyond the end.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_forged_state_to_go_on_from_is_not_confirmed() {
    for step in [None, Some(100), Some(1_000_000)] {
        let (room, link) = room();
        forge(
            &room.path(&kept(0)),
            &room.path("v/runs/run-1/latest.safetensors"),
            step,
        );
        let before = |name: &str| name.contains(KEPT[0]) || !name.starts_with("runs/run-1/");
        remake(&room, false, before, &[]);
        let told = room.says(
            &format!("run wee.toml --out v --expect {link}"),
            match step {
                None => 3,
                // Neither is a state of this drag.
                _ => 0,
            },
        );
        let wanted = match step {
            None => "pieces that were found do not hold",
            _ => "executed again: all",
        };
        assert!(told.contains(wanted), "{step:?}: {told}");
    }
}

/// Of a chain in the place of a bed's, without links, nothing is believed.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_stage_has_one_chain() {
    let (room, link) = room();
    forge(&room.path(&kept(2)), &room.path(&kept(2)), None);
    let honest = String::from_utf8(room.read("v/runs/run-1/chain.csv")).unwrap();
    let head: String = honest.split_inclusive('\n').take(2).collect();
    room.write("v/beds/run-1.chain.csv", head);
    let states = |name: &str| !name.starts_with("runs/run-1/") || name.matches('/').count() == 3;
    remake(&room, false, states, &["beds/run-1.chain.csv"]);
    let told = room.says(
        &format!("run wee.toml --out v --beds empty --expect {link}"),
        3,
    );
    assert!(told.contains("run-1.chain.csv"), "{told}");
    let told = room.says("bisect run v", 2);
    assert!(told.contains("a stage has one chain"), "{told}");
}

/// A chain that does not end with the link of its manifest is no chain of the run.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_chain_ends_with_the_link_of_its_manifest() {
    let (room, _) = room();
    room.done("run wee.toml --out other --set law.mu=0.4");
    room.write(
        "v/runs/run-1/chain.csv",
        room.read("other/runs/run-1/chain.csv"),
    );
    remake(&room, true, |_| true, &[]);
    let told = room.says("bisect run v", 2);
    assert!(told.contains("does not end with the link"), "{told}");
}

/// A checkpoint holds the step that its name says, so that a piece has steps.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_checkpoint_is_of_the_step_of_its_name() {
    let (room, link) = room();
    std::fs::copy(room.path(&kept(2)), room.path(&kept(1))).unwrap();
    remake(&room, true, |_| true, &[]);
    let told = room.says(
        &format!("verify v --segment run-1:4000-4100 --expect {link}"),
        3,
    );
    assert!(told.contains("holds step 4167"), "{told}");
}

/// A bed that was found in a folder does not go into the library, and one under another law is no bed of its recipe.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn only_beds_that_were_poured_here_are_kept() {
    let (room, _) = room();
    room.done("run --resume v --beds own");
    assert!(
        !room.path("own").exists() || std::fs::read_dir(room.path("own")).unwrap().count() == 0
    );
    room.done("run wee.toml --out other --set law.mu=0.4 --beds others");
    let (mut sim, note) = checkpoint::read_noted(&room.path("v/beds/bed.safetensors")).unwrap();
    sim.law = checkpoint::read_noted(&room.path("other/beds/bed.safetensors"))
        .unwrap()
        .0
        .law;
    let bed = std::fs::read_dir(room.path("beds"))
        .unwrap()
        .next()
        .unwrap()
        .unwrap();
    let name = bed.file_name().into_string().unwrap();
    room.write(
        &format!("beds/{name}/bed.safetensors"),
        checkpoint::pack(&mut sim, &note).unwrap(),
    );
    let told = room.says("run wee.toml --out new", 2);
    assert!(told.contains("another law"), "{told}");
}
