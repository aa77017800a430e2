//! What `--merge` removes of tasks, and what stays.

use bitgrain::manifest::{FileRecord, Manifest};
use bitgrain_tests::wee::{Room, copy_all};

use crate::FURNISHED;

/// A finished campaign beside which a task of its first drag lies, as that was before it was gathered.
fn with_a_task() -> Room {
    let room = FURNISHED.copy();
    std::fs::remove_dir_all(room.path("camp")).unwrap();
    room.done("sweep weecamp.toml --out camp --task mu0.3/run-1");
    copy_all(&room.path("camp/tasks"), &room.path("kept"));
    room.done("sweep weecamp.toml --out camp");
    copy_all(&room.path("kept"), &room.path("camp/tasks"));
    room
}

/// `--merge` removes of a task what it wrote, not what somebody put in the place of a result.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_merge_leaves_what_was_put_in_the_place_of_a_result() {
    let room = with_a_task();
    room.write("camp/tasks/mu0.3/run-1/runs/run-1/forces.csv", "mine");
    let told = room.done("sweep weecamp.toml --out camp --merge");
    assert!(told.contains("holds other files and stays"), "{told}");
    assert_eq!(
        room.read("camp/tasks/mu0.3/run-1/runs/run-1/forces.csv"),
        b"mine"
    );
    assert_eq!(room.files("camp/tasks").len(), 1);
}

/// A task whose files differ from those that its member has already is told, and stays.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_merge_keeps_a_task_that_came_out_otherwise() {
    let room = with_a_task();
    let task = room.path("camp/tasks/mu0.3/run-1");
    let mut manifest = Manifest::of(&task).unwrap().unwrap();
    let name = "runs/run-1/forces.csv";
    let mut text = std::fs::read(task.join(name)).unwrap();
    text.push(b'\n');
    std::fs::write(task.join(name), &text).unwrap();
    let entry = manifest.files.iter_mut().find(|entry| entry.path == name);
    *entry.unwrap() = FileRecord::of(name, &text);
    std::fs::write(task.join("manifest.json"), manifest.text()).unwrap();
    let told = room.done("sweep weecamp.toml --out camp --merge");
    assert!(
        told.contains("is not the file that its member has"),
        "{told}"
    );
    assert_eq!(std::fs::read(task.join(name)).unwrap(), text);
}
