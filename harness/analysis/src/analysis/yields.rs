//! The yield force of an intruder: the drag in the limit of zero speed (Kumar 2018, section III E).

use serde::{Deserialize, Serialize};

use super::{Curve, Finding, Value};
use crate::fit::Datum;
use crate::fit::limit::extrapolated;
use crate::fit::linear::constant;

/// Fastest run, over sqrt(g d), that counts as the slow limit itself: the paper's 0.01.
pub const SLOW: f64 = 0.0101;
/// The same with friction: there the drag at 0.05 is that at 0.01 within errors (the campaign `kumar-yield`: 271 ± 5
/// and 284 ± 8 rho d^3 g on one bed). Without friction it is 5 % more (Table I of Kumar 2018, D = 2 d).
pub const SLOW_WITH_FRICTION: f64 = 0.0505;
/// Least friction coefficient with which the drag has a plateau (Kumar 2018, section III D).
pub const PLATEAU_MU: f64 = 0.05;
/// Froude number up to which it is flat (Kumar 2018, section III A).
pub const PLATEAU_FROUDE: f64 = 1.0;
/// Froude number up to which a frictionless drag is extrapolated from: the paper fits its law below 1.
pub const EXTRAPOLATED_FROUDE: f64 = 1.3;

/// How a yield force was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// A run at V = 0.01 sqrt(g d) or slower, as in the paper; with friction at 0.05.
    SlowRun,
    /// Weighted mean of the runs below Fr = 1, with friction.
    Plateau,
    /// `a` of `a + b Fr^c` through the slow runs, without.
    Extrapolated,
}

/// The yield force of a curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Yield {
    /// How it was found.
    pub method: Method,
    /// How many runs it rests on.
    pub runs: usize,
    /// It, or why there is none.
    pub force: Finding<Value>,
}

/// Points below a Froude number.
fn below(curve: &Curve, froude: f64) -> Vec<Datum> {
    let slow = curve.points.iter().filter(|p| p.froude <= froude);
    slow.map(|p| p.drag.at(p.froude)).collect()
}

/// The yield force of a curve, by the best method that its runs allow.
pub(super) fn yield_of(curve: &Curve) -> Yield {
    let slow = if curve.material.mu >= PLATEAU_MU {
        SLOW_WITH_FRICTION
    } else {
        SLOW
    };
    let limit = slow * curve.mean_diameter.sqrt();
    let slow: Vec<Value> = curve
        .points
        .iter()
        .filter(|p| p.speed <= limit)
        .map(|p| p.drag)
        .collect();
    if let Some(force) = Value::mean(slow.iter().copied()) {
        return Yield {
            method: Method::SlowRun,
            runs: slow.len(),
            force: Finding::Found(force),
        };
    }
    if curve.material.mu >= PLATEAU_MU {
        let data = below(curve, PLATEAU_FROUDE);
        let force = match &data[..] {
            [] => Finding::refused(format!("no run is below Fr = {PLATEAU_FROUDE}")),
            [one] => Finding::Found(Value::new(one.y, one.error)),
            _ => constant(&data)
                .map(|fit| Value::from(&fit.parameters[0]))
                .into(),
        };
        return Yield {
            method: Method::Plateau,
            runs: data.len(),
            force,
        };
    }
    let data = below(curve, EXTRAPOLATED_FROUDE);
    let limit = extrapolated(&data).map(|limit| Value::new(limit.value, limit.error));
    Yield {
        method: Method::Extrapolated,
        runs: data.len(),
        force: limit.into(),
    }
}
