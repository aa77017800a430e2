//! A whole experiment: scenario, beds, drags, summary, report. Each stage hands its result to the
//! next through files of the run directory, in a first run too.

use std::path::{Path, PathBuf};
use std::time::Instant;

use bitgrain_kernel::{BITS_VERSION, PARTS, Pushed};
use rayon::ThreadPoolBuilder;
use serde::Serialize;

use crate::bed::library::Library;
use crate::bed::recipe::Recipe;
use crate::blocks::METHOD;
use crate::drag::{Means, Record};
use crate::error::{Error, Result};
use crate::files::{check_writable, write_text, write_whole};
use crate::folder::Folder;
use crate::progress::{Progress, Stage};
use crate::report;
use crate::scenario::{BedPlan, RunPlan, Scenario};
use crate::series::series_text;
use crate::sim::{Sim, hex};
use crate::summary::{BedSummary, RunRecord, RunSummary, Summary};
use crate::{bed, checkpoint, drag, export, lammps, present};

/// Timings and other facts of the machine, kept apart from the results.
#[derive(Serialize)]
struct Performance {
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
/// `threads` threads; results do not depend on how many, nor on where a bed came from.
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
    let pool = ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| {
            Error::input(
                "--threads",
                format!("{threads} threads cannot be started: {e}"),
            )
        })?;
    let (plans, runs) = (scenario.beds(), scenario.runs());

    let beds = side_by_side(
        &pool,
        plans.len(),
        |k| plans[k].center[2] as u64,
        |k| settle_one(scenario, &plans[k], &folder, library, progress),
    );
    let beds: Vec<(BedSummary, StagePerformance)> = beds.into_iter().collect::<Result<_>>()?;
    let (beds, mut stages): (Vec<_>, Vec<_>) = beds.into_iter().unzip();

    let dragged = side_by_side(
        &pool,
        runs.len(),
        |k| runs[k].steps,
        |k| drag_one(scenario, &runs[k], &beds[runs[k].bed], &folder, progress),
    );
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
        threads,
        seconds: began.elapsed().as_secs_f64(),
        stages,
    };
    write_json(&folder.performance(), &performance)?;
    Ok(folder.report())
}

/// Does `count` jobs on the pool, the longest first, and returns their results in order.
fn side_by_side<T: Send>(
    pool: &rayon::ThreadPool,
    count: usize,
    length: impl Fn(usize) -> u64,
    job: impl Fn(usize) -> T + Sync,
) -> Vec<T> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&k| (u64::MAX - length(k), k));
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    let (job, slots) = (&job, results.iter_mut());
    let mut slots: Vec<Option<&mut Option<T>>> = slots.map(Some).collect();
    pool.scope_fifo(|scope| {
        for k in order {
            let slot = slots[k].take().expect("each job is given out once");
            scope.spawn_fifo(move |_| *slot = Some(job(k)));
        }
    });
    results
        .into_iter()
        .map(|r| r.expect("the scope waits for every job"))
        .collect()
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

/// A settled bed in the run directory: from the library, poured and kept there, or imported.
fn settle_one(
    scenario: &Scenario,
    plan: &BedPlan,
    folder: &Folder<'_>,
    library: &Library,
    progress: &Progress,
) -> Result<(BedSummary, StagePerformance)> {
    let name = format!("bed {}", plan.name);
    let mut stage = progress.stage(&name, bed::pouring_steps(scenario));
    let path = folder.bed(&plan.name);
    let from = fetch_bed(scenario, plan, &path, library, &mut stage)?;
    let mut sim = checkpoint::read(&path)?;
    let title = format!("{} of {}: atom_style sphere", plan.name, scenario.name);
    let data = lammps::data_text(&export::atoms(&sim, true), &title);
    write_text(&folder.bed_data(&plan.name), &data, scenario.measure.gzip)?;
    let steps = if from == "poured" {
        sim.step_count()
    } else {
        0
    };
    let performance = timed(stage, from, &sim, steps);
    let summary = bed::survey(&plan.name, &scenario.measures(), &mut sim);
    progress.line(&format!(
        "{}: {} grains {from} ({} steps, {:.1} s); surface at {}, depth {}, packing fraction {:.3}, \
         coordination number {:.2}, weight carried {:.4}",
        plan.name,
        summary.grains,
        summary.steps,
        performance.seconds,
        report::short(summary.surface),
        report::short(summary.depth),
        summary.packing_fraction,
        summary.coordination_number,
        summary.support / summary.weight,
    ));
    Ok((summary, performance))
}

/// Puts the checkpoint of a settled bed where the run wants it, and says where it came from.
fn fetch_bed(
    scenario: &Scenario,
    plan: &BedPlan,
    path: &Path,
    library: &Library,
    stage: &mut Stage,
) -> Result<&'static str> {
    if let Some(source) = &scenario.source {
        let mut sim = bed::import::bed(scenario, source)?;
        write_whole(path, &checkpoint::bytes(&mut sim, ""))?;
        return Ok("imported");
    }
    let recipe = Recipe::new(scenario, plan);
    if let Some(bytes) = library.find(&recipe)? {
        write_whole(path, &bytes)?;
        return Ok("reused");
    }
    // An earlier run may have poured it and then found no room in the library.
    let digest = recipe.digest();
    let here = std::fs::read(path).ok();
    let here = here.filter(|bytes| checkpoint::parse(bytes, "", Some(&digest)).is_ok());
    if let Some(bytes) = here {
        library.keep(&recipe, &bytes)?;
        return Ok("reused");
    }
    let mut sim = bed::pour(scenario, plan, stage)?;
    let bytes = checkpoint::bytes(&mut sim, &digest);
    // First where it is used: what was poured for days is not lost for want of a library.
    write_whole(path, &bytes)?;
    library.keep(&recipe, &bytes)?;
    Ok("poured")
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
    let performance = timed(stage, "dragged", &sim, plan.steps);
    let summary = summarise(scenario, plan, bed, &means, &mut sim);
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
    let title = format!("{run}, step {step}");
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

fn summarise(
    scenario: &Scenario,
    plan: &RunPlan,
    bed: &BedSummary,
    means: &Means,
    sim: &mut Sim,
) -> RunSummary {
    let digest = sim.digest();
    let [x, y, _] = scenario.bed.size;
    let diameter = scenario.intruder.diameter;
    let weight = bed.packing_fraction * scenario.bed.density * scenario.gravity;
    let above = weight * (x * y) * (bed.depth + 0.5 * diameter);
    RunSummary {
        name: plan.name.clone(),
        bed: bed.name.clone(),
        froude: plan.froude,
        speed: plan.speed,
        diameter,
        depth: bed.depth,
        distance: plan.distance,
        steps: plan.steps,
        window_start: plan.discard,
        window_end: plan.distance,
        window_steps: means.window_steps,
        drag: means.drag,
        lift: means.lift,
        side: means.side,
        contacts: means.contacts,
        contact_angle: means.contact_angle,
        coordination: means.coordination,
        drag_uncut: means.drag_uncut,
        plug_ratio: means.drag.mean / above,
        digest: hex(&digest.whole),
        digest_parts: PARTS
            .iter()
            .zip(digest.parts())
            .map(|(name, part)| (name.to_string(), hex(part)))
            .collect(),
    }
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
