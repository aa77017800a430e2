//! The reference worlds on this machine, and the command that runs them on others.

use std::path::Path;
use std::process::Output;

use bitgrain_kernel::Real;
use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::{self, Line, Room};
use bitgrain_kernel::fixed_point::I32F32;
use bitgrain_tests::{golden, output};

use crate::machines::compare::first_difference;
use crate::machines::firmware::{QUANTITIES, bounds};
use crate::machines::list::TARGETS;

const PROGRAM: &str = env!("CARGO_BIN_EXE_targets");

/// All lines, as every program under `tests/rigs` prints them.
fn lines() -> Vec<u8> {
    let mut text = Vec::new();
    let mut all = Hasher::new();
    collect::<f64>(&mut all, &mut text);
    collect::<f32>(&mut all, &mut text);
    text.extend(conformance::last(&all).text());
    text
}

/// Those of the worlds in fixed point, which follow.
fn fixed_lines() -> Vec<u8> {
    let mut text = Vec::new();
    let mut all = Hasher::new();
    collect::<I32F32>(&mut all, &mut text);
    text.extend(conformance::last(&all).text());
    text
}

fn collect<R: Real>(all: &mut Hasher, text: &mut Vec<u8>) {
    let mut room = Room::<R>::vacant();
    let show = |line: &Line| text.extend(line.text());
    conformance::run(&mut room, all, show).expect("every reference world runs to its end");
}

/// `INSTA_UPDATE=always` rewrites the golden text, for changes of bits that have a reason.
#[test]
fn this_machine_gives_the_reference_text() {
    same_text("reference", lines());
}

#[test]
fn this_machine_gives_the_reference_text_in_fixed_point() {
    same_text("fixed", fixed_lines());
}

fn same_text(name: &str, text: Vec<u8>) {
    let path = golden(&format!("digests/{name}.snap.txt"));
    // Which line differs says more than that the files do.
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "no") {
        let expected = std::fs::read_to_string(&path).unwrap();
        let got = String::from_utf8(text.clone()).unwrap();
        assert_eq!(first_difference(&got, &expected), None);
    }
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("digests"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description("cargo test -p bitgrain-tests --release --test tools targets::");
    settings.bind(|| insta::assert_binary_snapshot!(&format!("{name}.txt"), text));
}

fn targets(args: &[&str]) -> Output {
    output(PROGRAM, Path::new("."), args)
}

fn status_and_text(out: &Output) -> (Option<i32>, String) {
    let bytes = [out.stdout.as_slice(), out.stderr.as_slice()].concat();
    (out.status.code(), String::from_utf8(bytes).unwrap())
}

#[test]
fn unknown_names_and_options_are_refused() {
    for args in [
        &["s39x"][..],
        &["--require", "host,s39x"],
        &["--list", "s39x"],
    ] {
        let (status, told) = status_and_text(&targets(args));
        assert_eq!(status, Some(2), "{told}");
        assert!(
            told.starts_with("unknown target `s39x`; there are s390x, "),
            "{told}"
        );
    }
    for args in [&["--lost"][..], &["--require"]] {
        assert_eq!(status_and_text(&targets(args)).0, Some(2));
    }
    assert_eq!(status_and_text(&targets(&["--help"])).0, Some(0));
}

#[test]
fn the_list_has_every_target_with_its_packages() {
    let (status, told) = status_and_text(&targets(&["--list"]));
    assert_eq!(status, Some(0));
    for target in TARGETS {
        let line = told
            .lines()
            .position(|line| line.starts_with(&format!("{:<15} ", target.name)));
        let below = told.lines().nth(line.expect(target.name) + 1).unwrap();
        assert_eq!(below.trim(), target.packages().join(" "));
    }
}

/// Without its emulator a target is skipped, which is an error only if it is required.
#[test]
fn what_is_not_here_is_skipped_and_its_packages_named() {
    let bare = |args: &[&str]| {
        let mut command = std::process::Command::new(PROGRAM);
        command.args(args).env("PATH", "/nowhere");
        status_and_text(&command.output().unwrap())
    };
    let (status, told) = bare(&["s390x", "wasm"]);
    assert_eq!(status, Some(0), "{told}");
    let line = |name: &str| told.lines().find(|line| line.starts_with(name)).unwrap();
    assert!(
        line("s390x").contains("skipped: apt-get install ")
            && line("s390x").ends_with(" qemu-user")
    );
    assert!(line("wasm").ends_with(" nodejs"));
    let (status, told) = bare(&["wasm", "--require", "s390x"]);
    assert_eq!(status, Some(1), "{told}");
    assert!(told.ends_with("required, but skipped: s390x\n"));
}

/// A rig that is not built here must not lag behind: the kernel's own dependencies are the workspace's.
#[test]
fn rigs_take_the_versions_of_the_workspace() {
    let read = |name: &str| std::fs::read_to_string(golden("..").join(name)).unwrap();
    let version = |lock: &str, name: &str| {
        let at = lock.find(&format!("name = \"{name}\"\n")).expect(name);
        lock[at..].lines().nth(1).unwrap().to_string()
    };
    let ours = read("Cargo.lock");
    for rig in ["linux", "wasm", "cortex-m", "panics"] {
        let lock = read(&format!("tests/rigs/{rig}/Cargo.lock"));
        for name in ["heapless", "libm"] {
            assert_eq!(version(&lock, name), version(&ours, name), "{rig}");
        }
    }
}

#[test]
fn every_board_has_its_ranges() {
    let text = std::fs::read_to_string(golden("firmware.csv")).unwrap();
    let rows = bounds(&text).unwrap();
    let boards = TARGETS.iter().filter(|target| target.is_firmware());
    let mut named = 0;
    for board in boards {
        for what in QUANTITIES {
            let row = rows
                .iter()
                .find(|r| r.board == board.name && r.what == what);
            let row = row.expect(board.name);
            assert!(
                row.least <= row.most && row.most <= row.least * 5 / 4,
                "{row:?}"
            );
            named += 1;
        }
    }
    assert_eq!(named, rows.len());
}
