//! How a command treats its channels: closed pipes, signals, files that may not grow, and foreign text on a
//! terminal.
#![cfg(unix)]

use std::io::Read;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use bitgrain_tests::wee::Room;
use bitgrain_tests::{SMALL, copied, golden, made_run, output};

use crate::PROGRAM;

/// Runs a line of a shell, in which `$0` is the program.
fn shell(folder: &Path, line: &str) -> Output {
    output("sh", folder, &["-c", line, PROGRAM])
}

/// The exit status of the program whose standard output nobody reads.
fn status_unread(folder: &Path, args: &[&str]) -> Option<i32> {
    let mut child = Command::new(PROGRAM)
        .args(args)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    child.wait().unwrap().code()
}

/// A verdict is not hidden by a closed reader; only commands that merely print end early with 0.
#[test]
#[cfg_attr(
    debug_assertions,
    ignore = "drags through a small bed: seconds in release"
)]
fn a_closed_standard_output_hides_no_verdict() {
    let made = made_run(PROGRAM);
    assert_eq!(status_unread(made.path(), &["verify", "run"]), Some(0));
    let other = copied(made.path());
    let forces = other.path().join("run/runs/run-1/forces.csv");
    let text = std::fs::read_to_string(&forces).unwrap();
    std::fs::write(&forces, text.replacen("0.1", "0.2", 1)).unwrap();
    assert_eq!(status_unread(other.path(), &["verify", "run"]), Some(3));
    let case = golden("cases/collapse.json");
    let args = [
        "replay",
        case.to_str().unwrap(),
        "--steps",
        "20000",
        "--every",
        "1",
    ];
    assert_eq!(status_unread(made.path(), &args), Some(0));
    // If nobody reads from the beginning the first sample ends it.
    assert_eq!(status_unread(made.path(), &["claims"]), Some(0));
}

/// A limit on the size of files ends in a message, and the process is not killed.
#[test]
#[cfg(target_os = "linux")]
fn a_file_that_may_not_grow_is_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let quick = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    std::fs::write(folder.path().join("soft.toml"), quick).unwrap();
    let out = shell(
        folder.path(),
        "ulimit -f 8; exec \"$0\" run soft.toml --out limited --beds none",
    );
    let told = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(1), "{:?} {told}", out.status);
    assert!(
        told.contains("cannot write") && told.contains("ulimit -f"),
        "{told}"
    );
}

/// The second signal ends a command at once, also one that is not looking.
#[test]
#[cfg(target_os = "linux")]
fn a_second_signal_ends_it_now() {
    let bed = golden("peers/bed200.data");
    let args = [
        "bench",
        "--bed",
        bed.to_str().unwrap(),
        "--tiles",
        "60",
        "--steps",
        "100000",
    ];
    let mut child = Command::new(PROGRAM)
        .args(args)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let kill = |id: u32| {
        let killed = Command::new("kill")
            .args(["-TERM", &id.to_string()])
            .status();
        assert!(killed.unwrap().success());
    };
    // It has its handler by then, and takes many seconds from one check of the request to stop to the next.
    std::thread::sleep(Duration::from_millis(1500));
    kill(child.id());
    std::thread::sleep(Duration::from_millis(50));
    assert!(child.try_wait().unwrap().is_none(), "it did not look yet");
    let asked = Instant::now();
    kill(child.id());
    let end = loop {
        if let Some(end) = child.try_wait().unwrap() {
            break end;
        }
        if asked.elapsed() > Duration::from_secs(3) {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("it goes on");
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    assert_eq!(end.code(), Some(130));
}

/// Escape sequences in names and files do not reach a terminal, and no word of a megabyte does.
#[test]
fn text_of_others_is_made_plain() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("bad\u{1b}[2J.toml"), "a = 1\n").unwrap();
    let word = "x".repeat(1_000_000);
    std::fs::write(at.join("long.toml"), format!("{word} = 1\n")).unwrap();
    std::fs::write(at.join("evil.json"), "{\"\u{7f}\": 1}").unwrap();
    for args in [
        &["run", "bad\u{1b}[2J.toml"][..],
        &["run", "long.toml"],
        &["run", "no\u{1b}]0;such\u{7}"],
        &["run", "quick", "--set", "\u{1b}[31m=1"],
        &["replay", "evil.json", "--steps", "1"],
        &["\u{1b}[2J"],
        &["run", "quick", "--\u{1b}[2J"],
        &["bed", "show", "\u{1b}[2J"],
        &["report", "\u{1b}[2J"],
    ] {
        let out = output(PROGRAM, at, args);
        let told = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{args:.40?}: {told:.300}");
        let control = |c: char| c.is_control() && c != '\n';
        assert!(
            !told.contains(control),
            "{args:.40?}: {:?}",
            told.chars().take(300).collect::<String>()
        );
        // A word is shown as far as the longest path.
        assert!(told.len() < 20_000, "{} bytes", told.len());
    }
}

/// Requests to the command line itself end as before.
#[test]
fn help_and_version_are_as_they_were() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| output(PROGRAM, folder.path(), args);
    for args in [&["--help"][..], &["--version"], &["run", "--help"]] {
        let out = run(args);
        assert_eq!(out.status.code(), Some(0));
        assert!(out.stderr.is_empty() && !out.stdout.is_empty());
    }
    let none = run(&[]);
    assert_eq!(none.status.code(), Some(2));
    assert!(none.stdout.is_empty() && !none.stderr.is_empty());
    // A closed reader is not an error for them.
    let mut child = Command::new(PROGRAM)
        .arg("--help")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut told = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut told)
        .unwrap();
    assert_eq!((child.wait().unwrap().code(), &told[..]), (Some(0), ""));
}

/// Threads have the stack that the program gives them, whatever a variable of the environment says.
#[test]
fn no_variable_makes_the_stack_of_a_thread_too_short() {
    let room = Room::new(PROGRAM);
    let mut run = room.command("run wee.toml --out out --beds beds --threads 2");
    let out = run.env("RUST_MIN_STACK", "1").output().unwrap();
    let said = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{said}");
    let line = "RUST_MIN_STACK=1 exec \"$0\" bisect 'cat' 'cat' --commands";
    assert_ne!(shell(Path::new("."), line).status.code(), None);
}
