//! Two commands that are asked for their arrays while they run, and compared.

use std::process::{Command, Stdio};

use bitgrain_tests::printed;

use crate::PROGRAM;

/// A command that keeps to the protocol: `sh child.sh PARTS LAST`. In its frames a label is another from step PARTS on,
/// and its run ends with step LAST. It notes each step that it was asked for.
pub const CHILD: &str = "\
while read -r word step; do
  echo $step >> asked
  [ $step -gt $2 ] && step=$2
  label=same; [ $step -ge $1 ] && label=sane
  printf 'step %s\\narray label u8 4\\n%sarray number u8 1x6\\n%06ddone\\n' $step $label $step
done
";

#[test]
#[cfg(unix)]
fn two_commands_part_at_the_first_step() {
    let room = tempfile::tempdir().unwrap();
    std::fs::write(room.path().join("child.sh"), CHILD).unwrap();
    let bisect = |a: &str, b: &str, more: &[&str], status: i32| {
        let args = [&["bisect", "--commands", a, b], more].concat();
        printed(PROGRAM, room.path(), &args, status)
    };
    let asked = || {
        let text = std::fs::read_to_string(room.path().join("asked")).unwrap();
        std::fs::remove_file(room.path().join("asked")).unwrap();
        text.lines().count()
    };
    let found = "the same to step 36, different at step 37
  arrays: label
  label[2]: 109 (0x6d) against 110 (0x6e)
  bits: 2 differ, the lowest is bit 0, the highest bit 1
  elements: 1 of 4 differ
";
    let (one, other) = ("sh child.sh 2000 1000", "sh child.sh 37 1000");
    let told = bisect(one, other, &[], 3);
    assert!(told.starts_with(found), "{told}");
    assert_eq!(asked(), 2 * 38, "one execution of each");
    // With strides the same is found, and fewer steps are asked for.
    for every in ["2", "5", "36", "37", "38", "1000", "100000"] {
        let told = bisect(one, other, &["--every", every], 3);
        assert!(told.contains(found), "{every}: {told}");
        assert!(asked() <= 2 * 110, "{every}");
    }
    let told = bisect(one, other, &["--to", "36"], 0);
    assert!(told.contains("no difference"), "{told}");
    let told = bisect(one, other, &["--to", "37"], 3);
    assert!(told.contains(found), "{told}");
    let other = |name: &str, from: &str, to: &str| {
        assert!(CHILD.contains(from));
        std::fs::write(room.path().join(name), CHILD.replace(from, to)).unwrap();
        bisect(one, &format!("sh {name} 2000 1000"), &[], 3)
    };
    let begins = "different from the beginning, step 0\n  arrays: number\n  number";
    let told = other("shape.sh", "1x6", "6");
    assert!(
        told.starts_with(&format!("{begins}: u8 1x6 against u8 6\n")),
        "{told}"
    );
    let told = other(
        "fewer.sh",
        "array number u8 1x6\\n%06ddone\\n' $step $label $step",
        "done\\n' $step $label",
    );
    assert!(
        told.starts_with(&format!("{begins}: only the first has it\n")),
        "{told}"
    );
    let told = bisect(one, "sh child.sh 0 9", &[], 3);
    assert!(
        told.starts_with("different from the beginning, step 0\n"),
        "{told}"
    );
}

/// A run that ends before the other, or before the step that was asked for, is not the same, unless that is meant.
#[test]
#[cfg(unix)]
fn a_command_that_ends_first_differs() {
    let room = tempfile::tempdir().unwrap();
    std::fs::write(room.path().join("child.sh"), CHILD).unwrap();
    let bisect = |a: &str, b: &str, more: &[&str], status: i32| {
        let args = [&["bisect", "--commands", a, b], more].concat();
        printed(PROGRAM, room.path(), &args, status)
    };
    // Both ends are found without being told, with strides too.
    for every in ["1", "7"] {
        let told = bisect(
            "sh child.sh 1000 50",
            "sh child.sh 1000 50",
            &["--every", every],
            0,
        );
        assert!(told.contains("both end at step 50"), "{told}");
        let told = bisect(
            "sh child.sh 1000 50",
            "sh child.sh 1000 60",
            &["--every", every],
            3,
        );
        let ends =
            "the same to step 50: the first ends with step 50, the second goes on with step 51";
        assert!(told.contains(ends), "{told}");
        let told = bisect(
            "sh child.sh 1000 60",
            "sh child.sh 1000 50",
            &["--every", every, "--prefix"],
            0,
        );
        assert!(told.contains("one run ends before the other"), "{told}");
        let told = bisect(
            "sh child.sh 1000 50",
            "sh child.sh 50 60",
            &["--every", every],
            3,
        );
        assert!(
            told.contains("the same to step 49, different at step 50"),
            "{told}"
        );
    }
    let still = "sh child.sh 1000 0";
    for more in [&[][..], &["--prefix"], &["--prefix", "--to", "9"]] {
        let told = bisect(still, still, more, 3);
        assert!(told.contains("and none after that was compared"), "{told}");
    }
    let told = bisect(still, "sh child.sh 1000 9", &["--prefix"], 3);
    assert!(told.contains("no step after step 0"), "{told}");
    let bare = "while read a n; do printf \"step $n\\narray x u8 0\\ndone\\n\"; done";
    let told = bisect(bare, bare, &["--to", "9"], 3);
    assert!(told.contains("no array that was compared has"), "{told}");
    let ended = "sh child.sh 1000 50";
    let told = bisect(ended, ended, &["--to", "51"], 3);
    assert!(
        told.contains("both end at step 50, and step 51 was asked for"),
        "{told}"
    );
    bisect(ended, ended, &["--to", "51", "--prefix"], 0);
    bisect(ended, ended, &["--to", "50"], 0);
}

/// A command that has another label in its first execution than in later ones is told from one that differs always.
#[test]
#[cfg(unix)]
fn a_command_that_differs_from_itself_is_told() {
    let room = tempfile::tempdir().unwrap();
    let child = "echo >> starts; starts=$(wc -l < starts)\n".to_string()
        + &CHILD.replace("label=sane", "[ $starts = 1 ] && label=sane");
    std::fs::write(room.path().join("child.sh"), CHILD).unwrap();
    std::fs::write(room.path().join("moody.sh"), child).unwrap();
    let args = [
        "bisect",
        "--commands",
        "sh child.sh 99 99",
        "sh moody.sh 37 99",
        "--every",
        "10",
    ];
    let told = printed(PROGRAM, room.path(), &args, 3);
    assert!(
        told.contains("`sh moody.sh 37 99` gave other arrays at step 40 when it was started again"),
        "{told}"
    );
    // One execution of each has one first difference.
    std::fs::remove_file(room.path().join("starts")).unwrap();
    let told = printed(PROGRAM, room.path(), &args[..4], 3);
    assert!(
        told.contains("the same to step 36, different at step 37\n  arrays: label\n"),
        "{told}"
    );
}

/// A command that hangs is ended with all that it started, and Ctrl-C ends both.
#[test]
#[cfg(target_os = "linux")]
fn nothing_is_left_running() {
    let room = tempfile::tempdir().unwrap();
    std::fs::write(room.path().join("child.sh"), CHILD).unwrap();
    // One in the group of the command, and one that left the group; the number of the last is written last.
    let hanging = "sleep 1000 & setsid sh -c 'echo $$ > pid; exec sleep 1000' & wait";
    let alive = || {
        let pid = std::fs::read_to_string(room.path().join("pid")).unwrap();
        let status = std::fs::read_to_string(format!("/proc/{}/status", pid.trim()));
        // One that has ended may wait for its parent to notice.
        status.is_ok_and(|status| !status.contains("State:\tZ"))
    };
    // The system takes a moment to end a process.
    let is_gone = || {
        (0..500).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(10));
            !alive()
        })
    };
    let args = [
        "bisect",
        "--commands",
        "sh child.sh 99 99",
        hanging,
        "--limit",
        "1",
    ];
    printed(PROGRAM, room.path(), &args, 2);
    assert!(is_gone());

    std::fs::remove_file(room.path().join("pid")).unwrap();
    let mut command = Command::new(PROGRAM);
    command
        .args(&args[..4])
        .current_dir(room.path())
        .stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    while !std::fs::read_to_string(room.path().join("pid")).is_ok_and(|pid| pid.ends_with('\n')) {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    assert!(alive());
    let kill = format!("kill -INT {}", child.id());
    assert!(
        Command::new("sh")
            .args(["-c", &kill])
            .status()
            .unwrap()
            .success()
    );
    let out = child.wait_with_output().unwrap();
    let told = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(130), "{told}");
    assert!(told.contains("bisect interrupted at step 0"), "{told}");
    assert!(is_gone());
}
