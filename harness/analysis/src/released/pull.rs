//! Spheres that a constant force pulled: which of them stop and which run, and the force between.

use super::runs::FreeRun;
use bitgrain_lab::scenario::Release;
use bitgrain_lab::summary::{DragSummary, Summary};

/// Travel in mean diameters that tells creeping, yielding and running apart: one grain.
const GRAIN: f64 = 1.0;

/// How a sphere answers a constant force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// In all its time it went less than a grain's diameter.
    Creeping,
    /// It went further, but in the second half of its time less than that.
    Yielding,
    /// In the second half of its time it went a grain's diameter or more.
    Running,
}

impl Regime {
    /// In a word.
    pub fn word(self) -> &'static str {
        match self {
            Regime::Creeping => "creeping",
            Regime::Yielding => "yielding",
            Regime::Running => "running",
        }
    }
}

/// A pull.
#[derive(Clone, Debug, PartialEq)]
pub struct Pull {
    /// Name of its run.
    pub name: String,
    /// The force.
    pub force: f64,
    /// Travel in all.
    pub travel: f64,
    /// Travel in the second half of its time.
    pub late: f64,
    /// Mean speed in that.
    pub speed: f64,
    /// What that makes it.
    pub regime: Regime,
    /// Whether it went on beyond the length of the box, into its own wake.
    pub wake: bool,
}

/// The pulls of a run directory, by their force.
pub fn pulls(summary: &Summary, runs: &[FreeRun<'_>]) -> Vec<Pull> {
    let d = summary.inputs.mean_diameter();
    let pull = |free: &FreeRun<'_>| {
        let Release::Pulled { force, .. } = free.release else {
            return None;
        };
        let (travel, late) = (
            free.run.distance,
            free.run.window_end - free.run.window_start,
        );
        Some(Pull {
            name: free.run.name.clone(),
            force,
            travel,
            late,
            speed: free.run.speed,
            regime: match (travel.abs() < GRAIN * d, late.abs() < GRAIN * d) {
                (true, _) => Regime::Creeping,
                (false, true) => Regime::Yielding,
                (false, false) => Regime::Running,
            },
            wake: travel > summary.inputs.bed.size[0] - free.run.diameter,
        })
    };
    let mut all: Vec<Pull> = runs.iter().filter_map(pull).collect();
    all.sort_by(|a, b| a.force.total_cmp(&b.force));
    all
}

/// The largest force up to which all pulls creep, and the least of those that run; `None` without either.
pub fn bracket(pulls: &[Pull]) -> Option<[f64; 2]> {
    let creeping = pulls
        .iter()
        .take_while(|pull| pull.regime == Regime::Creeping);
    let least = creeping.last()?.force;
    let mut running = pulls.iter().filter(|pull| pull.regime == Regime::Running);
    Some([least, running.next()?.force])
}

/// The slowest drag at constant speed beside pulls, whose force is the yield force by speed.
pub fn slowest(summary: &Summary) -> Option<&DragSummary> {
    let held = summary.runs.iter().filter(|run| run.released.is_none());
    held.min_by(|a, b| a.speed.total_cmp(&b.speed))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_yield_force_lies_between_what_creeps_and_what_runs() {
        use Regime::{Creeping, Running, Yielding};
        let pull = |(force, regime): (f64, Regime)| Pull {
            name: "run".into(),
            force,
            travel: 0.0,
            late: 0.0,
            speed: 0.0,
            regime,
            wake: false,
        };
        let of =
            |all: &[(f64, Regime)]| bracket(&all.iter().copied().map(pull).collect::<Vec<_>>());
        let all = [
            (20.0, Creeping),
            (40.0, Creeping),
            (60.0, Yielding),
            (80.0, Running),
            (90.0, Yielding),
        ];
        assert_eq!(of(&all), Some([40.0, 80.0]));
        assert_eq!(of(&all[..3]), None);
        assert_eq!(of(&all[2..]), None);
    }
}
