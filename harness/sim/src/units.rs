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

impl Units {
    /// Units of the mean grain diameter d, the grains' density rho and gravity g.
    pub fn reduced() -> Self {
        Self::named([
            "d",
            "sqrt(d/g)",
            "sqrt(g d)",
            "rho d^3 g",
            "rho d^4 g",
            "rho d^4 g",
        ])
    }

    /// SI units.
    pub fn si() -> Self {
        Self::named(["m", "s", "m/s", "N", "N m", "J"])
    }

    fn named(names: [&str; 6]) -> Self {
        let [length, time, speed, force, torque, energy] = names.map(str::to_string);
        Self {
            length,
            time,
            speed,
            force,
            torque,
            energy,
        }
    }
}
