//! The beds of a run: from the library, made and kept there, or imported.

use std::path::{Path, PathBuf};

use super::saving::Saver;
use super::setting::Setting;
use super::taken::{KEPT, RESUMED, REUSED};
use crate::bed;
use crate::bed::recipe::Recipe;
use crate::bed::{Pouring, PouringState};
use crate::folder::Folder;
use crate::manifest::Ledger;
use crate::pace::StageKind;
use crate::performance::{StagePerformance, timed};
use crate::progress::Stage;
use crate::scenario::{BedPlan, CheckedScenario};
use crate::summary::BedSummary;
use bitgrain_sim::checkpoint::{self, StageState};
use bitgrain_sim::disk::{self, Kind};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::{bits, text_file};
use bitgrain_sim::format::short;
use bitgrain_sim::simulation::Simulation;
use bitgrain_sim::{export, lammps};

use super::summarise::rig;

/// Where the bed below a lid is in the run directory.
pub(super) fn below<'a>(scenario: &'a CheckedScenario, plan: &BedPlan) -> &'a BedPlan {
    let wanted = Recipe::new(scenario, &plan.bare());
    let mut bare = scenario.bare_beds().iter();
    let found = bare.find(|other| Recipe::new(scenario, other) == wanted);
    found.expect("every lid lies on one of the bare beds")
}

/// Pours a bed that lies below others' lids, unless it is at hand.
pub(super) fn pour_bare(
    setting: Setting<'_>,
    ledger: &Ledger,
    plan: &BedPlan,
) -> Result<StagePerformance> {
    let Setting {
        scenario, progress, ..
    } = setting;
    let steps = planned_steps(scenario, plan);
    let mut stage = progress.paced_stage(&plan.name, steps, StageKind::Pouring);
    let (how, steps) = fetch_bed(setting, ledger, plan, &mut stage)?;
    let (sim, note) = read_settled(setting, ledger, plan)?;
    ledger.finish_stage(&plan.name, &note.link)?;
    let performance = StagePerformance {
        stage: plan.name.clone(),
        ..timed(stage, how, &sim, steps)
    };
    progress.line(&format!(
        "{}: {} grains {how} ({:.1} s)",
        plan.name,
        sim.count(),
        performance.seconds
    ));
    Ok(performance)
}

/// About how many steps a bed takes, or a lid on it.
fn planned_steps(scenario: &CheckedScenario, plan: &BedPlan) -> u64 {
    match plan.lid {
        Some(_) => bed::covering_steps(scenario, plan),
        None => bed::pouring_steps(scenario, plan),
    }
}

/// A settled bed in the run directory: from the library, poured and kept there, or imported.
pub(super) fn settle_one(
    setting: Setting<'_>,
    ledger: &Ledger,
    plan: &BedPlan,
) -> Result<(BedSummary, StagePerformance)> {
    let Setting {
        scenario, progress, ..
    } = setting;
    let steps = planned_steps(scenario, plan);
    let mut stage = progress.paced_stage(&plan.name, steps, StageKind::Pouring);
    let (how, steps) = fetch_bed(setting, ledger, plan, &mut stage)?;
    let (mut sim, note) = read_settled(setting, ledger, plan)?;
    let (path, bytes) = data_file(setting.folder, scenario, plan, &sim)?;
    ledger.write(&path, &bytes)?;
    ledger.finish_stage(&plan.name, &note.link)?;
    let performance = StagePerformance {
        stage: plan.name.clone(),
        ..timed(stage, how, &sim, steps)
    };
    let summary = surveyed(scenario, plan, &mut sim, &note)?;
    progress.line(&format!(
        "{}: {} grains {how} ({} steps, {:.1} s); surface at {}, depth {}, packing fraction {:.3}, \
         coordination number {:.2}, weight carried {:.4}",
        plan.name,
        summary.grains,
        summary.steps,
        performance.seconds,
        short(summary.surface),
        short(summary.depth),
        summary.packing_fraction,
        summary.coordination_number,
        summary.support / summary.weight,
    ));
    if let Some(rig) = &summary.rig {
        progress.line(&format!(
            "{}: effective depth {} ({:.1} D), lid of density {}, upward force on the intruder {:.1} \
             buoyancies",
            plan.name,
            short(rig.effective_depth),
            rig.effective_depth / rig.diameter,
            short(rig.lid_density),
            rig.reaction_over_buoyancy
        ));
    }
    Ok((summary, performance))
}

/// A settled bed as a LAMMPS data file: its path and its bytes.
///
/// # Errors
/// [`Error::Write`] if packing fails.
pub fn data_file(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
    plan: &BedPlan,
    sim: &Simulation,
) -> Result<(PathBuf, Vec<u8>)> {
    let title = format!(
        "{} of {}: atom_style sphere; {}",
        plan.name,
        scenario.name,
        bits()
    );
    let data = lammps::data_text(&export::atoms(sim, true), &title);
    text_file(&folder.bed_data(&plan.name), &data, scenario.measure.gzip)
}

/// A settled bed of the run directory, whose chain of digests is written beside it.
fn read_settled(
    setting: Setting<'_>,
    ledger: &Ledger,
    plan: &BedPlan,
) -> Result<(Simulation, StageState)> {
    let path = setting.folder.bed(&plan.name);
    let (sim, note) = setting.folder.state(&path)?;
    let course = PouringState::of(&note).map_err(|problem| Error::Damaged {
        place: path.display().to_string(),
        problem,
    })?;
    let chain = setting.folder.bed_chain(&plan.name);
    ledger.write(&chain, course.chain().text().as_bytes())?;
    Ok((sim, note))
}

/// What is measured of a settled bed.
///
/// # Errors
/// [`Error::Contract`].
pub fn surveyed(
    scenario: &CheckedScenario,
    plan: &BedPlan,
    sim: &mut Simulation,
    note: &StageState,
) -> Result<BedSummary> {
    let mut summary = bed::survey(&plan.name, &scenario.measures(), sim)?;
    summary.chain = note.link.clone();
    summary.rig = scenario
        .has_rig()
        .then(|| rig(scenario, plan, &summary, sim));
    Ok(summary)
}

/// Puts the checkpoint of a settled bed where the run needs it, and says where it came from and how many
/// steps were executed for it.
fn fetch_bed(
    setting: Setting<'_>,
    ledger: &Ledger,
    plan: &BedPlan,
    stage: &mut Stage,
) -> Result<(&'static str, u64)> {
    let Setting {
        scenario,
        folder,
        library,
        ..
    } = setting;
    let path: &Path = &folder.bed(&plan.name);
    // Asked to stop before it began.
    stage.look().map_err(Error::saved)?;
    let saved = folder.pouring(&plan.name);
    if scenario.source.is_some() {
        let mut bed = begin_bed(folder, scenario, plan)?;
        ledger.write(path, &checkpoint::pack(&mut bed.sim, &bed.course.note())?)?;
        return Ok(("imported", 0));
    }
    let recipe = Recipe::new(scenario, plan);
    // The bed here comes first: its drags may have begun.
    if let Some(bytes) = settled_here(setting, ledger, path, &recipe)? {
        // Not for the library: who made this folder is not known.
        ledger.write(path, &bytes)?;
        ledger.remove_state(&saved)?;
        return Ok((KEPT, 0));
    }
    if let Some(bytes) = library.find(&recipe)? {
        ledger.write(path, &bytes)?;
        ledger.remove_state(&saved)?;
        return Ok((REUSED, 0));
    }
    let (mut bed, how) = match unsettled_here(setting, plan, &saved)? {
        Some(bed) => (bed, RESUMED),
        None => {
            let how = if plan.lid.is_some() {
                "covered"
            } else {
                "poured"
            };
            (begin_bed(folder, scenario, plan)?, how)
        }
    };
    let began = bed.sim.step_count();
    stage.resume(began);
    let mut saver = Saver::new(ledger, setting.save, saved, began);
    let went = bed.go_on(scenario, plan, stage, &mut saver);
    if let Err(error) = went {
        if matches!(error, Error::Interrupted { .. }) {
            saver.save(&mut bed.sim, &bed.course.note())?;
        } else if error.is_physical() {
            saver.clear()?;
        }
        return Err(error.saved());
    }
    if began == 0 {
        let planned = planned_steps(scenario, plan);
        let (grains, taken) = (bed.sim.count(), bed.sim.step_count());
        setting.progress.settled(grains, planned, taken);
    }
    let bytes = checkpoint::pack(&mut bed.sim, &bed.course.note())?;
    // First in the folder that uses it: days of pouring are not lost if there is no library.
    ledger.write(path, &bytes)?;
    // If it stays it is older than the bed, and harmless.
    let _ = saver.clear();
    library.keep(&recipe, &bytes)?;
    Ok((how, bed.sim.step_count() - began))
}

/// A bed as its first grain is let go, as its lid is laid on what lies below it, or as it is taken over
/// from a file.
///
/// # Errors
/// If the file is not such a bed, or the bed below the lid cannot be read.
pub fn begin_bed(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
    plan: &BedPlan,
) -> Result<Pouring> {
    if let Some(source) = &scenario.source {
        let sim = bed::import::bed(scenario, source)?;
        return Pouring::imported(sim, scenario, plan);
    }
    if plan.lid.is_none() {
        return Pouring::begin(scenario, plan);
    }
    let bare = folder.bed(&below(scenario, plan).name);
    let (mut bare, note) = folder.state(&bare)?;
    Pouring::cover(&mut bare, &note.link, scenario, plan)
}

/// The bytes of the bed that lies in the run directory, if it is this one and whole.
fn settled_here(
    setting: Setting<'_>,
    ledger: &Ledger,
    path: &Path,
    recipe: &Recipe,
) -> Result<Option<Vec<u8>>> {
    if disk::kind(path) != Some(Kind::File) {
        return Ok(None);
    }
    let name = path.display().to_string();
    if ledger.lists(path) && !ledger.vouches(path) {
        let told = format!("{name} was changed after it was written; it is made again");
        setting.progress.warn(&told);
        return Ok(None);
    }
    let bytes = disk::read(path)?;
    match bed::prove(&bytes, &name, recipe) {
        Ok(()) => Ok(Some(bytes)),
        Err(damage @ Error::Damaged { .. }) => {
            setting
                .progress
                .warn(&format!("{damage}; it is made again"));
            Ok(None)
        }
        Err(other) => Err(other),
    }
}

/// The bed that was saved unsettled, if it is this one and whole.
fn unsettled_here(setting: Setting<'_>, plan: &BedPlan, path: &Path) -> Result<Option<Pouring>> {
    if disk::kind(path) != Some(Kind::File) {
        return Ok(None);
    }
    let place = path.display().to_string();
    match setting.folder.state(path) {
        Ok((sim, note)) => Pouring::of(sim, &note, setting.scenario, plan)
            .map(Some)
            .map_err(|problem| {
                let what = format!("{problem}; remove it to pour again");
                Error::input(place, what)
            }),
        Err(damage @ Error::Damaged { .. }) => {
            setting
                .progress
                .warn(&format!("{damage}; the bed is poured from the beginning"));
            Ok(None)
        }
        Err(other) => Err(other),
    }
}
