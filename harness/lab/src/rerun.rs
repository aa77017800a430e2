//! A run done again, whole or in part, from what its folder holds: every checkpoint that was kept is a
//! place to begin from.

use crate::drag::Dragging;
use crate::folder::Folder;
use crate::progress::{Progress, Stage};
use crate::run::{self, DragTask, surveyed};
use crate::scenario::{BedPlan, CheckedScenario, DragPlan};
use crate::summary::BedSummary;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;

/// A run directory and what its scenario plans.
pub struct RunArchive<'a> {
    /// Where it is.
    pub folder: &'a Folder<'a>,
    /// The scenario.
    pub scenario: CheckedScenario,
}

/// A stage of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunPart<'a> {
    /// A bed, from release to rest.
    Bed(&'a BedPlan),
    /// A drag.
    Drag(&'a DragPlan),
}

impl RunPart<'_> {
    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            RunPart::Bed(plan) => &plan.name,
            RunPart::Drag(plan) => &plan.name,
        }
    }
}

impl<'a> RunArchive<'a> {
    /// What a folder holds.
    ///
    /// # Errors
    /// As [`Folder::saved_scenario`].
    pub fn open(folder: &'a Folder<'a>) -> Result<Self> {
        let scenario = folder.saved_scenario()?;
        Ok(Self { folder, scenario })
    }

    /// All stages, in the order in which they are run.
    pub fn parts(&self) -> impl Iterator<Item = RunPart<'_>> {
        let beds = self.scenario.all_beds().into_iter().map(RunPart::Bed);
        beds.chain(self.scenario.drags().iter().map(RunPart::Drag))
    }

    /// The stage of this name.
    ///
    /// # Errors
    /// [`Error::Input`] with the names that there are.
    pub fn part(&self, name: &str) -> Result<RunPart<'_>> {
        let mut parts = self.parts();
        parts.find(|part| part.name() == name).ok_or_else(|| {
            let problem = format!("is not a stage of this run; there are {}", self.names());
            Error::input(name, problem)
        })
    }

    /// Names of all stages, to be read.
    pub fn names(&self) -> String {
        let names: Vec<String> = self.parts().map(|part| part.name().to_string()).collect();
        names.join(", ")
    }

    /// What was measured of the settled bed of a drag.
    ///
    /// # Errors
    /// If its checkpoint cannot be read.
    pub fn bed_of(&self, run: &DragPlan) -> Result<BedSummary> {
        self.bed(&self.scenario.beds()[run.bed])
    }

    /// What was measured of a settled bed.
    ///
    /// # Errors
    /// If its checkpoint cannot be read.
    pub fn bed(&self, plan: &BedPlan) -> Result<BedSummary> {
        let (mut sim, note) = self.folder.state(&self.folder.bed(&plan.name))?;
        surveyed(&self.scenario, plan, &mut sim, &note)
    }

    /// A drag with its bed.
    pub fn drag<'b>(&'b self, plan: &'b DragPlan, bed: &'b BedSummary) -> DragTask<'b> {
        DragTask {
            folder: self.folder,
            scenario: &self.scenario,
            plan,
            bed,
        }
    }

    /// The state of a drag at a step: 0, or one of those that were kept.
    ///
    /// # Errors
    /// If the checkpoint cannot be read or is another drag's.
    pub fn state(&self, drag: DragTask<'_>, step: u64) -> Result<(Simulation, Dragging)> {
        if step == 0 {
            return run::begin(drag);
        }
        let path = self.folder.checkpoint(&drag.plan.name, step);
        run::read(drag, &path, Some(step))
    }

    /// The last step at or before this one at which the state of a drag was kept.
    pub fn kept_before(&self, plan: &DragPlan, step: u64) -> u64 {
        let kept = plan.checkpoints.iter().rev().copied();
        let mut kept = kept.filter(|&n| n <= step);
        let is_there = |&n: &u64| disk::is_there(&self.folder.checkpoint(&plan.name, n));
        kept.find(is_there).unwrap_or(0)
    }

    /// Runs a stage again from the last kept state at or before `from` until `observer` has seen enough.
    ///
    /// # Errors
    /// A fault of the run, and what `observer` returns.
    pub fn rerun(
        &self,
        part: RunPart<'_>,
        from: u64,
        progress: &Progress,
        observer: &mut impl Observer,
    ) -> Result<()> {
        let mut stage: Stage = progress.stage(part.name(), from);
        match part {
            RunPart::Bed(plan) => {
                let mut bed = run::begin_bed(self.folder, &self.scenario, plan)?;
                bed.go_on(&self.scenario, plan, &mut stage, observer)?;
            }
            RunPart::Drag(plan) => {
                let bed = self.bed_of(plan)?;
                let drag = self.drag(plan, &bed);
                let (mut sim, mut dragging) = self.state(drag, self.kept_before(plan, from))?;
                stage.resume(dragging.step);
                dragging.go_on(&mut sim, plan, &stage, observer)?;
            }
        }
        Ok(())
    }
}
