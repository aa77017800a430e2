//! How fast stages went on this machine.

use crate::progress::Stage;
use bitgrain_sim::simulation::Simulation;
use serde::Serialize;

/// Timings and other facts of the machine, kept apart from the results.
#[derive(Serialize)]
pub(super) struct Performance {
    pub(super) bits_version: u32,
    pub(super) threads: usize,
    pub(super) seconds: f64,
    pub(super) stages: Vec<StagePerformance>,
}

/// How one stage went on this machine.
#[derive(Serialize)]
pub struct StagePerformance {
    pub(super) stage: String,
    /// What was done: poured, reused, imported, dragged.
    pub(super) how: String,
    pub(super) seconds: f64,
    pub(super) steps: u64,
    pub(super) grain_steps_per_s: f64,
    pub(super) searches: u64,
    pub(super) pairs_listed: usize,
}

pub(super) fn timed(stage: Stage, how: &str, sim: &Simulation, steps: u64) -> StagePerformance {
    let (name, seconds) = (stage.name().to_string(), stage.finish());
    let (searches, pairs_listed, _) = sim.list_counts();
    StagePerformance {
        stage: name,
        how: how.to_string(),
        seconds,
        steps,
        grain_steps_per_s: steps as f64 * sim.count() as f64 / seconds,
        searches,
        pairs_listed,
    }
}
