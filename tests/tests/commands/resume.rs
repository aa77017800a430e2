//! Nothing is lost: runs that are stopped, killed or lose files end with the bytes of an
//! undisturbed run.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use bitgrain::checkpoint;
use bitgrain::random::{Purpose, uniforms};
use bitgrain_tests::processes::signal;
use bitgrain_tests::{differing, output, results, two_drags};

use crate::PROGRAM;

type Files = BTreeMap<String, Vec<u8>>;

/// A folder with the scenario in it.
struct Desk(tempfile::TempDir);

impl Desk {
    fn new() -> Self {
        Self::of(&two_drags())
    }

    fn of(scenario: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("small.toml"), scenario).unwrap();
        Self(folder)
    }

    fn run(&self, args: &[&str]) -> Output {
        output(PROGRAM, self.0.path(), args)
    }

    fn out(&self) -> PathBuf {
        self.0.path().join("out/small")
    }

    /// The run begun with these arguments, to be killed.
    fn begin(&self, args: &[&str]) -> std::process::Child {
        let mut command = Command::new(PROGRAM);
        command.args(["run", "small.toml"]).args(args);
        command.current_dir(self.0.path());
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().unwrap()
    }

    /// Goes on with whatever is there, and returns its files.
    fn finish(&self) -> Files {
        let begun = self.out().join("scenario.toml").exists();
        let args = match begun {
            true => ["run", "--resume", "out/small"],
            false => ["run", "small.toml", "-v"],
        };
        let out = self.run(&args);
        let told = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{told}");
        results(&self.out())
    }
}

/// The files of an undisturbed run, and how long it took while it saved often.
static ALONE: LazyLock<(Files, Duration)> = LazyLock::new(|| alone_on(&Desk::new(), OFTEN));

/// Steps between saves.
const OFTEN: &str = "100";

fn alone_on(desk: &Desk, every: &str) -> (Files, Duration) {
    let began = Instant::now();
    let out = desk.run(&["run", "small.toml", "--save-every", every]);
    assert!(
        out.status.success(),
        "{}",
        String::from_utf8_lossy(&out.stderr)
    );
    (results(&desk.out()), began.elapsed())
}

/// Half files that are left below a folder.
fn half_files(folder: &Path) -> usize {
    let ends = |name: &&String| name.ends_with(".partial");
    results(folder).keys().filter(ends).count()
}

/// Kills a run at an instant, goes on with it, and returns whether it was killed in the middle of a save.
fn killed_at(instant: Duration, every: &str, want: &Files) -> (bool, bool) {
    let desk = Desk::new();
    let mut child = desk.begin(&["--save-every", every]);
    std::thread::sleep(instant);
    let _ = child.kill();
    let died = !child.wait().unwrap().success();
    let saving = half_files(desk.0.path()) > 0;
    let got = desk.finish();
    assert!(
        got == *want,
        "killed after {instant:?}: {:?} differ",
        differing(&got, want)
    );
    (died, saving)
}

/// This many instants over the time that a run takes, at random; returns how many hit one that was still at
/// work and how many of those in the middle of a save.
fn killed(count: u32, every: &str, (want, whole): &(Files, Duration)) -> (usize, usize) {
    let (mut died, mut saving) = (0, 0);
    for k in 0..count {
        let [x] = uniforms(7, Purpose::Sample, k);
        let hit = killed_at(whole.mul_f64(x), every, want);
        died += usize::from(hit.0);
        saving += usize::from(hit.1);
    }
    println!("{died} of {count} were killed at work, {saving} of them in the middle of a save");
    (died, saving)
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn killed_runs_end_with_the_same_bytes() {
    let (died, _) = killed(5, OFTEN, &ALONE);
    assert!(died >= 2, "{died} of 5 were killed at work");
}

/// `cargo test -p bitgrain-tests --release --test commands resume:: -- --ignored --nocapture`
#[test]
#[ignore = "minutes"]
fn a_hundred_killed_runs_end_with_the_same_bytes() {
    // All the time, so that some are hit in the middle of a save.
    let every = "20";
    let (died, saving) = killed(100, every, &alone_on(&Desk::new(), every));
    assert!(died >= 80 && saving >= 1, "{died} died, {saving} in a save");
}

/// On SIGTERM a run saves itself at once; the same command goes on, as often as needed.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn stopped_runs_end_with_the_same_bytes() {
    let (want, whole) = &*ALONE;
    let desk = Desk::new();
    for (share, name) in [(0.2, "INT"), (0.3, "TERM"), (0.3, "TERM"), (0.3, "INT")] {
        let mut child = desk.begin(&[]);
        std::thread::sleep(whole.mul_f64(share));
        signal(child.id(), name);
        let status = child.wait().unwrap();
        assert!(matches!(status.code(), Some(130 | 0)), "{status}");
    }
    assert!(desk.finish() == *want);
}

/// A bed poured with another friction than that of the drag: stopped in the midst of its pouring or later the run ends
/// with the same bytes, and it verifies.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_bed_poured_with_another_friction_goes_on_and_verifies() {
    let slippery = "settled = 1e-2\npouring_mu = 0.05";
    let text = two_drags().replacen("settled = 1e-2", slippery, 1);
    let whole = Desk::of(&text);
    let (want, time) = &alone_on(&whole, OFTEN);
    assert!(ALONE.0["beds/bed.safetensors"] != want["beds/bed.safetensors"]);
    let desk = Desk::of(&text);
    for share in [0.1, 0.15, 0.2, 0.2] {
        let mut child = desk.begin(&["--save-every", OFTEN]);
        std::thread::sleep(time.mul_f64(share));
        let _ = child.kill();
        child.wait().unwrap();
    }
    let got = desk.finish();
    assert!(got == *want, "{:?} differ", differing(&got, want));
    let out = desk.run(&["verify", "out/small"]);
    let told = String::from_utf8_lossy(&out.stdout);
    assert!(
        out.status.success() && told.contains("bed: steps 0 to "),
        "{told}"
    );
}

/// A run in the middle of its drags: one of them is finished, the other was stopped.
fn half_done() -> Desk {
    let desk = Desk::new();
    assert!(desk.run(&["run", "small.toml"]).status.success());
    let run = desk.out().join("runs/run-1");
    let kept = kept(&run);
    std::fs::copy(&kept[1], run.join("latest.safetensors")).unwrap();
    for gone in [
        &kept[2],
        &kept[3],
        &run.join("summary.json"),
        &desk.out().join("summary.json"),
    ] {
        std::fs::remove_file(gone).unwrap();
    }
    desk
}

fn kept(run: &Path) -> Vec<PathBuf> {
    let all = std::fs::read_dir(run.join("checkpoints")).unwrap();
    let mut all: Vec<PathBuf> = all.map(|file| file.unwrap().path()).collect();
    all.sort();
    assert_eq!(all.len(), 4);
    all
}

/// Whatever is taken away between two commands is made again.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn missing_files_are_made_again() {
    let (want, _) = &*ALONE;
    let names: Vec<&String> = want.keys().collect();
    let gone = |name: &str| -> Vec<&str> {
        let found = names.iter().filter(|n| n.contains(name));
        let found: Vec<&str> = found.map(|n| n.as_str()).collect();
        assert!(!found.is_empty(), "{name}");
        found
    };
    let second = "runs/run-2/checkpoints/000000003334";
    for what in [
        "beds/bed.safetensors",
        "beds/bed.chain.csv",
        "run-1/forces.csv",
        "run-1/chain.csv",
        "snapshots/grains",
        "run-2/snapshots/contacts",
        second,
        "run-1/checkpoints",
        "run-2/",
        "runs/",
        "summary.json",
        "report.html",
    ] {
        let desk = half_done();
        for name in gone(what) {
            let _ = std::fs::remove_file(desk.out().join(name));
        }
        let got = desk.finish();
        assert!(got == *want, "without {what}: {:?}", differing(&got, want));
    }
}

/// A state that was changed since is reported and passed over; the one before it is used instead.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn damaged_states_are_told_and_passed_over() {
    let (want, _) = &*ALONE;
    for name in [
        "run-1/latest.safetensors",
        "run-2/checkpoints/000000006667.safetensors",
    ] {
        let desk = half_done();
        let path = desk.out().join("runs").join(name);
        let mut bytes = std::fs::read(&path).unwrap_or_else(|_| panic!("{name} is there"));
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
        std::fs::write(&path, bytes).unwrap();
        let out = desk.run(&["run", "--resume", "out/small"]);
        let told = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{told}");
        assert!(
            told.contains(name)
                && (told.contains("not a whole checkpoint") || told.contains("was changed since")),
            "{told}"
        );
        assert!(results(&desk.out()) == *want, "{name}");
    }
}

/// A disk that fills up ends the command with a clear error; with a little more room it goes on from
/// there, until all of it fits.
#[test]
#[cfg(unix)]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_full_disk_loses_nothing() {
    let (want, _) = &*ALONE;
    let desk = Desk::new();
    let mut full = Vec::new();
    // Files may grow to this many blocks of 512 bytes.
    for blocks in [4, 60, 130, 190, 250, 330, 500, 2000] {
        let limited = format!(
            "trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" run small.toml --save-every 300"
        );
        let out = output("sh", desk.0.path(), &["-c", &limited, PROGRAM]);
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        match out.status.code() {
            Some(0) => break,
            Some(1) => {
                assert!(told.contains("then give the same command again"), "{told}");
                let (_, file) = told.split_once("cannot write ").unwrap();
                full.push(file.split(':').next().unwrap().to_string());
            }
            other => panic!("{other:?}: {told}"),
        }
    }
    let times = full.len();
    full.dedup();
    assert!(times >= 4 && full.len() >= 2, "{times} times: {full:?}");
    assert_eq!(half_files(desk.0.path()), 0, "no half file is left behind");
    assert!(desk.finish() == *want);
}

/// Two runs never write into one folder: not the same scenario, not another before there is any result.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_folder_has_one_run() {
    let desk = Desk::new();
    let slow = two_drags().replacen("settled = 1e-2", "settled = 1e-12", 1);
    std::fs::write(desk.0.path().join("slow.toml"), slow).unwrap();
    let mut first = Command::new(PROGRAM)
        .args(["run", "slow.toml"])
        .current_dir(desk.0.path())
        .spawn()
        .unwrap();
    while !desk.out().join("scenario.toml").exists() {
        assert!(first.try_wait().unwrap().is_none(), "it is at work");
        std::thread::sleep(Duration::from_millis(5));
    }
    let before = std::fs::read(desk.out().join("scenario.toml")).unwrap();
    for args in [["run", "slow.toml"], ["run", "small.toml"]] {
        let out = desk.run(&args);
        let told = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(2), "{told}");
        assert!(told.contains("another run is at work"), "{told}");
    }
    let after = std::fs::read(desk.out().join("scenario.toml")).unwrap();
    assert!(before == after, "nothing of the first was touched");
    first.kill().unwrap();
    first.wait().unwrap();
}

/// What another version, another scenario or another bed made is refused by name.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn what_does_not_belong_is_refused() {
    let desk = half_done();
    let scenario = desk.out().join("scenario.toml");
    let text = std::fs::read_to_string(&scenario).unwrap();
    let refused = |words: &[&str]| {
        let out = desk.run(&["run", "--resume", "out/small"]);
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{told}");
        assert!(words.iter().all(|word| told.contains(word)), "{told}");
    };
    std::fs::write(
        &scenario,
        text.replacen("BITS_VERSION 1", "BITS_VERSION 7", 1),
    )
    .unwrap();
    refused(&[
        "BITS_VERSION 7",
        "BITS_VERSION 1",
        "the program that began the run",
    ]);
    std::fs::write(
        &scenario,
        text.replacen("distance = 4.0", "distance = 4.5", 1),
    )
    .unwrap();
    refused(&["out/small", "another scenario", "changed since"]);
    std::fs::write(&scenario, &text).unwrap();
    let latest = desk.out().join("runs/run-1/latest.safetensors");
    let whole = std::fs::read(&latest).unwrap();
    let head = br#"\"bits_version\":1"#;
    let at = whole.windows(head.len()).position(|w| w == head).unwrap();
    let mut other = whole.clone();
    other[at + head.len() - 1] = b'2';
    std::fs::write(&latest, other).unwrap();
    // The seal is over the version too; what another program wrote has its own seal.
    let out = desk.run(&["run", "--resume", "out/small"]);
    assert!(String::from_utf8_lossy(&out.stderr).contains("seal"));
    let head = br#"\"format\":3"#;
    let at = whole.windows(head.len()).position(|w| w == head).unwrap();
    let desk = half_done();
    let latest = desk.out().join("runs/run-1/latest.safetensors");
    let mut other = std::fs::read(&latest).unwrap();
    other[at + head.len() - 1] = b'2';
    std::fs::write(&latest, other).unwrap();
    let out = desk.run(&["run", "--resume", "out/small"]);
    let told = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(2), "{told}");
    assert!(
        told.contains("written in format 2 with arithmetic 1; this program reads formats 3 to 5")
    );
}

/// Every bit of a small checkpoint, a note with it, and every length: none passes.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn every_flipped_bit_and_every_truncation_is_seen() {
    let case = r#"{"law": {"kind": "hertz_history", "kn": 2e5, "kt": 2.45e5, "gamma_n": 9,
        "gamma_t": 9, "mu": 0.5}, "dt": 1e-4, "gravity": [0, 0, -1],
        "obstacles": [{"shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
        "grains": [{"id": 3, "diameter": 1, "density": 1, "position": [0, 0, 0.4999]},
        {"id": 5, "diameter": 1, "density": 1, "position": [0, 0, 1.4997], "spin": [1, 2, 3]}]}"#;
    let case = bitgrain::case::parse(case, "case").unwrap();
    let mut sim = case.start("case", |_| {}).unwrap();
    sim.steps(20).unwrap();
    assert_eq!(sim.contact_histories().len(), 2);
    let note = checkpoint::StageState {
        recipe: "a recipe".into(),
        link: "a link".into(),
        course: "{\"step\": 20}".into(),
        fields: vec![1, 2, 3],
        frames: "a frame".into(),
    };
    let whole = checkpoint::pack(&mut sim, &note).unwrap();
    let (mut again, read) = checkpoint::unpack(&whole, "state").unwrap();
    assert!(read == note && again.digest() == sim.digest());
    assert!(checkpoint::pack(&mut again, &read).unwrap() == whole);
    let mut flipped = whole.clone();
    for at in 0..whole.len() {
        for bit in 0..8 {
            flipped[at] ^= 1 << bit;
            let refused = checkpoint::unpack(&flipped, "state").is_err();
            assert!(refused, "byte {at} of {}, bit {bit}", whole.len());
            flipped[at] ^= 1 << bit;
        }
        assert!(
            checkpoint::unpack(&whole[..at], "state").is_err(),
            "{at} bytes"
        );
    }
    let mut longer = whole.clone();
    longer.push(0);
    assert!(checkpoint::unpack(&longer, "state").is_err());
    assert!(
        whole.len() < 8000,
        "{} bytes: small enough to try all",
        whole.len()
    );
}
