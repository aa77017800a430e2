//! The frames of a drag before they are written, one file for each checkpoint that is kept. In between they
//! are stored in the checkpoint that the drag is saved in, so that a drag that is stopped writes the same.

use super::task::DragTask;
use crate::drag::Dragging;
use crate::frames;
use bitgrain_sim::checkpoint::StageState;
use bitgrain_sim::simulation::Simulation;

/// Frames since the last checkpoint that was kept.
pub struct Frames {
    rows: String,
    wanted: bool,
    /// Whether none of them is missing.
    whole: bool,
}

impl Frames {
    /// Those of a drag that begins or goes on, if they are `wanted`. If a drag was saved without them, none
    /// are written up to its next kept checkpoint.
    pub fn go_on(drag: DragTask<'_>, wanted: bool, dragging: &mut Dragging) -> Self {
        let rows = std::mem::take(&mut dragging.frames);
        let (plan, at) = (drag.plan, dragging.step);
        let kept = plan.checkpoints.iter().rev().find(|n| **n <= at);
        let from = kept.copied().unwrap_or(0);
        let due = plan.frames.iter().filter(|n| (from + 1..=at).contains(*n));
        let whole = wanted && due.eq(&frames::steps(&rows));
        Self {
            rows,
            wanted,
            whole,
        }
    }

    /// Whether the state after this step is one of them.
    pub fn wants(&self, drag: DragTask<'_>, step: u64) -> bool {
        self.whole && drag.films(step)
    }

    /// Adds the state after this step.
    pub fn add(&mut self, drag: DragTask<'_>, step: u64, sim: &Simulation) {
        self.rows += &frames::rows(sim, &drag.plan.motion, step);
    }

    /// What is saved of a drag, with these frames.
    pub fn note(&self, note: StageState) -> StageState {
        StageState {
            frames: if self.whole {
                self.rows.clone()
            } else {
                String::new()
            },
            ..note
        }
    }

    /// The text of their file at a checkpoint that is kept, and none are left; `None` if there are none.
    pub fn take(&mut self) -> Option<String> {
        let rows = std::mem::take(&mut self.rows);
        let whole = std::mem::replace(&mut self.whole, self.wanted);
        (whole && !rows.is_empty()).then(|| frames::text(&rows))
    }
}
