//! What the numbers of a scenario are counted in.

use serde::{Deserialize, Serialize};

/// What one unit of each kind of number stands for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Units {
    /// Lengths.
    pub length: String,
    /// Times.
    pub time: String,
    /// Speeds.
    pub speed: String,
    /// Forces.
    pub force: String,
    /// Torques.
    pub torque: String,
    /// Energies.
    pub energy: String,
}
