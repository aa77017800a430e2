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
    let inputs: [(&str, &[u8]); 16] = [
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
    for (name, steps) in [("good", 0..3), ("far", 7..9)] {
        let out = fed(table.folder(), &["record", name], &frames(steps, 9));
        assert!(out.status.success());
    }
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
    for args in [["good", "empty"], ["none.csv", "good"], ["good", "far"]] {
        table.add(&["bisect", args[0], args[1]], b"");
    }
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
    table.add(&["bisect", "a", "b", "--to", "3"], b"");
}
