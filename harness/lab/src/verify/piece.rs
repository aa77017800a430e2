//! The pieces of a run that are executed again, and which of them are asked for.

use super::scope::{Scope, Segment};
use crate::manifest::Manifest;
use crate::rerun::{RunArchive, RunPart};
use crate::run::Taken;
use crate::scenario::{BedPlan, DragPlan};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::random::{Purpose, uniforms};

/// Steps between two states that were kept, or a whole bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece<'a> {
    Bed(&'a BedPlan),
    Drag(&'a DragPlan, u64, u64),
}

impl Piece<'_> {
    pub(super) fn name(&self) -> &str {
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

/// A piece of a run, and what distinguishes it from those of other runs.
#[derive(Clone, Copy)]
pub(crate) struct Job<'a> {
    pub(super) archive: &'a RunArchive<'a>,
    pub(super) piece: Piece<'a>,
    /// The last link of its stage by the manifest, if that is finished.
    pub(super) link: Option<&'a str>,
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

    /// Whether a call that did this for the stages of its run did not execute its stage from the beginning; of other
    /// stages none. What a stage goes on from may be forged, and with it all that follows.
    pub(crate) fn is_found(&self, taken: &[Taken]) -> bool {
        let mut taken = taken.iter().filter(|one| one.stage == self.piece.name());
        taken.any(|one| !one.is_whole())
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

/// The pieces of a run that are asked for, without a choice at random.
///
/// # Errors
/// [`Error::Input`] if there are none.
pub(crate) fn pieces<'a>(
    archive: &'a RunArchive<'a>,
    manifest: Option<&'a Manifest>,
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
    let job = |piece: Piece<'a>| Job {
        archive,
        link: manifest.and_then(|manifest| manifest.link(piece.name())),
        piece,
        label: "",
    };
    Ok(pieces.into_iter().map(job).collect())
}
