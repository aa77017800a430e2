//! What is left to do of a scenario, and the time that it takes.

use std::path::PathBuf;

use crate::bed;
use crate::bed::library::BedCache;
use crate::bed::recipe::Recipe;
use crate::folder::Folder;
use crate::pace::{Pace, StageKind, gain, of_small};
use crate::scenario::{BedPlan, CheckedScenario, DragPlan};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::format::duration;

/// What has to be done.
#[derive(Default)]
pub(super) struct Work {
    /// Names of the beds that are not at hand.
    pub(super) missing: Vec<String>,
    /// Steps of each pouring.
    pub(super) poured: Vec<u64>,
    /// Steps of each settling under a lid.
    pub(super) covered: Vec<u64>,
    /// Steps of each drag.
    pub(super) dragged: Vec<u64>,
    /// Drags that are done.
    pub(super) done: usize,
    /// How fast stages went so far.
    pub(super) pace: Pace,
}

impl Work {
    /// For a scenario whose beds may be in a library, and which may have been begun in a folder.
    pub(super) fn of(
        scenario: &CheckedScenario,
        library: &BedCache,
        folder: Option<Folder<'_>>,
    ) -> Result<Self> {
        let begun = |folder: &Folder<'_>| {
            let text = disk::read_if_there(&folder.scenario()).ok().flatten();
            text.is_some_and(|text| text == folder.scenario_text(scenario).as_bytes())
        };
        let folder = folder.filter(begun);
        let has = |path: fn(&Folder<'_>, &str) -> PathBuf, name: &str| {
            folder.is_some_and(|folder| disk::is_there(&path(&folder, name)))
        };
        let summary = |folder: &Folder<'_>, run: &str| folder.of_run(run, "summary.json");
        let open = scenario
            .drags()
            .iter()
            .filter(|run| !has(summary, &run.name));
        let mut work = Work {
            dragged: open.map(DragPlan::steps).collect(),
            pace: folder
                .map(|folder| Pace::read(folder.0))
                .unwrap_or_default(),
            ..Work::default()
        };
        work.done = scenario.drags().len() - work.dragged.len();
        if scenario.source.is_none() {
            let absent = |plan: &BedPlan| {
                if has(|folder, bed| folder.bed(bed), &plan.name) {
                    return Ok(false);
                }
                let found = library.find(&Recipe::new(scenario, plan))?;
                Ok::<bool, Error>(found.is_none())
            };
            for plan in scenario.beds() {
                if !absent(plan)? {
                    continue;
                }
                if plan.lid.is_some() {
                    work.covered.push(bed::covering_steps(scenario, plan));
                }
                work.missing.push(plan.name.clone());
            }
            for plan in scenario.bare_beds() {
                if absent(plan)? {
                    work.poured.push(bed::pouring_steps(scenario, plan));
                }
            }
        }
        Ok(work)
    }

    /// Steps that the last of this many threads has done when all is done: of beds, and of drags.
    pub(super) fn longest(&self, threads: usize) -> [u64; 2] {
        let busiest = |jobs: &[u64]| side_by_side(jobs, threads);
        [
            busiest(&self.poured) + busiest(&self.covered),
            busiest(&self.dragged),
        ]
    }

    /// The time that it takes, in words: a range by the speed of the trial, or what the speed so far makes of it.
    pub(super) fn time(&self, grains: usize, threads: usize, trial: f64) -> String {
        let kinds = [StageKind::Pouring, StageKind::Dragging];
        let [pours, drags] = self.longest(threads);
        let [Some(pouring), Some(dragging)] = kinds.map(|kind| self.pace.speed(kind)) else {
            return range(pours + drags, grains, trial);
        };
        // If there are fewer jobs than threads, a job runs on several.
        let gain = |jobs: usize| gain(threads as f64 / jobs.clamp(1, threads) as f64);
        let beds = self.poured.len().max(self.covered.len());
        let pours = pours as f64 * self.pace.of_plan() / pouring / gain(beds);
        let drags = drags as f64 / dragging / gain(self.dragged.len());
        format!(
            "about {}",
            duration(of_small((pours + drags) * grains as f64, grains))
        )
    }
}

/// How much longer than at the speed of the trial a run takes at most: quick took 1 to 2.1 times as long, beds of
/// ten thousand grains and more 1.1 to 1.6.
const SLOWER: f64 = 2.0;

/// The time of this many steps of this many grains, in words.
pub(super) fn range(steps: u64, grains: usize, speed: f64) -> String {
    let least = steps as f64 * grains as f64 / speed;
    format!("{} to {}", duration(least), duration(SLOWER * least))
}

/// Steps that the busiest of `threads` workers does, the longest job first.
pub(crate) fn side_by_side(jobs: &[u64], threads: usize) -> u64 {
    let mut jobs = jobs.to_vec();
    jobs.sort_unstable_by(|a, b| b.cmp(a));
    let mut load = vec![0u64; threads.max(1)];
    for job in jobs {
        if let Some(least) = load.iter_mut().min() {
            *least += job;
        }
    }
    load.into_iter().max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_jobs_are_shared_out_first() {
        assert_eq!(side_by_side(&[3, 5, 4, 2], 2), 7);
        assert_eq!(side_by_side(&[3, 5], 1), 8);
        assert_eq!(side_by_side(&[], 2), 0);
    }
}
