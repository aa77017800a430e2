//! Paths that lead elsewhere than they seem to: past a folder that is not there, through links, into results; and
//! names that are not text, or that a shell or a run takes for something of its own.

use std::process::Output;

use bitgrain::recording::array::Element;
use bitgrain::recording::{ArrayRef, Keep, Recorder};
use bitgrain_tests::wee::{Room, WEE};

use crate::damage::inventory;
use crate::{FURNISHED, PROGRAM};

/// Refused for this reason, and nothing is made or changed.
fn refused(room: &Room, words: &str, reason: &str) {
    let before = inventory(room.folder.path());
    let told = room.says(words, 2);
    assert!(told.contains(reason), "{words}: {told}");
    assert!(inventory(room.folder.path()) == before, "{words}: {told}");
}

fn said(out: &Output) -> String {
    let text = String::from_utf8_lossy(&out.stdout);
    text.into_owned() + &String::from_utf8_lossy(&out.stderr)
}

#[cfg(unix)]
fn link(room: &Room, to: &str, name: &str) {
    let path = room.path(name);
    let _ = std::fs::remove_file(&path);
    std::os::unix::fs::symlink(room.path(to), path).unwrap();
}

/// What lies behind a folder that is made only later is not looked at before, so no such path is taken.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn nothing_is_written_past_a_folder_that_is_not_there() {
    let room = FURNISHED.copy();
    for name in [
        "scenario.toml",
        "campaign.toml",
        "summary.json",
        "bitgrain.1",
        "arrays/000000000000.safetensors",
    ] {
        room.write(&format!("mine/{name}"), "mine");
    }
    let commands = [
        "run wee.toml --out new/../mine",
        "run wee.toml --out out --beds new/../mine",
        "run wee.toml --out new/../mine --submit slurm --dry-run",
        "sweep weecamp.toml --out new/../mine",
        "sweep weecamp.toml --out new/../mine --task mu0.3/bed",
        "sweep weecamp.toml --out new/../mine --submit slurm --dry-run",
        "benchmark chung-ooi --out new/../mine",
        "man new/../mine",
        "record new/../mine --keep all",
        "replay run --stage run-1 --steps 0 --vtk new/../mine",
        "replay run --stage run-1 --steps 0 --save new/../run/summary.json",
        "analyse run --out run/runs/run-1/x/../forces.csv",
        "analyse run --out new/a.json --report new/../run/summary.json",
        "bisect bitgrain bitgrain --scenario wee.toml --out new/../mine",
    ];
    for words in commands {
        refused(&room, words, "is no folder, and `..` behind it");
    }
    // A command line is no path, and what is there may be left by `..`.
    let told = said(&room.told("bisect --commands new/../a new/../b"));
    assert!(!told.contains("is no folder"), "{told}");
    room.done("man run/../pages");
    // Nor does the current folder have to be there as `new/.` before `new` is.
    #[cfg(unix)]
    room.done("run wee.toml --out new/. --submit slurm --dry-run");
}

/// A run is compared as a run, whatever else lies in its folder.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_recording_in_a_run_is_not_compared_in_its_place() {
    let room = FURNISHED.copy();
    let mut recorder = Recorder::create(&room.path("recorded"), Keep::Digests).unwrap();
    let one = ArrayRef {
        element: Element::U8,
        shape: &[1],
        bytes: &[1],
    };
    recorder.record(0, &[("one", one)]).unwrap();
    recorder.close().unwrap();
    room.says("bisect run camp/members/mu0.3", 3);
    for run in ["run", "camp/members/mu0.3"] {
        let recording = room.read("recorded/recording.csv");
        room.write(&format!("{run}/recording.csv"), recording);
    }
    for words in [
        "bisect run camp/members/mu0.3",
        "bisect recorded run",
        "bisect run recorded",
    ] {
        refused(&room, words, "holds both a run and a recording");
    }
    room.done("bisect run/recording.csv camp/members/mu0.3/recording.csv");
    for (folder, reason) in [
        ("camp", "is the folder of a run or campaign"),
        ("run/runs/new", "lies among the results of the run"),
        ("camp/members/new", "lies among the results of the campaign"),
    ] {
        refused(&room, &format!("record {folder}"), reason);
    }
}

/// Files in a folder whose name is not text are extra as others are.
#[test]
#[cfg(target_os = "linux")]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn no_name_hides_a_file_among_results() {
    use std::os::unix::ffi::OsStrExt;
    let room = FURNISHED.copy();
    let name = std::ffi::OsStr::from_bytes(b"x\xff");
    let hidden = room.path("run/runs/run-1").join(name);
    std::fs::create_dir(&hidden).unwrap();
    std::fs::write(hidden.join("forces.csv"), "extra").unwrap();
    let told = room.says("verify run --sample 1", 3);
    assert!(told.contains("x\u{fffd} is extra"), "{told}");
    let mut command = room.command("run wee.toml --out");
    let out = command.arg(hidden.join("new")).output().unwrap();
    let told = said(&out);
    assert_eq!(out.status.code(), Some(2), "{told}");
    assert!(told.contains("lies among the results"), "{told}");
}

/// Of what a run or campaign keeps in its folder nothing is read that lies elsewhere.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn nothing_saved_is_read_through_a_link() {
    let room = FURNISHED.copy();
    let commands = [
        "verify run",
        "run --resume run",
        "report run",
        "replay run --stage run-2 --from 700 --steps 0",
    ];
    room.write("secret", "root:x:0:0\n");
    link(&room, "secret", "run/scenario.toml");
    for words in commands {
        let told = room.says(words, 2);
        assert!(!told.contains("root:x"), "{words}: {told}");
    }
    link(&room, "secret", "camp/campaign.toml");
    let told = room.says("verify camp", 2);
    assert!(!told.contains("root:x"), "{told}");
    // The same scenario, and the same states, elsewhere.
    let read = [
        ("scenario.toml", commands[3]),
        ("beds/bed.safetensors", commands[3]),
        (
            "runs/run-2/checkpoints/000000000695.safetensors",
            commands[3],
        ),
        ("beds/bed.safetensors", "verify run --segment run-2:0-1"),
    ];
    for (name, words) in read {
        let room = FURNISHED.copy();
        room.write("elsewhere", room.read(&format!("run/{name}")));
        link(&room, "elsewhere", &format!("run/{name}"));
        let told = said(&room.told(words));
        assert!(
            told.contains("is a symbolic link"),
            "{name}, {words}: {told}"
        );
    }
}

/// Nothing is put among the results of a run or campaign, by whatever path.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn nothing_is_put_among_results() {
    let room = FURNISHED.copy();
    link(&room, "run", "way");
    link(&room, "run/runs", "runs");
    for words in [
        "run wee.toml --out run --beds way/beds",
        "run wee.toml --out way --beds run/beds/more",
        "run wee.toml --out other --beds run/runs/beds",
        "run wee.toml --out runs/new",
        "run wee.toml --out run/beds/../runs/new",
        "run wee.toml --out runs/new --submit slurm --dry-run",
        "sweep weecamp.toml --out runs/new",
    ] {
        refused(&room, words, "lies among the results of the run in ");
    }
    for words in [
        "run wee.toml --out camp/members/new",
        "run wee.toml --out camp/tasks/new/run-1",
        "run wee.toml --out new --beds camp/members/mu0.3/beds",
        "sweep weecamp.toml --out camp/members/new",
        "sweep weecamp.toml --out camp --beds camp/members/mu0.3/beds",
        "sweep weecamp.toml --out new --beds new/tasks",
        "sweep weecamp.toml --out new --beds new/tasks --task mu0.3/bed",
        "sweep weecamp.toml --out new --beds new/members/mu0.3 --tasks",
    ] {
        refused(&room, words, "lies among the results of the ");
    }
    // Members are runs, and `tasks` is nothing in a folder of others.
    room.done("run --resume camp/members/mu0.3");
    room.done("run wee.toml --out tasks/members/new");
}

/// A run has a copy of an imported bed under its name, which must not be one that the run uses otherwise.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_bed_is_not_imported_by_a_name_of_ours() {
    let room = FURNISHED.copy();
    let bed = "box = [5.0, 5.0, 6.0]\ngrains = 130\nsettled = 1e-1";
    let scenario = |name: &str| {
        let text = WEE.replacen(bed, &format!("file = '{name}'"), 1);
        text.replacen("diameter = 1.0\nheight = 3.0\n", "", 1)
    };
    for name in ["failure.json", "a\\b.data", "a.data.1-2.bitgrain-partial"] {
        room.write(name, room.read("run/beds/bed.data"));
        room.write("imported.toml", scenario(name));
        refused(
            &room,
            "run imported.toml --out new",
            "that a run cannot give",
        );
        refused(
            &room,
            "run imported.toml --dry-run",
            "that a run cannot give",
        );
    }
    room.write("a b.data", room.read("run/beds/bed.data"));
    room.write("imported.toml", scenario("a b.data"));
    room.done("run imported.toml --dry-run");
}

/// The states of a search lie in the system's folder for temporary files, whatever its name.
#[test]
#[cfg(target_os = "linux")]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_search_leaves_nothing_whatever_the_name_of_its_folder() {
    use std::os::unix::ffi::OsStrExt;
    let room = Room::new(PROGRAM);
    let temporary = room.path("").join(std::ffi::OsStr::from_bytes(b"t\xff"));
    std::fs::create_dir(&temporary).unwrap();
    let folders = ["run", "camp/members/mu0.3"].map(|name| FURNISHED.path(name));
    let mut command = room.command("bisect");
    let out = command.args(folders).env("TMPDIR", &temporary).output();
    let out = out.unwrap();
    assert_eq!(out.status.code(), Some(3), "{}", said(&out));
    let names = std::fs::read_dir(room.folder.path()).unwrap();
    assert_eq!(names.count(), 3, "two files and the folder");
    assert_eq!(std::fs::read_dir(&temporary).unwrap().count(), 0);
}
