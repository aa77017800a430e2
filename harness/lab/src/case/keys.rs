//! What the file of a case says.

use crate::case::{CaseLaw, MotionSpec, ObstacleSpec};
use bitgrain_sim::law::{WrongKey, material_number};
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

impl Case {
    /// Numbers of the materials of all grains, and of all obstacles.
    ///
    /// # Errors
    /// The key with a name that the law does not have, or without one.
    pub(super) fn materials(&self) -> Result<[Vec<u8>; 2], WrongKey> {
        let names = self.law.names();
        let grains = self.grains.iter().map(|g| &g.material);
        let obstacles = self.obstacles.iter().map(|o| &o.material);
        Ok([
            numbers(&names, "grains", grains)?,
            numbers(&names, "obstacles", obstacles)?,
        ])
    }
}

fn numbers<'a>(
    names: &[&str],
    list: &str,
    given: impl Iterator<Item = &'a Option<String>>,
) -> Result<Vec<u8>, WrongKey> {
    let number = |(k, name): (usize, &Option<String>)| {
        let number = material_number(names, name.as_deref());
        number.map_err(|problem| (format!("{list}[{k}].material"), problem))
    };
    given.enumerate().map(number).collect()
}
