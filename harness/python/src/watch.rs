//! A look at the time step now and then: whether it resolves the waves and the collisions of a world.

use crate::simulated::Core;

/// Steps between two looks.
pub const LOOK: u64 = 1000;

/// What is known of a world's time step.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepWatch {
    /// Whether one that is too long is refused.
    pub strict: bool,
    /// Whether its user was told.
    pub told: bool,
    /// The step of the last look; none since the world was changed.
    pub looked: Option<u64>,
}

impl Core {
    /// What is wrong with the time step, if nobody was told yet and it is time to look.
    pub fn long_step(&mut self) -> Option<String> {
        let now = self.sim.step_count();
        let is_due = |last: u64| now >= last.saturating_add(LOOK);
        if self.watch.told && !self.watch.strict || !self.watch.looked.is_none_or(is_due) {
            return None;
        }
        let times = self.sim.shortest_times();
        let problem = self.sim.long_step(&times);
        self.watch.told = problem.is_some();
        // What is refused is looked at again.
        self.watch.looked = problem.is_none().then_some(now);
        problem
    }
}
