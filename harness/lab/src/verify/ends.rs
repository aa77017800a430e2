//! What a run says of its ends, compared with its last states.

use super::{Cause, Problems};
use crate::manifest::{Manifest, NAME};
use crate::rerun::{RunArchive, RunPart};
use crate::run;
use crate::summary::read_summary;
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

/// Compares what a run says of its ends with its last states, without executing any: the last link of
/// each finished stage, and the summary. Reports what was found, and returns what does not hold.
///
/// # Errors
/// What `say` returns.
pub(crate) fn check_ends(
    archive: &RunArchive<'_>,
    manifest: Option<&Manifest>,
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<Problems> {
    let mut problems = Problems::default();
    let mut wrong = |problem: String| {
        say(&problem)?;
        problems.add(Cause::Changed, problem);
        Ok::<_, Error>(())
    };
    for stage in manifest.map_or(&[][..], |manifest| &manifest.stages) {
        let Ok(part) = archive.part(&stage.name) else {
            continue; // Not planned, which was reported.
        };
        let path = match part {
            RunPart::Bed(plan) => archive.folder.bed(&plan.name),
            RunPart::Drag(plan) => archive.folder.checkpoint(&plan.name, plan.steps()),
        };
        let link = checkpoint::read_noted(&path).map(|(_, note)| note.link);
        if stage.finished && !link.is_ok_and(|link| link == stage.link) {
            let place = path.display();
            wrong(format!(
                "{}: its link in {NAME} is not the last one of {place}",
                stage.name
            ))?;
        }
    }
    let path = archive.folder.summary();
    if manifest.is_some_and(|manifest| manifest.finished) || disk::is_there(&path) {
        let made = summary_text(archive).map(String::into_bytes);
        let written = disk::read(&path);
        if !matches!((&made, &written), (Ok(made), Ok(written)) if made == written) {
            let place = path.display();
            wrong(format!("{place}: not what the checkpoints give"))?;
        }
    }
    Ok(problems)
}

/// The run's own summary, made from its beds and the last checkpoints of its drags.
fn summary_text(archive: &RunArchive<'_>) -> Result<String> {
    let plans = archive.scenario.beds();
    let mut beds = Vec::with_capacity(plans.len());
    for plan in plans {
        beds.push(archive.bed(plan)?);
    }
    let written = read_summary(&archive.folder.summary()).map_or(Vec::new(), |whole| whole.runs);
    let mut runs = Vec::new();
    for plan in archive.scenario.drags() {
        let drag = archive.drag(plan, &beds[plan.bed]);
        let (mut sim, dragging) = archive.state(drag, plan.steps())?;
        let (_, mut run) = run::results(drag, &dragging, &mut sim)?;
        if let Some(written) = written.iter().find(|one| one.name == run.name) {
            run.leave_out_as(written);
        }
        runs.push(run);
    }
    let whole = run::whole_summary(archive.folder, &archive.scenario, beds, runs);
    crate::json::json_text(&archive.folder.summary(), &whole)
}
