//! What several tests share: where the goldens are, how the peers' data is read, and small cases.

pub mod fuzzing;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use bitgrain::case::{Case, GrainSpec, ObstacleSpec};
use bitgrain::law::LawSpec;
use serde_json::Value;

/// A file or folder under `golden/`.
pub fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../golden")
        .join(name)
}

/// A JSON golden, packed or plain.
pub fn json(name: &str) -> Value {
    let bytes = std::fs::read(golden(name)).expect("the golden is in the repository");
    let mut text = String::new();
    if name.ends_with(".gz") {
        let mut unpacked = flate2::read::GzDecoder::new(bytes.as_slice());
        unpacked
            .read_to_string(&mut text)
            .expect("the golden is whole");
    } else {
        text = String::from_utf8(bytes).expect("the golden is text");
    }
    serde_json::from_str(&text).expect("the golden is JSON")
}

/// A number of a JSON value.
pub fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// A list of numbers of a JSON value.
pub fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .expect("a list")
        .iter()
        .map(number)
        .collect()
}

/// Three numbers beginning at `at`.
pub fn triple(row: &[f64], at: usize) -> [f64; 3] {
    [row[at], row[at + 1], row[at + 2]]
}

/// The largest magnitude among numbers.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |a, b| if b.abs() > a { b.abs() } else { a })
}

/// A case in open space, without gravity.
pub fn open_case(
    law: LawSpec,
    dt: f64,
    grains: Vec<GrainSpec>,
    obstacles: Vec<ObstacleSpec>,
) -> Case {
    Case {
        law,
        bounds: None,
        gravity: [0.0; 3],
        dt,
        obstacles,
        grains,
    }
}

/// A resting wall at z = 0 with the grains above it.
pub fn floor() -> ObstacleSpec {
    ObstacleSpec::Plane {
        point: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        velocity: [0.0; 3],
    }
}

/// A scenario of 300 grains that is poured in seconds.
pub const SMALL: &str = r#"
name = "small"
units = "reduced"

[bed]
box = [8.0, 6.0, 6.0]
grains = 300

[law]
kind = "hertz_history"
kn = 2e5
kt = 2.45e5
gamma_n = 792.0
gamma_t = 792.0
mu = 0.5

[intruder]
diameter = 1.5
height = 2.5
speed = 1.0

[drag]
dt = 3e-4
distance = 4.0
"#;

/// [`SMALL`] with its bed from a file, which brings the intruder; `keys` are the lines that the
/// intruder's table says all the same.
pub fn small_from_file(file: &str, keys: &str) -> String {
    let begin = SMALL.find("box = ").expect("it is in the text");
    let end = SMALL.find("\n\n[law]").expect("it is in the text");
    let text = SMALL.replacen(&SMALL[begin..end], &format!("file = \"{file}\""), 1);
    text.replacen("diameter = 1.5\nheight = 2.5\n", keys, 1)
}

/// Runs a program in a folder to its end.
pub fn output(program: &str, folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(program);
    command.args(args).current_dir(folder);
    command.output().expect("the command starts")
}

/// What a user sees: command, messages, exit status, as one text to review.
pub fn told(args: &[&str], out: &Output) -> String {
    let status = out.status.code().map_or("none".into(), |c| c.to_string());
    let text = String::from_utf8_lossy(&out.stderr).replace("bitgrain-under-test", "bitgrain");
    format!("$ bitgrain {}\n{text}[{status}]\n\n", args.join(" "))
}
