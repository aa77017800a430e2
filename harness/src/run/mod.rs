//! A whole experiment: scenario, beds, drags, summary, report. Each stage hands its result to the
//! next through files of the run directory, in a first run too.

mod beds;
mod jobs;
mod summarise;

pub use beds::bare_beds;

use std::path::{Path, PathBuf};
use std::time::Instant;

use bitgrain_kernel::{BITS_VERSION, Pushed};
use serde::Serialize;

use crate::bed::library::Library;
use crate::blocks::METHOD;
use crate::coefficients::table_text;
use crate::drag::Record;
use crate::error::{Error, Result};
use crate::files::{bits, check_writable, write_text, write_whole};
use crate::folder::Folder;
use crate::progress::{Progress, Stage};
use crate::report;
use crate::scenario::{BedPlan, RunPlan, Scenario, UnitSystem};
use crate::series::series_text;
use crate::sim::Sim;
use crate::summary::{BedSummary, RunRecord, RunSummary, Summary};
use crate::{checkpoint, drag, export, flow, lammps, present};
use beds::{pour_bare, settle_one};
use jobs::side_by_side;
use summarise::summarise;

/// Timings and other facts of the machine, kept apart from the results.
#[derive(Serialize)]
struct Performance {
    bits_version: u32,
    threads: usize,
    seconds: f64,
    stages: Vec<StagePerformance>,
}

#[derive(Serialize)]
struct StagePerformance {
    stage: String,
    /// What was done: poured, reused, imported, dragged.
    how: String,
    seconds: f64,
    steps: u64,
    grain_steps_per_s: f64,
    searches: u64,
    pairs_listed: usize,
}

/// Runs a scenario into the folder `out` and returns the path of its report.
///
/// Beds come from `library` or are poured and kept there, side by side and then the drags, on
/// `threads` threads, several for each where there are fewer of them; results do not depend on how
/// many, nor on where a bed came from.
///
/// # Errors
/// The first stage that went wrong, in the order of the scenario; what the others wrote stays.
pub fn run(
    scenario: &Scenario,
    out: &Path,
    library: &Library,
    threads: usize,
    progress: &Progress,
) -> Result<PathBuf> {
    let began = Instant::now();
    let folder = Folder(out);
    let _claimed = folder.claim(scenario)?;
    if scenario.source.is_none() {
        // Found out now rather than after days of pouring.
        check_writable(library.folder())?;
    }
    let si = scenario.units == UnitSystem::Si;
    let (d, density) = (scenario.mean_diameter(), scenario.bed.density);
    if let Some(table) = table_text(&scenario.law, d, density, si) {
        progress.line(table.trim_end());
    }
    progress.line(&scenario.time_step_line());
    let (plans, runs) = (scenario.beds(), scenario.runs());
    let height = |plan: &BedPlan| plan.center[2] as u64;

    // What lies below lids first: several lids lie on one bed.
    let mut bare = bare_beds(scenario);
    if plans.iter().all(|plan| plan.lid.is_none()) {
        bare.clear();
    }
    let poured = side_by_side(
        threads,
        bare.len(),
        |k| height(&bare[k]),
        |k| pour_bare(scenario, &bare[k], &folder, library, progress),
    )?;
    let mut stages: Vec<StagePerformance> = poured.into_iter().collect::<Result<_>>()?;

    let beds = side_by_side(
        threads,
        plans.len(),
        |k| height(&plans[k]),
        |k| settle_one(scenario, &plans[k], &folder, library, progress),
    )?;
    let beds: Vec<(BedSummary, StagePerformance)> = beds.into_iter().collect::<Result<_>>()?;
    let (beds, timed): (Vec<_>, Vec<_>) = beds.into_iter().unzip();
    stages.extend(timed);

    let dragged = side_by_side(
        threads,
        runs.len(),
        |k| runs[k].steps,
        |k| drag_one(scenario, &runs[k], &beds[runs[k].bed], &folder, progress),
    )?;
    let dragged: Vec<(RunSummary, StagePerformance)> =
        dragged.into_iter().collect::<Result<_>>()?;
    let (runs, timed): (Vec<_>, Vec<_>) = dragged.into_iter().unzip();
    stages.extend(timed);

    let whole = Summary {
        version: env!("CARGO_PKG_VERSION").into(),
        bits_version: BITS_VERSION,
        scenario: scenario.name.clone(),
        units: scenario.units(),
        inputs: folder.inputs(scenario),
        standard_error_method: METHOD.into(),
        beds,
        runs,
    };
    write_json(&folder.summary(), &whole)?;
    present::write_report(&folder)?;
    let performance = Performance {
        bits_version: BITS_VERSION,
        threads,
        seconds: began.elapsed().as_secs_f64(),
        stages,
    };
    write_json(&folder.performance(), &performance)?;
    Ok(folder.report())
}

fn timed(stage: Stage, how: &str, sim: &Sim, steps: u64) -> StagePerformance {
    let (name, seconds) = (stage.name().to_string(), stage.finish());
    let (searches, pairs_listed, _) = sim.search_counts();
    StagePerformance {
        stage: name,
        how: how.to_string(),
        seconds,
        steps,
        grain_steps_per_s: steps as f64 * sim.count() as f64 / seconds,
        searches,
        pairs_listed,
    }
}

fn drag_one(
    scenario: &Scenario,
    plan: &RunPlan,
    bed: &BedSummary,
    folder: &Folder<'_>,
    progress: &Progress,
) -> Result<(RunSummary, StagePerformance)> {
    let stage = progress.stage(&format!("{} Fr {:.2}", plan.name, plan.froude), plan.steps);
    let mut sim = checkpoint::read(&folder.bed(&bed.name))?;
    let mut record = Record::default();
    let snapshot = |step, sim: &Sim, contacts: &[Pushed<f64>]| {
        write_snapshot(folder, scenario, &plan.name, step, sim, contacts)
    };
    let measured = drag::drag(&mut sim, scenario, plan, &stage, &mut record, snapshot);
    let text = series_text(&scenario.units(), &scenario.measure, &record.series);
    let partial = folder.partial_series(&plan.name);
    let means = measured.inspect_err(|_| {
        // Whatever was measured is kept, beside what an earlier run may have finished; why the drag
        // stopped is what must be told.
        let _ = write_whole(&partial, text.as_bytes());
    })?;
    write_whole(&folder.series(&plan.name), text.as_bytes())?;
    let _ = std::fs::remove_file(&partial);
    let write =
        |file: &str, text: String| write_whole(&folder.of_run(&plan.name, file), text.as_bytes());
    write("angles.csv", record.angles.text())?;
    write("coordination.csv", record.coordination.text())?;
    if let Some(gauge) = &record.flow {
        let rows = flow::flow_text(&scenario.units(), &gauge.rows);
        write("flow.csv", rows)?;
        write("profile.csv", gauge.profile.text())?;
    }
    let performance = timed(stage, "dragged", &sim, plan.steps);
    let summary = summarise(scenario, plan, bed, &means, &record, &mut sim);
    let whole = RunRecord {
        version: env!("CARGO_PKG_VERSION").into(),
        bits_version: BITS_VERSION,
        units: scenario.units(),
        inputs: folder.inputs(scenario),
        standard_error_method: METHOD.into(),
        bed: bed.clone(),
        run: summary.clone(),
    };
    write_json(&folder.of_run(&plan.name, "summary.json"), &whole)?;
    progress.line(&format!(
        "{}: Fr {}, drag {} +- {} {} ({:.1} s)",
        plan.name,
        report::short(plan.froude),
        report::short(summary.drag.mean),
        report::short(summary.drag.standard_error),
        scenario.units().force,
        performance.seconds
    ));
    if let Some(flow) = &summary.flow {
        progress.line(&format!(
            "{}: drag/(rho g h D L) {:.2} +- {:.2}, lift {:.1} +- {:.1} buoyancies, far bed at {:.3} of \
             the speed",
            plan.name,
            flow.drag_coefficient,
            flow.drag_coefficient_error,
            flow.lift_over_buoyancy,
            flow.lift_over_buoyancy_error,
            flow.far_field
        ));
    }
    Ok((summary, performance))
}

/// A state as a LAMMPS dump for OVITO, and as two VTK files, grains and contacts, for ParaView.
fn write_snapshot(
    folder: &Folder<'_>,
    scenario: &Scenario,
    run: &str,
    step: u64,
    sim: &Sim,
    contacts: &[Pushed<f64>],
) -> Result<()> {
    let (mut frame, forces) = export::frame(sim);
    frame.step = step;
    let title = format!("{run}, step {step}; {}", bits());
    let dump = folder.snapshot(run, "grains", step, "dump");
    let text = lammps::dump_text(&frame, Some(&forces));
    write_text(&dump, &text, scenario.measure.gzip)?;
    let write = |kind, ending, text: String| {
        write_whole(&folder.snapshot(run, kind, step, ending), text.as_bytes())
    };
    write("grains", "vtk", export::vtk_grains(sim, &title))?;
    write(
        "contacts",
        "vtk",
        export::vtk_contacts(sim, contacts, &title),
    )
}

/// Writes a value as JSON; a number that is not finite, which JSON would turn into null, is refused.
fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    let tree =
        serde_json::to_value(value).map_err(|e| Error::write(path, std::io::Error::other(e)))?;
    if has_null(&tree) {
        let problem = std::io::Error::other("a number in it is not finite");
        return Err(Error::write(path, problem));
    }
    let mut text = serde_json::to_string_pretty(value)
        .map_err(|e| Error::write(path, std::io::Error::other(e)))?;
    text.push('\n');
    write_whole(path, text.as_bytes())
}

fn has_null(tree: &serde_json::Value) -> bool {
    match tree {
        serde_json::Value::Null => true,
        serde_json::Value::Array(list) => list.iter().any(has_null),
        serde_json::Value::Object(map) => map.values().any(has_null),
        _ => false,
    }
}
