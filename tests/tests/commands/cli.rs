//! Messages to users: refusals with exit status 2, runs that fail with 3, and what stays.

use std::path::Path;
use std::process::Output;

use bitgrain_tests::tank::TANK;
use bitgrain_tests::{RIG, SMALL, golden};

pub(crate) fn bitgrain(folder: &Path, args: &[&str]) -> Output {
    bitgrain_tests::output(env!("CARGO_BIN_EXE_bitgrain-under-test"), folder, args)
}

fn told(folder: &Path, args: &[&str]) -> String {
    bitgrain_tests::told(args, &bitgrain(folder, args))
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description("recipe: `cargo test -p bitgrain-tests --test commands cli::`");
    settings.bind(|| insta::assert_snapshot!(name, text));
}

#[test]
fn wrong_scenarios_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bed.toml");
    let edits = [
        ("diameter = 1.5", "diametre = 1.5"),
        ("speed = 1.0", "sped = 1.0"),
        ("grains = 300", "grains = \"many\""),
        ("grains = 300", "grains = 300\nfill_height = 4.0"),
        ("grains = 300", "grains = 3000"),
        ("grains = 300", "grains = -3"),
        ("kn = 2e5", "kn = -2e5"),
        ("mu = 0.5", "mu = nan"),
        ("grains = 300", "grains = 300\npouring_mu = -0.1"),
        ("grains = 300", "grains = 300\npouring_mu = inf"),
        ("kind = \"hertz_history\"", "kind = \"hertz\""),
        ("dt = 3e-4", "dt = 3e-3"),
        ("dt = 3e-4", "dt = 0.0"),
        ("height = 2.5", "height = 7.0"),
        ("height = 2.5", "height = 2.5\ndepth = 1.0"),
        ("diameter = 1.5", "diameter = 9.0"),
        ("box = [8.0, 6.0, 6.0]", "box = [8.0, 2.0, 30.0]"),
        ("box = [8.0, 6.0, 6.0]", "box = [8.0, 6.0]"),
        ("distance = 4.0", "distance = 9.0"),
        ("distance = 4.0", "distance = 1.0"),
        ("distance = 4.0", "distance = [4.0, 5.0]"),
        ("units = \"reduced\"", "units = \"reduced\"\ngravity = 9.81"),
        ("units = \"reduced\"", "units = \"imperial\""),
        ("name = \"small\"", "name = \"../small\""),
        ("[law]", "[law"),
    ];
    let mut text = String::new();
    for (from, to) in edits {
        assert!(SMALL.contains(from));
        std::fs::write(&file, SMALL.replacen(from, to, 1)).unwrap();
        text.push_str(&format!("# {}\n", to.replace('\n', "; ")));
        text.push_str(&told(folder.path(), &["run", "bed.toml"]));
    }
    text.push_str(&told(folder.path(), &["run", "quik"]));
    text.push_str(&told(folder.path(), &["run", "nowhere.toml"]));
    text.push_str(&told(
        folder.path(),
        &["run", "quick", "--set", "law.muu=0.3"],
    ));
    text.push_str(&told(folder.path(), &["run", "quick", "--set", "law.mu"]));
    text.push_str(&told(
        folder.path(),
        &["run", "quick", "--set", "drag.dt=1"],
    ));
    std::fs::write(&file, [0x1f, 0x8b, 8, 0, 1, 2, 3]).unwrap();
    text.push_str(&told(folder.path(), &["run", "bed.toml"]));
    assert!(!folder.path().join("out").exists(), "nothing was begun");
    assert_eq!(
        text.matches("[2]\n").count(),
        edits.len() + 6,
        "every one is refused with 2"
    );
    snapshot("scenarios", &text);
}

/// Refusals of a cylinder, of a lid and of a bed that moves.
#[test]
fn wrong_rigs_are_refused() {
    let (thick, high) = ("\ndiameter = 0.0015", "\nheight = 0.008");
    let (deep, far) = ("effective_depth = [0.01, 0.03]", "distance = 0.012");
    let (si, rows) = ("units = \"si\"", "every = 100");
    let edits = [
        (thick, "\ndiameter = 0.05"),
        (thick, "\ndiameter = 0.002"),
        (thick, "\ndiameter = []"),
        (thick, "\ndiameter = [0.001, 0.001]"),
        (thick, "\ndiameter = \"thick\""),
        (high, "\nheight = 0.002"),
        (high, "\nheight = 0.0235"),
        (high, "\nheight = 0.008\ndensity = 2500.0"),
        (far, "distance = 0.012\ndiscard = 0.001"),
        (far, "distance = 0.05"),
        (far, "distance = 0.003"),
        ("base = 0.0009", "base = 0.0"),
        ("base = 0.0009\n", ""),
        ("0.0405", "0.039"),
        ("0.0405", "0.041"),
        ("0.006,", "0.0065,"),
        ("0.024", "0.021"),
        (deep, "effective_depth = [0.03]\ndensity = 1e5"),
        ("effective_depth = [0.01, 0.03]\n", ""),
        (deep, "effective_depth = []"),
        (deep, "effective_depth = [0.03, 0.03]"),
        (deep, "effective_depth = -0.03"),
        (deep, "effective_depth = 0.005"),
        (deep, "density = 1000.0"),
        (si, "units = \"si\"\nseed = 3\nseeds = [1, 2]"),
        (si, "units = \"si\"\nseeds = [1, 2, 1]"),
        (si, "units = \"reduced\""),
        ("\"cylinder\"", "\"bar\""),
        ("\"bed\"", "\"base\""),
        ("\"in_turn\"", "\"in_layers\""),
        ("\"both\"", "\"none\""),
        ("\"both\"", "false"),
        (rows, "every = 100\nfields = { window = 0.004 }"),
        (rows, "every = 100\nfields = { window = 0.0 }"),
        (rows, "every = 100\nfields = { grid = [0, 3, 120] }"),
        (rows, "every = 100\nfields = { grid = [2000, 2000, 2] }"),
        (rows, "every = 100\nfields = { every = 0 }"),
        (rows, "every = 100\nfields = { every = 2000 }"),
        (rows, "every = 100\nfields = { windows = 0.001 }"),
    ];
    snapshot("rigs", &refusals(RIG, "rig.toml", &edits));
    let sound = RIG.replacen(far, "distance = 0.05\nown_wake = true", 1);
    let sound = bitgrain::scenario::parse(&sound, "wake", &[], Path::new("")).unwrap();
    assert_eq!(sound.drags()[0].distance, 0.05);
}

/// What is said of a scenario after each of some edits, every one of which is refused before anything is begun.
fn refusals(scenario: &str, name: &str, edits: &[(&str, &str)]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for (from, to) in edits {
        assert_eq!(scenario.matches(from).count(), 1, "{from}");
        std::fs::write(folder.path().join(name), scenario.replacen(from, to, 1)).unwrap();
        let what = if to.is_empty() { from } else { to };
        let what = what.trim().replace('\n', "; ");
        let how = if to.is_empty() { " left out" } else { "" };
        text.push_str(&format!("# {what}{how}\n"));
        text.push_str(&told(folder.path(), &["run", name]));
    }
    assert!(!folder.path().join("out").exists(), "nothing was begun");
    assert_eq!(text.matches("[2]\n").count(), edits.len());
    text
}

#[test]
fn wrong_tanks_are_refused() {
    let (tank, long, end) = ("container = \"tank\"", "length = 4.0", "snapshots = 0");
    let (bar, far, rest) = ("\"bar\"", "distance = 12.5664", "settled = 1e-5");
    let edits = [
        (tank, "container = \"barrel\""),
        (tank, ""),
        (bar, "\"sphere\""),
        (bar, "\"cylinder\""),
        (long, ""),
        (long, "length = -4.0"),
        (long, "length = 1.0"),
        (long, "length = 5.0"),
        (long, "length = 4.0\ndensity = 2.0"),
        ("[13.0, 13.0, 15.0]", "[13.0, 14.0, 15.0]"),
        ("depth = 4.0", "depth = 6.0"),
        ("own_wake = true", "own_wake = false"),
        (far, "distance = 1.5"),
        (far, "distance = 12.5664\nmoves = \"bed\""),
        (rest, "settled = 1e-5\nbase = 0.0"),
        (rest, "settled = 1e-5\nfloor = false"),
        (end, "snapshots = 0\nfields = {}"),
        (end, "snapshots = 0\n[lid]\neffective_depth = 8.0"),
    ];
    snapshot("tanks", &refusals(TANK, "tank.toml", &edits));
}

pub(crate) const CASE: &str = r#"{
  "law": {"kind": "hertz_history", "kn": 2e5, "kt": 2.45e5, "gamma_n": 792.4, "gamma_t": 792.4, "mu": 0.5},
  "box": {"lo": [0, 0, 0], "hi": [6, 6, 9], "periodic": [true, true, false]},
  "gravity": [0, 0, -1],
  "dt": 2e-4,
  "obstacles": [{"shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 1]}],
  "grains": [
    {"id": 1, "diameter": 1.0, "density": 1.0, "position": [1, 2, 3]},
    {"id": 4, "diameter": 1.0, "density": 1.0, "position": [1, 2, 0.6], "motion": "frozen"}
  ]
}"#;

/// A case of two materials.
const MATERIALS: &str = r#"{
  "law": {
    "kind": "hertz_tsuji",
    "materials": {"glass": {"young": 4e5, "poisson": 0.25}, "steel": {"young": 4e6, "poisson": 0.3}},
    "pairs": [
      {"between": ["glass", "glass"], "restitution": 0.8, "mu": 0.3},
      {"between": ["steel", "steel"], "restitution": 0.8, "mu": 0.3},
      {"between": ["glass", "steel"], "restitution": 0.6, "mu": 0.2}
    ]
  },
  "dt": 2e-4,
  "obstacles": [
    {"shape": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "material": "steel"}
  ],
  "grains": [
    {"id": 1, "diameter": 1, "density": 1, "position": [0, 0, 0.6], "material": "glass"},
    {"id": 2, "diameter": 1, "density": 1, "position": [0, 2, 0.6], "material": "glass"}
  ]
}"#;

#[test]
fn wrong_cases_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.json");
    let edits = [
        ("\"gravity\"", "\"gravty\""),
        ("\"position\": [1, 2, 3]", "\"position\": [1, 2]"),
        ("\"position\": [1, 2, 3]", "\"position\": [1, NaN, 3]"),
        ("\"position\": [1, 2, 3]", "\"position\": [1, 1e999, 3]"),
        ("\"position\": [1, 2, 3]", "\"position\": [1, 2, 12]"),
        ("\"id\": 4", "\"id\": 1"),
        ("\"id\": 4, ", ""),
        ("\"diameter\": 1.0", "\"diameter\": 0"),
        ("\"mu\": 0.5", "\"mu\": -0.5"),
        ("\"kind\": \"hertz_history\"", "\"kind\": \"hooke\""),
        ("\"dt\": 2e-4", "\"dt\": 2e-2"),
        ("\"hi\": [6, 6, 9]", "\"hi\": [2, 6, 9]"),
        ("\"hi\": [6, 6, 9]", "\"hi\": [6, 6, -9]"),
        ("\"normal\": [0, 0, 1]", "\"normal\": [1, 0, 1]"),
        ("\"normal\": [0, 0, 1]", "\"normal\": [0, 0, 0]"),
        ("\"motion\": \"frozen\"", "\"motion\": \"stuck\""),
        (
            "\"motion\": \"frozen\"",
            "\"motion\": \"frozen\", \"velocity\": [1, 0, 0]",
        ),
        ("\"frozen\"}\n  ]\n}", "\"frozen\"}"),
        ("\"motion\": \"frozen\"", "\"material\": \"glass\""),
    ];
    let edits = edits.map(|edit| (CASE, edit));
    let several = [
        ("\"glass\"}", "\"sand\"}"),
        (", \"material\": \"glass\"", ""),
        ("\"mu\": 0.2", "\"mu\": -0.2"),
        ("\"mu\": 0.2", "\"mu\": 0.2, \"kn\": 1"),
        ("\"poisson\": 0.3", "\"poisson\": 0.6"),
        ("[\"glass\", \"steel\"]", "[\"glass\", \"steal\"]"),
        ("[\"glass\", \"steel\"]", "[\"steel\", \"steel\"]"),
        ("[\"steel\", \"steel\"]", "[\"steel\", \"glass\"]"),
        ("\"dt\": 2e-4", "\"dt\": 2e-2"),
        ("\"materials\"", "\"material\""),
        (
            "[\"glass\", \"glass\"], \"restitution\": 0.8, \"mu\": 0.3},\n      {\"between\": [\"steel\", \"steel\"]",
            "[\"steel\", \"steel\"]",
        ),
    ];
    let several = several.map(|edit| (MATERIALS, edit));
    let edits: Vec<_> = edits.into_iter().chain(several).collect();
    let mut text = String::new();
    for (case, (from, to)) in edits.iter().copied() {
        assert!(case.contains(from), "{from}");
        std::fs::write(&file, case.replacen(from, to, 1)).unwrap();
        text.push_str(&format!("# {}\n", to.replace('\n', " ")));
        text.push_str(&told(
            folder.path(),
            &["replay", "case.json", "--steps", "5"],
        ));
    }
    assert_eq!(
        text.matches("[2]\n").count(),
        edits.len(),
        "every one is refused with 2"
    );
    snapshot("cases", &text);
}

/// Stops at the step, names it and the grains, keeps what was printed, ends with 3.
#[test]
fn runs_that_go_wrong_stop_there() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.json");
    let edits = [
        ("\"position\": [1, 2, 3]", "\"position\": [1, 2, 1.2]"),
        ("\"position\": [1, 2, 3]", "\"position\": [1, 2, 0.6]"),
        (
            "\"position\": [1, 2, 3]",
            "\"position\": [3, 2, 8.99], \"velocity\": [0, 0, 4]",
        ),
        (
            "\"position\": [1, 2, 3]",
            "\"position\": [1, 2, 1.7], \"velocity\": [0, 0, -160]",
        ),
    ];
    let mut text = String::new();
    for (from, to) in edits {
        std::fs::write(&file, CASE.replacen(from, to, 1)).unwrap();
        text.push_str(&format!("# {to}\n"));
        let args = ["replay", "case.json", "--steps", "200", "--every", "5"];
        let printed = bitgrain(folder.path(), &args).stdout;
        let lines = printed.iter().filter(|&&b| b == b'\n').count();
        text.push_str(&format!("({lines} samples printed)\n"));
        text.push_str(&told(folder.path(), &args));
    }
    assert_eq!(
        text.matches("[3]\n").count(),
        edits.len(),
        "every one ends with 3"
    );
    snapshot("faults", &text);
}

#[test]
fn wrong_beds_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read_to_string(golden("peers/bed200.data")).unwrap();
    let file = folder.path().join("bed.data");
    let cut = whole.len() / 2;
    let beds: [(&str, String); 7] = [
        ("cut off", whole[..cut].to_string()),
        ("a repeated id", whole.replacen("\n2 3 ", "\n1 3 ", 1)),
        (
            "a word for a number",
            whole.replacen("\n2 3 0.97", "\n2 3 x.97", 1),
        ),
        (
            "NaN",
            whole.replacen("\n2 3 0.97048064689525138", "\n2 3 nan", 1),
        ),
        ("no box", whole.replacen("0 5.5 xlo xhi", "", 1)),
        (
            "another style",
            whole.replacen("Atoms # sphere", "Atoms # charge", 1),
        ),
        (
            "an unknown section",
            whole.replacen("Velocities", "Bonds", 1),
        ),
    ];
    let mut text = String::new();
    for (what, bed) in &beds {
        assert_ne!(*bed, whole, "{what}");
        std::fs::write(&file, bed).unwrap();
        text.push_str(&format!("# {what}\n"));
        text.push_str(&told(
            folder.path(),
            &["bench", "--bed", "bed.data", "--steps", "5"],
        ));
    }
    assert_eq!(
        text.matches("[2]\n").count(),
        beds.len(),
        "every one is refused with 2"
    );
    snapshot("beds", &text);
}

/// JSON Lines as documented: steps 0, K, 2K, ..., N; contacts when asked for.
#[test]
fn a_replay_prints_its_samples() {
    let case = golden("cases/collapse.json");
    let case = case.to_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let args = [
        "replay",
        case,
        "--steps",
        "9500",
        "--every",
        "3000",
        "--contacts",
    ];
    let out = bitgrain(folder.path(), &args);
    assert!(out.status.success());
    let lines: Vec<serde_json::Value> = String::from_utf8(out.stdout)
        .unwrap()
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let steps: Vec<u64> = lines.iter().map(|l| l["step"].as_u64().unwrap()).collect();
    assert_eq!(steps, [0, 3000, 6000, 9000, 9500]);
    let golden_digests = std::fs::read_to_string(golden("digests/cases.snap")).unwrap();
    for line in &lines[..4] {
        assert!(golden_digests.contains(line["digest"].as_str().unwrap()));
        assert_eq!(line["grains"].as_array().unwrap().len(), 30);
        assert_eq!(line["obstacles"].as_array().unwrap().len(), 2);
    }
    // The contact forces on each grain add up to its force.
    let last = &lines[4];
    let contacts = last["contacts"].as_array().unwrap();
    assert!(contacts.len() > 5);
    for grain in last["grains"].as_array().unwrap() {
        let mut sum = [0.0; 3];
        for c in contacts {
            let sign = match (c["i"] == grain["id"], c["j"] == grain["id"]) {
                (true, _) => 1.0,
                (_, true) => -1.0,
                _ => 0.0,
            };
            for a in 0..3 {
                let both = [&c["normal_force"][a], &c["tangential_force"][a]];
                sum[a] += sign * both.map(|f| f.as_f64().unwrap()).iter().sum::<f64>();
            }
        }
        for a in 0..3 {
            // Rounding of sums of forces of some thousands.
            assert!((sum[a] - grain["force"][a].as_f64().unwrap()).abs() < 1e-9);
        }
    }
}

/// Every shipped scenario is sound, and so is its resolved form.
#[test]
fn shipped_scenarios_are_sound() {
    for (name, _) in bitgrain::scenario::SHIPPED {
        let scenario = bitgrain::scenario::load(name, &[]).unwrap();
        let again =
            bitgrain::scenario::parse(&scenario.to_toml(), name, &[], Path::new("")).unwrap();
        assert_eq!(scenario, again);
        assert_eq!(scenario.name, name);
    }
    let one = bitgrain::scenario::load("kumar-system-1", &[]).unwrap();
    assert_eq!(
        (one.grain_count(3.0), one.beds()[0].center),
        (70_000, [20.0, 20.0, 13.5])
    );
    let two = bitgrain::scenario::load("kumar-system-2", &[]).unwrap();
    assert_eq!(
        (two.grain_count(3.0), two.beds().len(), two.drags().len()),
        (300_000, 7, 35)
    );
}

/// The dragging stage keeps the series measured before a fault, and says where it stopped.
#[test]
fn a_drag_that_goes_wrong_keeps_its_series() {
    let folder = tempfile::tempdir().unwrap();
    // So fast that it drives grains into each other beyond the limit.
    let text = SMALL.replacen("speed = 1.0", "speed = 150.0", 1);
    let text = text.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    let text = text.replacen("distance = 4.0", "distance = 6.0", 1);
    std::fs::write(
        folder.path().join("fast.toml"),
        format!("{text}\n[measure]\nevery = 1\n"),
    )
    .unwrap();
    let out = bitgrain(folder.path(), &["run", "fast.toml", "--out", "fast"]);
    let message = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(3), "{message}");
    assert!(message.contains("run-1 stopped at step"), "{message}");
    let fast = folder.path().join("fast");
    assert!(fast.join("beds/bed.safetensors").exists());
    assert!(fast.join("runs/run-1/forces.partial.csv").exists());
    assert!(!fast.join("summary.json").exists());
}
