//! Recordings of other simulators, as the guide and its examples do them.
//!
//! `cargo test -p bitgrain-tests --release --test tools recordings:: -- --ignored`. They need Python with numpy, blake3
//! and mujoco (the variable `PYTHON` names it if it is not `python3`), and Debian's `lammps`, `openmpi-bin`, `b3sum`.

use std::path::Path;
use std::process::Command;

use bitgrain_tests::processes::MPI_AS_ROOT;
use bitgrain_tests::root;

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

/// A folder with the examples, in which `bitgrain` and `python3` are those under test.
fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let examples = std::fs::read_dir(root().join("harness/guide/recordings-example")).unwrap();
    for example in examples
        .map(Result::unwrap)
        .filter(|file| file.path().is_file())
    {
        std::fs::copy(example.path(), folder.path().join(example.file_name())).unwrap();
    }
    // Where it is, before there is another of its name.
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let found = Command::new("sh")
        .args(["-c", "command -v \"$0\"", &python])
        .output()
        .unwrap();
    let python = String::from_utf8(found.stdout).unwrap().trim().to_string();
    assert!(!python.is_empty(), "no Python");
    let bin = folder.path().join("bin");
    std::fs::create_dir(&bin).unwrap();
    for (name, program) in [("bitgrain", PROGRAM), ("python3", &python)] {
        let path = bin.join(name);
        let text = format!("#!/bin/sh\nexec '{program}' \"$@\"\n");
        std::fs::write(&path, text).unwrap();
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o755);
        std::fs::set_permissions(&path, mode).unwrap();
    }
    folder
}

/// Runs a line in the shell; what it prints, if it ends with this status.
fn shell(folder: &Path, line: &str, status: i32) -> String {
    let bin = folder.join("bin");
    let path = format!(
        "{}:{}",
        bin.display(),
        std::env::var("PATH").unwrap_or_default()
    );
    let mut command = Command::new("sh");
    command
        .args(["-c", line])
        .current_dir(folder)
        .env("PATH", path);
    command.envs(MPI_AS_ROOT);
    let out = command.output().unwrap();
    let error = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(status), "{line}: {error}");
    String::from_utf8_lossy(&out.stdout).into_owned()
}

/// Blocks of a page in this language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("harness/guide").join(page)).unwrap();
    let begin = format!("```{language}\n");
    let blocks = text.split(&begin).skip(1);
    blocks
        .map(|block| block.split("```").next().unwrap().to_string())
        .collect()
}

/// The commands of an example, in order, and what the last of them must print; the example prints it twice alike.
fn example(which: usize) -> (Vec<String>, String) {
    let commands = blocks("recordings-example/README.md", "sh").swap_remove(which);
    let printed = blocks("recordings-example/README.md", "text").swap_remove(which);
    (commands.lines().map(String::from).collect(), printed)
}

/// Runs an example; `exact` if what it prints does not depend on versions of other programs.
fn runs(which: usize, exact: bool) {
    let folder = desk();
    let (commands, printed) = example(which);
    let (last, before) = commands.split_last().unwrap();
    for command in before {
        print!("{}", shell(folder.path(), command, 0));
    }
    let told = shell(folder.path(), last, 3);
    println!("{told}");
    assert!(
        told.contains("the same to step ") && told.contains(" ulp apart"),
        "{told}"
    );
    if exact {
        assert_eq!(told, printed);
    }
}

#[test]
#[ignore = "needs Python with numpy: `.ci/run recordings`"]
fn sums_in_two_orders_part() {
    runs(0, true);
    // The other way comes to the same, and one order is the same twice.
    let folder = desk();
    let (_, printed) = example(0);
    let commands = |a, b| {
        format!(
            "bitgrain bisect --commands 'python3 sums.py {a} asked' 'python3 sums.py {b} asked'"
        )
    };
    assert_eq!(shell(folder.path(), &commands("up", "down"), 3), printed);
    let told = shell(folder.path(), &commands("up", "up"), 0);
    assert!(told.starts_with("both end at step 4000\n"), "{told}");
    // The guide says what a stride misses.
    let told = shell(
        folder.path(),
        &(commands("up", "down") + " --every 1000"),
        3,
    );
    assert!(
        told.contains("the same to step 965, different at step 966"),
        "{told}"
    );
}

#[test]
#[ignore = "needs LAMMPS, MPI and Python with numpy: `.ci/run recordings`"]
fn lammps_on_two_ranks_parts_from_one() {
    runs(1, false);
    let folder = desk();
    for out in ["one", "two"] {
        shell(
            folder.path(),
            &format!("python3 lammps_ranks.py 2 | bitgrain record {out}"),
            0,
        );
    }
    shell(folder.path(), "bitgrain bisect one two", 0);
}

#[test]
#[ignore = "needs Python with mujoco: `.ci/run recordings`"]
fn mujoco_with_another_matrix_parts() {
    runs(2, false);
    let folder = desk();
    let (commands, _) = example(2);
    let same = commands[0].replace("sparse", "dense");
    let told = shell(folder.path(), &same, 0);
    assert!(told.starts_with("both end at step 2000\n"), "{told}");
}

/// What the guide shows in Python writes the same recording in three ways, and each link is what `b3sum` says.
#[test]
#[ignore = "needs Python with numpy and blake3, and b3sum: `.ci/run recordings`"]
fn python_of_the_guide_runs() {
    let folder = desk();
    let frames = blocks("src/recordings.md", "python");
    let own = blocks("src/file-formats.md", "python");
    assert_eq!((frames.len(), own.len()), (2, 1));
    let states = "
import sys, numpy
def states():
    for step in range(20):
        yield {\"x\": numpy.arange(6.0).reshape(3, 2) / (step + 1), \"t\": numpy.array(0.1 * step)}
";
    let write = |name: &str, parts: &[&str]| {
        std::fs::write(folder.path().join(name), parts.concat()).unwrap()
    };
    let all = "
for step, arrays in enumerate(states()):
    write(step, **arrays)
sys.stdout.buffer.write(b\"end\\n\")
";
    write("frames_of.py", &[states, &frames[0], all]);
    write(
        "asked.py",
        &[states, &frames[0], &frames[1], "answer(states())\n"],
    );
    let lines = "
recording = Recording(\"own.csv\")
for step, arrays in enumerate(states()):
    for name, array in arrays.items():
        recording.add(step, name, array)
recording.close()
";
    write("own.py", &[states, &own[0], lines]);
    shell(
        folder.path(),
        "python3 frames_of.py | bitgrain record piped && python3 own.py",
        0,
    );
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!(read("own.csv"), read("piped/recording.csv"));
    let told = shell(
        folder.path(),
        "bitgrain bisect --commands 'python3 asked.py' 'python3 asked.py'",
        0,
    );
    assert!(told.starts_with("both end at step 19\n"), "{told}");

    let mut before = "0".repeat(64);
    let text = read("own.csv");
    let rows = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    for row in rows {
        let (row, link) = row.rsplit_once(',').unwrap();
        let said = shell(
            folder.path(),
            &format!("printf %s {before},{row} | b3sum --no-names"),
            0,
        );
        assert_eq!(said.trim(), link);
        before = link.to_string();
    }
    assert_eq!(text.lines().last(), Some(&format!("# end {before}")[..]));
}
