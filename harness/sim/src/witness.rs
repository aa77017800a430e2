//! Who looks on while a stage runs, keeps its states, checks them or prints them: whatever it does, no
//! bit of the stage changes.

use bitgrain_kernel::ContactForce;

use crate::chain::Link;
use crate::checkpoint::Note;
use crate::error::Result;
use crate::sim::Sim;

/// Looks on while a stage runs. Steps are the stage's own: of a drag from 0, of a bed from the first
/// grain's release.
pub trait Witness {
    /// The state that the stage begins or goes on from.
    ///
    /// # Errors
    /// What stops the stage.
    fn begins(&mut self, _step: u64, _sim: &mut Sim) -> Result<()> {
        Ok(())
    }

    /// Whether the state and the contacts after this step are wanted.
    fn looks_at(&self, _step: u64) -> bool {
        false
    }

    /// The state after a step that is looked at, and its touching contacts.
    ///
    /// # Errors
    /// What stops the stage.
    fn look(&mut self, _step: u64, _sim: &mut Sim, _contacts: &[ContactForce<f64>]) -> Result<()> {
        Ok(())
    }

    /// A link of the stage's chain, as it is made.
    ///
    /// # Errors
    /// What stops the stage.
    fn linked(&mut self, _link: &Link) -> Result<()> {
        Ok(())
    }

    /// A moment at which the stage could be saved: `note` makes what goes into the checkpoint besides the
    /// state.
    ///
    /// # Errors
    /// What stops the stage.
    fn pause(&mut self, _step: u64, _sim: &mut Sim, _note: &dyn Fn() -> Note) -> Result<()> {
        Ok(())
    }

    /// The step after which the witness has seen enough.
    fn ends(&self) -> u64 {
        u64::MAX
    }
}

/// Nobody looks on.
impl Witness for () {}
