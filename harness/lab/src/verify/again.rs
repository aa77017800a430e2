//! Pieces of a run executed again: a bed, or a drag from one kept state to the next.

use std::path::PathBuf;

use super::check::{Check, Finding};
use super::piece::{Job, Piece};
use crate::bed::PouringState;
use crate::drag::Dragging;
use crate::frames;
use crate::json::json_text;
use crate::manifest::NAME;
use crate::progress::Progress;
use crate::rerun::RunArchive;
use crate::run::{self, DragTask, LOAD};
use crate::scenario::{BedPlan, DragPlan};
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;

/// Executes a piece, and compares what it gives with what was written.
///
/// # Errors
/// If it cannot be executed.
pub(super) fn again(job: &Job<'_>, progress: &Progress) -> Result<Finding> {
    let mut finding = match job.piece {
        Piece::Bed(plan) => bed_again(job.archive, plan, progress)?,
        Piece::Drag(plan, from, to) => drag_again(job.archive, plan, [from, to], progress)?,
    };
    if let (Some(listed), Some(end)) = (job.link, &finding.end)
        && listed != end
    {
        let name = job.piece.name();
        finding.text = format!("{name}: its link in {NAME} is not the last one of its execution");
        (finding.holds, finding.end) = (false, None);
    }
    Ok(finding)
}

/// Pours a bed again, or takes it over again.
fn bed_again(archive: &RunArchive<'_>, plan: &BedPlan, progress: &Progress) -> Result<Finding> {
    let bytes = disk::read(&archive.folder.bed(&plan.name))?;
    let (settled, course) = settled(archive, plan, &bytes)?;
    let written = beside_bed(archive, plan, &settled, &course)?.is_none();
    let mut check = Check::new(&course.chain().links, u64::MAX);
    let first = course.chain().links.first().map_or(0, |link| link.step);
    let steps = [first, settled.step_count()];
    let mut bed = run::begin_bed(archive.folder, &archive.scenario, plan)?;
    // Its first link was made as it began.
    check.on_digest(&bed.course.chain().links[0])?;
    let mut stage = progress.stage(&plan.name, settled.step_count());
    let rests = bed.go_on(&archive.scenario, plan, &mut stage, &mut check)?;
    let note = bed.course.note();
    let same = rests && checkpoint::pack(&mut bed.sim, &note)? == bytes && written;
    let more = match archive.scenario.source {
        Some(_) => " (taken over again)",
        None => "",
    };
    Ok(check
        .finding(&plan.name, steps, same, more)
        .ending_with(&note.link))
}

/// The state of a settled bed and its course, from the bytes of its checkpoint.
fn settled(
    archive: &RunArchive<'_>,
    plan: &BedPlan,
    bytes: &[u8],
) -> Result<(Simulation, PouringState)> {
    let place = archive.folder.bed(&plan.name).display().to_string();
    let (settled, note) = checkpoint::unpack(bytes, &place)?;
    let course = PouringState::of(&note).map_err(|problem| Error::Damaged { place, problem })?;
    Ok((settled, course))
}

/// The first file beside a settled bed that does not follow from its state, in words.
fn beside_bed(
    archive: &RunArchive<'_>,
    plan: &BedPlan,
    settled: &Simulation,
    course: &PouringState,
) -> Result<Option<String>> {
    let RunArchive { folder, scenario } = archive;
    let chain = course.chain().text().into_bytes();
    let mut files = vec![(folder.bed_chain(&plan.name), chain)];
    let data = run::data_file(folder, scenario, plan, settled)?;
    // The manifest says whether there must be one.
    if disk::is_there(&data.0) {
        files.push(data);
    }
    let wrong = |(path, text): &(PathBuf, Vec<u8>)| disk::read(path).ok().as_ref() != Some(text);
    let wrong = files.into_iter().find(wrong);
    Ok(wrong.map(|(path, _)| format!("{} is missing or not as it was written", path.display())))
}

/// The same of a bed whose state is another's that is poured again, and its link.
pub(crate) fn beside_twin(job: &Job<'_>) -> Option<String> {
    let Piece::Bed(plan) = job.piece else {
        return None;
    };
    let found = disk::read(&job.archive.folder.bed(&plan.name)).and_then(|bytes| {
        let (settled, course) = settled(job.archive, plan, &bytes)?;
        let wrong = beside_bed(job.archive, plan, &settled, &course)?;
        let same = job.link.is_none_or(|link| link == course.chain().end());
        Ok(wrong.or((!same).then(|| format!("its link in {NAME} is not that of its state"))))
    });
    let problem = found.unwrap_or_else(|e| Some(e.to_string()))?;
    Some(format!("{}: {problem}", plan.name))
}

/// Drags again from one kept state to the next.
fn drag_again(
    archive: &RunArchive<'_>,
    plan: &DragPlan,
    steps: [u64; 2],
    progress: &Progress,
) -> Result<Finding> {
    let [from, to] = steps;
    let bed = archive.bed_of(plan)?;
    let drag = archive.drag(plan, &bed);
    let path = archive.folder.checkpoint(&plan.name, to);
    let bytes = disk::read(&path)?;
    let (_, recorded) = run::read(drag, &path, Some(to))?;
    let (mut sim, mut dragging) = archive.state(drag, from)?;
    let mut check = Check::new(&recorded.chain.links, to);
    check.drag = Some(drag);
    let earlier = plan.checkpoints.iter().rev().find(|n| **n < to);
    check.frames_after = earlier.copied().unwrap_or(0);
    // What the checkpoint that it begins from holds of the steps before.
    let before = dragging.chain.links.last().map_or(0, |link| link.step);
    let same = |one: &Dragging, other: &Dragging| {
        let until = |d: &Dragging| {
            d.chain
                .links
                .iter()
                .take_while(|l| l.step <= before)
                .count()
        };
        one.chain.links[..until(one)] == other.chain.links[..until(other)]
    };
    if !same(&dragging, &recorded) {
        check.broken = Some(format!("its checkpoints do not agree about step {before}"));
    } else if from == 0 {
        check.held += 1;
    }
    let mut stage = progress.stage(&format!("{} from {from}", plan.name), to);
    stage.resume(from);
    dragging.go_on(&mut sim, plan, &stage, &mut check)?;
    // There may be none: they are for viewing only, and not all runs have them.
    let film = archive.folder.frames(&plan.name, to);
    if disk::is_there(&film) && disk::read(&film)? != frames::text(&check.frames).into_bytes() {
        let problem = format!("{} is not as it was written", film.display());
        check.broken.get_or_insert(problem);
    }
    let note = dragging.note();
    let mut same = checkpoint::pack(&mut sim, &note)? == bytes;
    let mut more = String::new();
    if same && check.broken.is_none() && to == plan.steps() {
        let wrong = wrong_tables(drag, &dragging, &mut sim)?;
        if wrong.is_empty() {
            more = ", and its tables are as written".into();
        } else {
            let files = wrong.join(", ");
            check.broken = Some(format!(
                "{files} of its folder: missing or not as it was written"
            ));
            same = false;
        }
    }
    let finding = check.finding(&plan.name, steps, same, &more);
    Ok(match to == plan.steps() {
        true => finding.ending_with(&note.link),
        false => finding,
    })
}

/// The tables of a finished drag that are not as it gives them.
fn wrong_tables(
    drag: DragTask<'_>,
    dragging: &Dragging,
    sim: &mut Simulation,
) -> Result<Vec<&'static str>> {
    let (mut tables, summary) = run::results(drag, dragging, sim)?;
    let path = |file: &str| drag.folder.of_run(&drag.plan.name, file);
    let record = run::record(drag.folder, drag.scenario, drag.bed, &summary);
    tables.push(("summary.json", json_text(&path("summary.json"), &record)?));
    let given = tables.iter().any(|(file, _)| *file == LOAD);
    let not_given = (!given && disk::is_there(&path(LOAD))).then_some(LOAD);
    let wrong = tables
        .into_iter()
        .filter(|(file, text)| disk::read(&path(file)).ok().as_deref() != Some(text.as_bytes()));
    Ok(wrong.map(|(file, _)| file).chain(not_given).collect())
}
