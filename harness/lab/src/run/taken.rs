//! How the stages of a run came to be: executed by a call, taken from the library of beds, or found in the folder.

use std::fmt;

use crate::performance::StagePerformance;
use bitgrain_sim::chain::Chain;

/// What a call did for a bed that it took from the library.
pub(super) const REUSED: &str = "reused";

/// What it did for a stage that was in the folder.
pub(super) const KEPT: &str = "kept";

/// What it did for a stage of which a part was there.
pub(super) const RESUMED: &str = "resumed";

/// A stage of a run and what a call did for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Taken {
    /// Its name.
    pub stage: String,
    /// What was done: poured, reused, kept, resumed and so on.
    pub how: String,
    /// How many of its last steps the call executed.
    pub steps: u64,
}

impl Taken {
    pub(crate) fn new(stage: &str, done: &StagePerformance) -> Self {
        Self {
            stage: stage.into(),
            how: done.how.clone(),
            steps: done.steps,
        }
    }

    /// What was done for a stage; if nothing was, it was there.
    pub(crate) fn of(taken: &[Self], stage: &str) -> Self {
        let of = taken.iter().find(|taken| taken.stage == stage);
        of.cloned().unwrap_or_else(|| Self {
            stage: stage.into(),
            how: KEPT.into(),
            steps: 0,
        })
    }

    /// Whether the call executed it from its beginning; an imported bed has no steps.
    pub fn is_whole(&self) -> bool {
        ![REUSED, KEPT, RESUMED].contains(&&self.how[..])
    }

    /// How many links of its chain came to be in which way. That all were executed does not say that the stage is
    /// confirmed: only one that is [whole](Taken::is_whole) went on from no state that was found.
    pub fn links(&self, chain: &Chain) -> Links {
        let last = chain.links.last().map_or(0, |link| link.step);
        let own =
            |step: u64| self.is_whole() || self.steps > 0 && step > last.saturating_sub(self.steps);
        let executed = chain.links.iter().filter(|link| own(link.step)).count();
        let rest = chain.links.len() - executed;
        let (library, found) = match self.how == REUSED {
            true => (rest, 0),
            false => (0, rest),
        };
        Links {
            executed,
            library,
            found,
        }
    }
}

/// How many links came to be in which way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Links {
    /// Executed by the call.
    pub executed: usize,
    /// Taken from the library of beds.
    pub library: usize,
    /// Found in the folder.
    pub found: usize,
}

impl Links {
    /// All of them.
    pub fn all(&self) -> usize {
        self.executed + self.library + self.found
    }
}

impl std::ops::AddAssign for Links {
    fn add_assign(&mut self, more: Self) {
        self.executed += more.executed;
        self.library += more.library;
        self.found += more.found;
    }
}

impl fmt::Display for Links {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "of {} links {} were executed by this call, {} taken from the library of beds, {} found in the folder",
            self.all(),
            self.executed,
            self.library,
            self.found
        )
    }
}
