//! Observers watch a stage while it runs, keep its states, check them or print them: whatever they do, no
//! bit of the stage changes.

use bitgrain_kernel::ContactForce;

use crate::chain::Link;
use crate::checkpoint::StageState;
use crate::error::Result;
use crate::simulation::Simulation;

/// Watches a stage while it runs. Steps are the stage's own: of a drag from 0, of a bed from the first
/// grain's release.
pub trait Observer {
    /// The state that the stage begins or goes on from.
    ///
    /// # Errors
    /// What stops the stage.
    fn on_start(&mut self, _step: u64, _sim: &mut Simulation) -> Result<()> {
        Ok(())
    }

    /// Whether the state after this step is wanted.
    fn wants_step(&self, _step: u64) -> bool {
        false
    }

    /// Whether the touching contacts of a step that is wanted are wanted too: it is slower to show them.
    fn wants_contacts(&self, step: u64) -> bool {
        self.wants_step(step)
    }

    /// The state after a step that is looked at, and its touching contacts if they are wanted.
    ///
    /// # Errors
    /// What stops the stage.
    fn on_step(
        &mut self,
        _step: u64,
        _sim: &mut Simulation,
        _contacts: &[ContactForce<f64>],
    ) -> Result<()> {
        Ok(())
    }

    /// A link of the stage's chain, as it is made.
    ///
    /// # Errors
    /// What stops the stage.
    fn on_digest(&mut self, _link: &Link) -> Result<()> {
        Ok(())
    }

    /// Whether the stage must be offered to be saved after this very step, and not only every now and then.
    fn wants_checkpoint(&self, _step: u64) -> bool {
        false
    }

    /// A moment at which the stage could be saved: `note` makes what goes into the checkpoint besides the
    /// state.
    ///
    /// # Errors
    /// What stops the stage.
    fn on_checkpoint(
        &mut self,
        _step: u64,
        _sim: &mut Simulation,
        _note: &dyn Fn() -> StageState,
    ) -> Result<()> {
        Ok(())
    }

    /// The step after which the observer has seen enough.
    fn last_step(&self) -> u64 {
        u64::MAX
    }
}

/// No observer.
impl Observer for () {}
