//! What a call executed of finished runs, and what it found of them executed again: only execution confirms a result.

use std::path::Path;

use crate::bisect::chain_of;
use crate::folder::Folder;
use crate::manifest::Manifest;
use crate::manifest::audit::audit;
use crate::progress::Progress;
use crate::rerun::RunArchive;
use crate::run::{Links, Taken, planned};
use crate::verify::{Job, Problems, Scope, beside_twin, execute, pieces, summary_problem};
use bitgrain_sim::error::{CHANGED, Error, Result, UNEXPECTED};

/// Whether the finished run in `out` has all these links.
///
/// # Errors
/// [`Error::Unverified`] with the first that is neither its closing hash nor the last link of a stage.
pub fn check_expected(out: &Path, expect: &[String]) -> Result<()> {
    let manifest = Manifest::of(out)?;
    let has = |link: &&String| manifest.as_ref().is_some_and(|own| own.has_link(link));
    match expect.iter().find(|link| !has(link)) {
        None => Ok(()),
        Some(link) => Err(Error::Unverified {
            problem: format!(
                "{}: {link} is neither its closing hash nor the last link of a stage",
                out.display()
            ),
            hint: UNEXPECTED,
        }),
    }
}

/// Refuses a folder in which something lies that a run of its scenario does not write, as a manifest that was found may
/// have it, or whose summary is not what its last states give, or what lies beside a bed not what its state gives.
///
/// # Errors
/// [`Error::Unverified`], after each finding was a line of `say`.
pub fn check_folder(root: &Path, say: &mut impl FnMut(&str) -> Result<()>) -> Result<()> {
    let folder = Folder(root);
    let archive = RunArchive::open(&folder)?;
    let Some(manifest) = Manifest::of(root)? else {
        return Ok(());
    };
    let mut problems = Problems::default();
    let found = audit(root, &manifest, &planned(&archive.scenario))?;
    problems.tell_audit(&found.wrong, say)?;
    for job in pieces(&archive, Some(&manifest), &Scope::default())? {
        problems.tell(beside_twin(&job), say)?;
    }
    problems.tell(summary_problem(&archive, Some(&manifest)), say)?;
    problems.conclude(root)
}

/// Whether a call executed all of these stages from the beginning.
pub fn is_whole(taken: &[Taken]) -> bool {
    taken.iter().all(Taken::is_whole)
}

/// The links of the run in a folder, by what the call did for its stages.
///
/// # Errors
/// If a chain cannot be read.
pub fn links(root: &Path, taken: &[Taken]) -> Result<Links> {
    let mut links = Links::default();
    for one in taken {
        if let Some(chain) = chain_of(root, &one.stage)? {
            links += one.links(&chain);
        }
    }
    Ok(links)
}

/// Executes again what the call that did this for the stages of a finished run did not execute of it. Nothing is
/// written. Each finding is a line of `say`.
///
/// # Errors
/// [`Error::Unverified`] if a piece does not hold, after all was reported; [`Error::Interrupted`].
pub fn execute_found(
    root: &Path,
    taken: &[Taken],
    threads: usize,
    progress: &Progress,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let folder = Folder(root);
    let archive = RunArchive::open(&folder)?;
    let manifest = Manifest::of(root)?;
    let jobs = found(&archive, manifest.as_ref(), taken, "")?;
    execute_pieces(root, &jobs, threads, progress, &mut say)
}

/// The pieces of a finished run of which the call that did this for its stages did not execute every step.
///
/// # Errors
/// As [`pieces`].
pub(crate) fn found<'a>(
    archive: &'a RunArchive<'a>,
    manifest: Option<&'a Manifest>,
    taken: &[Taken],
    label: &'a str,
) -> Result<Vec<Job<'a>>> {
    let mut jobs = pieces(archive, manifest, &Scope::default())?;
    jobs.retain(|job| job.is_found(taken));
    jobs.iter_mut().for_each(|job| job.label = label);
    Ok(jobs)
}

/// Executes pieces of the runs in `root` again.
///
/// # Errors
/// As [`execute_found`].
pub(crate) fn execute_pieces(
    root: &Path,
    jobs: &[Job<'_>],
    threads: usize,
    progress: &Progress,
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let done = execute(jobs, threads, progress, say)?;
    let (links, count) = (done.links, done.pieces);
    match done.wrong {
        0 => say(&format!(
            "executed again: all {links} links of {count} pieces that were found hold"
        )),
        wrong => Err(Error::Unverified {
            problem: format!(
                "{}: {wrong} of {count} pieces that were found do not hold",
                root.display()
            ),
            hint: CHANGED,
        }),
    }
}
