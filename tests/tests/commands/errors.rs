//! Every class of error that a user can meet, once: the message, and the exit status.
//!
//! `golden/messages/classes.snap` is the table. A message says what is wrong, where, why if that is
//! not plain, and what to do.

use std::fmt::Write;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use bitgrain_tests::{RIG, SMALL, golden, output, small_from_file, told};

use crate::PROGRAM;

/// A folder with a sound scenario and bed, and the table as it grows.
struct Desk {
    folder: tempfile::TempDir,
    table: String,
    classes: usize,
}

impl Desk {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        Self {
            folder,
            table: String::new(),
            classes: 0,
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn run(&self, args: &[&str]) -> Output {
        output(PROGRAM, self.folder.path(), args)
    }

    /// A class of error: the command must end with this status.
    fn class(&mut self, name: &str, status: i32, args: &[&str]) {
        let out = self.run(args);
        self.record(name, status, args, &out);
    }

    fn record(&mut self, name: &str, status: i32, args: &[&str], out: &Output) {
        // The refusal is worded in one of three ways, depending on the user and the mount.
        let mut text = told(args, out);
        for other in [
            "Operation not permitted (os error 1)",
            "Read-only file system (os error 30)",
        ] {
            text = text.replace(other, "Permission denied (os error 13)");
        }
        assert_eq!(out.status.code(), Some(status), "{name}: {text}");
        write!(self.table, "# {name}\n{text}").unwrap();
        self.classes += 1;
    }

    /// A scenario with one thing changed.
    fn scenario(&mut self, name: &str, from: &str, to: &str) {
        assert_eq!(SMALL.matches(from).count(), 1, "{from}");
        self.write("bed.toml", SMALL.replacen(from, to, 1));
        self.class(name, 2, &["run", "bed.toml"]);
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn every_class_of_error_teaches() {
    let mut desk = Desk::new();
    scenarios(&mut desk);
    light_lid(&mut desk);
    imports(&mut desk);
    cases(&mut desk);
    runs(&mut desk);
    library(&mut desk);
    places(&mut desk);
    interrupted(&mut desk);
    assert!(desk.classes >= 45, "{}", desk.classes);
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description(
        "recipe: `cargo test -p bitgrain-tests --release --test commands errors::`",
    );
    settings.bind(|| insta::assert_snapshot!("classes", desk.table));
}

fn scenarios(desk: &mut Desk) {
    desk.scenario("syntax", "[law]", "[law");
    desk.scenario("unknown key", "diameter = 1.5", "diametre = 1.5");
    desk.scenario("wrong type", "grains = 300", "grains = \"many\"");
    desk.scenario("missing key", "dt = 3e-4\n", "");
    desk.scenario("unknown contact law", "hertz_history", "hooke");
    desk.scenario("impossible number", "kn = 2e5", "kn = -2e5");
    desk.scenario(
        "two spellings of one thing",
        "grains = 300",
        "grains = 300\nfill_height = 4.0",
    );
    desk.scenario("unknown units", "\"reduced\"", "\"imperial\"");
    desk.scenario(
        "wrong unit system",
        "\"reduced\"",
        "\"reduced\"\ngravity = 9.81",
    );
    desk.scenario("reduced defaults in SI units", "\"reduced\"", "\"si\"");
    desk.scenario(
        "intruder wider than the box",
        "diameter = 1.5",
        "diameter = 9.0",
    );
    desk.scenario("intruder outside the box", "height = 2.5", "height = 7.0");
    desk.scenario("grains overfill the box", "grains = 300", "grains = 3000");
    desk.scenario(
        "box too short for its period",
        "[8.0, 6.0, 6.0]",
        "[8.0, 2.0, 30.0]",
    );
    desk.scenario("unstable time step", "dt = 3e-4", "dt = 3e-3");
    desk.scenario("into the own wake", "distance = 4.0", "distance = 9.0");
    desk.scenario(
        "nothing left to average",
        "distance = 4.0",
        "distance = 1.0",
    );
    let rare = "distance = 4.0\n[measure]\nevery = 5000";
    desk.scenario("too few samples", "distance = 4.0", rare);
    desk.scenario("name that is no folder", "\"small\"", "\"../small\"");
    desk.class("unknown scenario", 2, &["run", "quik"]);
    desk.class("missing file", 2, &["run", "nowhere.toml"]);
    desk.class(
        "unknown key on the command line",
        2,
        &["run", "quick", "--set", "law.muu=0.3"],
    );
    desk.class(
        "setting without a value",
        2,
        &["run", "quick", "--set", "law.mu"],
    );
    desk.write("bed.toml", [0x1f, 0x8b, 8, 0, 1, 2, 3]);
    desk.class("damaged gzip", 2, &["run", "bed.toml"]);
    desk.write("bed.toml", [b'a', 0xff, 0xfe]);
    desk.class("not a text", 2, &["run", "bed.toml"]);
}

/// Deeper than the intruder's 0.01, but by less than a grain's own layer adds.
fn light_lid(desk: &mut Desk) {
    let lids = "effective_depth = [0.01, 0.03]\npressure_gradient = \"both\"";
    assert!(RIG.contains(lids));
    let light = RIG.replacen(lids, "effective_depth = 0.0112", 1);
    desk.write("light.toml", light);
    desk.class("lid lighter than grains", 2, &["run", "light.toml"]);
}

/// The small scenario with a bed from a file.
fn from_file(keys: &str) -> String {
    small_from_file("bed.data", keys)
}

fn imports(desk: &mut Desk) {
    desk.write("import.toml", from_file(""));
    let run = ["run", "import.toml"];
    desk.class("bed's file missing", 2, &run);
    let bed = std::fs::read_to_string(golden("peers/bed200.data")).unwrap();
    desk.write("bed.data", &bed);
    desk.class("bed without an intruder", 2, &run);
    desk.write("bed.data", &bed[..bed.len() / 2]);
    desk.class("bed cut off", 2, &run);
    desk.write("bed.data", bed.replacen("\n2 3 0.97", "\n2 3 x.97", 1));
    desk.class("bed with a word for a number", 2, &run);
    let with_ball = bed.replacen("\n2 3 ", "\n2 2 ", 1);
    desk.write("bed.data", &with_ball);
    desk.write("import.toml", from_file("diameter = 3.0\n"));
    desk.class("scenario and bed contradict each other", 2, &run);
    let wide = from_file("").replacen("file =", "diameters = [0.99, 1.01]\nfile =", 1);
    desk.write("import.toml", wide);
    desk.class("grains of other sizes than the scenario's", 2, &run);
    let kept = from_file("").replacen("distance = 4.0", "distance = 4.0\nhistory = \"kept\"", 1);
    desk.write("import.toml", kept);
    desk.class("histories asked of a bed that has none", 2, &run);
    for (name, keys, from, to) in [
        ("cylinder", "shape = \"cylinder\"\n", "", ""),
        ("lid", "", "[law]", "[lid]\ndensity = 10.0\n[law]"),
        ("motion", "", "dt = 3e-4", "dt = 3e-4\nmoves = \"bed\""),
        ("pouring", "", "file =", "pouring = \"in_turn\"\nfile ="),
        ("friction", "", "file =", "pouring_mu = 0.1\nfile ="),
    ] {
        desk.write("import.toml", from_file(keys).replacen(from, to, 1));
        desk.class(&format!("{name} asked of a bed from a file"), 2, &run);
    }
    let dump = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n1\nITEM: BOX BOUNDS pp pp ff\n\
                0 8\n0 8\n0 8\nITEM: ATOMS id type x y\n1 1 1 1\n";
    desk.write("bed.data", dump);
    desk.write("import.toml", from_file(""));
    desk.class("dump without a column that is needed", 2, &run);
}

const CASE: &str = r#"{
  "law": {"kind": "hertz_tsuji", "young": 1e6, "poisson": 0.3, "restitution": 0.6, "mu": 0.5},
  "dt": 1e-4,
  "grains": [
    {"id": 1, "diameter": 1.0, "density": 1.0, "position": [0, 0, 0]},
    {"id": 2, "diameter": 1.0, "density": 1.0, "position": [0, 0, 1.2]}
  ]
}"#;

fn cases(desk: &mut Desk) {
    let replay = ["replay", "case.json", "--steps", "5"];
    desk.write("case.json", CASE.replacen("1.2", "NaN", 1));
    desk.class("a case with NaN", 2, &replay);
    desk.write("case.json", CASE.replacen("\"id\": 2", "\"id\": 1", 1));
    desk.class("two grains of one name", 2, &replay);
    desk.write("case.json", CASE.replacen("1.2", "0.5", 1));
    desk.class("grains begin deep in each other", 3, &replay);
    desk.write("case.json", CASE);
    let full = Command::new(PROGRAM)
        .args(replay)
        .current_dir(desk.folder.path())
        .stdout(std::fs::File::create("/dev/full").unwrap())
        .output()
        .unwrap();
    desk.record("full disk behind standard output", 1, &replay, &full);
}

fn runs(desk: &mut Desk) {
    let quick = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    let fast =
        quick
            .replacen("\"small\"", "\"fast\"", 1)
            .replacen("speed = 1.0", "speed = 150.0", 1);
    let fast = fast.replacen("distance = 4.0", "distance = 6.0\n[measure]\nevery = 1", 1);
    desk.write("fast.toml", fast);
    desk.class("a drag that goes wrong", 3, &["run", "fast.toml"]);
    // So stiff a bound that rounding alone keeps the bed above it.
    let never = SMALL.replacen("\"small\"", "\"never\"", 1);
    let never = never.replacen("grains = 300", "grains = 90\nsettled = 1e-300", 1);
    let never = never.replacen("[8.0, 6.0, 6.0]", "[4.0, 4.0, 6.0]", 1);
    let never = never.replacen("distance = 4.0", "distance = 3.5\n[measure]\nevery = 5", 1);
    desk.write("never.toml", never.replacen("dt = 3e-4", "dt = 9e-4", 1));
    desk.class("a bed that does not settle", 3, &["run", "never.toml"]);
}

/// The folder of the one bed in the library.
fn only_bed(desk: &Desk) -> PathBuf {
    let mut beds = std::fs::read_dir(desk.path("beds")).unwrap();
    beds.next().unwrap().unwrap().path()
}

fn library(desk: &mut Desk) {
    std::fs::remove_dir_all(desk.path("beds")).unwrap();
    let soft = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    desk.write("soft.toml", &soft);
    let args = ["run", "soft.toml", "--out", "soft"];
    assert!(desk.run(&args).status.success());
    desk.write("other.toml", soft.replacen("mu = 0.5", "mu = 0.4", 1));
    desk.class(
        "folder of another scenario",
        2,
        &["run", "other.toml", "--out", "soft"],
    );

    // The library's is looked for if the folder has none.
    std::fs::remove_file(desk.path("soft/beds/bed.safetensors")).unwrap();
    let checkpoint = only_bed(desk).join("bed.safetensors");
    let whole = std::fs::read(&checkpoint).unwrap();
    let mut damaged = whole.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 1;
    std::fs::write(&checkpoint, damaged).unwrap();
    desk.class("damaged bed in the library", 2, &args);
    let head = br#"\"format\":3"#;
    let at = whole.windows(head.len()).position(|w| w == head).unwrap();
    let mut old = whole.clone();
    old[at + head.len() - 1] = b'1';
    std::fs::write(&checkpoint, old).unwrap();
    desk.class("bed of another version", 2, &args);
    std::fs::write(&checkpoint, &whole).unwrap();

    // The bed of another recipe under this one's name.
    let mine = only_bed(desk);
    let kept = desk.path("kept");
    std::fs::rename(&mine, &kept).unwrap();
    assert!(
        desk.run(&["run", "other.toml", "--out", "other"])
            .status
            .success()
    );
    let theirs = only_bed(desk);
    std::fs::rename(&theirs, &mine).unwrap();
    desk.class("bed of another recipe", 2, &args);
    std::fs::rename(&kept, &theirs).unwrap();
    desk.class("no such bed", 2, &["bed", "show", "xyz"]);
    desk.class("empty name of a bed", 2, &["bed", "remove", ""]);
    // Another bed whose name differs in the last digit alone.
    let (shared, last) = mine
        .to_str()
        .unwrap()
        .split_at(mine.to_str().unwrap().len() - 1);
    let twin = format!("{shared}{}", if last == "0" { "1" } else { "0" });
    std::fs::create_dir(&twin).unwrap();
    let recipe = Path::new(&twin).join("recipe.toml");
    std::fs::write(&recipe, "").unwrap();
    let begin = Path::new(shared).file_name().unwrap().to_str().unwrap();
    desk.class("name that several beds share", 2, &["bed", "show", begin]);
    std::fs::remove_dir_all(&twin).unwrap();
    std::fs::remove_file(mine.join("recipe.toml")).unwrap();
    let name = mine.file_name().unwrap().to_string_lossy().into_owned();
    desk.class("bed without its recipe", 2, &["bed", "show", &name]);
    std::fs::remove_dir_all(desk.path("beds")).unwrap();
}

fn places(desk: &mut Desk) {
    desk.class(
        "no permission to write",
        1,
        &["run", "soft.toml", "--out", "/sys/bitgrain"],
    );
    desk.write("taken", "");
    desk.class(
        "a file where a folder should be",
        1,
        &["run", "soft.toml", "--out", "taken"],
    );
    // A file may grow to 8 blocks of 512 bytes: what a disk that fills up does to a write.
    let limited = "trap '' XFSZ; ulimit -f 8; exec \"$0\" run soft.toml --out limited --beds none";
    let out = output("sh", desk.folder.path(), &["-c", limited, PROGRAM]);
    let args = ["run", "soft.toml", "--out", "limited", "--beds", "none"];
    desk.record("a disk that fills up", 1, &args, &out);
    let partial = |folder: &Path| -> Vec<String> {
        let all = std::fs::read_dir(folder).map_or(Vec::new(), |d| d.flatten().collect());
        let names = all
            .iter()
            .map(|f| f.file_name().to_string_lossy().into_owned());
        names.filter(|name| name.ends_with(".partial")).collect()
    };
    assert_eq!(
        partial(&desk.path("limited")),
        Vec::<String>::new(),
        "half files are taken away"
    );
    desk.class(
        "argument out of its range",
        2,
        &["run", "quick", "--threads", "0"],
    );
}

/// Ctrl-C between two steps: the series so far is written, the bed is kept.
fn interrupted(desk: &mut Desk) {
    let slow = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    let slow = slow.replacen("\"small\"", "\"slow\"", 1);
    desk.write(
        "slow.toml",
        slow.replacen("speed = 1.0", "speed = 0.001", 1),
    );
    let args = ["run", "slow.toml", "-v"];
    let mut child = Command::new(PROGRAM)
        .args(args)
        .current_dir(desk.folder.path())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let step = lines.next().unwrap().unwrap();
    assert!(step.starts_with("time step 0.0003 "), "{step}");
    // The bed is there: the drag has begun, and takes millions of steps.
    let bed = lines.next().unwrap().unwrap();
    assert!(bed.starts_with("bed: 300 grains"), "{bed}");
    std::thread::sleep(std::time::Duration::from_millis(1000));
    let kill = format!("kill -INT {}", child.id());
    let killed = Command::new("sh").args(["-c", &kill]).status();
    assert!(killed.unwrap().success());
    let told: Vec<String> = lines.map(|line| line.unwrap()).collect();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130), "{told:?}");
    let digits = |c: char| if c.is_ascii_digit() { '0' } else { c };
    let message = told.join("\n");
    let (before, after) = message.split_once("at step ").unwrap();
    let step: String = after
        .chars()
        .take_while(char::is_ascii_digit)
        .map(digits)
        .collect();
    let after = &after[step.len()..];
    write!(
        desk.table,
        "# interrupted (the step varies)\n$ bitgrain {}\n{before}at step N{after}\n[130]\n\n",
        args.join(" ")
    )
    .unwrap();
    desk.classes += 1;
    let rows =
        std::fs::read_to_string(desk.path("out/slow/runs/run-1/forces.partial.csv")).unwrap();
    assert!(rows.lines().count() > 2, "the series so far is kept");
}
