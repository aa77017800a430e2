//! Something of a user's own in every place of a run, a campaign and a library, before every command that writes:
//! whatever the command does, that stays as it was, and so does what a link leads to.
//!
//! The whole of it: `cargo test -p bitgrain-tests --release --test commands planted:: -- --ignored --nocapture`

use std::collections::BTreeMap;
use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use bitgrain_tests::wee::{Room, copy_all};

use crate::damage::inventory;

/// What is planted.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Plant {
    File,
    LinkToFile,
    LinkToFolder,
    Folder,
    Pipe,
}

const PLANTS: [Plant; 5] = [
    Plant::File,
    Plant::LinkToFile,
    Plant::LinkToFolder,
    Plant::Folder,
    Plant::Pipe,
];

/// Commands, each with the folders that it may write to.
const VERBS: [(&str, &[&str]); 13] = [
    ("run --resume run", &["run/", "beds/"]),
    ("run wee.toml --out run --beds empty", &["run/", "empty/"]),
    ("run wee.toml --out fresh", &["fresh/", "beds/"]),
    ("run wee.toml --out run --against twin", &["run/", "beds/"]),
    ("report run", &["run/"]),
    ("analyse run", &["run/"]),
    ("sweep weecamp.toml --out camp", &["camp/", "beds/"]),
    ("sweep weecamp.toml --out camp --merge", &["camp/", "beds/"]),
    (
        "sweep weecamp.toml --out pieces --task mu0.3/run-1",
        &["pieces/", "beds/"],
    ),
    ("sweep weecamp.toml --out pieces --merge", &["pieces/"]),
    (
        "sweep weecamp.toml --out camp --submit slurm --dry-run",
        &["camp/"],
    ),
    ("analyse camp", &["camp/"]),
    ("bed remove --all --beds beds", &["beds/"]),
];

/// Names that a command may write and a finished room does not have, and names that it never writes.
const FREE: [&str; 36] = [
    "run/manifest.json",
    "run/report.html",
    "run/performance.json",
    "camp/manifest.json",
    "camp/report.html",
    "camp/analysis.json",
    "run/notes.txt",
    "run/analysis.json",
    "run/difference.json",
    "run/difference.safetensors",
    "run/failure.json",
    "run/slurm",
    "run/beds/notes.txt",
    "run/beds/imported",
    "run/beds/bed.pouring.safetensors",
    "run/runs/notes.txt",
    "run/runs/run-1/notes.txt",
    "run/runs/run-1/latest.safetensors",
    "run/runs/run-1/forces.partial.csv",
    "run/runs/run-1/failure.json",
    "fresh/scenario.toml",
    "fresh/manifest.json",
    "fresh/beds",
    "fresh/runs/run-1/forces.csv",
    "fresh/report.html",
    "camp/notes.txt",
    "camp/tasks",
    "camp/tasks/archive/2023/thesis.tex",
    "camp/tasks/mu0.3",
    "camp/tasks/mu0.3/run-1",
    "camp/tasks/mu0.3/run-1/notes.txt",
    "camp/members/mu0.3/runs/run-1/latest.safetensors",
    "camp/members/mu0.3/failure.json",
    "camp/slurm",
    "pieces/tasks/mu0.3/run-2/notes.txt",
    "beds/notes.txt",
];

/// A finished run, another one, a finished campaign, one of whose drags two were done in pieces, and their library.
static FURNISHED: LazyLock<Room> = LazyLock::new(|| {
    let room = crate::FURNISHED.copy();
    copy_all(&room.path("run"), &room.path("twin"));
    for run in ["run-1", "run-2"] {
        room.done(&format!(
            "sweep weecamp.toml --out pieces --task mu0.3/{run}"
        ));
    }
    for name in [
        "forces.csv",
        "chain.csv",
        "latest.safetensors",
        "recipe.toml",
    ] {
        room.write(&format!("others/{name}"), "mine");
    }
    room.write("others/a.csv.12-0.bitgrain-partial", "mine");
    room.write("others/empty/thesis.tex", "mine");
    room
});

/// Every place: those of what a finished room has in these folders, and the free ones.
fn places() -> Vec<(String, bool)> {
    let own = inventory(FURNISHED.folder.path());
    let folders = ["run", "camp", "pieces", "beds"];
    let there = own.into_keys().filter(|name| {
        let top = name.split('/').next().unwrap_or_default();
        folders.contains(&top) && name.contains('/')
    });
    let free = FREE.iter().map(|name| (name.to_string(), true));
    let there = there.filter(|name| !FREE.contains(&&name[..]));
    there.map(|name| (name, false)).chain(free).collect()
}

/// Puts it there, in the place of what there was.
fn plant(room: &Room, name: &str, what: Plant) -> PathBuf {
    let path = room.path(name);
    if path.is_dir() {
        std::fs::remove_dir_all(&path).unwrap();
    } else if path.exists() {
        std::fs::remove_file(&path).unwrap();
    }
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let others = room.path("others");
    match what {
        Plant::File => std::fs::write(&path, "mine").unwrap(),
        Plant::LinkToFile => symlink(others.join("forces.csv"), &path).unwrap(),
        Plant::LinkToFolder => symlink(&others, &path).unwrap(),
        Plant::Folder => {
            std::fs::create_dir(&path).unwrap();
            std::fs::write(path.join("notes.txt"), "mine").unwrap();
        }
        Plant::Pipe => {
            let made = Command::new("mkfifo").arg(&path).status().unwrap();
            assert!(made.success());
        }
    }
    path
}

/// Whether it is still there.
fn stands(room: &Room, path: &Path, what: Plant) -> bool {
    let Ok(data) = std::fs::symlink_metadata(path) else {
        return false;
    };
    let leads = |to: PathBuf| std::fs::read_link(path).is_ok_and(|found| found == to);
    let holds = |path: &Path| std::fs::read(path).is_ok_and(|bytes| bytes == b"mine");
    match what {
        Plant::File => data.is_file() && holds(path),
        Plant::LinkToFile => leads(room.path("others/forces.csv")),
        Plant::LinkToFolder => leads(room.path("others")),
        Plant::Folder => data.is_dir() && holds(&path.join("notes.txt")),
        Plant::Pipe => data.file_type().is_fifo(),
    }
}

fn only(files: &BTreeMap<String, Vec<u8>>, wanted: impl Fn(&str) -> bool) -> BTreeMap<&str, &[u8]> {
    let files = files.iter().map(|(name, bytes)| (&name[..], &bytes[..]));
    files.filter(|(name, _)| wanted(name)).collect()
}

/// Plants one thing before one command; says whether the command refused it.
fn try_one(name: &str, what: Plant, (words, writes): (&str, &[&str])) -> bool {
    let room = FURNISHED.copy();
    let path = plant(&room, name, what);
    let before = inventory(room.folder.path());
    let out = room.told(words);
    let after = inventory(room.folder.path());
    let text = String::from_utf8_lossy(&out.stdout) + String::from_utf8_lossy(&out.stderr);
    let case = format!(
        "{what:?} as {name} before `{words}`: {:?}: {text}",
        out.status.code()
    );
    assert!(
        !text.contains("panicked") && out.status.code().is_some_and(|code| code < 4),
        "{case}"
    );
    assert!(stands(&room, &path, what), "{case}");
    let elsewhere = |name: &str| {
        !writes
            .iter()
            .any(|folder| name.starts_with(folder) || *folder == format!("{name}/"))
    };
    assert_eq!(only(&before, elsewhere), only(&after, elsewhere), "{case}");
    let refused = out.status.code() != Some(0);
    // What is refused is named, and refused before anything is written.
    let named = name.split('/').skip(1).any(|word| text.contains(word));
    assert!(out.status.code() != Some(2) || named, "{case}");
    refused
}

/// All cases, or every `nth` of them.
fn matrix(nth: usize) {
    let mut cases = Vec::new();
    for (name, free) in places() {
        let top = format!("{}/", name.split('/').next().unwrap_or_default());
        for what in PLANTS {
            // A file of ours that holds something else is damaged, and is made again.
            if what == Plant::File && !free {
                continue;
            }
            let verbs = VERBS
                .iter()
                .filter(|(_, writes)| writes.contains(&&top[..]));
            cases.extend(verbs.map(|verb| (name.clone(), what, *verb)));
        }
    }
    let cases: Vec<_> = cases.into_iter().step_by(nth).collect();
    let (mut refused, mut failed) = (0, 0);
    for (name, what, verb) in &cases {
        let tried = std::panic::catch_unwind(|| try_one(name, *what, *verb));
        refused += usize::from(*tried.as_ref().unwrap_or(&false));
        failed += usize::from(tried.is_err());
    }
    assert_eq!(failed, 0, "of {} cases", cases.len());
    println!("{} cases, {refused} refused", cases.len());
    assert!(refused * 3 > cases.len(), "{refused} of {}", cases.len());
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_is_planted_stays() {
    matrix(37);
}

#[test]
#[ignore = "minutes"]
fn all_that_is_planted_stays() {
    matrix(1);
}

/// What was written here and what was not is told apart where nothing lists it.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn ours_and_others_are_told_apart() {
    let room = FURNISHED.copy();
    // A state that no comparison left.
    std::fs::copy(
        room.path("run/beds/bed.safetensors"),
        room.path("run/difference.safetensors"),
    )
    .unwrap();
    let told = room.says("run wee.toml --out run --against twin", 2);
    assert!(told.contains("difference.safetensors"), "{told}");
    // A run of somebody else in the place of a task.
    let place = "camp/tasks/mu0.3/run-1";
    room.done("run wee.toml --out moved --set law.mu=0.9");
    copy_all(&room.path("moved"), &room.path(place));
    let before = room.files(place);
    let told = room.done("sweep weecamp.toml --out camp");
    assert!(told.contains("the folder of the task stays"), "{told}");
    assert_eq!(room.files(place), before);
    // The manifest is lost: what is marked as a result was written here, and what is not made again goes.
    let room = FURNISHED.copy();
    std::fs::remove_file(room.path("run/manifest.json")).unwrap();
    let (series, half) = (
        room.read("run/runs/run-1/forces.csv"),
        "run/runs/run-1/forces.partial.csv",
    );
    room.write(half, "mine");
    let told = room.says("run --resume run", 2);
    assert!(told.contains("move it away"), "{told}");
    room.write(half, series);
    room.done("run --resume run");
    room.done("verify run");
    assert_eq!(room.files("run"), FURNISHED.files("run"));
}
