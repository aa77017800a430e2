//! Recordings on the command line: made from a pipe, compared, and found while two commands run.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use bitgrain::recording::array::{Element, little_endian};
use bitgrain::recording::{ArrayRef, Keep, Recorder};
use bitgrain_tests::{golden, printed, told};

use crate::PROGRAM;
use crate::asked::CHILD;

/// Gives a command these bytes on its standard input.
fn fed(folder: &Path, args: &[&str], input: &[u8]) -> Output {
    let mut command = Command::new(PROGRAM);
    command.args(args).current_dir(folder);
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A command that refuses the beginning does not read the rest.
    let _ = child.stdin.take().unwrap().write_all(input);
    child.wait_with_output().unwrap()
}

/// The frames of some steps of two numbers, the second of which is another from step `parts` on.
fn frames(steps: std::ops::Range<u64>, parts: u64) -> Vec<u8> {
    let mut out = Vec::new();
    for step in steps {
        write!(out, "step {step}\narray x f64 1x2\n").unwrap();
        let second = if step < parts { 0.5 } else { 0.5f64.next_up() };
        out.extend(little_endian(&[step as f64, second]));
        out.extend(b"done\n");
    }
    out.extend(b"end\n");
    out
}

#[test]
fn what_is_piped_in_is_what_a_recorder_writes() {
    let room = tempfile::tempdir().unwrap();
    let out = fed(
        room.path(),
        &["record", "piped", "--keep", "all"],
        &frames(0..5, 9),
    );
    let told = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(
        out.status.success() && told.starts_with("piped: 5 steps; last link "),
        "{told}"
    );
    let mut recorder = Recorder::create(&room.path().join("called"), Keep::All).unwrap();
    for step in 0..5 {
        let bytes = little_endian(&[step as f64, 0.5]);
        let x = ArrayRef {
            element: Element::F64,
            shape: &[1, 2],
            bytes: &bytes,
        };
        recorder.record(step, &[("x", x)]).unwrap();
    }
    let link = recorder.close().unwrap();
    assert!(told.contains(&link), "{told}");
    assert_eq!(
        bitgrain_tests::results(&room.path().join("piped")),
        bitgrain_tests::results(&room.path().join("called"))
    );
}

/// A recording that a program writes by itself, without a library of ours, in the lines that the guide describes.
#[test]
fn anyone_can_write_a_recording() {
    let room = tempfile::tempdir().unwrap();
    let mut text = String::from("# bitgrain recording 1\nstep,array,type,shape,digest,link\n");
    let mut link = "0".repeat(64);
    for step in 0..5 {
        let digest = blake3::hash(&little_endian(&[f64::from(step), 0.5]));
        let row = format!("{step},x,f64,1x2,{digest}");
        link = blake3::hash(format!("{link},{row}").as_bytes()).to_string();
        writeln!(text, "{row},{link}").unwrap();
    }
    writeln!(text, "# end {link}").unwrap();
    std::fs::write(room.path().join("own.csv"), &text).unwrap();
    let out = fed(room.path(), &["record", "piped"], &frames(0..5, 9));
    assert!(out.status.success());
    assert_eq!(
        std::fs::read_to_string(room.path().join("piped/recording.csv")).unwrap(),
        text
    );
    let same = printed(PROGRAM, room.path(), &["bisect", "own.csv", "piped"], 0);
    assert!(same.contains("no difference"), "{same}");
    assert!(
        fed(
            room.path(),
            &["record", "other", "--keep", "last:3"],
            &frames(0..5, 3)
        )
        .status
        .success()
    );
    let parted = printed(PROGRAM, room.path(), &["bisect", "own.csv", "other"], 3);
    assert!(
        parted.contains(
            "the same to step 2, different at step 3\n  arrays: x\n  the first did not keep"
        ),
        "{parted}"
    );
}

#[test]
fn two_recordings_part_at_a_bit() {
    let room = tempfile::tempdir().unwrap();
    for (name, parts) in [("one", 9), ("other", 3)] {
        let out = fed(
            room.path(),
            &["record", name, "--keep", "every:3"],
            &frames(0..5, parts),
        );
        assert!(out.status.success());
    }
    let found = "the same to step 2, different at step 3
  arrays: x
  x[0, 1]: 0.5 (0x3fe0000000000000) against 0.5000000000000001 (0x3fe0000000000001)
  bits: one differs, bit 0; 1 ulp apart
  elements: 1 of 2 differ
bitgrain: the runs differ
";
    assert_eq!(
        printed(PROGRAM, room.path(), &["bisect", "one", "other"], 3),
        found
    );
}

/// What comes is compared with another recording as it comes, to the end of both.
#[test]
fn what_comes_is_held_against_a_recording() {
    let room = tempfile::tempdir().unwrap();
    let record = |name: &str, more: &[&str], input: &[u8], status: i32| {
        let out = fed(room.path(), &[&["record", name], more].concat(), input);
        let told = String::from_utf8_lossy(&out.stdout).into_owned()
            + &String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(status), "{name}: {told}");
        told
    };
    let good = frames(0..6, 9);
    let told = record("golden", &["--keep", "all"], &good, 0);
    let link = told.trim().rsplit(' ').next().unwrap();
    let against = ["--against", "golden"];
    let told = record(
        "same",
        &[&against[..], &["--expect", link]].concat(),
        &good,
        0,
    );
    assert!(told.contains("no difference"), "{told}");

    let told = record("bit", &against, &frames(0..6, 3), 3);
    let found = "the first is golden, the second standard input, recorded in bit
the same to step 2, different at step 3
  arrays: x
  x[0, 1]: 0.5 (0x3fe0000000000000) against 0.5000000000000001 (0x3fe0000000000001)
";
    assert!(told.starts_with(found), "{told}");
    // Nothing after the difference was read, and what was recorded has no end.
    let text = std::fs::read_to_string(room.path().join("bit/recording.csv")).unwrap();
    assert!(text.lines().last().unwrap().starts_with("3,x,"), "{text}");

    let told = record("short", &against, &frames(0..4, 9), 3);
    let ends = "the same to step 3: the first goes on with step 4, the second ends with step 3";
    assert!(told.contains(ends), "{told}");
    let told = record("long", &against, &frames(0..8, 9), 3);
    let ends = "the same to step 5: the first ends with step 5, the second goes on with step 6";
    assert!(told.contains(ends), "{told}");
    // A program that dies, between two steps and in the midst of one.
    let frame = good.len() / 6;
    for (name, left) in [("died", 3 * frame), ("dying", 3 * frame + 33)] {
        let cut = &good[..left];
        let told = record(name, &against, cut, 3);
        assert!(
            told.contains("the second was cut off after step 2"),
            "{told}"
        );
        record(&format!("{name}-alone"), &[], cut, 2);
    }
    let prefix = ["--against", "golden", "--prefix"];
    for (name, steps, same) in [
        ("short-meant", 0..4, "4 of 6"),
        ("long-meant", 0..8, "6 of 6"),
    ] {
        let told = record(name, &prefix, &frames(steps, 9), 0);
        let compared = format!("{same} steps of the first were compared");
        assert!(told.contains(&compared), "{told}");
    }
    record("bit-meant", &prefix, &frames(0..6, 3), 3);
    let told = record("other", &["--expect", link], &frames(0..6, 3), 3);
    assert!(told.contains("its last link is not"), "{told}");

    // A recording that was cut is not a whole one, whatever it is compared with.
    std::fs::create_dir(room.path().join("cut")).unwrap();
    let text = std::fs::read_to_string(room.path().join("golden/recording.csv")).unwrap();
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    for left in [lines.len() - 1, lines.len() - 2] {
        std::fs::write(
            room.path().join("cut/recording.csv"),
            lines[..left].concat(),
        )
        .unwrap();
        for pair in [["cut", "golden"], ["golden", "cut"], ["cut", "cut"]] {
            let told = printed(PROGRAM, room.path(), &["bisect", pair[0], pair[1]], 3);
            assert!(told.contains("cut off"), "{told}");
            let args = ["bisect", "--prefix", pair[0], pair[1]];
            printed(PROGRAM, room.path(), &args, 0);
        }
        record(&format!("of-cut-{left}"), &["--against", "cut"], &good, 3);
    }
    printed(PROGRAM, room.path(), &["bisect", "golden", "short"], 3);
    printed(
        PROGRAM,
        room.path(),
        &["bisect", "golden", "short", "--prefix"],
        0,
    );
}

/// A recording is written neither through a link nor over what lies there.
#[test]
#[cfg(unix)]
fn a_recording_replaces_nothing() {
    let room = tempfile::tempdir().unwrap();
    let place = |name: &str| room.path().join(name);
    std::fs::create_dir_all(place("others")).unwrap();
    for (folder, name, to) in [
        ("one", "recording.csv", "others/notes.csv"),
        ("two", "arrays", "others"),
        ("three", "recording.csv", "nowhere"),
    ] {
        std::fs::create_dir(place(folder)).unwrap();
        std::os::unix::fs::symlink(place(to), place(folder).join(name)).unwrap();
        let out = fed(
            room.path(),
            &["record", folder, "--keep", "all"],
            &frames(0..2, 9),
        );
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{told}");
        assert!(told.contains("has a recording already"), "{told}");
    }
    assert!(!place("nowhere").exists());
    assert_eq!(std::fs::read_dir(place("others")).unwrap().count(), 0);
}

/// Messages, as they are told.
struct Table {
    room: tempfile::TempDir,
    text: String,
}

impl Table {
    fn folder(&self) -> &Path {
        self.room.path()
    }

    /// A command that is refused.
    fn add(&mut self, args: &[&str], input: &[u8]) {
        let out = fed(self.folder(), args, input);
        assert_eq!(out.status.code(), Some(2), "{}", told(args, &out));
        self.text += &told(args, &out);
    }
}

/// What is not as it should be, each with its message: frames, recordings, commands.
#[test]
#[cfg(unix)]
fn messages_say_what_is_wrong() {
    let mut table = Table {
        room: tempfile::tempdir().unwrap(),
        text: String::new(),
    };
    frames_that_are_refused(&mut table);
    recordings_that_are_refused(&mut table);
    commands_that_misbehave(&mut table);
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("recordings", table.text));
}

fn frames_that_are_refused(table: &mut Table) {
    let good = frames(0..3, 9);
    let inputs: [(&str, &[u8]); 19] = [
        ("nothing", b""),
        ("no-end", &good[..good.len() - 4]),
        ("cut", &good[..good.len() - 20]),
        ("other", b"x = 3\n"),
        ("step", b"step one\n"),
        ("type", b"step 1\narray x float64 2\n"),
        ("shape", b"step 1\narray x f64 2,2\n"),
        ("name", b"step 1\narray x:y u8 1\nadone\n"),
        ("more", b"step 1\narray x u8 3\nabcddone\n"),
        ("fewer", b"step 1\narray x u8 7\nabcddone\nend\n"),
        ("twice", b"step 1\narray x u8 1\naarray x u8 1\naend\n"),
        (
            "back",
            b"step 1\narray x u8 1\nadone\nstep 1\narray x u8 1\nadone\n",
        ),
        ("none", b"step 1\ndone\n"),
        ("large", b"step 1\narray x f64 1000000x1000\n"),
        ("long", &[b'a'; 2000]),
        ("binary", b"\xff\n"),
        ("neither", b"step 1\narray x bool 1\n\x07done\nend\n"),
        ("kept", b"step 1\narray __metadata__ u8 1\nadone\nend\n"),
        ("after", b"step 1\narray x u8 1\nadone\nend\nstep 2\n"),
    ];
    for (name, input) in inputs {
        table.add(&["record", name], input);
    }
    table.add(&["record", "cut"], &good);
    // 145 bytes or more a step: before the 9,000th the file would have more than a MiB.
    table.add(&["record", "much", "--max-input", "1"], &frames(0..9000, 0));
    table.add(&["record", "it", "--keep", "some"], &good);
}

fn recordings_that_are_refused(table: &mut Table) {
    let out = fed(table.folder(), &["record", "good"], &frames(0..3, 9));
    assert!(out.status.success());
    let whole = std::fs::read_to_string(table.folder().join("good/recording.csv")).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    let spoilt = [
        ("head.csv", "step,array\n".to_string()),
        ("changed.csv", whole.replacen("\n1,x", "\n1,y", 1)),
        ("missing.csv", whole.replace(lines[3], "")),
        ("half.csv", whole[..whole.len() - 100].to_string()),
        ("columns.csv", whole.replace(lines[3], "1,x,f64\n")),
        ("ended.csv", format!("{whole}{}", lines[3])),
        ("last.csv", whole.replace(lines[4], "")),
    ];
    for (name, text) in &spoilt {
        std::fs::write(table.folder().join(name), text).unwrap();
        table.add(&["bisect", "good", name], b"");
    }
    std::fs::create_dir(table.folder().join("empty")).unwrap();
    let empty = b"step 1\narray x f64 0x3\ndone\nend\n";
    for (name, input) in [("no-steps", &b"end\n"[..]), ("no-element", empty)] {
        assert!(
            fed(table.folder(), &["record", name], input)
                .status
                .success()
        );
    }
    let pairs = [
        ["good", "empty"],
        ["none.csv", "good"],
        ["no-steps", "no-steps"],
        ["no-element", "no-element"],
    ];
    for args in pairs {
        table.add(&["bisect", args[0], args[1]], b"");
    }
    let good = frames(0..3, 9);
    table.add(&["record", "new", "--against", "nowhere"], &good);
    table.add(&["record", "new", "--against", "half.csv"], &good);
    table.add(&["record", "new", "--prefix"], &good);
    table.add(&["record", "new", "--expect", "abc"], &good);
    let link = "0".repeat(64);
    table.add(&["record", "none-1", "--expect", &link], b"end\n");
    table.add(
        &["record", "none-2", "--against", "good", "--prefix"],
        b"end\n",
    );
    assert!(!table.folder().join("new").exists());
}

fn commands_that_misbehave(table: &mut Table) {
    std::fs::write(table.folder().join("child.sh"), CHILD).unwrap();
    let once =
        "read a; printf 'step 0\\narray label u8 4\\nsamearray number u8 1x6\\n000000done\\n'";
    let commands = [
        "echo out of memory >&2; exit 4",
        "no-such-program",
        "while read line; do kill -9 $$; done",
        "while read line; do echo hello; done",
        "while read line; do echo 'step 0'; exit; done",
        "while read line; do printf 'step 0\\narray x f64 3\\n1234'; exit; done",
        "while read line; do printf 'step 7\\narray x u8 1\\nadone\\n'; done",
        "while read line; do printf 'step 0\\ndone\\n'; done",
        "while read line; do echo end; done",
        &format!("{once}; read b; exit 1"),
        "yes",
        "exec cat",
        "sleep 1000",
    ];
    for command in commands {
        let args = [
            "bisect",
            "--commands",
            "sh child.sh 99 99",
            command,
            "--limit",
            "1",
        ];
        table.add(&args, b"");
    }
    // What a command does after its last answer.
    let answer = "read a; printf 'step 0\\narray x u8 1\\nadone\\n'";
    for last in [
        "read b; kill -9 $$",
        "read b; echo no room left >&2; exit 4",
        "echo step 1",
        "echo end; echo step 1",
        "sleep 1000",
    ] {
        let command = format!("{answer}; {last}");
        let args = ["bisect", "--commands", &command, &command, "--to", "0"];
        table.add(&[&args[..], &["--limit", "1"]].concat(), b"");
    }
    table.add(&["bisect", "a", "b", "--to", "3"], b"");
}
