//! How a scenario is run.

use crate::bed::library::BedCache;
use crate::folder::Folder;
use crate::progress::Progress;
use crate::run::SaveEvery;
use crate::scenario::CheckedScenario;
use bitgrain_sim::error::Result;

/// How a scenario is run; none of it changes a result.
#[derive(Clone, Copy)]
pub struct Setting<'a> {
    /// What is run.
    pub scenario: &'a CheckedScenario,
    /// The run directory.
    pub folder: &'a Folder<'a>,
    /// The settled beds that runs share.
    pub library: &'a BedCache,
    /// Threads.
    pub threads: usize,
    /// How often an unfinished stage is saved.
    pub save: SaveEvery,
    /// Whether frames of the drags are written, for a moving picture.
    pub frames: bool,
    /// Names of the drags to do, with their beds; all if there is none.
    pub only: &'a [String],
    /// Writes the report of a run whose stages are all done: pages are drawn above this layer.
    pub write_report: WriteReport,
    /// Bars, lines and the request to stop.
    pub progress: &'a Progress,
}

/// Writes the report of a run directory.
pub type WriteReport = fn(&Folder<'_>) -> Result<()>;
