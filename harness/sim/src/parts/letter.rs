//! What a part tells the others at the end of each leg of its way.

use bitgrain_kernel::Error as KernelError;
use bitgrain_kernel::Row;
use bitgrain_kernel::parts::GhostMotion;
use bitgrain_kernel::phases::{Extent, ForceCheck, MotionCheck};
use serde::{Deserialize, Serialize};

use super::share::Share;

/// A grain that a part offers to another one as a ghost.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Offer {
    /// Its place in the whole world.
    pub home: u32,
    pub id: u32,
    pub group: u8,
    /// Of position, velocity and spin.
    pub rows: [Row<f64>; 3],
}

/// What forces and motion found.
#[derive(Clone, Copy, Serialize, Deserialize)]
pub(super) struct Found {
    pub forces: ForceCheck,
    pub motion: MotionCheck<f64>,
    /// A fault of one part alone: of its storage, or of the arithmetic of its thread.
    pub alone: Option<KernelError>,
}

impl Found {
    pub const NOTHING: Self = Self {
        forces: ForceCheck::NONE,
        motion: MotionCheck::NONE,
        alone: None,
    };

    pub fn and(self, other: Self) -> Self {
        Self {
            forces: self.forces.and(other.forces),
            motion: self.motion.and(other.motion),
            alone: self.alone.or(other.alone),
        }
    }
}

/// What a letter is about; the rest of it is that of an earlier one.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Told {
    /// What was found, and where grains are now.
    Found,
    /// How far the part reaches, and what it cost.
    Extent,
    /// Which grains may be ghosts.
    Offers,
}

/// A letter. Lists for each receiver are written over those of an earlier letter.
pub(super) struct Letter {
    pub told: Told,
    pub found: Found,
    /// Skin and reach, which are those of the first part for all.
    pub skins: [f64; 2],
    /// Where the grains that are ghosts of another part are now, for each.
    pub rows: Vec<Vec<GhostMotion<f64>>>,
    /// What own grains take from obstacles that move freely, whose sums all parts need.
    pub pushes: Vec<Share>,
    /// Before a search.
    pub extent: Option<Extent<f64>>,
    /// Seconds of work since the last cut.
    pub busy: f64,
    /// Grains that the part owns.
    pub grains: usize,
    /// Own grains that may come near another part, for each.
    pub offers: Vec<Vec<Offer>>,
}

impl Default for Letter {
    fn default() -> Self {
        Self {
            told: Told::Found,
            found: Found::NOTHING,
            skins: [0.0; 2],
            rows: Vec::new(),
            pushes: Vec::new(),
            extent: None,
            busy: 0.0,
            grains: 0,
            offers: Vec::new(),
        }
    }
}
