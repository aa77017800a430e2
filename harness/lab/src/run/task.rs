//! A drag with all that belongs to it.

use crate::folder::Folder;
use crate::scenario::{CheckedScenario, DragPlan};
use crate::summary::BedSummary;

/// One drag: its place and what it is.
#[derive(Clone, Copy)]
pub struct DragTask<'a> {
    /// The run directory.
    pub folder: &'a Folder<'a>,
    /// The scenario.
    pub scenario: &'a CheckedScenario,
    /// The drag.
    pub plan: &'a DragPlan,
    /// Its settled bed.
    pub bed: &'a BedSummary,
}
