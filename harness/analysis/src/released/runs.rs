//! The runs whose intruders forces moved.

use bitgrain_lab::scenario::{DragPlan, Release};
use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::{DragSummary, Released, Summary};

/// A run whose intruder forces moved.
#[derive(Clone, Copy, Debug)]
pub struct FreeRun<'a> {
    /// Its numbers.
    pub run: &'a DragSummary,
    /// The way of the intruder.
    pub released: &'a Released,
    /// How it was set going.
    pub release: Release,
    /// The rows of its series; none if they were not read.
    pub rows: &'a [SeriesRow],
}

/// The runs whose intruder forces moved, in the order of the summary; `series` has the rows of its runs.
pub fn free_runs<'a>(summary: &'a Summary, series: &'a [Vec<SeriesRow>]) -> Vec<FreeRun<'a>> {
    let plans = summary.inputs.drags();
    let plan = |run: &DragSummary| plans.iter().find(|plan| plan.name == run.name);
    let free = |(k, run): (usize, &'a DragSummary)| {
        let plan: &DragPlan = plan(run)?;
        Some(FreeRun {
            run,
            released: run.released.as_ref()?,
            release: plan.release,
            rows: series.get(k).map_or(&[], Vec::as_slice),
        })
    };
    summary.runs.iter().enumerate().filter_map(free).collect()
}
