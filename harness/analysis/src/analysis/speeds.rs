//! Drag against Froude number: three regimes and where they meet (Kumar 2018, sections III A and III C).

use serde::{Deserialize, Serialize};

use super::yields::PLATEAU_MU;
use super::{Curve, Finding, Material, Value, Yield};
use crate::fit::offset_power::offset_power;
use crate::fit::power::power;
use crate::fit::regimes::{First, RegimeFits, Regimes, regime_fits, regimes};
use crate::fit::{Datum, Fit};

/// The paper's crossovers: from the first regime to the line, and to the quadratic.
pub const CROSSOVERS: [f64; 2] = [1.0, 5.0];

/// The findings of one curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Speeds {
    /// The slowest run against the fastest below Fr = 1.
    pub flatness: Finding<Flatness>,
    /// Each regime alone, between the paper's crossovers.
    pub alone: RegimeFits,
    /// `a + b Fr^c` below Fr = 1.3 (Kumar 2018, Table I), without friction.
    pub first: Option<Finding<Fit>>,
    /// All three, with the crossovers found.
    pub regimes: Finding<Regimes>,
}

/// How flat the drag is below Fr = 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flatness {
    /// The Froude numbers compared.
    pub froude: [f64; 2],
    /// Drag of the faster over that of the slower.
    pub ratio: Value,
}

/// All curves of a material, each over its yield force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pooled {
    /// The grains.
    pub material: Material,
    /// Runs of all curves.
    pub runs: usize,
    /// All three regimes, with the crossovers found.
    pub regimes: Finding<Regimes>,
    /// Each regime alone, between the paper's crossovers.
    pub alone: RegimeFits,
    /// Exponent of drag less yield force against Fr - 1 from Fr = 1.2 to the second crossover: the line
    /// joins the plateau at Fr = 1 (Kumar 2018, section IV), so a line has the exponent 1.
    pub second: Finding<Fit>,
    /// Exponent of drag above Fr = 5.
    pub third: Finding<Fit>,
}

fn first_of(mu: f64) -> First {
    if mu >= PLATEAU_MU {
        First::Flat
    } else {
        First::Power
    }
}

/// Regimes of one curve.
pub(super) fn speeds(curve: &Curve) -> Speeds {
    let data: Vec<Datum> = curve.points.iter().map(|p| p.drag.at(p.froude)).collect();
    let [x1, x2] = CROSSOVERS;
    let frictional = curve.material.mu >= PLATEAU_MU;
    let slow: Vec<Datum> = data
        .iter()
        .filter(|d| d.x <= super::yields::EXTRAPOLATED_FROUDE)
        .copied()
        .collect();
    Speeds {
        flatness: flatness(curve),
        alone: regime_fits(&data, x1, x2),
        first: (!frictional).then(|| offset_power(&slow).into()),
        regimes: regimes(&data, first_of(curve.material.mu)).into(),
    }
}

fn flatness(curve: &Curve) -> Finding<Flatness> {
    let slow: Vec<&super::Point> = curve
        .points
        .iter()
        .filter(|p| p.froude <= CROSSOVERS[0])
        .collect();
    match &slow[..] {
        [first, .., last] if last.froude > first.froude => Finding::Found(Flatness {
            froude: [first.froude, last.froude],
            ratio: last.drag.over(first.drag),
        }),
        _ => Finding::refused("a comparison takes two speeds below Fr = 1"),
    }
}

/// Regimes of all curves of a material together.
pub(super) fn pooled(material: Material, curves: &[(&Curve, &Yield)]) -> Pooled {
    let mut all = Vec::new();
    for (curve, own) in curves {
        let Some(&force) = own.force.found() else {
            continue;
        };
        all.extend(curve.points.iter().map(|p| p.drag.over(force).at(p.froude)));
    }
    all.sort_by(|a, b| a.x.total_cmp(&b.x));
    let [x1, x2] = CROSSOVERS;
    let part = |from: f64, to: f64, [x, y]: [f64; 2]| -> Vec<Datum> {
        let inside = all.iter().filter(|d| d.x >= from && d.x <= to);
        let less = |d: &Datum| Datum {
            x: d.x - x,
            y: d.y - y,
            ..*d
        };
        inside.map(less).filter(|d| d.y > 0.0).collect()
    };
    Pooled {
        material,
        runs: all.len(),
        regimes: regimes(&all, first_of(material.mu)).into(),
        alone: regime_fits(&all, x1, x2),
        second: power(&part(1.2 * x1, x2, [x1, 1.0]), "Fr - 1 up to Fr = 5").into(),
        third: power(&part(x2, f64::INFINITY, [0.0; 2]), "Fr above 5").into(),
    }
}
