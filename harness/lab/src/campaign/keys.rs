//! The keys of a campaign's file, as TOML names them.

use serde::{Deserialize, Serialize};
use toml::Table;

use super::rules::Rule;
use crate::scenario::OneOrMany;

/// A campaign: a base scenario, and grids of values over it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// What the campaign's folder is called.
    pub name: String,
    /// Combinations that keep their value in the base when a grid varies a part of them, unless the grid says
    /// otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keep: Vec<Rule>,
    /// The base: the keys of a scenario, or the name of a shipped one or of a scenario's file.
    pub base: Base,
    /// What is varied: the runs are those of all grids together, each once.
    pub grid: Vec<ParameterGrid>,
}

/// A scenario in the file itself, or by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Base {
    /// Name of a shipped scenario, or path of a file beside the campaign's.
    Named(String),
    /// The keys of a scenario; speeds, depth and diameter may be left to the grids.
    Written(Table),
}

/// Values of the varied quantities: each one with each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterGrid {
    /// Its purpose, in a word or two.
    pub name: String,
    /// Keys of the scenario that are the same in all of it, as `{ "bed.box" = [28.0, 14.0, 26.0] }`.
    #[serde(default, skip_serializing_if = "Table::is_empty")]
    pub set: Table,
    /// Combinations that keep their value in the base, instead of the campaign's `keep`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub keep: Option<Vec<Rule>>,
    /// Stiffness `law.kn`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kn: Option<OneOrMany>,
    /// Damping `law.gamma_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gamma_n: Option<OneOrMany>,
    /// Damping as `gamma_n/kn^0.6`, which fixes the restitution at every speed (Kumar 2018, Fig. 2).
    #[serde(
        rename = "gamma_n/kn^0.6",
        default,
        skip_serializing_if = "Option::is_none"
    )]
    pub damping: Option<OneOrMany>,
    /// Friction coefficient `law.mu`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu: Option<OneOrMany>,
    /// Diameter of the intruder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diameter: Option<OneOrMany>,
    /// Length of a bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<OneOrMany>,
    /// Depth of the intruder's centre below the expected surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<OneOrMany>,
    /// Height of its centre above the floor, instead of `depth`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<OneOrMany>,
    /// Seeds; each pours its own beds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<Vec<u64>>,
    /// Froude numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub froude: Option<OneOrMany>,
    /// Speeds, instead of `froude`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed: Option<OneOrMany>,
    /// Travel: one for all speeds, or one for each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distance: Option<OneOrMany>,
}

/// A varied quantity that makes members: its name in their names, the key that it sets, its values.
pub struct Axis {
    /// Name in the file.
    pub name: &'static str,
    /// What stands before its value in a member's name.
    pub short: &'static str,
    /// The scenario's key that it sets.
    pub key: &'static str,
    /// Values, as TOML writes them.
    pub values: Vec<f64>,
}

impl ParameterGrid {
    /// The varied quantities that make members, in the order of their names; speeds are not among them.
    pub fn axes(&self) -> Vec<Axis> {
        let given = [
            ("kn", "Kn", "law.kn", &self.kn),
            ("gamma_n", "gn", "law.gamma_n", &self.gamma_n),
            ("gamma_n/kn^0.6", "e", "law.gamma_n", &self.damping),
            ("mu", "mu", "law.mu", &self.mu),
            ("diameter", "D", "intruder.diameter", &self.diameter),
            ("length", "L", "intruder.length", &self.length),
            ("depth", "h", "intruder.depth", &self.depth),
            ("height", "z", "intruder.height", &self.height),
        ];
        let mut axes: Vec<Axis> = Vec::new();
        for (name, short, key, values) in given {
            axes.extend(values.as_ref().map(|values| Axis {
                name,
                short,
                key,
                values: values.values(),
            }));
        }
        // Seeds beyond 2^53 are refused when they are read.
        axes.extend(self.seed.as_ref().map(|seeds| Axis {
            name: "seed",
            short: "s",
            key: "seed",
            values: seeds.iter().map(|&seed| seed as f64).collect(),
        }));
        axes
    }
}
