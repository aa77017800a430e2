//! The names of all files that a run of a scenario writes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::beside::{ANALYSIS, PERFORMANCE, REPORT};
use crate::folder::{FAILURE, Folder};
use crate::manifest::{self, FolderKind, Planned, When, relative};
use crate::scenario::{CheckedScenario, DragPlan, IntruderShape};
use bitgrain_sim::files::packed_name;

/// What the folder of a run of this scenario is to hold.
pub fn planned(scenario: &CheckedScenario) -> Planned {
    Planned {
        of: FolderKind::Run,
        stages: stages(scenario),
        files: names(scenario),
    }
}

/// Names of the stages of a run, in order.
pub fn stages(scenario: &CheckedScenario) -> Vec<String> {
    let beds = scenario.all_beds().into_iter().map(|bed| &bed.name);
    let drags = scenario.drags().iter().map(|drag| &drag.name);
    beds.chain(drags).cloned().collect()
}

/// Every file that a run of this scenario may write, by its path from the run directory on, and when it is there.
/// Half files (`.bitgrain-partial`), the scripts below `slurm/` and `difference.json` are not among them.
pub fn names(scenario: &CheckedScenario) -> BTreeMap<String, When> {
    let folder = Folder(Path::new(""));
    let mut names = BTreeMap::new();
    let mut add = |path: PathBuf, when: When| {
        let name = relative(folder.0, &path).expect("names of files of a run are text");
        names.insert(name, when);
    };
    add(folder.scenario(), When::Always);
    add(folder.summary(), When::Whole);
    for beside in [manifest::NAME, PERFORMANCE, REPORT, ANALYSIS] {
        add(beside.into(), When::Beside);
    }
    if let (Some(_), Some(file)) = (&scenario.source, &folder.inputs(scenario).bed.file) {
        add(file.into(), When::Always);
    }
    for bed in scenario.all_beds() {
        let ended = || When::Finished(bed.name.clone());
        add(folder.bed(&bed.name), ended());
        add(folder.bed_chain(&bed.name), ended());
        add(folder.pouring(&bed.name), When::Beside);
        // Not of one that only lies below lids, and of one that does as well not before a drag goes through it.
        if scenario.beds().contains(bed) {
            let data = folder.bed_data(&bed.name);
            add(packed_if(data, scenario.measure.gzip), When::Whole);
        }
    }
    let beds = scenario.all_beds().into_iter();
    let beds = beds.map(|bed| bed.name.clone()).collect();
    add(FAILURE.into(), When::Unfinished(beds));
    for plan in scenario.drags() {
        let run = &plan.name[..];
        let ended = || When::Finished(run.into());
        for table in tables(scenario, plan) {
            add(folder.of_run(run, table), ended());
        }
        add(folder.of_run(run, "summary.json"), ended());
        if has_load(scenario, plan) {
            add(folder.of_run(run, LOAD), When::Perhaps);
        }
        for path in plan
            .snapshots
            .iter()
            .flat_map(|&n| snapshot(&folder, scenario, plan, n))
        {
            add(path, ended());
        }
        let mut before = 0;
        for &step in &plan.checkpoints {
            add(folder.checkpoint(run, step), ended());
            // For viewing only, and not all runs have them.
            if plan.frames.iter().any(|n| (before + 1..=step).contains(n)) {
                add(folder.frames(run, step), When::Perhaps);
            }
            before = step;
        }
        for unfinished in [folder.partial_series(run), folder.of_run(run, FAILURE)] {
            add(unfinished, When::Unfinished(vec![run.into()]));
        }
        add(folder.latest(run), When::Beside);
    }
    names
}

/// The stress on a cylinder: of a drag whose fields have a sample on every part of it.
pub(crate) const LOAD: &str = "load.csv";

fn has_load(scenario: &CheckedScenario, plan: &DragPlan) -> bool {
    plan.fields.is_some() && scenario.intruder.shape == IntruderShape::Cylinder
}

/// The tables of a finished drag, but for [`LOAD`].
fn tables(scenario: &CheckedScenario, plan: &DragPlan) -> Vec<&'static str> {
    let mut tables = vec!["forces.csv", "angles.csv", "coordination.csv", "chain.csv"];
    for (has, more) in [
        (scenario.measure.energy, &["energy.csv"][..]),
        (plan.flows, &["flow.csv", "profile.csv"]),
        (plan.half_turn.is_some(), &["bar.csv", "velocity.csv"]),
        (plan.fields.is_some(), &["fields.vti", "plane.csv"]),
    ] {
        tables.extend(more.iter().filter(|_| has));
    }
    tables
}

/// The files of a snapshot: grains twice, contacts, and the bodies of a tank.
pub(super) fn snapshot(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
    plan: &DragPlan,
    step: u64,
) -> Vec<PathBuf> {
    let path = |kind, ending| folder.snapshot(&plan.name, kind, step, ending);
    let mut files = vec![
        packed_if(path("grains", "dump"), scenario.measure.gzip),
        path("grains", "vtk"),
        path("contacts", "vtk"),
    ];
    if shows_bodies(plan) {
        files.push(path("bodies", "vtk"));
    }
    files
}

/// Whether a snapshot shows bodies: bar and tank.
pub(super) fn shows_bodies(plan: &DragPlan) -> bool {
    plan.half_turn.is_some()
}

fn packed_if(path: PathBuf, packed: bool) -> PathBuf {
    if packed { packed_name(&path) } else { path }
}
