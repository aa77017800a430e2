//! Beds: their packing, and their way to LAMMPS' files and back.

use std::path::Path;

use bitgrain::bed::{self, import};
use bitgrain::export;
use bitgrain::lammps::data_text;
use bitgrain::progress::Stage;
use bitgrain::scenario::{self, CheckedScenario, OneOrMany};
use bitgrain::summary::BedSummary;
use bitgrain_tests::{SMALL, assert_named, output, small_from_file};

fn quick(sets: &[&str]) -> CheckedScenario {
    let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    scenario::load("quick", &sets).unwrap()
}

/// A bed of 1,200 grains, 10 deep, small enough for a test and wide enough for a packing fraction.
fn poured(mu: &str) -> BedSummary {
    let scenario = quick(&[
        "bed.box=[8.0, 8.0, 16.0]",
        "bed.grains=1200",
        "intruder.diameter=1.0",
        "intruder.height=5.0",
        "drag.distance=8.0",
        mu,
    ]);
    let mut sim = bed::pour(&scenario, &scenario.beds()[0], &mut Stage::silent()).unwrap();
    bed::survey("bed", &scenario.measures(), &mut sim).unwrap()
}

/// Poured random packings of spheres: 0.58 to 0.62 and 4 to 6 contacts with friction 0.5; without
/// friction the packing is denser, near random close packing (0.64), and has the six contacts a grain
/// that make it just rigid, less its rattlers, a little more by overlap.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn packings_are_those_of_the_field() {
    let (rough, smooth) = std::thread::scope(|scope| {
        let smooth = scope.spawn(|| poured("law.mu=0.0"));
        (poured("law.mu=0.5"), smooth.join().unwrap())
    });
    assert!((0.58..0.62).contains(&rough.packing_fraction), "{rough:?}");
    assert!((4.0..6.0).contains(&rough.coordination_number), "{rough:?}");
    assert!(
        (0.62..0.66).contains(&smooth.packing_fraction),
        "{smooth:?}"
    );
    assert!(
        (5.6..6.4).contains(&smooth.coordination_number),
        "{smooth:?}"
    );
    assert!(smooth.surface < rough.surface);
    for bed in [rough, smooth] {
        assert!((bed.support / bed.weight - 1.0).abs() < 5e-4, "{bed:?}");
        assert!(bed.kinetic_energy_over_weight_d < 1e-6, "{bed:?}");
    }
}

/// A settled bed written as a LAMMPS data file and imported from there: every grain the same to the
/// last bit, whatever its number now is.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn a_bed_goes_to_a_data_file_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let text = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-3", 1);
    let scenario = scenario::parse(&text, "small", &[], Path::new("")).unwrap();
    let sim = bed::pour(&scenario, &scenario.beds()[0], &mut Stage::silent()).unwrap();
    let file = folder.path().join("bed.data");
    std::fs::write(&file, data_text(&export::atoms(&sim, true), "a bed")).unwrap();

    let text = small_from_file("bed.data", "");
    let imported = scenario::parse(&text, "small", &[], folder.path()).unwrap();
    assert_eq!(imported.intruder.diameter, OneOrMany::One(1.5));
    let again = import::bed(&imported, &file).unwrap();
    assert_eq!(again.obstacles[0].point, sim.obstacles[0].point);
    assert_eq!(
        again.obstacles[0].inverse_mass,
        sim.obstacles[0].inverse_mass
    );
    let grains = |sim: &bitgrain::simulation::Simulation| -> Vec<([u64; 11], [i32; 3], u8)> {
        let mut rows: Vec<_> = (0..sim.count())
            .map(|i| {
                let (x, v, w) = (sim.position[i], sim.velocity[i], sim.spin[i]);
                let row = [
                    x[0], x[1], x[2], x[3], v[0], v[1], v[2], v[3], w[0], w[1], w[2],
                ];
                (row.map(f64::to_bits), sim.image[i], sim.group[i])
            })
            .collect();
        rows.sort_unstable();
        rows
    };
    assert_eq!(grains(&sim).len(), 300);
    assert_eq!(grains(&sim), grains(&again));
}

/// A packed run: its report reads its snapshots, and they are beds to drag through in their turn.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn packed_snapshots_are_beds() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        let out = output(
            env!("CARGO_BIN_EXE_bitgrain-under-test"),
            folder.path(),
            args,
        );
        assert!(
            out.status.success(),
            "{}",
            String::from_utf8_lossy(&out.stderr)
        );
    };
    let soft = "bed.settled=1e-2";
    std::fs::write(folder.path().join("small.toml"), SMALL).unwrap();
    run(&[
        "run",
        "small.toml",
        "--set",
        soft,
        "--set",
        "measure.gzip=true",
    ]);
    let out = folder.path().join("out/small");
    assert!(out.join("beds/bed.data.gz").exists());
    assert_named(&out);
    let report = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(
        report.contains("after a travel of"),
        "the flow is drawn from a packed dump"
    );
    let dumps = std::fs::read_dir(out.join("runs/run-1/snapshots")).unwrap();
    let names = dumps.map(|file| file.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".dump.gz")).collect();
    names.sort();
    assert_eq!(names.len(), 2);

    let file = format!("out/small/runs/run-1/snapshots/{}", names[1]);
    // Half the way: this bed has no floor below its grains of the base, and they leave a gap.
    let text = small_from_file(&file, "").replacen("distance = 4.0", "distance = 2.0", 1);
    std::fs::write(folder.path().join("again.toml"), text).unwrap();
    let often = "measure.every=20";
    run(&["run", "again.toml", "--out", "again", "--set", often]);
    // The folder stands alone: its own scenario gives the same numbers.
    run(&["run", "again/scenario.toml", "--out", "third"]);
    assert_named(&folder.path().join("again"));
    let of = |name: &str| std::fs::read(folder.path().join(name).join("summary.json")).unwrap();
    assert!(of("again") == of("third"));
}

/// `bed list`, `show` and `remove`, as a user would.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn beds_are_listed_shown_and_removed() {
    let folder = tempfile::tempdir().unwrap();
    let run = |args: &[&str]| {
        let out = output(
            env!("CARGO_BIN_EXE_bitgrain-under-test"),
            folder.path(),
            args,
        );
        let error = String::from_utf8_lossy(&out.stderr);
        assert!(out.status.success(), "{args:?}: {error}");
        String::from_utf8(out.stdout).unwrap()
    };
    assert_eq!(run(&["bed", "list"]), "no beds in beds\n");
    let text = SMALL.replacen("grains = 300", "grains = 300\nsettled = 1e-2", 1);
    std::fs::write(folder.path().join("small.toml"), &text).unwrap();
    run(&["run", "small.toml"]);
    let deeper = text.replacen("height = 2.5", "height = [2.5, 3.0]", 1);
    std::fs::write(folder.path().join("two.toml"), deeper).unwrap();
    run(&["run", "two.toml", "--out", "two"]);
    let how = std::fs::read_to_string(folder.path().join("two/performance.json")).unwrap();
    assert!(
        how.contains("\"reused\"") && how.contains("\"poured\""),
        "{how}"
    );

    let list = run(&["bed", "list"]);
    assert_eq!(list.lines().count(), 4, "{list}");
    assert!(
        list.contains("8 x 6 x 6") && list.contains("2 bed(s) in beds, "),
        "{list}"
    );
    let name = list.lines().nth(1).unwrap().split(' ').next().unwrap();
    let shown = run(&["bed", "show", &name[..6]]);
    assert!(
        shown.contains("packing fraction") && shown.contains("grains = 300"),
        "{shown}"
    );
    assert!(run(&["bed", "remove", &name[..6]]).contains("removed"));
    assert_eq!(run(&["bed", "list"]).lines().count(), 3);
    run(&["bed", "remove", "--all"]);
    assert_eq!(run(&["bed", "list"]), "no beds in beds\n");

    let plan = run(&["run", "small.toml", "--dry-run", "--out", "dry"]);
    for line in [
        "steps in all",
        "memory",
        "disk",
        "  Fr  ",
        "inertial number",
        "K_n/(rho g d)",
    ] {
        assert!(plan.contains(line), "{plan}");
    }
    assert!(
        !folder.path().join("dry").exists(),
        "a dry run writes nothing"
    );
}
