//! The rig of Guillard 2014, section III, at a size of seconds, from end to end: its goldens, its beds and
//! lids, and laws that they obey whatever the grains do.

use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use bitgrain::bed::energy_of_borne;
use bitgrain::bed::library::BedCache;
use bitgrain::folder::Folder;
use bitgrain::manifest::{FolderKind, Vouched};
use bitgrain::observe::weight_and_support;
use bitgrain::progress::Progress;
use bitgrain::scenario::{self, CheckedScenario};
use bitgrain::simulation::{Simulation, sphere_mass};
use bitgrain::summary::{BedSummary, DragSummary, Rig, Summary, read_folder, read_summary};
use bitgrain::{checkpoint, present, run};
use bitgrain_tests::wee::forge_manifest;
use bitgrain_tests::{RIG, assert_named, golden, output, results, written};

const G: f64 = 9.81;
const D: f64 = 0.0015;

fn rig(sets: &[&str]) -> CheckedScenario {
    let sets: Vec<String> = sets.iter().map(|s| s.to_string()).collect();
    scenario::parse(RIG, "rig", &sets, Path::new("")).unwrap()
}

/// The rig over the shortest way that leaves a window after two diameters.
fn short() -> CheckedScenario {
    rig(&["drag.distance=0.006", "measure.every=40"])
}

fn run_into(scenario: &CheckedScenario, out: &Path, beds: &Path, threads: usize) {
    let library = BedCache::new(beds);
    bitgrain::present::run(scenario, out, &library, threads, &Progress::new(false)).unwrap();
}

/// One run that the tests of this file share: one of its drags was done alone, then the whole.
struct Made {
    out: PathBuf,
    /// The files after the drag that was done alone.
    alone: BTreeMap<String, Vec<u8>>,
    files: BTreeMap<String, Vec<u8>>,
    whole: Summary,
}

/// The drag that was done alone.
const ALONE: &str = "bed-3-run-1";

/// Does these drags of the rig, or all, into a folder.
fn part_into(out: &Path, beds: &Path, only: &[&str]) -> bitgrain::error::Result<Option<run::Done>> {
    let only: Vec<String> = only.iter().map(|name| name.to_string()).collect();
    run::run_in(run::Setting {
        scenario: &short(),
        folder: &Folder(out),
        library: &BedCache::new(beds),
        threads: 1,
        save: Default::default(),
        frames: true,
        only: &only,
        write_report: present::write_report,
        progress: &Progress::new(false),
    })
}

/// Made once for all tests of this file; the first of them waits some ten seconds for it.
static MADE: LazyLock<Made> = LazyLock::new(|| {
    // Not a temporary folder: nothing that is static is ever dropped.
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("rig");
    let _ = std::fs::remove_dir_all(&folder);
    let (out, beds) = (folder.join("out"), folder.join("beds"));
    assert_eq!(part_into(&out, &beds, &[ALONE]).unwrap(), None);
    let alone = results(&out);
    let done = part_into(&out, &beds, &[]).unwrap();
    assert_eq!(done.map(|done| done.report), Some(out.join("report.html")));
    Made {
        alone,
        files: results(&out),
        whole: read_summary(&out.join("summary.json")).unwrap(),
        out,
    }
});

impl Made {
    /// The settled bed of a run, as it was before the motion.
    fn bed(&self, k: usize) -> Simulation {
        let name = format!("beds/{}.safetensors", self.whole.beds[k].name);
        checkpoint::read(&self.out.join(name)).unwrap()
    }

    fn text(&self, file: &str) -> &str {
        std::str::from_utf8(&self.files[file]).unwrap()
    }
}

/// For a drag that is asked for alone only its bed is made as well; the whole run goes on from there to the same
/// files: the goldens are those of a run that was not begun so.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours beds: seconds in release")]
fn a_drag_done_alone_is_that_of_the_whole() {
    let made = &MADE.alone;
    assert!(made.contains_key("runs/bed-3-run-1/summary.json"));
    assert!(!made.contains_key("summary.json") && !made.contains_key("beds/bed-2.safetensors"));
    for (name, bytes) in made {
        // The manifest says that the others are not finished.
        assert!(
            bytes == &MADE.files[name] || name == "manifest.json",
            "{name}"
        );
    }
    // What is done can be viewed before the rest is.
    let (folder, beds) = (written(made), tempfile::tempdir().unwrap());
    let out = folder.path();
    assert_named(out);
    assert_named(&MADE.out);
    let so_far = read_folder(&Folder(out), &vouched(out)).unwrap().1;
    assert_eq!([so_far.beds.len(), so_far.runs.len()], [1, 1]);
    assert_eq!(so_far.runs[0], MADE.whole.runs[2]);
    assert_eq!(so_far.beds[0], MADE.whole.beds[2]);
    let unknown = part_into(out, beds.path(), &["run-9"])
        .unwrap_err()
        .to_string();
    assert!(unknown.contains(ALONE), "{unknown}");
}

/// A summary that went missing is told, and written again.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours beds: seconds in release")]
fn a_missing_summary_is_told_and_written_again() {
    let (folder, beds) = (written(&MADE.files), tempfile::tempdir().unwrap());
    let out = folder.path();
    std::fs::remove_file(out.join("summary.json")).unwrap();
    let missing = read_folder(&Folder(out), &vouched(out)).unwrap_err();
    assert!(
        missing.to_string().contains("summary.json: is missing"),
        "{missing}"
    );
    let done = part_into(out, beds.path(), &[]).unwrap().unwrap();
    assert!(done.executed.iter().all(|taken| taken.steps == 0));
    assert!(results(out) == MADE.files);
}

fn of(bed: &BedSummary) -> &Rig {
    bed.rig.as_ref().unwrap()
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("rig"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings
        .set_description("recipe: `cargo test -p bitgrain-tests --release --test physics rig::`");
    settings.bind(|| insta::assert_snapshot!(name, text));
}

fn bed_lines(bed: &BedSummary) -> String {
    let rig = of(bed);
    format!(
        "{}: {} grains, {} of them base and {} lid, {} steps\n\
         \x20 surface {:.6e} m, depth {:.6e} m, packing {:.6}, contacts a grain {:.4}\n\
         \x20 kinetic energy {:.3e} m g d, carried {:.6} of {:.6e} N, {} gradient\n\
         \x20 lid density {:.6e} kg/m^3, effective depth {:.6} D, pressure {:.6e} Pa, reaction {:.4} buoyancies\n\
         \x20 state {}\n",
        bed.name,
        bed.grains,
        bed.frozen,
        rig.lid_grains,
        bed.steps,
        bed.surface,
        bed.depth,
        bed.packing_fraction,
        bed.coordination_number,
        bed.kinetic_energy_over_weight_d,
        bed.support / bed.weight,
        bed.weight,
        if rig.pressure_gradient {
            "with"
        } else {
            "without"
        },
        rig.lid_density,
        rig.effective_depth / rig.diameter,
        rig.pressure,
        rig.reaction_over_buoyancy,
        bed.digest,
    )
}

fn run_lines(run: &DragSummary) -> String {
    let flow = run.flow.as_ref().unwrap();
    format!(
        "{}: drag {:.6e} +- {:.1e} N, lift {:.6e} +- {:.1e} N, {:.4} contacts\n\
         \x20 C_d {:.5}, lift {:.5} buoyancies, effective depth {:.6} D, packing {:.6}\n\
         \x20 pressure {:.6e} Pa, measured {:.6e} Pa, far field {:.6}, slowest layer {:.6}\n\
         \x20 carried by base {:.6}, by lid {:.6}, by inertia {:.6}; {} floating\n\
         \x20 state {}\n",
        run.name,
        run.drag.mean,
        run.drag.standard_error,
        run.lift.mean,
        run.lift.standard_error,
        run.contacts.mean,
        flow.drag_coefficient,
        flow.lift_over_buoyancy,
        flow.effective_depth / run.diameter,
        flow.packing_fraction,
        flow.pressure,
        flow.pressure_measured,
        flow.far_field,
        flow.far_field_least,
        flow.carried_by_base,
        flow.carried_by_lid,
        flow.inertia,
        flow.floating,
        run.digest,
    )
}

/// The numbers to read, the first rows of what is written during the drags, and the hash of each file but the
/// report, whose looks may change while its numbers do not.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn the_rig_gives_its_goldens() {
    let made = &*MADE;
    let mut text: String = made.whole.beds.iter().map(bed_lines).collect();
    text.extend(made.whole.runs.iter().map(run_lines));
    snapshot("summary", &text);
    snapshot("flow", made.text("runs/bed-4-run-1/flow.csv"));
    let hashed = made.files.iter().filter(|(name, _)| *name != "report.html");
    let hashes = hashed.map(|(name, bytes)| format!("{}  {name}\n", blake3::hash(bytes).to_hex()));
    snapshot("files", &hashes.collect::<String>());
}

/// A rig three times: poured by two threads, by one, and with the beds of the first; the same bytes.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn threads_and_beds_at_hand_change_no_byte() {
    let quick = rig(&[
        "bed.box=[0.027, 0.0045, 0.021]",
        "bed.fill_height=0.012",
        "bed.settled=1e-2",
        "intruder.diameter=0.001",
        "intruder.height=0.006",
        "lid.effective_depth=0.03",
        "drag.distance=0.0045",
        "measure.every=20",
    ]);
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mut found = Vec::new();
    for (out, beds, threads, how) in [
        ("a", "beds", 2, "\"covered\""),
        ("b", "others", 1, "\"covered\""),
        ("c", "beds", 2, "\"reused\""),
    ] {
        run_into(&quick, &at(out), &at(beds), threads);
        let told = std::fs::read_to_string(at(out).join("performance.json")).unwrap();
        assert!(told.contains(how), "{told}");
        assert_eq!(told.contains("\"poured\""), out != "c", "{told}");
        found.push(results(&at(out)));
    }
    assert!(found[0].contains_key("runs/bed-2-run-1/flow.csv"));
    assert!(found[0] == found[1], "threads change no byte");
    assert!(found[0] == found[2], "a bed at hand changes no byte");
    let report = at("a").join("report.html");
    let before = std::fs::read(&report).unwrap();
    std::fs::remove_file(&report).unwrap();
    bitgrain::present::write_report(&bitgrain::folder::Folder(&at("a"))).unwrap();
    assert!(
        std::fs::read(&report).unwrap() == before,
        "written anew, it is the same"
    );
}

/// At rest, carried, and the cylinder's load steady, which is what a lift is measured against.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn beds_begin_at_rest() {
    let scenario = short();
    for (k, bed) in MADE.whole.beds.iter().enumerate() {
        let mut sim = MADE.bed(k);
        let energy = if of(bed).pressure_gradient {
            bed.kinetic_energy_over_weight_d
        } else {
            energy_of_borne(&mut sim, &scenario.measures())
        };
        assert!(energy < scenario.bed.settled, "{bed:?}");
        assert!((bed.support / bed.weight - 1.0).abs() < 5e-4, "{bed:?}");
        let begin = sim.obstacles[0].force[2];
        sim.steps(500).unwrap();
        let bulk = bed.packing_fraction * scenario.bed.density;
        let buoyancy = bulk * G * scenario.intruder_volume(of(bed).diameter);
        let change = (sim.obstacles[0].force[2] - begin).abs() / buoyancy;
        // Twice the change allowed between the two looks that find a bed at rest.
        assert!(change < 0.2, "{}: {change} buoyancies", bed.name);
        let (_, weight, support) = weight_and_support(&sim);
        assert!((support / weight - 1.0).abs() < 1e-3, "{}", bed.name);
    }
}

/// Base and lid carry the drag, except for the change of the bed's momentum. The rest is the kick of half
/// a step at either end of the window: a force like the drag, over the window's thousands of steps.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn base_and_lid_carry_the_drag_of_every_run() {
    assert_eq!(MADE.whole.runs.len(), 4);
    for run in &MADE.whole.runs {
        let flow = run.flow.as_ref().unwrap();
        let carried = flow.carried_by_base + flow.carried_by_lid;
        let missing = carried - 1.0 - flow.inertia;
        assert!(missing.abs() < 1e-3, "{}: {missing}", run.name);
        assert!((0.7..1.3).contains(&carried), "{}: {carried}", run.name);
    }
}

/// What lids of 60 and 210 times the grains' density add at a packing of 0.6 and D/d = 3.3: the paper's
/// `h~ = h + (pi d/6)(rho_lid/rho)` with the bulk density, to the digits that it is given with.
#[test]
fn lids_add_the_depth_of_the_paper() {
    let paper = scenario::load("guillard-2014", &[]).unwrap();
    let wide = paper.intruder.diameter.values()[0];
    assert!((wide / paper.mean_diameter() - 3.3).abs() < 1e-12);
    for (heavier, added) in [(60.0, 15.9), (210.0, 55.5)] {
        let depth = paper.lid_depth(heavier * paper.bed.density, 0.6 * paper.bed.density);
        assert!((depth / wide - added).abs() < 0.05, "{}", depth / wide);
    }
}

/// At the paper's size the box is its box, and the cylinder lies in the middle of the bed, 16 D from its floor and its
/// surface (section III A); the lid has room above.
#[test]
fn the_papers_cylinder_lies_in_the_middle() {
    let paper = scenario::load("guillard-2014", &[]).unwrap();
    let box_size = paper.bed.size.map(|length| length / paper.mean_diameter());
    for (length, grains) in box_size.iter().zip([140.0, 10.0, 120.0]) {
        assert!((length - grains).abs() < 1e-9, "{box_size:?}");
    }
    let wide = paper.intruder.diameter.values()[0];
    let surface = paper.expected_surface(wide);
    for plan in paper.beds() {
        for extent in [plan.center[2], surface - plan.center[2]] {
            // The number of grains is a whole one.
            assert!((extent / wide - 16.0).abs() < 1e-3, "{}", extent / wide);
        }
    }
}

/// Each lid gives the depth that is asked for; without a gradient only the lid presses, and the weight
/// above the axis is rho g h~ to rounding. With one, that weight is less by the surface's roughness:
/// h reaches to the highest grains, above which half a layer is missing.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn lids_press_as_planned() {
    let scenario = short();
    let [x, y, _] = scenario.bed.size;
    for (bed, plan) in MADE.whole.beds.iter().zip(scenario.beds()) {
        let rig = of(bed);
        let expected = rig.bulk_density * G * rig.effective_depth;
        let lid = rig.lid_grains as f64 * sphere_mass(D, rig.lid_density) * G / (x * y);
        let Some(lid_plan) = plan.lid else {
            assert_eq!(
                (rig.lid_grains, lid, rig.effective_depth),
                (0, 0.0, bed.depth)
            );
            continue;
        };
        assert_eq!(rig.lid_grains, 27 * 4);
        // The lid's density is chosen for the bare bed, which it then presses together a little.
        let asked = lid_plan.effective_depth.unwrap();
        assert!((rig.effective_depth / asked - 1.0).abs() < 0.01, "{rig:?}");
        let of_lid = rig.bulk_density * G * (PI * D / 6.0) * (rig.lid_density / rig.bulk_density);
        // Sums of a hundred weights, each to a few parts in 10^16.
        assert!((of_lid / lid - 1.0).abs() < 1e-13);
        let missing = expected - rig.pressure;
        if rig.pressure_gradient {
            let layer = rig.bulk_density * G * 0.5 * D;
            assert!(missing > 0.0 && missing < layer, "{missing} of {layer}");
        } else {
            assert!(missing.abs() < 1e-13 * expected, "{missing}");
        }
    }
    // None of that changes during the motion if the lid alone has weight.
    for run in &MADE.whole.runs {
        let flow = run.flow.as_ref().unwrap();
        let off = (flow.pressure_measured / flow.pressure - 1.0).abs();
        // With a gradient the bed loosens as it begins to move, and its surface rises.
        let most = if flow.pressure_gradient { 0.06 } else { 1e-13 };
        assert!(off < most, "{}: {off}", run.name);
    }
}

/// `--dry-run` prints Table I of the paper, with its values for grains of this size.
#[test]
fn a_dry_run_prints_the_papers_table() {
    let folder = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_bitgrain-under-test");
    let out = output(
        program,
        folder.path(),
        &["run", "guillard-2014", "--dry-run"],
    );
    assert!(out.status.success());
    let text = String::from_utf8(out.stdout).unwrap();
    let table = text
        .split("\n\n")
        .find(|part| part.starts_with("contact law"));
    snapshot("table-one", table.expect("a part of the forecast"));
}

/// A file that was damaged is named with its line, and what to do.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release, minutes in debug")]
fn a_damaged_flow_series_is_refused() {
    let folder = written(&MADE.files);
    let place = |name: &str| folder.path().join(name);
    let whole = Folder(folder.path());
    present::write_report(&whole).unwrap();
    assert!(std::fs::read(whole.report()).unwrap() == MADE.files["report.html"]);
    for file in ["flow.csv", "profile.csv"] {
        let name = format!("runs/bed-2-run-1/{file}");
        let text = MADE.text(&name);
        // In the middle of its last number but one.
        let cut = text.trim_end().rfind(',').unwrap() - 1;
        std::fs::write(place(&name), &text[..cut]).unwrap();
        let told = present::write_report(&whole).unwrap_err().to_string();
        assert!(told.contains(file) && told.contains("--resume"), "{told}");
        // Also if a manifest vouches for it.
        forge_manifest(whole.0, FolderKind::Run, &[]);
        let told = present::write_report(&whole).unwrap_err().to_string();
        let at = format!(
            "{file}:{}: is not a row of finite numbers",
            text.lines().count()
        );
        assert!(
            told.contains(&at) && told.contains("is the file cut off?"),
            "{told}"
        );
        std::fs::write(place(&name), text).unwrap();
        forge_manifest(whole.0, FolderKind::Run, &[]);
    }
}

/// What the manifest of a run vouches for.
fn vouched(out: &std::path::Path) -> Vouched {
    Vouched::open(out, FolderKind::Run).unwrap()
}
