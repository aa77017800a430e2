//! What the runs of a campaign say together (Kumar 2018, section III): regimes of the drag, what goes on
//! round the intruder, yield forces and how they scale.
//!
//! Everything is a pure function of the campaign's table, and every fit says how good it is or why there is
//! none.

mod around;
mod curves;
mod exponents;
mod scaling;
mod speeds;
mod stiffness;
#[cfg(test)]
mod tests;
mod value;
mod words;
mod yields;

pub use around::{Around, Contacts, Floating, Offset};
pub use curves::{Curve, Material, Point};
pub use exponents::Scaled;
pub(crate) use exponents::near;
pub use scaling::{AtSpeed, Collapse, Exponent, Scaling, Spread};
pub use speeds::{Flatness, Pooled, Speeds};
pub use stiffness::{Level, Stiffness};
pub use value::Value;
pub use words::words;
pub(crate) use words::{grains, intruder, material};
pub use yields::{Method, Yield};

use serde::{Deserialize, Serialize};

use crate::campaign::table::Table;
use crate::fit::Refusal;
use crate::format::round10;

/// What was found, or why it was not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding<T> {
    /// What was found.
    Found(T),
    /// Why the data cannot carry it.
    Refused(Refusal),
}

impl<T> Finding<T> {
    /// What was found, if it was.
    pub fn found(&self) -> Option<&T> {
        match self {
            Finding::Found(found) => Some(found),
            Finding::Refused(_) => None,
        }
    }

    /// Refused by a sentence.
    pub fn refused(why: impl Into<String>) -> Self {
        Finding::Refused(Refusal(why.into()))
    }
}

impl<T> From<Result<T, Refusal>> for Finding<T> {
    fn from(found: Result<T, Refusal>) -> Self {
        found.map_or_else(Finding::Refused, Finding::Found)
    }
}

/// Everything that the table says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Analysis {
    /// Rows of the table.
    pub rows: usize,
    /// Rows that failed.
    pub failed: usize,
    /// Rows whose bed slid along as a plug.
    pub sliding: usize,
    /// Whether these count all the same.
    pub plugs: bool,
    /// Drag against speed: intruder, depth and grains the same.
    pub curves: Vec<Curve>,
    /// Regimes of each curve.
    pub speeds: Vec<Speeds>,
    /// Regimes of all curves of a material together, each over its yield force.
    pub pooled: Vec<Pooled>,
    /// Contact angle, coordination, grains without contacts, by material.
    pub around: Vec<Around>,
    /// The yield force of each curve.
    pub yields: Vec<Yield>,
    /// How yield and drag scale with size and depth, by material.
    pub scaling: Vec<Scaling>,
    /// The same intruder in grains of other stiffness or damping.
    pub stiffness: Vec<Stiffness>,
}

/// Analyses a table. Runs whose bed slid along as a plug are left out unless `plugs`.
pub fn analyse(table: &Table, plugs: bool) -> Analysis {
    let read = curves::read(table, plugs);
    let curves = read.curves;
    let yields: Vec<Yield> = curves.iter().map(yields::yield_of).collect();
    let materials = curves::materials(&curves);
    let of = |material: &Material| -> Vec<(&Curve, &Yield)> {
        let both = curves.iter().zip(&yields);
        both.filter(|(curve, _)| curve.material == *material)
            .collect()
    };
    let scaling = materials
        .iter()
        .map(|m| scaling::scaling(*m, &of(m)))
        .collect();
    let pooled = materials
        .iter()
        .map(|m| speeds::pooled(*m, &of(m)))
        .collect();
    let around = materials
        .iter()
        .map(|m| around::around(*m, &of(m)))
        .collect();
    Analysis {
        rows: table.len(),
        failed: read.failed,
        sliding: read.sliding,
        plugs,
        speeds: curves.iter().map(speeds::speeds).collect(),
        pooled,
        around,
        scaling,
        stiffness: stiffness::stiffness(&curves, &yields),
        curves,
        yields,
    }
}

/// The analysis as JSON, numbers to ten digits.
pub fn text(analysis: &Analysis) -> String {
    let mut tree = serde_json::to_value(analysis).expect("an analysis has only finite numbers");
    round(&mut tree);
    let mut text = serde_json::to_string_pretty(&tree).expect("a tree of values is text");
    text.push('\n');
    text
}

fn round(tree: &mut serde_json::Value) {
    match tree {
        serde_json::Value::Array(list) => list.iter_mut().for_each(round),
        serde_json::Value::Object(map) => map.values_mut().for_each(round),
        serde_json::Value::Number(number) if number.is_f64() => {
            let rounded = number.as_f64().map(round10);
            if let Some(x) = rounded.and_then(serde_json::Number::from_f64) {
                *number = x;
            }
        }
        _ => {}
    }
}
