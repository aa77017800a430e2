//! The drags of a campaign, one by one.

use crate::campaign::columns::Status;
use crate::campaign::only::Only;
use crate::campaign::plan::{Member, Plan};
use crate::scenario::DragPlan;
use bitgrain_sim::error::{Error, Result};

/// The outcome of a drag: nothing yet, or its end.
pub(super) type Slot = Option<Status>;

/// One drag of one member.
pub(super) struct Job {
    pub(super) member: usize,
    pub(super) plan: DragPlan,
    pub(super) work: u64,
    pub(super) wanted: bool,
}

impl Job {
    /// Whether it is still to be done.
    pub(super) fn open(&self, slot: &Slot) -> bool {
        self.wanted && slot.is_none()
    }
}

/// All drags, and which of them are wanted.
pub(super) fn jobs(plan: &Plan, only: &Only) -> Vec<Job> {
    let mut jobs = Vec::new();
    for (member, Member { name, scenario }) in plan.members.iter().enumerate() {
        let beds = scenario.beds();
        for plan in scenario.drags() {
            let grains = scenario.grain_count(beds[plan.bed].diameter) as u64;
            jobs.push(Job {
                member,
                work: plan.steps().saturating_mul(grains),
                wanted: only.wants(name, &plan.name),
                plan: plan.clone(),
            });
        }
    }
    jobs
}

/// All results, or what stopped the first of them; an interruption only if nothing else did.
pub(super) fn first_cause<T>(results: Vec<Result<T>>) -> Result<Vec<T>> {
    let (mut given, mut interrupted) = (Vec::with_capacity(results.len()), None);
    for result in results {
        match result {
            Ok(value) => given.push(value),
            Err(error @ Error::Interrupted { .. }) => interrupted = Some(error),
            Err(error) => return Err(error),
        }
    }
    interrupted.map_or(Ok(given), Err)
}
