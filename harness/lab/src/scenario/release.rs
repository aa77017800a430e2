//! What moves the intruder of a scenario, and how that of one drag is set going.

use serde::{Deserialize, Serialize};

/// What moves an intruder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IntruderMotion {
    /// The host, at constant speed along x.
    #[default]
    Dragged,
    /// Its weight, free in all six degrees of freedom, from above the bed.
    Dropped,
    /// A constant force along x.
    Pulled,
    /// The host at constant speed along x, and along z the bed and its weight.
    Floating,
}

/// How the intruder of one drag is set going.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Release {
    /// At constant speed along x, held along y and z.
    Dragged,
    /// At constant speed along x, free along z.
    Floating {
        /// Whether it spins freely.
        spins: bool,
    },
    /// From above the bed, with the energy of a fall from rest.
    Dropped {
        /// Height of its lowest point above the free surface at the beginning of the fall (length).
        height: f64,
    },
    /// Pulled by a constant force.
    Pulled {
        /// Along x (force).
        force: f64,
        /// Whether it is free along z too.
        rises: bool,
        /// Whether it spins freely.
        spins: bool,
    },
}

impl Release {
    /// Whether forces move it: its way is measured, not planned.
    pub fn is_free(self) -> bool {
        self != Release::Dragged
    }

    /// Whether it ends after a time, since its travel is not known before.
    pub fn is_timed(self) -> bool {
        matches!(self, Release::Dropped { .. } | Release::Pulled { .. })
    }

    /// Whether it answers torques.
    pub fn spins(self) -> bool {
        match self {
            Release::Dragged => false,
            Release::Dropped { .. } => true,
            Release::Floating { spins } | Release::Pulled { spins, .. } => spins,
        }
    }

    /// Whose speed it is that a plan has of it.
    pub(super) fn whose(self) -> &'static str {
        match self {
            Release::Dragged | Release::Floating { .. } => "the drag",
            Release::Dropped { .. } => "the fall",
            Release::Pulled { .. } => "sqrt(g d)",
        }
    }
}
