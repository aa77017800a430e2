//! The drags of `guillard-medium`, a quarter of an hour of a core each: what is kept of them belongs together, a
//! piece of one is done again, and their fields keep what grains keep.
//!
//! `golden/README.md` says how the files are made.

use std::collections::{BTreeMap, BTreeSet};

use bitgrain::checkpoint::{self, Note};
use bitgrain::drag::Dragging;
use bitgrain::error::Result;
use bitgrain::fields::text::load_text;
use bitgrain::folder::Folder;
use bitgrain::progress::Stage;
use bitgrain::scenario::{self, Scenario};
use bitgrain::sim::{Sim, hex};
use bitgrain::summary::{RunSummary, Summary, read_folder};
use bitgrain::witness::Witness;
use bitgrain_tests::{golden, unpacked};
use sha2::{Digest, Sha256};

/// Steps between the links that are kept of a chain.
const LINKS: u64 = 5_000;

/// The drag of which a piece is done again, by the state it begins with: just before the window of the means.
const PIECE: (&str, &str) = ("bed-9-run-1", "bed-9-run-1.safetensors.gz");

/// Fields that are kept: of the first seed, at each effective depth, with a pressure gradient and without.
const FIELDS: [&str; 8] = [
    "bed-1-run-1.csv.gz",
    "bed-5-run-1.csv.gz",
    "bed-9-run-1.csv.gz",
    "bed-13-run-1.csv.gz",
    "bed-17-run-1.csv.gz",
    "bed-21-run-1.csv.gz",
    "bed-25-run-1.csv.gz",
    "bed-29-run-1.csv.gz",
];

fn shipped() -> Scenario {
    scenario::load("guillard-medium", &[]).unwrap()
}

fn whole() -> Summary {
    read_folder(&Folder(&golden("guillard-medium"))).unwrap().1
}

fn text(name: &str) -> String {
    String::from_utf8(unpacked(&format!("guillard-medium/{name}"))).unwrap()
}

/// Links by drag and step.
fn links() -> BTreeMap<(String, u64), String> {
    let text = text("links.csv.gz");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let [run, step, link] = cells[..] else {
            panic!("{line}");
        };
        ((run.to_string(), step.parse().unwrap()), link.to_string())
    };
    text.lines().map(row).collect()
}

/// Every drag is one of the scenario as it is shipped, and has all its links, of which its summary names the last.
#[test]
fn drags_are_those_of_the_shipped_scenario() {
    let (shipped, whole, links) = (shipped(), whole(), links());
    assert_eq!(whole.inputs, shipped);
    let plans = shipped.runs();
    for run in &whole.runs {
        let plan = plans.iter().find(|plan| plan.name == run.name).unwrap();
        assert_eq!((run.speed, run.steps), (plan.speed, plan.steps));
        for step in (0..=run.steps).step_by(LINKS as usize) {
            assert_eq!(links[&(run.name.clone(), step)].len(), 64);
        }
        assert_eq!(links[&(run.name.clone(), run.steps)], run.chain);
        assert_eq!(run.digest.len(), 64);
    }
    let steps: u64 = whole.runs.iter().map(|run| run.steps / LINKS + 1).sum();
    assert_eq!(links.len() as u64, steps);
}

/// Of every file of every drag there is a hash; that of the load is the one of the load in the summary.
#[test]
fn files_have_hashes() {
    let text = text("files.sha256");
    let row = |line: &str| {
        let (hash, name) = line.split_once("  ").unwrap();
        (name.to_string(), hash.to_string())
    };
    let mut hashes: BTreeMap<String, String> = text.lines().map(row).collect();
    let whole = whole();
    let mut take = |name: &str| hashes.remove(name).unwrap_or_else(|| panic!("{name}"));
    for run in &whole.runs {
        let load = run.flow.as_ref().unwrap().load.as_ref().unwrap();
        let load = load_text(load, &whole.units);
        let own = Sha256::digest(load.as_bytes());
        let of = |file: &str| format!("runs/{}/{file}", run.name);
        assert_eq!(take(&of("load.csv")), hex(&own), "{}", run.name);
        for file in [
            "angles.csv",
            "chain.csv",
            "coordination.csv",
            "fields.vti",
            "flow.csv",
            "forces.csv",
            "plane.csv",
            "profile.csv",
        ] {
            assert_eq!(take(&of(file)).len(), 64);
        }
    }
    let beds: BTreeSet<&str> = whole.runs.iter().map(|run| &run.bed[..]).collect();
    for bed in beds {
        assert_eq!(take(&format!("beds/{bed}.chain.csv")).len(), 64);
    }
    assert!(hashes.is_empty(), "{hashes:?}");
}

/// Goes no further than to this step.
struct Until(u64);

impl Witness for Until {
    fn pause(&mut self, _: u64, _: &mut Sim, _: &dyn Fn() -> Note) -> Result<()> {
        Ok(())
    }

    fn ends(&self) -> u64 {
        self.0
    }
}

/// From a state just before the window of the means a drag goes on to the same links, and sums its fields to the
/// same bits as when it was first done.
#[test]
#[cfg_attr(debug_assertions, ignore = "ten seconds in release")]
fn a_piece_done_again_gives_the_same_links_and_sums() {
    let (scenario, links) = (shipped(), links());
    let plan = scenario
        .runs()
        .into_iter()
        .find(|plan| plan.name == PIECE.0);
    let plan = plan.unwrap();
    let state = unpacked(&format!("guillard-medium/{}", PIECE.1));
    let (mut sim, note) = checkpoint::unpack(&state, PIECE.1).unwrap();
    let mut dragging = Dragging::of(&note).unwrap();
    assert_eq!(dragging.key, scenario.key(&plan.name));
    assert_eq!(dragging.fields.as_ref().unwrap().samples(), 0);
    let end = (dragging.step / LINKS + 1) * LINKS;
    dragging
        .go_on(
            &mut sim,
            &scenario,
            &plan,
            &Stage::silent(),
            &mut Until(end),
        )
        .unwrap();
    assert_eq!(dragging.chain.end(), links[&(plan.name, end)]);
    let fields = dragging.fields.unwrap();
    let said = format!(
        "step {end}\nlink {}\nsamples {}\nsums {}\n",
        dragging.chain.end(),
        fields.samples(),
        blake3::hash(&fields.array())
    );
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("guillard-medium"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("piece", said));
}

/// Of a point of the plane: where it is, packing fraction and velocity along x; none where nothing is known.
type Row = ([f64; 2], Option<[f64; 2]>);

fn plane(file: &str) -> Vec<Row> {
    let text = text(&format!("fields/{file}"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let real = |k: usize| cells[k].parse::<f64>().unwrap();
        let known = (cells[2] != "2").then(|| [real(3), real(4)]);
        ([real(0), real(1)], known)
    };
    text.lines().skip(1).map(row).collect()
}

/// Grains that come in go out: through every plane across the flow passes the same volume, to the half per cent by
/// which the bed is heaped up while it flows. Far from the cylinder it goes at the speed that displacements give;
/// base and lid, which go at that of the motion, make up to half a per cent of difference.
#[test]
fn fields_keep_the_grains() {
    let (scenario, whole) = (shipped(), whole());
    let [nx, _, nz] = scenario.measure.fields.as_ref().unwrap().grid;
    for file in FIELDS {
        let run = whole.runs.iter().find(|run| file.starts_with(&run.name));
        let run: &RunSummary = run.unwrap();
        let rows = plane(file);
        assert_eq!(rows.len(), nx * nz);
        let sum = |kx: usize, of: fn([f64; 2]) -> f64| -> f64 {
            let column = (0..nz).filter_map(|kz| rows[kz * nx + kx].1);
            column.map(of).sum()
        };
        let flux = |kx: usize| sum(kx, |[solid, speed]| solid * speed);
        let mean = (0..nx).map(flux).sum::<f64>() / nx as f64;
        for kx in 0..nx {
            let off = flux(kx) / mean - 1.0;
            assert!(off.abs() < 0.01, "{file}: x = {}: {off}", rows[kx].0[0]);
        }
        let edge = || (0..nx).filter(|kx| rows[*kx].0[0].abs() > 0.4 * scenario.bed.size[0]);
        let solid: f64 = edge().map(|kx| sum(kx, |[solid, _]| solid)).sum();
        let far = edge().map(flux).sum::<f64>() / solid / run.speed;
        let measured = run.flow.as_ref().unwrap().far_field;
        assert!(
            (far / measured - 1.0).abs() < 0.01,
            "{file}: {far} and {measured}"
        );
    }
}
