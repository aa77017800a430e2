//! How yield force and drag grow with the size of the intruder and its depth (Kumar 2018, sections III E to
//! III H): `F ~ (D + d)^phi h^alpha`.

use serde::{Deserialize, Serialize};

use super::beds::larger;
use super::exponents::{Force, Scaled, distinct, geometric_mean, near, scaled};
use super::yields::EXTRAPOLATED_FROUDE;
use super::{Curve, Finding, Material, Value, Yield};
use crate::fit::power::power;
use crate::fit::{Datum, Fit, Refusal};

/// Depth in mean diameters down to which the paper's collapse fails (Kumar 2018, section III H).
pub const SHALLOW: f64 = 25.0;

/// An exponent at a depth or a diameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exponent {
    /// The depth asked for, or the diameter, at which it is.
    pub at: f64,
    /// `A x^p`; `A` is the paper's f(mu), or g(mu).
    pub fit: Finding<Fit>,
}

/// An exponent at a Froude number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AtSpeed {
    /// Diameter D.
    pub diameter: f64,
    /// Speed V.
    pub speed: f64,
    /// `A h^p` of the drag there.
    pub fit: Finding<Fit>,
}

/// Runs at one Froude number, each over its scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// The Froude number.
    pub froude: f64,
    /// How many.
    pub runs: usize,
    /// Root mean square deviation from their mean (of shallow runs from that of deep ones), over it.
    pub spread: f64,
    /// The same from the errors of the runs alone.
    pub expected: f64,
}

/// How well the curves collapse.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Collapse {
    /// phi and alpha of the scale (D + d)^phi h^alpha that each drag is taken over.
    pub exponents: [f64; 2],
    /// By Froude number.
    pub speeds: Vec<Spread>,
    /// How many independent deviations there are.
    pub deviations: f64,
    /// Root mean square over all.
    pub spread: f64,
    /// The same from errors alone.
    pub expected: f64,
}

/// What one material says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaling {
    /// The grains.
    pub material: Material,
    /// phi: yield force against D + d at each depth asked for, to which the forces of the settled beds are scaled.
    pub phi: Vec<Exponent>,
    /// The exponent of depth in this scaling: alpha of both at once, of yields or of slow drags, or 1 if
    /// there is none.
    pub brought_by: f64,
    /// alpha: yield force against depth at each diameter.
    pub alpha: Vec<Exponent>,
    /// alpha of the drag at each speed.
    pub alpha_at_speed: Vec<AtSpeed>,
    /// Mean over these speeds, as the paper takes it.
    pub alpha_mean: Finding<Value>,
    /// Least and largest depth of the curves, in mean diameters.
    pub depths: [f64; 2],
    /// Both at once.
    pub both: Finding<Scaled>,
    /// Both from the drags up to Fr = 1.3 at the Froude numbers that all curves share: if drags of all sizes and
    /// depths grow alike with the speed, these are the exponents of the yield force without it.
    pub slow: Finding<Scaled>,
    /// Drags of all diameters at a depth, over (D + d)^phi (Kumar 2018, Fig. 15); phi of the yields, or of slow
    /// drags if these give none. So is alpha below.
    pub by_size: Finding<Collapse>,
    /// Drags of all depths at a diameter, over h^alpha (Kumar 2018, Fig. 19).
    pub by_depth: Finding<Collapse>,
    /// The same of depths beyond 25 d alone, where the paper finds its collapse.
    pub by_depth_deep: Finding<Collapse>,
    /// How far drags at depths up to 25 d, which the paper finds off that curve, lie from the mean of the deep ones.
    pub shallow_off_deep: Finding<Collapse>,
}

impl Scaling {
    /// The exponent of depth from both at once, of yields or of slow drags; `None` if there is neither.
    pub fn depth_exponent(&self) -> Option<Value> {
        let of = |found: &Finding<Scaled>| found.found()?.fit.parameter("alpha").map(Value::from);
        of(&self.both).or(of(&self.slow))
    }
}

type Pair<'a> = (&'a Curve, &'a Yield);

/// All scalings of one material.
pub(super) fn scaling(material: Material, curves: &[Pair]) -> Scaling {
    let both: Finding<Scaled> = both(curves).into();
    let slow: Finding<Scaled> = slow(curves).into();
    let at_once =
        |found: &Finding<Scaled>, name| found.found()?.fit.parameter(name).map(Value::from);
    // Beds do not settle to the depth that was asked for: yields are scaled to one depth.
    let slope = at_once(&both, "alpha").or(at_once(&slow, "alpha"));
    let slope = slope.map_or(1.0, |alpha| alpha.value);
    let phi = phi(curves, slope);
    let alpha = alpha(curves);
    let exponent = |list: &[Exponent], name| {
        let found = list.iter().filter_map(|e| e.fit.found());
        let mean = Value::mean(found.filter_map(|fit| fit.parameter("p")).map(Value::from));
        mean.or(at_once(&slow, name))
    };
    let (size, depth) = (exponent(&phi, "phi"), exponent(&alpha, "alpha"));
    let no_phi = || Finding::refused("a collapse takes the exponent phi, which was not found");
    let no_alpha = || Finding::refused("a collapse takes the exponent alpha, which was not found");
    let by_size = size.map_or_else(no_phi, |phi| {
        collapse(curves, |c| c.depth_asked, [phi.value, slope]).into()
    });
    let by_depth = |wanted: fn(&Curve) -> bool| {
        let own: Vec<Pair> = curves.iter().filter(|(c, _)| wanted(c)).copied().collect();
        depth.map_or_else(no_alpha, |alpha| {
            collapse(&own, |c| c.diameter, [0.0, alpha.value]).into()
        })
    };
    let shallow_off_deep = depth.map_or_else(no_alpha, |alpha| {
        off_deep(curves, [0.0, alpha.value]).into()
    });
    let alpha_at_speed = alpha_at_speed(curves);
    let speeds: Vec<Value> = alpha_at_speed
        .iter()
        .filter_map(|s| s.fit.found()?.parameter("p"))
        .map(Value::from)
        .collect();
    let alpha_mean = plain_mean(&speeds);
    let depths = distinct(curves.iter().map(|(c, _)| c.depth / c.mean_diameter));
    Scaling {
        material,
        depths: [depths[0], depths[depths.len() - 1]],
        brought_by: slope,
        by_size,
        by_depth: by_depth(|_| true),
        by_depth_deep: by_depth(is_deep),
        shallow_off_deep,
        phi,
        alpha,
        alpha_at_speed,
        alpha_mean,
        both,
        slow,
    }
}

/// Plain mean, with the error of its values or their scatter, whichever is larger.
fn plain_mean(values: &[Value]) -> Finding<Value> {
    match values.len() {
        2.. => Finding::Found(larger(values).0),
        _ => Finding::refused("a mean over speeds takes two speeds with an exponent each"),
    }
}

fn phi(curves: &[Pair], alpha: f64) -> Vec<Exponent> {
    exponents(
        curves,
        "D + d",
        |c| c.depth_asked,
        |depth, c, force| {
            let force = c.brought_to(depth, alpha, force);
            force.at(c.effective_diameter())
        },
    )
}

fn alpha(curves: &[Pair]) -> Vec<Exponent> {
    exponents(
        curves,
        "depths h",
        |c| c.diameter,
        |_, c, force| force.at(c.depth),
    )
}

/// An exponent of the yield force for each group of curves that have one `key`; `what` it is an exponent of.
fn exponents(
    curves: &[Pair],
    what: &str,
    key: fn(&Curve) -> f64,
    datum: impl Fn(f64, &Curve, Value) -> Datum,
) -> Vec<Exponent> {
    let one = |at: f64| {
        let own = curves.iter().filter(|(c, _)| near(key(c), at));
        let data: Vec<Datum> = own
            .filter_map(|(c, y)| Some(datum(at, c, *y.force.found()?)))
            .collect();
        let fit = power(&data, what).into();
        Exponent { at, fit }
    };
    let kinds = distinct(curves.iter().map(|(c, _)| key(c)));
    kinds.into_iter().map(one).collect()
}

fn alpha_at_speed(curves: &[Pair]) -> Vec<AtSpeed> {
    let mut out = Vec::new();
    for diameter in distinct(curves.iter().map(|(c, _)| c.diameter)) {
        let own: Vec<&Curve> = curves
            .iter()
            .map(|(c, _)| *c)
            .filter(|c| near(c.diameter, diameter))
            .collect();
        if distinct(own.iter().map(|c| c.depth_asked)).len() < 2 {
            continue;
        }
        for speed in distinct(own.iter().flat_map(|c| c.points.iter().map(|p| p.speed))) {
            let at = |c: &&Curve| -> Vec<Datum> {
                let points = c.points.iter().filter(|p| near(p.speed, speed));
                points.map(|p| p.drag.at(c.depth)).collect()
            };
            let data: Vec<Datum> = own.iter().flat_map(at).collect();
            if distinct(data.iter().map(|d| d.x)).len() > 2 {
                let fit = power(&data, "depths h").into();
                out.push(AtSpeed {
                    diameter,
                    speed,
                    fit,
                });
            }
        }
    }
    out
}

/// Both exponents from all yields.
fn both(curves: &[Pair]) -> Result<Scaled, Refusal> {
    let force = |(c, y): &Pair| {
        Some(Force {
            size: c.effective_diameter(),
            depth: c.depth,
            value: *y.force.found()?,
        })
    };
    let known: Vec<Force> = curves.iter().filter_map(force).collect();
    scaled(&known, "yield forces")
}

/// Both from slow drags: of each curve one force, the mean over the Froude numbers that all curves share. The
/// drags of a curve begin in one bed, so that they are not independent of each other.
fn slow(curves: &[Pair]) -> Result<Scaled, Refusal> {
    let has = |c: &Curve, froude: f64| c.points.iter().any(|p| near(p.froude, froude));
    let all = curves
        .iter()
        .flat_map(|(c, _)| c.points.iter().map(|p| p.froude));
    let mut shared = distinct(all.filter(|froude| *froude <= EXTRAPOLATED_FROUDE));
    shared.retain(|froude| curves.iter().all(|(c, _)| has(c, *froude)));
    if shared.is_empty() {
        let why =
            "the curves share no Froude number up to 1.3 at which their drags could be compared";
        return Err(Refusal(why.into()));
    }
    let force = |(c, _): &Pair| {
        let own = c
            .points
            .iter()
            .filter(|p| shared.iter().any(|s| near(p.froude, *s)));
        let drags: Vec<Value> = own.map(|p| p.drag).collect();
        let positive = drags.iter().all(|v| v.value > 0.0);
        Force {
            size: c.effective_diameter(),
            depth: c.depth,
            value: match positive {
                true => geometric_mean(&drags),
                false => Value::new(0.0, 0.0),
            },
        }
    };
    let forces: Vec<Force> = curves.iter().map(force).collect();
    scaled(&forces, "curves of slow drags")
}

/// How well the drags over their scale agree at equal Froude numbers, among curves of one `group`.
fn collapse(
    curves: &[Pair],
    group: impl Fn(&Curve) -> f64,
    exponents: [f64; 2],
) -> Result<Collapse, Refusal> {
    let mut speeds = Vec::new();
    for kind in distinct(curves.iter().map(|(c, _)| group(c))) {
        let own: Vec<&Curve> = curves
            .iter()
            .map(|(c, _)| *c)
            .filter(|c| near(group(c), kind))
            .collect();
        for froude in froudes(&own) {
            let at = |c: &&Curve| over_scale(c, froude, exponents);
            let values: Vec<Value> = own.iter().flat_map(at).collect();
            if own.iter().filter(|c| !at(c).is_empty()).count() > 1 {
                speeds.push(spread(froude, &values));
            }
        }
    }
    if speeds.is_empty() {
        return Err(Refusal(
            "a collapse takes two curves or more with runs at equal Froude numbers".into(),
        ));
    }
    // One of the runs at each speed fixes their mean.
    Ok(whole(exponents, speeds, |s| s.runs as f64 - 1.0))
}

/// Root mean squares over all speeds, each of which has so many independent deviations.
fn whole(exponents: [f64; 2], speeds: Vec<Spread>, independent: fn(&Spread) -> f64) -> Collapse {
    let deviations: f64 = speeds.iter().map(independent).sum();
    let whole = |of: fn(&Spread) -> f64| {
        let squares = speeds.iter().map(|s| independent(s) * of(s) * of(s));
        (squares.sum::<f64>() / deviations).sqrt()
    };
    Collapse {
        exponents,
        deviations,
        spread: whole(|s| s.spread),
        expected: whole(|s| s.expected),
        speeds,
    }
}

fn is_deep(curve: &Curve) -> bool {
    curve.depth_asked / curve.mean_diameter > SHALLOW
}

fn froudes(curves: &[&Curve]) -> Vec<f64> {
    distinct(
        curves
            .iter()
            .flat_map(|c| c.points.iter().map(|p| p.froude)),
    )
}

/// Drags at a Froude number over their scale.
fn over_scale(curve: &Curve, froude: f64, exponents: [f64; 2]) -> Vec<Value> {
    let scale = curve.scale(exponents);
    let points = curve.points.iter().filter(|p| near(p.froude, froude));
    points.map(|p| p.drag.divided(scale)).collect()
}

/// Drags over their scale at the lesser depths, over the mean of the deep ones of their diameter and Froude number.
fn off_deep(curves: &[Pair], exponents: [f64; 2]) -> Result<Collapse, Refusal> {
    let mut speeds = Vec::new();
    for diameter in distinct(curves.iter().map(|(c, _)| c.diameter)) {
        let own = curves.iter().map(|(c, _)| *c);
        let (deep, shallow): (Vec<&Curve>, Vec<&Curve>) = own
            .filter(|c| near(c.diameter, diameter))
            .partition(|c| is_deep(c));
        for froude in froudes(&shallow) {
            let at = |c: &&Curve| over_scale(c, froude, exponents);
            let Some(mean) = Value::mean(deep.iter().flat_map(at)) else {
                continue;
            };
            let ratios: Vec<Value> = shallow.iter().flat_map(at).map(|v| v.over(mean)).collect();
            let rms = |of: fn(&Value) -> f64| {
                let squares = ratios.iter().map(|ratio| of(ratio) * of(ratio));
                (squares.sum::<f64>() / ratios.len() as f64).sqrt()
            };
            speeds.push(Spread {
                froude,
                runs: ratios.len(),
                spread: rms(|ratio| ratio.value - 1.0),
                expected: rms(|ratio| ratio.error),
            });
        }
    }
    if speeds.is_empty() {
        return Err(Refusal(
            "no intruder has drags at one Froude number both down to 25 d and deeper".into(),
        ));
    }
    Ok(whole(exponents, speeds, |s| s.runs as f64))
}

fn spread(froude: f64, values: &[Value]) -> Spread {
    let n = values.len() as f64;
    let mean = values.iter().map(|v| v.value).sum::<f64>() / n;
    let squares = values
        .iter()
        .map(|v| (v.value / mean - 1.0) * (v.value / mean - 1.0));
    let errors = values.iter().map(|v| v.error / mean * (v.error / mean));
    Spread {
        froude,
        runs: values.len(),
        spread: (squares.sum::<f64>() / (n - 1.0)).sqrt(),
        expected: (errors.sum::<f64>() / n).sqrt(),
    }
}
