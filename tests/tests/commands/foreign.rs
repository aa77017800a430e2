//! Files in our own formats that somebody else wrote: refused with exit status 2, with file and key, and nothing beyond
//! the folder is touched. No panic, no list that a number in them made long, no path followed.

use std::path::Path;
use std::process::Command;

use bitgrain::analysis::analyse;
use bitgrain::campaign::plan;
use bitgrain::campaign::table::CampaignTable;
use bitgrain::claims::book::Book;
use bitgrain::manifest::FolderKind;
use bitgrain::summary::{parse_record, parse_summary, read_summary};
use bitgrain_tests::wee::forge_manifest;
use bitgrain_tests::{CAMPAIGN, golden, output, root};
use serde_json::{Value, json};

use crate::PROGRAM;

/// Most memory of a command that reads one of them, in KiB.
const MEMORY: u64 = 2_000_000;

/// A sound summary of two drags.
fn sound() -> Value {
    let text = std::fs::read_to_string(golden("guillard-small/summary.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// What changes, and the key that is named.
const CHANGES: [(&str, &str, &str); 38] = [
    ("/inputs/drag/distance", "[]", "inputs.drag.distance"),
    (
        "/inputs/measure/snapshots",
        "18446744073709551615",
        "inputs.measure.snapshots",
    ),
    (
        "/inputs/measure/snapshots",
        "1000000000000000",
        "inputs.measure.snapshots",
    ),
    (
        "/inputs/measure/checkpoints",
        "0",
        "inputs.measure.checkpoints",
    ),
    ("/inputs/measure/every", "0", "inputs.measure.every"),
    ("/inputs/drag/dt", "1e-300", "inputs.drag."),
    (
        "/inputs/intruder/diameter",
        "[]",
        "inputs.intruder.diameter",
    ),
    ("/inputs/intruder/speed", "[]", "inputs.intruder.speed"),
    ("/inputs/seeds", "[1, 1]", "inputs.seeds"),
    ("/inputs/name", "\"../../elsewhere\"", "inputs.name"),
    ("/inputs/bed/box", "[1e300, 1e300, 1e300]", "inputs."),
    ("/inputs/bed/file", "\"/etc/passwd\"", "inputs."),
    (
        "/inputs/measure/fields",
        "{\"grid\": [4000000000, 4000000000, 4]}",
        "inputs.measure.fields.grid",
    ),
    ("/scenario", "\"other\"", "scenario"),
    ("/version", "\"\\u001b[2J\"", "version"),
    ("/units/force", "\"pounds\"", "units"),
    ("/beds", "[]", "beds"),
    ("/beds/0/name", "\"../../../etc/passwd\"", "beds[0].name"),
    ("/beds/0/name", "\"bed-2\"", "beds["),
    ("/beds/0/frozen", "100000000", "beds[0].frozen"),
    ("/beds/0/digest", "\"<b>\"", "beds[0].digest"),
    ("/beds/0/rig", "null", "beds[0].rig"),
    ("/beds/0/rig/diameter", "1.0", "beds[0].rig.diameter"),
    ("/runs", "[]", "runs"),
    ("/runs/0/name", "\"../../../elsewhere\"", "runs[0].name"),
    ("/runs/0/bed", "\"bed-2\"", "runs[0].bed"),
    ("/runs/0/bed", "\"bed-7\"", "runs[0].bed"),
    ("/runs/0/steps", "0", "runs[0].steps"),
    ("/runs/0/steps", "18446744073709551615", "runs[0].steps"),
    ("/runs/0/distance", "-1.0", "runs[0].distance"),
    ("/runs/0/speed", "0", "runs[0].speed"),
    ("/runs/0/diameter", "7.0", "runs[0].diameter"),
    (
        "/runs/0/window_steps",
        "18446744073709551615",
        "runs[0].window_steps",
    ),
    (
        "/runs/0/drag/standard_error",
        "-1.0",
        "runs[0].drag.standard_error",
    ),
    ("/runs/0/drag/mean", "1e999", "out of range"),
    ("/runs/0/digest_parts", "[]", "runs[0].digest_parts"),
    ("/runs/0/digest", "\"00\"", "runs[0].digest"),
    (
        "/runs/0/flow/load",
        "{\"normal\": [], \"normal_error\": [], \"tangential\": [], \"tangential_error\": [], \"parts\": []}",
        "runs[0].flow.load.normal",
    ),
];

/// The text of a summary with the value at a place changed; places that are not there are made.
fn changed(summary: &Value, place: &str, to: &str) -> String {
    const MARK: &str = "\"what is put in\"";
    let mut summary = summary.clone();
    let (outer, key) = place.rsplit_once('/').unwrap();
    let mark: Value = serde_json::from_str(MARK).unwrap();
    match summary.pointer_mut(outer).unwrap() {
        Value::Object(map) => {
            map.insert(key.into(), mark);
        }
        Value::Array(list) => list[key.parse::<usize>().unwrap()] = mark,
        _ => panic!("{place}"),
    }
    summary.to_string().replacen(MARK, to, 1)
}

#[test]
fn changed_summaries_are_refused() {
    let sound = sound();
    let path = Path::new("summary.json");
    parse_summary(&sound.to_string(), path).unwrap();
    for (place, to, key) in CHANGES {
        let text = changed(&sound, place, to);
        let error = parse_summary(&text, path).unwrap_err();
        let told = error.to_string();
        assert!(told.starts_with("summary.json"), "{place}: {told}");
        assert!(told.contains(key), "{place} = {to}: {told}");
        assert_eq!(error.exit_status(), 2);
    }
    // A drag twice.
    let mut twice = sound.clone();
    twice["runs"][1] = twice["runs"][0].clone();
    let told = parse_summary(&twice.to_string(), path).unwrap_err();
    assert!(told.to_string().contains("runs[1].name"), "{told}");
}

#[test]
fn changed_records_of_one_drag_are_refused() {
    let whole = sound();
    let record = json!({
        "version": whole["version"], "bits_version": whole["bits_version"], "units": whole["units"],
        "inputs": whole["inputs"], "standard_error_method": whole["standard_error_method"],
        "bed": whole["beds"][0], "run": whole["runs"][0],
    });
    let path = Path::new("summary.json");
    let read = parse_record(&record.to_string(), path).unwrap();
    assert_eq!(read.run.name, "bed-1-run-1");
    let mut changes = 0;
    for (place, to, key) in CHANGES {
        let place = place.replace("/beds/0", "/bed").replace("/runs/0", "/run");
        if ["/scenario", "/beds", "/runs"].contains(&&place[..]) {
            continue;
        }
        let told = parse_record(&changed(&record, &place, to), path).unwrap_err();
        let key = key.replace("beds[0]", "bed").replace("runs[0]", "run");
        let key = key.replace("beds[", "run.bed");
        assert!(told.to_string().contains(&key), "{place} = {to}: {told}");
        changes += 1;
    }
    assert!(changes > 30);
}

/// Summaries that ship are read as they were.
#[test]
fn summaries_of_before_are_read() {
    for (name, runs) in [
        ("guillard-small/summary.json", 2),
        ("guillard-medium/summary.json.gz", 32),
    ] {
        let read = read_summary(&golden(name)).unwrap();
        assert_eq!(read.runs.len(), runs, "{name}");
    }
}

/// Input that once caused an abort or a panic of a command, with little memory at hand.
#[test]
#[cfg(target_os = "linux")]
fn commands_refuse_what_they_read() {
    let sound = sound();
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    std::fs::create_dir_all(&run).unwrap();
    let shipped = root().join("harness/lab/scenarios/guillard-small.toml");
    std::fs::copy(shipped, run.join("scenario.toml")).unwrap();
    for (place, to, key) in CHANGES {
        std::fs::write(run.join("summary.json"), changed(&sound, place, to)).unwrap();
        forge_manifest(&run, FolderKind::Run, &[]);
        for command in ["analyse", "report", "claims"] {
            let limited = format!("ulimit -v {MEMORY}; exec \"$0\" {command} run");
            let out = Command::new("sh")
                .args(["-c", &limited, PROGRAM])
                .current_dir(folder.path())
                .output()
                .unwrap();
            let told = String::from_utf8_lossy(&out.stderr);
            assert_eq!(
                out.status.code(),
                Some(2),
                "{command}, {place} = {to}: {told}"
            );
            assert!(told.contains(key) && !told.contains("panicked"), "{told}");
        }
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "nothing is written elsewhere");
}

/// A scenario's file is foreign too: numbers are checked before lists are made from them.
#[test]
fn scenarios_that_ask_for_too_much_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let many = |n: usize| -> String {
        let values: Vec<String> = (1..=n)
            .map(|k| format!("{}", 1.0 + k as f64 * 1e-6))
            .collect();
        format!("[{}]", values.join(", "))
    };
    let dots = "a.".repeat(30_000);
    for (set, key) in [
        (
            "measure.snapshots=1000000000000000".to_string(),
            "measure.snapshots",
        ),
        ("drag.distance=[]".to_string(), "drag.distance"),
        (format!("intruder.speed={}", many(1001)), "intruder.speed"),
        (
            format!("seeds={:?}", (1..500).collect::<Vec<u64>>()),
            "intruder",
        ),
        ("bed.grains=100000001".to_string(), "bed.grains"),
        ("bed.fill_height=1e30".to_string(), "bed."),
        ("drag.dt=1e-320".to_string(), "drag."),
        (format!("{dots}a=1"), "parts"),
    ] {
        let out = output(PROGRAM, folder.path(), &["run", "quick", "--set", &set]);
        let told = String::from_utf8_lossy(&out.stderr);
        let end = &told[told.len().saturating_sub(300)..];
        assert_eq!(
            out.status.code(),
            Some(2),
            "{}: {end}",
            &set[..30.min(set.len())]
        );
        assert!(told.contains(key), "{end}");
    }
}

/// A grid's name that is not that of a folder in place, and more than can be planned.
#[test]
fn campaigns_that_reach_out_are_refused() {
    let sound = CAMPAIGN.replacen("base = \"small.toml\"", "base = \"quick\"", 1);
    let sound = sound.replacen("speed = [1.0, 2.0]", "speed = [1.0, 2.0]\nkeep = []", 1);
    let parse = |text: &str| plan::parse(text, "camp.toml", &[], Path::new(""));
    let many = |n: usize| -> String {
        let values: Vec<String> = (1..=n)
            .map(|k| format!("{}", 0.1 + k as f64 * 1e-7))
            .collect();
        format!("[{}]", values.join(", "))
    };
    let (name, mu) = ("name = \"friction\"", "mu = [0.1, 0.5]");
    let long = "x".repeat(300);
    for (from, to, key) in [
        (name, "name = \"../../out\"", "grid.name"),
        (name, "name = \"/tmp/out\"", "grid.name"),
        (name, "name = \"a\\u001b[2J\"", "grid.name"),
        (name, &format!("name = \"{long}\""), "grid.name"),
        (name, "name = \"\"", "grid.name"),
        (
            mu,
            &format!("mu = {}", many(20_000)),
            "`mu` has 20000 values",
        ),
        (
            mu,
            &format!(
                "mu = {0}\nkn = {0}\ndepth = {0}\ndiameter = {0}",
                many(5000)
            ),
            "more than 10000 beds",
        ),
        (
            "speed = [1.0, 2.0]",
            &format!("speed = {}", many(1500)),
            "intruder.speed",
        ),
    ] {
        assert!(sound.contains(from), "{from}");
        let told = parse(&sound.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(told.contains(key), "{to:.60}: {told:.300}");
    }
}

/// Claims with numbers that are none, and more of them than can be compared with each other.
#[test]
fn books_with_impossible_numbers_are_refused() {
    let shipped = std::fs::read_to_string(golden("claims.toml")).unwrap();
    let refused = |text: &str| Book::parse(text, "book.toml").unwrap_err().to_string();
    for (from, to) in [
        ("value = 1.0", "value = nan"),
        ("tolerance = 0.1", "tolerance = inf"),
        ("tolerance = 0.1", "tolerance = -0.1"),
        ("error = 0.0306", "error = -0.0306"),
        ("value = 1.0608", "value = -inf\n#"),
    ] {
        let told = refused(&shipped.replacen(from, to, 1));
        assert!(told.contains("claim `kumar-flat`"), "{to}: {told}");
    }
    let one = &shipped[shipped.find("[[claim]]").unwrap()..];
    let one = &one[..one.find("[[claim.measured]]").unwrap()];
    let many: String = (0..10_001)
        .map(|k| one.replacen("kumar-flat", &k.to_string(), 1))
        .collect();
    assert!(refused(&many).contains("at most 10000"));
}

/// A table longer than any campaign's, and one whose rows all lie on one curve.
#[test]
fn tables_that_are_too_long_are_refused() {
    let head = "member,run,status,froude,drag,drag_error,speed,depth,plug_ratio\n";
    let row = |k: usize| format!("m,r,done,{},{},0.1,{},5,0.1\n", k + 1, k + 2, k + 1);
    let long: String = (0..200_001).map(row).collect();
    let told = CampaignTable::parse(&format!("{head}{long}"), "results.csv").unwrap_err();
    assert!(told.to_string().contains("more than 200000 rows"), "{told}");
    let some: String = (0..2000).map(row).collect();
    let began = std::time::Instant::now();
    let table = CampaignTable::parse(&format!("{head}{some}"), "results.csv").unwrap();
    let analysis = analyse(&table, true);
    assert_eq!(analysis.rows, 2000);
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
}
