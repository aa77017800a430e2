//! Requests for more memory than there is end in a message, in seconds, and in little memory.
#![cfg(target_os = "linux")]

use std::fmt::Write;
use std::path::Path;
use std::process::Output;
use std::time::Instant;

use bitgrain_tests::{SMALL, output};

use crate::PROGRAM;

/// Runs the command with at most this many KiB of memory, on one thread.
fn limited(folder: &Path, memory: u64, args: &str) -> Output {
    let line = format!("ulimit -v {memory}; RAYON_NUM_THREADS=1 exec \"$0\" {args}");
    output("sh", folder, &["-c", &line, PROGRAM])
}

/// A case of grains at these places.
fn case(places: impl Iterator<Item = [f64; 3]>) -> String {
    let law =
        r#"{"kind": "hertz_tsuji", "young": 1e6, "poisson": 0.3, "restitution": 0.6, "mu": 0.5}"#;
    let mut text = format!("{{\"law\": {law}, \"dt\": 1e-4, \"grains\": [");
    for (k, x) in places.enumerate() {
        let comma = if k > 0 { "," } else { "" };
        let _ = write!(
            text,
            "{comma}\n{{\"id\": {}, \"diameter\": 1, \"density\": 1, \"position\": {x:?}}}",
            k + 1
        );
    }
    text + "]}"
}

fn told(out: &Output) -> String {
    String::from_utf8_lossy(&out.stderr).into_owned()
}

/// Pairs of grains in one place were all listed before one of them was found too deep.
#[test]
fn crowds_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    for count in [20_000, 100_000] {
        // A hair apart, so that none is equal to another.
        let places = (0..count).map(|k| [1.0, 2.0, 3.0 + 1e-7 * f64::from(k)]);
        std::fs::write(folder.path().join("crowd.json"), case(places)).unwrap();
        let began = Instant::now();
        let out = limited(folder.path(), 1_000_000, "replay crowd.json --steps 1");
        let told = told(&out);
        assert_eq!(out.status.code(), Some(3), "{told}");
        assert!(told.contains("overlap by more than a quarter"), "{told}");
        assert!(began.elapsed().as_secs() < 30, "{:?}", began.elapsed());
    }
}

/// More touching bodies than a grain can have: the list is not made.
#[test]
fn walls_without_end_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = case((0..3000).map(|k| [1.1 * f64::from(k), 0.0, 0.5]));
    let wall = r#"{"shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}"#;
    let walls = vec![wall; 3000].join(",");
    let text = text.replacen(
        "\"grains\"",
        &format!("\"obstacles\": [{walls}], \"grains\""),
        1,
    );
    std::fs::write(folder.path().join("walls.json"), text).unwrap();
    let out = limited(folder.path(), 1_000_000, "replay walls.json --steps 1");
    let told = told(&out);
    assert_eq!(out.status.code(), Some(2), "{told}");
    assert!(
        told.contains("obstacle list is full") && told.contains("many in one place"),
        "{told}"
    );
}

/// A scenario within every limit that this machine has no room for; its folder can be continued.
#[test]
fn beds_and_fields_that_do_not_fit_are_told_of() {
    let folder = tempfile::tempdir().unwrap();
    let large = SMALL
        .replacen("[8.0, 6.0, 6.0]", "[2000.0, 2000.0, 30.0]", 1)
        .replacen("grains = 300", "grains = 99000000", 1);
    std::fs::write(folder.path().join("large.toml"), large).unwrap();
    let fields = "distance = 4.0\n[measure]\nfields = { grid = [2000, 1, 2000], every = 10 }";
    let fields = SMALL.replacen("distance = 4.0", fields, 1).replacen(
        "grains = 300",
        "grains = 300\nsettled = 1e-2",
        1,
    );
    std::fs::write(folder.path().join("fields.toml"), fields).unwrap();
    for (name, what) in [
        ("large", "99000000 grains of bed"),
        ("fields", "the fields of run-1"),
    ] {
        let run = format!("run {name}.toml --threads 1 --beds beds");
        let out = limited(folder.path(), 1_000_000, &run);
        let told = told(&out);
        assert_eq!(out.status.code(), Some(3), "{told}");
        assert!(
            told.contains(what) && told.contains("of memory are needed"),
            "{told}"
        );
        // Both are called `small`.
        let left = std::fs::read_to_string(folder.path().join("out/small/scenario.toml")).unwrap();
        assert!(left.contains("name = \"small\""));
        std::fs::remove_dir_all(folder.path().join("out")).unwrap();
    }
}
