//! The same intruder in grains of other stiffness or damping (Kumar 2018, section III I and Fig. 20).

use serde::{Deserialize, Serialize};

use super::curves::SAME_DEPTH;
use super::{Curve, Point, Value, Yield};
use bitgrain_lab::campaign::rules::RESTITUTION;

/// Least Froude number of the regime in which only restitution counts.
pub const FAST: f64 = 5.0;
/// Ratios gamma_n/K_n^0.6 that differ by less than this part are one.
const SAME: f64 = 1e-6;

/// One material among those compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Stiffness K_n.
    pub kn: f64,
    /// Damping gamma_n.
    pub gamma_n: f64,
    /// Yield force.
    pub slow: Value,
    /// Drag over that of the first material, mean over equal Froude numbers beyond 5; none of the first.
    pub fast: Option<Value>,
}

/// Materials that differ by one thing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stiffness {
    /// What differs: `kn` at equal gamma_n/K_n^0.6, or `gamma_n` at equal K_n.
    pub what: String,
    /// Friction coefficient.
    pub mu: f64,
    /// Diameter D.
    pub diameter: f64,
    /// Depth asked for.
    pub depth_asked: f64,
    /// By what differs, ascending.
    pub levels: Vec<Level>,
}

type Pair<'a> = (&'a Curve, Value);

/// Groups of curves that differ by stiffness at equal restitution, or by damping alone.
pub(super) fn stiffness(curves: &[Curve], yields: &[Yield]) -> Vec<Stiffness> {
    let both = curves.iter().zip(yields);
    let known: Vec<Pair> = both
        .filter_map(|(c, y)| Some((c, *y.force.found()?)))
        .collect();
    let restitution = |c: &Curve| c.material.gamma_n / libm::pow(c.material.kn, RESTITUTION);
    let mut out = group(&known, "kn", restitution, |c| c.material.kn);
    out.extend(group(
        &known,
        "gamma_n",
        |c| c.material.kn,
        |c| c.material.gamma_n,
    ));
    out
}

fn group(
    known: &[Pair],
    what: &str,
    same: impl Fn(&Curve) -> f64,
    differs: impl Fn(&Curve) -> f64,
) -> Vec<Stiffness> {
    let alike = |a: &Curve, b: &Curve| {
        let place = |c: &Curve| (c.material.mu, c.diameter);
        let depth = (a.depth_asked - b.depth_asked).abs() < SAME_DEPTH * b.depth_asked;
        place(a) == place(b) && depth && (same(a) - same(b)).abs() <= SAME * same(b)
    };
    let mut groups: Vec<Vec<Pair>> = Vec::new();
    for pair in known {
        match groups.iter_mut().find(|group| alike(group[0].0, pair.0)) {
            Some(group) => group.push(*pair),
            None => groups.push(vec![*pair]),
        }
    }
    let whole = |mut group: Vec<Pair>| {
        group.sort_by(|a, b| differs(a.0).total_cmp(&differs(b.0)));
        let first = group[0].0;
        let level = |(curve, slow): &Pair| Level {
            kn: curve.material.kn,
            gamma_n: curve.material.gamma_n,
            slow: *slow,
            fast: fast(curve, first),
        };
        Stiffness {
            what: what.into(),
            mu: first.material.mu,
            diameter: first.diameter,
            depth_asked: first.depth_asked,
            levels: group.iter().map(level).collect(),
        }
    };
    groups
        .into_iter()
        .filter(|group| group.len() > 1)
        .map(whole)
        .collect()
}

/// Drag over another's at equal Froude numbers beyond 5, weighted mean; none of a curve over itself.
fn fast(curve: &Curve, first: &Curve) -> Option<Value> {
    if std::ptr::eq(curve, first) {
        return None;
    }
    let fast = curve
        .points
        .iter()
        .filter(|p| p.froude > FAST * (1.0 - SAME));
    let ratios = fast.flat_map(|p| {
        let same = |q: &&Point| (q.froude - p.froude).abs() < SAME * p.froude;
        let own = first.points.iter().filter(same);
        own.map(|q| p.drag.over(q.drag))
    });
    Value::mean(ratios)
}
