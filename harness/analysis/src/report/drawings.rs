//! What a page draws besides the numbers of a summary.

use super::course::FlowSeries;
use super::tank_charts::TankSeries;
use crate::report::BedPicture;
use crate::report::FieldPicture;
use crate::report::Film;
use crate::report::FlowPicture;
use crate::report::Scene;
use bitgrain_lab::series::SeriesRow;

/// What a page draws beside the numbers of a summary; if one is missing, the page says so.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drawings<'a> {
    /// Closing hash of the run; empty before its end.
    pub closing: &'a str,
    /// Force series, in the order of the runs of the summary.
    pub series: &'a [Vec<SeriesRow>],
    /// Settled beds, in the order of the summary's.
    pub beds: &'a [BedPicture],
    /// Last states of runs whose intruders forces move.
    pub ends: &'a [BedPicture],
    /// Grains round the intruder of the runs they name.
    pub flows: &'a [FlowPicture],
    /// Frames of the runs they name.
    pub films: &'a [Film],
    /// Tables of tanks, in the order of the runs.
    pub tanks: &'a [TankSeries],
    /// Flow series, in the order of the runs.
    pub courses: &'a [FlowSeries],
    /// Fields of the runs they name.
    pub maps: &'a [FieldPicture],
    /// The last snapshot of the last run.
    pub scene: Option<&'a Scene>,
}
