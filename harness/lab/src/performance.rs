//! How fast stages went on this machine.

use crate::pace::Pace;
use crate::progress::Stage;
use bitgrain_sim::simulation::Simulation;
use serde::Serialize;

/// Timings and other facts of the machine, kept apart from the results.
#[derive(Serialize)]
pub struct Performance {
    /// Which arithmetic.
    pub bits_version: u32,
    /// Threads.
    pub threads: usize,
    /// Wall-clock time of all (s).
    pub seconds: f64,
    /// Its parts.
    pub stages: Vec<StagePerformance>,
    /// All that was done in the folder, in all its runs: what a forecast of the rest learns from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
}

/// How one stage went on this machine.
#[derive(Clone, Debug, Serialize)]
pub struct StagePerformance {
    /// Its name.
    pub stage: String,
    /// What was done: poured, covered, imported, dragged, resumed, kept (it was there), reused (from the library).
    pub how: String,
    /// Wall-clock time (s).
    pub seconds: f64,
    /// Steps.
    pub steps: u64,
    /// Grains times steps in a second.
    pub grain_steps_per_s: f64,
    /// Searches for pairs.
    pub searches: u64,
    /// Pairs listed at its end.
    pub pairs_listed: usize,
}

/// What came of a stage that did so many steps.
pub fn timed(stage: Stage, how: &str, sim: &Simulation, steps: u64) -> StagePerformance {
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
