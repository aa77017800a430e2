//! A whole experiment: scenario, beds, drags, summary, report. Each stage hands its result to the
//! next through files of the run directory, in a first run too.

use std::path::{Path, PathBuf};
use std::time::Instant;

use bitgrain_kernel::{BITS_VERSION, PARTS};
use rayon::ThreadPoolBuilder;
use serde::Serialize;

use crate::error::{Error, Result};
use crate::files::{make_folder, write_whole};
use crate::observe::{self, INTRUDER};
use crate::progress::{Progress, Stage};
use crate::report::{self, BedPicture, PictureGrain};
use crate::scenario::{BedPlan, RunPlan, Scenario};
use crate::series::{SeriesRow, read_series, series_text};
use crate::sim::{Sim, hex};
use crate::summary::{BedSummary, RunSummary, Summary};
use crate::{bed, checkpoint, drag, summary};

/// Where everything of a run directory is.
struct Folder<'a>(&'a Path);

impl Folder<'_> {
    fn scenario(&self) -> PathBuf {
        self.0.join("scenario.toml")
    }
    fn bed(&self, bed: &str) -> PathBuf {
        self.0.join("beds").join(format!("{bed}.safetensors"))
    }
    fn series(&self, run: &str) -> PathBuf {
        self.0.join("runs").join(format!("{run}.csv"))
    }
    fn summary(&self) -> PathBuf {
        self.0.join("summary.json")
    }
    fn report(&self) -> PathBuf {
        self.0.join("report.html")
    }
    fn performance(&self) -> PathBuf {
        self.0.join("performance.json")
    }
}

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
    seconds: f64,
    steps: u64,
    grain_steps_per_s: f64,
    searches: u64,
    pairs_listed: usize,
}

/// Runs a scenario into the folder `out` and returns the path of its report.
///
/// Beds are poured side by side and then drags, on `threads` threads; results do not depend on how
/// many.
///
/// # Errors
/// The first stage that went wrong, in the order of the scenario; what the others wrote stays.
pub fn run(
    scenario: &Scenario,
    out: &Path,
    threads: usize,
    progress: &Progress,
) -> Result<PathBuf> {
    let began = Instant::now();
    let folder = Folder(out);
    claim(&folder, scenario)?;
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
        |k| pour_one(scenario, &plans[k], &folder, progress),
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
        beds,
        runs,
    };
    write_json(&folder.summary(), &whole)?;
    write_report(&folder)?;
    let performance = Performance {
        threads,
        seconds: began.elapsed().as_secs_f64(),
        stages,
    };
    write_json(&folder.performance(), &performance)?;
    Ok(folder.report())
}

/// Takes a folder for this scenario: a new one, or one that holds the same scenario.
fn claim(folder: &Folder<'_>, scenario: &Scenario) -> Result<()> {
    let (path, text) = (folder.scenario(), scenario.to_toml());
    match std::fs::read_to_string(&path) {
        Ok(old) if old != text => Err(Error::input(
            folder.0.display().to_string(),
            "holds the results of another scenario (its scenario.toml differs); choose another \
             --out or remove the folder",
        )),
        Ok(_) => Ok(()),
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
            make_folder(folder.0)?;
            write_whole(&path, text.as_bytes())
        }
        Err(e) => Err(Error::write(&path, e)),
    }
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

fn timed(stage: Stage, sim: &Sim, steps: u64) -> StagePerformance {
    let (name, seconds) = (stage.name().to_string(), stage.finish());
    let (searches, pairs_listed, _) = sim.search_counts();
    StagePerformance {
        stage: name,
        seconds,
        steps,
        grain_steps_per_s: steps as f64 * sim.count() as f64 / seconds,
        searches,
        pairs_listed,
    }
}

fn pour_one(
    scenario: &Scenario,
    plan: &BedPlan,
    folder: &Folder<'_>,
    progress: &Progress,
) -> Result<(BedSummary, StagePerformance)> {
    let fall = (4.0 * scenario.expected_surface() / scenario.gravity).sqrt();
    let mut stage = progress.stage(
        &format!("pouring {}", plan.name),
        (2.0 * fall / scenario.drag.dt) as u64,
    );
    let mut sim = bed::pour(scenario, plan, &mut stage)?;
    checkpoint::write(&folder.bed(&plan.name), &mut sim)?;
    let performance = timed(stage, &sim, sim.step_count());
    let summary = survey(scenario, plan, checkpoint::read(&folder.bed(&plan.name))?);
    progress.line(&format!(
        "{}: {} grains settled in {} steps ({:.1} s); surface at {}, depth {}, packing \
         fraction {:.3}",
        plan.name,
        summary.grains,
        summary.steps,
        performance.seconds,
        report::short(summary.surface),
        report::short(summary.depth),
        summary.packing_fraction
    ));
    Ok((summary, performance))
}

/// Reads off a settled bed what its summary says.
fn survey(scenario: &Scenario, plan: &BedPlan, mut sim: Sim) -> BedSummary {
    let d = scenario.mean_diameter();
    let surface = observe::surface_height(&sim, d);
    let intruder = (plan.center, 0.5 * scenario.intruder.diameter);
    let (free, weight, support) = observe::weight_and_support(&sim, scenario.gravity);
    BedSummary {
        name: plan.name.clone(),
        grains: sim.count(),
        frozen: sim.count() - free,
        steps: sim.step_count(),
        surface,
        depth: surface - plan.center[2],
        packing_fraction: observe::packing_fraction(&sim, d, surface - 2.0 * d, intruder),
        coordination_number: observe::coordination_number(&mut sim, surface - 2.0 * d),
        overlap_max: observe::deepest_overlap(&mut sim) / d,
        kinetic_energy_per_grain: bed::energy_per_grain(&sim, scenario),
        weight,
        support,
        digest: hex(&sim.digest().whole),
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
    let mut series: Vec<SeriesRow> = Vec::new();
    let measured = drag::drag(&mut sim, plan, scenario.measure.every, &stage, &mut series);
    // Whatever was measured is kept, also of a run that went wrong.
    let text = series_text(&scenario.units(), &scenario.measure, &series);
    write_whole(&folder.series(&plan.name), text.as_bytes())?;
    let means = measured?;
    let performance = timed(stage, &sim, plan.steps);
    let digest = sim.digest();
    let [x, y, _] = scenario.bed.size;
    let diameter = scenario.intruder.diameter;
    let summary = RunSummary {
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
        drag_uncut: means.drag_uncut,
        plug_ratio: means.drag.mean
            / (bed.packing_fraction
                * scenario.bed.density
                * scenario.gravity
                * (x * y)
                * (bed.depth + 0.5 * diameter)),
        digest: hex(&digest.whole),
        digest_parts: PARTS
            .iter()
            .zip(digest.parts())
            .map(|(name, part)| (name.to_string(), hex(part)))
            .collect(),
    };
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

/// Writes the report of a run directory from the files in it.
fn write_report(folder: &Folder<'_>) -> Result<()> {
    let whole = summary::read_summary(&folder.summary())?;
    let text = std::fs::read_to_string(folder.scenario())
        .map_err(|e| Error::read(&folder.scenario(), &e))?;
    let series = whole
        .runs
        .iter()
        .map(|run| read_series(&folder.series(&run.name)));
    let series: Vec<Vec<SeriesRow>> = series.collect::<Result<_>>()?;
    let pictures = whole
        .beds
        .iter()
        .map(|bed| picture(bed, &folder.bed(&bed.name)));
    let pictures: Vec<BedPicture> = pictures.collect::<Result<_>>()?;
    let page = report::page(&whole, &text, &series, &pictures);
    write_whole(&folder.report(), page.as_bytes())
}

fn picture(bed: &BedSummary, path: &Path) -> Result<BedPicture> {
    let sim = checkpoint::read(path)?;
    let body = &sim.obstacles[INTRUDER as usize];
    let grain = |i: usize| PictureGrain {
        position: [sim.position[i][0], sim.position[i][1], sim.position[i][2]],
        radius: sim.position[i][3],
        frozen: sim.group[i] == bed::FROZEN,
    };
    Ok(BedPicture {
        name: bed.name.clone(),
        // The floor of the bed; the box goes on below it so that a leak is seen.
        lo: [sim.domain.lo()[0], sim.domain.lo()[1], 0.0],
        hi: sim.domain.hi(),
        surface: bed.surface,
        grains: (0..sim.count()).map(grain).collect(),
        intruder: (body.point, body.reach()),
    })
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
