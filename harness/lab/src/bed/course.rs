//! What one look at a bed that settles hands to the next.

use serde::{Deserialize, Serialize};

use super::recipe::Recipe;
use bitgrain_sim::chain::Chain;
use bitgrain_sim::checkpoint::StageState;
use bitgrain_sim::simulation::Simulation;

/// The phase that a bed is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// Grains fall, all of them or those below the intruder.
    Fall,
    /// The others fall, over the intruder.
    Fill,
    /// The remaining motion is damped out with more damping.
    Quench,
    /// The bed rests under its own law.
    Rest,
    /// It is settled.
    Settled,
}

/// All that one look at a bed hands to the next besides the state itself.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PouringState {
    /// Digest of the bed's recipe; empty for an imported bed.
    pub(super) key: String,
    pub(super) phase: Phase,
    /// Step at which the phase began.
    pub(super) begin: u64,
    /// Upward force on the intruder at the look before.
    pub(super) before: f64,
    /// Height that the grains fall from.
    pub(super) top: f64,
    /// Digests of its states.
    pub(super) chain: Chain,
}

/// A bed in progress.
pub struct Pouring {
    /// The state.
    pub sim: Simulation,
    /// What belongs to it.
    pub course: PouringState,
}

impl PouringState {
    /// What a checkpoint holds of it. Only that of a settled bed has its recipe's digest.
    pub fn note(&self) -> StageState {
        let settled = self.phase == Phase::Settled;
        StageState {
            recipe: if settled {
                self.key.clone()
            } else {
                String::new()
            },
            link: self.chain.end().to_string(),
            course: serde_json::to_string(self).expect("what is measured is finite"),
            ..StageState::default()
        }
    }

    /// Reads it from a checkpoint's note.
    ///
    /// # Errors
    /// What is wrong with the note.
    pub fn of(note: &StageState) -> std::result::Result<Self, String> {
        let read: Self =
            serde_json::from_str(&note.course).map_err(|e| format!("holds no bed: {e}"))?;
        if read.chain.end() == note.link {
            Ok(read)
        } else {
            Err("does not hold the bed that its chain of digests is of".into())
        }
    }

    /// Whether the bed is in this phase.
    pub fn is_in(&self, phase: Phase) -> bool {
        self.phase == phase
    }

    /// Whether this is a bed by that recipe.
    pub fn is_by(&self, recipe: &Recipe) -> bool {
        self.key == recipe.digest()
    }

    /// Digests of its states.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }
}
