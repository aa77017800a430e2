//! A whole experiment: scenario, beds, drags, summary, report. Each stage hands its result to the
//! next through files of the run directory, in a first run too.

mod beds;
mod claim;
mod drags;
mod files;
mod film;
mod jobs;
mod saving;
mod setting;
mod summarise;
mod taken;
mod task;
mod told;

use crate::json::json_text;
pub use beds::{begin_bed, data_file, surveyed};
pub use claim::claim;
pub(crate) use claim::{refuse_foreign_names, refuse_other_kinds, try_claim};
pub use drags::{begin, read, record, results};
pub(crate) use files::LOAD;
pub use files::{names, planned, stages};
pub(crate) use jobs::side_by_side;
pub use saving::SaveEvery;
pub use setting::{Setting, WriteReport};
pub use taken::{Links, Taken};
pub use task::DragTask;

use std::path::PathBuf;
use std::time::Instant;

use bitgrain_kernel::BITS_VERSION;

use crate::bed::recipe::Recipe;
use crate::beside::write_beside;
use crate::folder::{DirectoryLock, Folder, refuse_library};
use crate::manifest::{FolderKind, Ledger};
use crate::performance::{Performance, StagePerformance};
use crate::progress::Progress;
use crate::scenario::{BedPlan, CheckedScenario, DragPlan, UnitSystem};
use crate::summary::{BedSummary, DragSummary, Summary};
use beds::{below, pour_bare, settle_one};
use bitgrain_sim::block_averaging::METHOD;
use bitgrain_sim::coefficients::table_text;
use bitgrain_sim::error::{Error, Result};
use drags::drag_one;

/// The outcome of a run whose drags are all done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Done {
    /// Its report.
    pub report: PathBuf,
    /// Its stages, and what was done for each.
    pub executed: Vec<Taken>,
}

/// Runs a scenario into its folder, or what is left of it, and says where its report is; `None` if only some of
/// its drags were wanted, and summary and report are left to the others.
///
/// Beds come from the library or are poured and kept there, side by side and then the drags, on so many
/// threads, several for each if there are fewer of them. Each goes on from where it was saved.
/// Results depend on none of this.
///
/// # Errors
/// The first stage that failed, in the order of the scenario; what the others wrote stays.
pub fn run_in(setting: Setting<'_>) -> Result<Option<Done>> {
    let Setting {
        scenario,
        folder,
        library,
        threads,
        progress,
        ..
    } = setting;
    let began = Instant::now();
    let runs = wanted(setting)?;
    refuse_library(library.folder(), folder.0, FolderKind::Run)?;
    let claim = claimed(setting)?;
    let ledger = &claim.ledger;
    progress.keep_pace(folder.0);
    let plans = scenario.beds();
    let dragged_through = |k: &usize| runs.iter().any(|run| run.bed == *k);
    let places: Vec<usize> = (0..plans.len()).filter(dragged_through).collect();
    if scenario.source.is_none() {
        let plans = places.iter().map(|&k| &plans[k]);
        let missing = plans.filter(|plan| !ledger.vouches(&folder.bed(&plan.name)));
        let recipes = missing.map(|plan| Recipe::new(scenario, plan));
        let recipes: Vec<Recipe> = recipes.filter(|recipe| !library.has(recipe)).collect();
        library.prepare(&recipes)?;
    }
    let si = scenario.units == UnitSystem::Si;
    let (d, density) = (scenario.mean_diameter(), scenario.bed.density);
    if let Some(table) = table_text(&scenario.law, d, density, si) {
        progress.line(table.trim_end());
    }
    progress.line(&scenario.time_step_line());
    let (beds, mut stages) = beds(setting, ledger, &places)?;
    let bed_of = |run: &DragPlan| &beds[places.partition_point(|k| *k < run.bed)];
    let dragged = side_by_side(
        threads,
        threads,
        runs.len(),
        |k| runs[k].steps(),
        |k| {
            let done = drag(setting, ledger, &runs[k], bed_of(&runs[k]));
            done.inspect_err(|error| report_now(error, runs.len(), progress))
        },
    )?;
    let dragged: Vec<(DragSummary, StagePerformance)> =
        dragged.into_iter().collect::<Result<_>>()?;
    let (runs, timed): (Vec<_>, Vec<_>) = dragged.into_iter().unzip();
    let poured = stages.iter().map(|bed| Taken::new(&bed.stage, bed));
    let pulled = runs.iter().zip(&timed);
    let pulled = pulled.map(|(run, done)| Taken::new(&run.name, done));
    let executed = poured.chain(pulled).collect();
    stages.extend(timed);
    let whole = runs.len() == scenario.drags().len();
    if whole {
        conclude(folder, ledger, scenario, beds, runs)?;
        (setting.write_report)(folder)?;
    }
    let performance = Performance {
        bits_version: BITS_VERSION,
        threads,
        seconds: began.elapsed().as_secs_f64(),
        stages,
        pace: Some(progress.pace()),
    };
    let path = folder.performance();
    write_beside(&path, json_text(&path, &performance)?.as_bytes())?;
    let report = folder.report();
    Ok(whole.then_some(Done { report, executed }))
}

/// The drags that are wanted.
///
/// # Errors
/// [`Error::Input`] with a name that none of them has.
fn wanted(setting: Setting<'_>) -> Result<Vec<DragPlan>> {
    let (all, only) = (setting.scenario.drags(), setting.only);
    if let Some(name) = only
        .iter()
        .find(|name| all.iter().all(|run| run.name != **name))
    {
        let names: Vec<&str> = all.iter().map(|run| &run.name[..]).collect();
        let problem = format!(
            "`{name}` is not a drag of the scenario; there are {}",
            names.join(", ")
        );
        return Err(Error::input("--only", problem));
    }
    let wants = |run: &&DragPlan| only.is_empty() || only.contains(&run.name);
    Ok(all.iter().filter(wants).cloned().collect())
}

/// The folder, owned by this process.
///
/// # Errors
/// As [`claim`].
pub fn claimed(setting: Setting<'_>) -> Result<DirectoryLock> {
    let claim = claim(setting.folder, setting.scenario)?;
    claim.warn_of_damage(setting.progress);
    if !claim.sure {
        setting.progress.warn(&format!(
            "{} cannot be locked: make sure that no other run is at work in it",
            setting.folder.0.display()
        ));
    }
    Ok(claim)
}

/// The settled beds of a run at these places of its plans, in a folder that is [`claimed`].
///
/// # Errors
/// The first that failed.
pub fn beds(
    setting: Setting<'_>,
    ledger: &Ledger,
    places: &[usize],
) -> Result<(Vec<BedSummary>, Vec<StagePerformance>)> {
    let Setting {
        scenario, threads, ..
    } = setting;
    let all = scenario.beds();
    let plans: Vec<&BedPlan> = places.iter().map(|&k| &all[k]).collect();
    let height = |plan: &BedPlan| plan.center[2] as u64;
    // What lies below lids first: several lids lie on one bed.
    let lids = plans.iter().filter(|plan| plan.lid.is_some());
    let wanted: Vec<&BedPlan> = lids.map(|plan| below(scenario, plan)).collect();
    let bare = scenario.bare_beds().iter();
    let bare: Vec<&BedPlan> = bare.filter(|bare| wanted.contains(bare)).collect();
    let poured = side_by_side(
        threads,
        threads,
        bare.len(),
        |k| height(bare[k]),
        |k| pour_bare(setting, ledger, bare[k]),
    )?;
    let mut stages: Vec<StagePerformance> = poured.into_iter().collect::<Result<_>>()?;
    let beds = side_by_side(
        threads,
        threads,
        plans.len(),
        |k| height(plans[k]),
        |k| settle_one(setting, ledger, plans[k]),
    )?;
    let beds: Vec<(BedSummary, StagePerformance)> = beds.into_iter().collect::<Result<_>>()?;
    let (beds, timed): (Vec<_>, Vec<_>) = beds.into_iter().unzip();
    stages.extend(timed);
    Ok((beds, stages))
}

/// One bed of a run in a folder that is [`claimed`]; of one that lies below lids as much as those need.
///
/// # Errors
/// If it fails or is interrupted.
pub(crate) fn bed(setting: Setting<'_>, ledger: &Ledger, plan: &BedPlan) -> Result<()> {
    if setting.scenario.bare_beds().contains(plan) {
        return pour_bare(setting, ledger, plan).map(|_| ());
    }
    let place = setting.scenario.beds().iter().position(|bed| bed == plan);
    let places: Vec<usize> = place.into_iter().collect();
    beds(setting, ledger, &places).map(|_| ())
}

/// One drag through a settled bed, or what is left of it.
///
/// # Errors
/// If it fails or is interrupted.
pub fn drag(
    setting: Setting<'_>,
    ledger: &Ledger,
    plan: &DragPlan,
    bed: &BedSummary,
) -> Result<(DragSummary, StagePerformance)> {
    let drag = DragTask {
        folder: setting.folder,
        scenario: setting.scenario,
        plan,
        bed,
    };
    drag_one(drag, ledger, setting.save, setting.frames, setting.progress)
}

/// Writes the summary of a run whose stages are all done, and returns the closing hash of its
/// manifest.
///
/// # Errors
/// [`Error::Write`].
pub fn conclude(
    folder: &Folder<'_>,
    ledger: &Ledger,
    scenario: &CheckedScenario,
    beds: Vec<BedSummary>,
    runs: Vec<DragSummary>,
) -> Result<String> {
    let whole = whole_summary(folder, scenario, beds, runs);
    let path = folder.summary();
    ledger.write(&path, json_text(&path, &whole)?.as_bytes())?;
    let closing = ledger.finish()?;
    Ok(closing)
}

/// Reports a stage that failed while others of several go on, which may take days.
fn report_now(error: &Error, stages: usize, progress: &Progress) {
    if stages > 1 && !matches!(error, Error::Interrupted { .. }) {
        progress.warn(&format!("{error}; the others go on"));
    }
}

/// All numbers of a run.
pub fn whole_summary(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
    beds: Vec<BedSummary>,
    runs: Vec<DragSummary>,
) -> Summary {
    Summary {
        version: env!("CARGO_PKG_VERSION").into(),
        bits_version: BITS_VERSION,
        scenario: scenario.name.clone(),
        units: scenario.units(),
        inputs: folder.inputs(scenario),
        standard_error_method: METHOD.into(),
        beds,
        runs,
    }
}
