//! What several tests share: where the goldens are, how the reference codes' data is read, and small cases.

pub mod damage;
pub mod drags;
pub mod extended;
mod folders;
pub mod fuzzing;
pub mod gather;
pub mod notices;
pub mod page;
pub mod processes;
pub mod reference_scheme;
pub mod tank;
pub mod wee;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use bitgrain::campaign::table::CampaignTable;
use bitgrain::case::{self, Case, CaseLaw, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::checkpoint;
use bitgrain::law::{HertzHistoryParameters, LawSpec};
use bitgrain::observer::Observer;
use bitgrain::simulation::Simulation;
use bitgrain_kernel::ContactForce;
use serde_json::Value;

pub use folders::{assert_named, copied, differing, results, written};

/// An observer that is shown the states after some steps, which ascend.
pub struct Shown<'a, F>(pub &'a [u64], pub F);

impl<F: FnMut(u64, &mut Simulation)> Observer for Shown<'_, F> {
    fn wants_step(&self, step: u64) -> bool {
        self.0.binary_search(&step).is_ok()
    }

    fn on_step(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        _: &[ContactForce<f64>],
    ) -> bitgrain::error::Result<()> {
        (self.1)(step, sim);
        Ok(())
    }
}

/// The folder of the repository.
pub fn root() -> PathBuf {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap_or(tests).to_path_buf()
}

/// A file or folder under `golden/`.
pub fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../golden")
        .join(name)
}

/// A JSON golden, packed or plain.
pub fn json(name: &str) -> Value {
    serde_json::from_slice(&unpacked(name)).expect("the golden is JSON")
}

/// The bytes of a golden, packed or plain.
pub fn unpacked(name: &str) -> Vec<u8> {
    let bytes = std::fs::read(golden(name)).expect("the golden is in the repository");
    if !name.ends_with(".gz") {
        return bytes;
    }
    let mut plain = Vec::new();
    let mut unpacked = flate2::read::GzDecoder::new(bytes.as_slice());
    unpacked
        .read_to_end(&mut plain)
        .expect("the golden is whole");
    plain
}

/// A settled bed of 2,500 grains, its ball set in motion.
pub fn settled_bed() -> Simulation {
    let bytes = unpacked("bed-2500/settled.safetensors.gz");
    let sim = checkpoint::parse(&bytes, "the golden bed", None);
    let mut sim = sim.expect("the golden bed is whole");
    sim.obstacles[0].velocity = [2.0, 0.0, 0.0];
    sim
}

/// The place of the highest grain.
pub fn highest(sim: &Simulation) -> usize {
    let height = |i: &usize| sim.position[*i][2];
    let top = (0..sim.count()).max_by(|i, j| height(i).total_cmp(&height(j)));
    top.expect("there are grains")
}

/// The settled bed, not yet started, whose highest grain leaves the box in the tenth step; and the id of that grain.
pub fn bed_that_loses_a_grain() -> (Simulation, u32) {
    let mut sim = settled_bed();
    let top = highest(&sim);
    sim.position[top][2] = sim.domain.hi()[2] - 0.02;
    sim.velocity[top][2] = 0.02 / (9.5 * sim.dt);
    let id = sim.id[top];
    (sim, id)
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
    law: impl Into<CaseLaw>,
    dt: f64,
    grains: Vec<GrainSpec>,
    obstacles: Vec<ObstacleSpec>,
) -> Case {
    Case {
        law: law.into(),
        bounds: None,
        gravity: [0.0; 3],
        dt,
        obstacles,
        grains,
    }
}

/// Kumar's law with about the stiffness and damping that Guillard's grains have under theirs.
pub const GLASS: LawSpec = LawSpec::HertzHistory(HertzHistoryParameters {
    kn: 4e6,
    kt: 4.5e6,
    gamma_n: 1e8,
    gamma_t: 1e8,
    mu: 0.5,
    rolling: None,
});

/// A golden case by its file; `FILE:hertz_history` is the same under the other law, [`GLASS`].
pub fn golden_case(name: &str) -> Case {
    let (file, law) = name.split_once(':').unwrap_or((name, ""));
    let mut case = case::read(&golden("cases").join(file)).expect("a sound case");
    if law == "hertz_history" {
        case.law = GLASS.into();
    }
    case
}

/// A free grain of diameter 1 and density 1 that does not spin.
pub fn ball(id: u32, position: [f64; 3], velocity: [f64; 3]) -> GrainSpec {
    GrainSpec {
        id,
        diameter: 1.0,
        density: 1.0,
        position,
        velocity,
        spin: [0.0; 3],
        motion: MotionSpec::Free,
        material: None,
    }
}

/// A resting wall at z = 0 with the grains above it.
pub fn floor() -> ObstacleSpec {
    ObstacleSpec::plane([0.0; 3], [0.0, 0.0, 1.0])
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

/// A cylinder in a bed of 1,481 grains that its base carries past it, bare and under two lids, with and
/// without a pressure gradient: a rig that takes seconds.
pub const RIG: &str = r#"
name = "rig"
units = "si"
gravity = 9.81

[bed]
box = [0.0405, 0.006, 0.024]
fill_height = 0.018
diameters = [0.0015, 0.0015]
density = 2500.0
base = 0.0009
pouring = "in_turn"

[law]
kind = "hertz_tsuji"
young = 5e6
poisson = 0.45
restitution = 0.6
mu = 0.5

[intruder]
shape = "cylinder"
diameter = 0.0015
height = 0.008
speed = 0.1

[lid]
effective_depth = [0.01, 0.03]
pressure_gradient = "both"

[drag]
dt = 1e-5
moves = "bed"
distance = 0.012

[measure]
every = 100
"#;

/// Coefficients of a `hertz_history` law: K_n, K_t, gamma_n, gamma_t and mu.
pub fn hertz_history(law: &LawSpec) -> [f64; 5] {
    let LawSpec::HertzHistory(HertzHistoryParameters {
        kn,
        kt,
        gamma_n,
        gamma_t,
        mu,
        ..
    }) = *law
    else {
        panic!("Kumar's law, LAMMPS' gran/hertz/history");
    };
    [kn, kt, gamma_n, gamma_t, mu]
}

/// [`SMALL`] with its bed from a file, which brings the intruder; `keys` are the lines that the
/// intruder's table says all the same.
pub fn small_from_file(file: &str, keys: &str) -> String {
    let begin = SMALL.find("box = ").expect("it is in the text");
    let end = SMALL.find("\n\n[law]").expect("it is in the text");
    let text = SMALL.replacen(&SMALL[begin..end], &format!("file = \"{file}\""), 1);
    text.replacen("diameter = 1.5\nheight = 2.5\n", keys, 1)
}

/// [`SMALL`] with two drags of a bed that has hardly settled, and a link every 200 steps: a second's run.
pub fn two_drags() -> String {
    let text = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    let text = text.replacen("speed = 1.0", "speed = [0.8, 2.0]", 1);
    text + "\n[measure]\nevery = 50\ndigest_every = 200\n"
}

/// Two frictions, two speeds: two beds and four drags in a second.
pub const CAMPAIGN: &str = r#"
name = "camp"
base = "small.toml"

[[grid]]
name = "friction"
set = { "bed.settled" = 1e-2, "measure.every" = 20, "measure.snapshots" = 0, "measure.checkpoints" = 1 }
mu = [0.1, 0.5]
speed = [1.0, 2.0]
"#;

/// A campaign of which a drag and a bed fail.
pub fn failing_campaign() -> String {
    CAMPAIGN
        .replace(
            "speed = [1.0, 2.0]",
            "speed = [1.0, 150.0]\ndistance = [4.0, 6.0]",
        )
        .replace("mu = [0.1, 0.5]", "mu = 0.5")
        .replace("\"measure.every\" = 20", "\"measure.every\" = 1")
        + r#"
[[grid]]
name = "restless"
set = { "bed.settled" = 1e-300, "bed.grains" = 90, "bed.box" = [4.0, 4.0, 6.0], "drag.dt" = 9e-4, "measure.every" = 5 }
mu = 0.4
speed = 1.0
distance = 3.5
"#
}

/// A folder with [`SMALL`], of fewer grains, and a campaign over it, and the program that runs it.
pub struct CampaignDesk {
    /// The folder.
    pub folder: tempfile::TempDir,
    program: &'static str,
}

impl CampaignDesk {
    /// With this campaign as `camp.toml`.
    pub fn new(program: &'static str, campaign: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let desk = Self { folder, program };
        let few = "box = [7.0, 4.0, 6.0]\ngrains = 140";
        desk.write(
            "small.toml",
            &SMALL.replacen("box = [8.0, 6.0, 6.0]\ngrains = 300", few, 1),
        );
        desk.write("camp.toml", campaign);
        desk
    }

    /// Writes a file.
    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.folder.path().join(name), text).expect("a file can be written");
    }

    /// The folder of its results.
    pub fn out(&self) -> PathBuf {
        self.folder.path().join("out/camp")
    }

    /// Runs it, or the rest of it.
    pub fn sweep(&self, args: &[&str]) -> Output {
        let args: Vec<&str> = ["sweep", "camp.toml"].iter().chain(args).copied().collect();
        output(self.program, self.folder.path(), &args)
    }

    /// The same, which must end well; returns what it printed.
    pub fn done(&self, args: &[&str]) -> String {
        let out = self.sweep(args);
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.success(), "{told}");
        told
    }

    /// Its table.
    pub fn table(&self) -> CampaignTable {
        CampaignTable::read(&self.out().join("results.csv")).expect("a table")
    }
}

/// What a program printed, on both its channels, which must have ended with this status.
pub fn printed(program: &str, folder: &Path, args: &[&str], status: i32) -> String {
    let out = output(program, folder, args);
    let told = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(status), "{args:?}: {told}");
    String::from_utf8_lossy(&out.stdout).into_owned() + &told
}

/// A folder with [`two_drags`] as `small.toml`, and a run of it in `run`.
pub fn made_run(program: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("small.toml");
    std::fs::write(path, two_drags()).expect("a file can be written");
    printed(
        program,
        folder.path(),
        &["run", "small.toml", "--out", "run"],
        0,
    );
    folder
}

/// The checkpoint of it that was kept of run 1 at half of its steps.
pub const HALF: &str = "runs/run-1/checkpoints/000000008334.safetensors";

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

/// The Rust of the README and the guide, compiled and run as tests of documentation.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../README.md")]
    struct Readme;
    #[doc = include_str!("../../harness/guide/src/embedding.md")]
    struct Embedding;
    #[doc = include_str!("../../harness/guide/src/extending.md")]
    struct Extending;
    #[doc = include_str!("../../harness/guide/src/fixed-point.md")]
    struct FixedPoint;
}
