//! Verification: pieces of a run are executed again, and every link of their chains of digests, the states
//! at their ends and the tables made from them are compared with what the run wrote.

mod check;
mod ends;
mod folder;
mod scope;

pub(crate) use ends::check_ends;
pub(crate) use folder::{Cause, Problems, check_manifest};
pub use scope::{Scope, Segment};

use check::{Check, Finding};

use crate::bed::PouringState;
use crate::drag::Dragging;
use crate::frames;
use crate::manifest::Manifest;
use crate::progress::Progress;
use crate::rerun::{RunArchive, RunPart};
use crate::run::{self, side_by_side};
use crate::scenario::{BedPlan, DragPlan};
use crate::summary::parse_record;
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;
use bitgrain_sim::observer::Observer;
use bitgrain_sim::random::{Purpose, uniforms};

/// Steps between two states that were kept, or a whole bed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Piece<'a> {
    Bed(&'a BedPlan),
    Drag(&'a DragPlan, u64, u64),
}

impl Piece<'_> {
    fn name(&self) -> &str {
        match self {
            Piece::Bed(plan) => &plan.name,
            Piece::Drag(plan, ..) => &plan.name,
        }
    }

    fn is_in(&self, segment: &Segment) -> bool {
        let overlap = match (self, segment.steps) {
            (Piece::Drag(_, from, to), Some((first, last))) => first < *to && *from < last,
            _ => true,
        };
        segment.stage == self.name() && overlap
    }
}

/// Verifies a run: its manifest against its folder, then what is asked for by execution. Reports each finding
/// as a line of `say`. Each entry of `expect` must be the manifest's closing hash or the last
/// link of a stage.
///
/// # Errors
/// [`Error::Unverified`] if something does not hold or the run is not finished, after all was reported;
/// [`Error::Input`] if there is nothing to verify.
pub fn verify(
    archive: &RunArchive<'_>,
    scope: &Scope,
    expect: &[String],
    threads: usize,
    progress: &Progress,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let root = archive.folder.0;
    let stages = run::stages(&archive.scenario);
    let (manifest, mut problems) = check_manifest(root, &stages, expect, &mut say)?;
    let jobs = pieces(archive, manifest.as_ref(), scope)?;
    let done = execute(&sampled(jobs, scope), threads, progress, &mut say)?;
    let (links, count) = (done.links, done.pieces);
    if done.wrong > 0 {
        let problem = format!("{} of {count} pieces do not hold", done.wrong);
        problems.add(Cause::Changed, problem);
    } else {
        if scope.is_all() {
            problems.take("", check_ends(archive, manifest.as_ref(), &mut say)?);
        }
        let asked = if scope.is_all() { "" } else { "the " };
        let those = if scope.is_all() { "" } else { " asked for" };
        say(&format!(
            "all {links} links of {asked}{count} pieces{those} hold"
        ))?;
        if !scope.is_all() && !expect.is_empty() {
            say(
                "what was expected is in the manifest; only a whole `verify` shows that the rest of the run \
                 gives it",
            )?;
        }
    }
    problems.conclude(root)
}

/// What executing pieces gave.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Executed {
    pub(crate) links: usize,
    pub(crate) pieces: usize,
    pub(crate) wrong: usize,
}

/// A piece of a run, and what distinguishes it from those of other runs.
#[derive(Clone, Copy)]
pub(crate) struct Job<'a> {
    archive: &'a RunArchive<'a>,
    piece: Piece<'a>,
    pub(crate) label: &'a str,
}

impl<'a> Job<'a> {
    /// The bed that it pours; `None` of a drag.
    pub(crate) fn bed(&self) -> Option<&'a BedPlan> {
        match self.piece {
            Piece::Bed(plan) => Some(plan),
            Piece::Drag(..) => None,
        }
    }
}

/// Of these pieces those that the scope's sample takes.
pub(crate) fn sampled<'a>(mut jobs: Vec<Job<'a>>, scope: &Scope) -> Vec<Job<'a>> {
    if let Some((count, seed)) = scope.sample {
        // Beds are whole pieces: a sample is of the drags, unless beds were asked for.
        if scope.segments.is_empty() {
            jobs.retain(|job| job.bed().is_none());
        }
        for k in 0..jobs.len().saturating_sub(count) {
            let [x] = uniforms(seed, Purpose::Sample, k as u32);
            jobs.remove((x * jobs.len() as f64) as usize);
        }
    }
    jobs
}

/// Executes pieces again, side by side, and reports each.
///
/// # Errors
/// [`Error::Interrupted`] and [`Error::Contract`]; every other fault is a finding.
pub(crate) fn execute(
    jobs: &[Job<'_>],
    threads: usize,
    progress: &Progress,
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<Executed> {
    let length = |k: usize| match jobs[k].piece {
        Piece::Bed(plan) => crate::bed::pouring_steps(&jobs[k].archive.scenario, plan),
        Piece::Drag(_, from, to) => to - from,
    };
    let found = side_by_side(threads, threads, jobs.len(), length, |k| {
        again(jobs[k].archive, jobs[k].piece, progress)
    })?;
    let mut done = Executed {
        pieces: jobs.len(),
        ..Executed::default()
    };
    for (job, found) in jobs.iter().zip(found) {
        let piece = job.piece;
        // A damaged file is a finding, a request to stop is not.
        let finding = match found {
            Err(e @ (Error::Interrupted { .. } | Error::Contract { .. })) => return Err(e),
            Err(e) => Finding {
                text: format!("{}: cannot be run again: {e}", piece.name()),
                links: 0,
                holds: false,
            },
            Ok(finding) => finding,
        };
        say(&format!("{}{}", job.label, finding.text))?;
        done.links += finding.links;
        done.wrong += usize::from(!finding.holds);
    }
    Ok(done)
}

/// The pieces of a run that are asked for, without a choice at random.
///
/// # Errors
/// [`Error::Input`] if there are none.
pub(crate) fn pieces<'a>(
    archive: &'a RunArchive<'a>,
    manifest: Option<&Manifest>,
    scope: &Scope,
) -> Result<Vec<Job<'a>>> {
    for segment in &scope.segments {
        archive.part(&segment.stage)?;
    }
    // Nothing of a finished stage may be missing, by the manifest or by the folder.
    let whole = manifest.is_some_and(|manifest| manifest.finished)
        || disk::is_there(&archive.folder.summary());
    let mut pieces = Vec::new();
    for part in archive.parts() {
        let ended = whole || manifest.is_some_and(|manifest| manifest.has_finished(part.name()));
        match part {
            RunPart::Bed(plan) => {
                if ended || disk::is_there(&archive.folder.bed(&plan.name)) {
                    pieces.push(Piece::Bed(plan));
                }
            }
            RunPart::Drag(plan) => {
                let mut from = 0;
                let ended =
                    ended || disk::is_there(&archive.folder.of_run(&plan.name, "summary.json"));
                let kept = |n: u64| disk::is_there(&archive.folder.checkpoint(&plan.name, n));
                let there = |n: &&u64| ended || kept(**n);
                for &to in plan.checkpoints.iter().filter(there) {
                    pieces.push(Piece::Drag(plan, from, to));
                    from = to;
                }
            }
        }
    }
    if !scope.segments.is_empty() {
        pieces.retain(|piece| scope.segments.iter().any(|segment| piece.is_in(segment)));
    }
    if pieces.is_empty() {
        let place = archive.folder.0.display().to_string();
        let problem = "holds no kept checkpoint for this: nothing can be verified yet";
        return Err(Error::input(place, problem));
    }
    let job = |piece| Job {
        archive,
        piece,
        label: "",
    };
    Ok(pieces.into_iter().map(job).collect())
}

fn again(archive: &RunArchive<'_>, piece: Piece<'_>, progress: &Progress) -> Result<Finding> {
    match piece {
        Piece::Bed(plan) => bed_again(archive, plan, progress),
        Piece::Drag(plan, from, to) => drag_again(archive, plan, [from, to], progress),
    }
}

/// Pours a bed again, or takes it over again.
fn bed_again(archive: &RunArchive<'_>, plan: &BedPlan, progress: &Progress) -> Result<Finding> {
    let path = archive.folder.bed(&plan.name);
    let bytes = disk::read(&path)?;
    let name = path.display().to_string();
    let (settled, note) = checkpoint::unpack(&bytes, &name)?;
    let course = PouringState::of(&note).map_err(|problem| Error::Damaged {
        place: name,
        problem,
    })?;
    let chain = archive.folder.bed_chain(&plan.name);
    let text = disk::read(&chain).unwrap_or_default();
    let (data, bytes_of_data) = run::data_file(archive.folder, &archive.scenario, plan, &settled)?;
    // A bed below a lid is not shared.
    let exported =
        !archive.scenario.beds().contains(plan) || disk::read(&data).ok() == Some(bytes_of_data);
    let written = text == course.chain().text().into_bytes() && exported;
    let mut check = Check::new(&course.chain().links, u64::MAX);
    let first = course.chain().links.first().map_or(0, |link| link.step);
    let steps = [first, settled.step_count()];
    let mut bed = run::begin_bed(archive.folder, &archive.scenario, plan)?;
    // Its first link was made as it began.
    check.on_digest(&bed.course.chain().links[0])?;
    let mut stage = progress.stage(&plan.name, settled.step_count());
    let settled = bed.go_on(&archive.scenario, plan, &mut stage, &mut check)?;
    let note = bed.course.note();
    let same = settled && checkpoint::pack(&mut bed.sim, &note)? == bytes && written;
    let more = match archive.scenario.source {
        Some(_) => " (taken over again)",
        None => "",
    };
    Ok(check.finding(&plan.name, steps, same, more))
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
    let (_, recorded) = run::read(drag, &path)?;
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
        let (tables, mut summary) = run::results(drag, &dragging, &mut sim)?;
        let place = archive.folder.of_run(&plan.name, "summary.json");
        let written = read_text(&place).and_then(|text| parse_record(&text, &place));
        if let Ok(written) = written {
            summary.leave_out_as(&written.run);
        }
        let summary = crate::json::json_text(
            &place,
            &run::record(drag.folder, drag.scenario, drag.bed, &summary),
        )?;
        let tables = tables.into_iter().chain([("summary.json", summary)]);
        let wrong: Vec<&str> = tables
            .filter(|(file, text)| {
                let written = disk::read(&archive.folder.of_run(&plan.name, file));
                written.ok().as_deref() != Some(text.as_bytes())
            })
            .map(|(file, _)| file)
            .collect();
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
    Ok(check.finding(&plan.name, steps, same, &more))
}
