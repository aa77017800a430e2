//! What the file of a case says.

use crate::case::{CaseLaw, MotionSpec, ObstacleSpec};
use serde::{Deserialize, Serialize};

/// A case as its file spells it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Contact law.
    pub law: CaseLaw,
    /// The box; open space if it is missing.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub bounds: Option<BoxSpec>,
    /// Acceleration of gravity on free grains.
    #[serde(default)]
    pub gravity: [f64; 3],
    /// Time step.
    pub dt: f64,
    /// Obstacles, numbered from 0 in this order.
    #[serde(default)]
    pub obstacles: Vec<ObstacleSpec>,
    /// Grains, in any order.
    pub grains: Vec<GrainSpec>,
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Lower edges.
    pub lo: [f64; 3],
    /// Upper edges.
    pub hi: [f64; 3],
    /// Which axes are periodic.
    pub periodic: [bool; 3],
}

/// A grain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GrainSpec {
    /// Name, from 1.
    pub id: u32,
    /// Diameter.
    pub diameter: f64,
    /// Mass density.
    pub density: f64,
    /// Position of the centre.
    pub position: [f64; 3],
    /// Velocity.
    #[serde(default)]
    pub velocity: [f64; 3],
    /// Spin.
    #[serde(default)]
    pub spin: [f64; 3],
    /// How it moves.
    #[serde(default)]
    pub motion: MotionSpec,
    /// Name of its material, if the law has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
}
