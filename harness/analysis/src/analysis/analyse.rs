//! All that a table says.

use super::{curves, near_field, scaling, speeds, stiffness, table_one, yields};
use crate::analysis::Curve;
use crate::analysis::Material;
use crate::analysis::NearField;
use crate::analysis::Pooled;
use crate::analysis::Scaling;
use crate::analysis::Speeds;
use crate::analysis::Stiffness;
use crate::analysis::TableOne;
use crate::analysis::Yield;
use bitgrain_lab::campaign::table::CampaignTable;
use bitgrain_sim::format::round10;
use serde::{Deserialize, Serialize};

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
    /// Whether these count nevertheless.
    pub plugs: bool,
    /// Drag against speed: intruder, depth and grains the same.
    pub curves: Vec<Curve>,
    /// Regimes of each curve.
    pub speeds: Vec<Speeds>,
    /// Regimes of all curves of a material together, each over its yield force.
    pub pooled: Vec<Pooled>,
    /// Contact angle, coordination, grains without contacts, by material.
    #[serde(rename = "around")]
    pub near_field: Vec<NearField>,
    /// The yield force of each curve.
    pub yields: Vec<Yield>,
    /// How yield and drag scale with size and depth, by material.
    pub scaling: Vec<Scaling>,
    /// Frictionless drags over those of the paper's Table I, by diameter.
    pub table_one: Vec<TableOne>,
    /// The same intruder in grains of other stiffness or damping.
    pub stiffness: Vec<Stiffness>,
}

/// Analyses a table. Runs whose bed slid along as a plug are left out unless `plugs`.
pub fn analyse(table: &CampaignTable, plugs: bool) -> Analysis {
    let read = curves::read(table, plugs);
    let curves = read.curves;
    let yields: Vec<Yield> = curves.iter().map(yields::yield_of).collect();
    let materials = curves::materials(&curves);
    let of = |material: &Material| -> Vec<(&Curve, &Yield)> {
        let both = curves.iter().zip(&yields);
        both.filter(|(curve, _)| curve.material == *material)
            .collect()
    };
    let scaling: Vec<Scaling> = materials
        .iter()
        .map(|m| scaling::scaling(*m, &of(m)))
        .collect();
    let pooled = materials
        .iter()
        .map(|m| speeds::pooled(*m, &of(m)))
        .collect();
    let near_field = materials
        .iter()
        .map(|m| near_field::near_field(*m, &of(m)))
        .collect();
    Analysis {
        rows: table.len(),
        failed: read.failed,
        sliding: read.sliding,
        plugs,
        speeds: curves.iter().map(speeds::speeds).collect(),
        pooled,
        near_field,
        table_one: table_one::table_one(&curves, &scaling),
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

pub(super) fn round(tree: &mut serde_json::Value) {
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
