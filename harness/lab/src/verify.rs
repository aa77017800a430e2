//! Verification: pieces of a run are executed again, and every link of their chains of digests, the states
//! at their ends and the tables made from them are compared with what the run wrote.

mod again;
mod check;
mod ends;
mod folder;
mod piece;
mod scope;

pub(crate) use again::beside_twin;
pub(crate) use ends::summary_problem;
pub(crate) use folder::{Cause, Problems, check_expected, check_manifest};
pub(crate) use piece::{Job, pieces, sampled};
pub use scope::{Scope, Segment};

use again::again;
use check::Finding;
use ends::scenario_problem;
use piece::Piece;

use crate::progress::Progress;
use crate::rerun::RunArchive;
use crate::run::{self, side_by_side};
use bitgrain_sim::error::{Error, Result};

/// Verifies a run: its manifest against its folder, then what is asked for by execution. Reports each finding
/// as a line of `say`. Each entry of `expect` must be the closing hash of a run that is executed whole, or the last
/// link of a stage whose end is executed.
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
    let planned = run::planned(&archive.scenario);
    let (manifest, mut problems) = check_manifest(root, &planned, expect, &mut say)?;
    problems.tell(scenario_problem(archive), &mut say)?;
    let jobs = pieces(archive, manifest.as_ref(), scope)?;
    let done = execute(&sampled(jobs, scope), threads, progress, &mut say)?;
    let (links, count) = (done.links, done.pieces);
    if done.wrong > 0 {
        let problem = format!("{} of {count} pieces do not hold", done.wrong);
        problems.add(Cause::Changed, problem);
    } else {
        if scope.is_all() {
            let problem = summary_problem(archive, manifest.as_ref());
            problems.tell(problem, &mut say)?;
        }
        let ends = |link: &str| scope.is_all() || done.ends.iter().any(|end| end == link);
        problems.take("", check_expected(expect, manifest.as_ref(), ends));
        let asked = if scope.is_all() { "" } else { "the " };
        let those = if scope.is_all() { "" } else { " asked for" };
        say(&format!(
            "all {links} links of {asked}{count} pieces{those} hold"
        ))?;
        if !scope.is_all() && !expect.is_empty() {
            say(
                "what was expected is held against what these end with; only a whole `verify` shows that the \
                 rest belongs to it",
            )?;
        }
    }
    problems.conclude(root)
}

/// What executing pieces gave.
#[derive(Clone, Debug, Default)]
pub(crate) struct Executed {
    pub(crate) links: usize,
    pub(crate) pieces: usize,
    pub(crate) wrong: usize,
    /// Last links of the stages whose last piece holds.
    pub(crate) ends: Vec<String>,
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
        again(&jobs[k], progress)
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
                end: None,
            },
            Ok(finding) => finding,
        };
        say(&format!("{}{}", job.label, finding.text))?;
        done.links += finding.links;
        done.ends.extend(finding.end);
        done.wrong += usize::from(!finding.holds);
    }
    Ok(done)
}
