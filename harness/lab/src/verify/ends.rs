//! The files of a run that belong to no piece: its scenario and its summary.

use crate::manifest::Manifest;
use crate::rerun::RunArchive;
use crate::run;
use bitgrain_sim::disk;
use bitgrain_sim::error::Result;

/// Says if the text of the scenario is not the one that a run of it writes.
pub(super) fn scenario_problem(archive: &RunArchive<'_>) -> Option<String> {
    let path = archive.folder.scenario();
    let text = archive.folder.scenario_text(&archive.scenario);
    let same = disk::read(&path).is_ok_and(|written| written == text.into_bytes());
    (!same).then(|| format!("{}: not as a run of it writes it", path.display()))
}

/// Says if the summary of a run is not what its last states, which are known to hold, give.
pub(crate) fn summary_problem(
    archive: &RunArchive<'_>,
    manifest: Option<&Manifest>,
) -> Option<String> {
    let path = archive.folder.summary();
    if !manifest.is_some_and(|manifest| manifest.finished) && !disk::is_there(&path) {
        return None;
    }
    let made = summary_text(archive).map(String::into_bytes);
    let same = matches!((made, disk::read(&path)), (Ok(made), Ok(written)) if made == written);
    (!same).then(|| format!("{}: not what the checkpoints give", path.display()))
}

/// The run's own summary, made from its beds and the last checkpoints of its drags.
fn summary_text(archive: &RunArchive<'_>) -> Result<String> {
    let plans = archive.scenario.beds();
    let mut beds = Vec::with_capacity(plans.len());
    for plan in plans {
        beds.push(archive.bed(plan)?);
    }
    let mut runs = Vec::new();
    for plan in archive.scenario.drags() {
        let drag = archive.drag(plan, &beds[plan.bed]);
        let (mut sim, dragging) = archive.state(drag, plan.steps())?;
        runs.push(run::results(drag, &dragging, &mut sim)?.1);
    }
    let whole = run::whole_summary(archive.folder, &archive.scenario, beds, runs);
    crate::json::json_text(&archive.folder.summary(), &whole)
}
