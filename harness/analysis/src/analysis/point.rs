//! What was measured at one speed: of one run, or of several beds together.

use serde::{Deserialize, Serialize};

use super::Value;

/// What the standard error of a drag is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorOf {
    /// That of block averages within the runs.
    Blocks,
    /// The spread of several beds, which is larger.
    Beds,
}

/// One run, or at one speed the runs through several beds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point {
    /// Member and run; of several beds the first.
    pub name: String,
    /// Beds that it is the mean of.
    pub beds: usize,
    /// What the error of the drag is.
    pub error_of: ErrorOf,
    /// Digest of its final state.
    pub digest: String,
    /// Speed V.
    pub speed: f64,
    /// Froude number.
    pub froude: f64,
    /// Depth of the intruder's centre as measured.
    pub depth: f64,
    /// Drag.
    pub drag: Value,
    /// Mean drag with nothing cut, as Kumar 2018 averages (Fig. 4); none if its error is not known.
    pub uncut: Option<Value>,
    /// Mean drag over each mean diameter of travel, from the first, nothing cut.
    pub by_travel: Vec<f64>,
    /// Travel that the averaging window leaves out, in mean diameters.
    pub discard: f64,
    /// Drag over the weight above.
    pub plug_ratio: f64,
    /// Contact angle, over all contacts.
    pub angle: Option<Value>,
    /// The same of contacts as they begin.
    pub new_angle: Option<Value>,
    /// Normalised coordination number, of the grains within 2 d of the intruder.
    pub kappa: Option<Value>,
    /// The same of the grains within other distances.
    pub within: Vec<Within>,
    /// Share of near grains without contacts.
    pub floating: Option<Value>,
    /// Grains that move along.
    pub moving: Option<Value>,
    /// Speed of the layers above over the intruder's.
    pub drift: Option<Value>,
    /// Shares of near grains with 0, 1, 2, ... contacts.
    pub coordination: Vec<f64>,
}

/// What is measured of the grains within a distance of the intruder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Within {
    /// The distance from its surface, in mean diameters.
    pub reach: f64,
    /// Contacts of a grain.
    pub coordination: Value,
    /// Share of the grains without contacts.
    pub floating: Value,
    /// Normalised coordination number.
    pub kappa: Value,
}
