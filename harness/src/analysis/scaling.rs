//! How yield force and drag grow with the size of the intruder and its depth (Kumar 2018, sections III E to
//! III H): `F ~ (D + d)^phi h^alpha`.

use serde::{Deserialize, Serialize};

use super::{Curve, Finding, Material, Point, Value, Yield};
use crate::fit::linear::{Column, columns};
use crate::fit::power::power;
use crate::fit::{DECADES_MIN, Datum, EXPONENT_ERROR_MAX, Exact, Fit, Refusal};

/// Depth in mean diameters down to which the paper's collapse fails (Kumar 2018, section III H).
pub const SHALLOW: f64 = 25.0;
/// Froude numbers that differ by less than this part are one.
const SAME_FROUDE: f64 = 1e-6;

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

/// Exponents of size and depth from all yield forces at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaled {
    /// `ln F = ln A + phi ln(D + d) + alpha ln h`.
    pub fit: Fit,
    /// `phi + alpha` with the error that their covariance gives.
    pub sum: Value,
}

/// Runs at one Froude number, each over its scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Spread {
    /// The Froude number.
    pub froude: f64,
    /// How many.
    pub runs: usize,
    /// Root mean square deviation from their mean, over it.
    pub spread: f64,
    /// The same as the errors of the runs alone would have it.
    pub expected: f64,
}

/// How well curves fall on one another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Collapse {
    /// By Froude number.
    pub speeds: Vec<Spread>,
    /// Root mean square over all.
    pub spread: f64,
    /// The same as errors alone would have it.
    pub expected: f64,
}

/// What one material says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scaling {
    /// The grains.
    pub material: Material,
    /// phi: yield force against D + d at each depth.
    pub phi: Vec<Exponent>,
    /// alpha: yield force against depth at each diameter.
    pub alpha: Vec<Exponent>,
    /// alpha of the drag at each speed.
    pub alpha_at_speed: Vec<AtSpeed>,
    /// Mean over these speeds, as the paper takes it.
    pub alpha_mean: Finding<Value>,
    /// Both at once.
    pub both: Finding<Scaled>,
    /// Drags of all diameters at a depth, over (D + d)^phi (Kumar 2018, Fig. 15).
    pub by_size: Finding<Collapse>,
    /// Drags of all depths at a diameter, over h^alpha (Kumar 2018, Fig. 19).
    pub by_depth: Finding<Collapse>,
    /// The same of depths beyond 25 d alone, where the paper has its collapse.
    pub by_depth_deep: Finding<Collapse>,
    /// And of those up to 25 d, where it has none.
    pub by_depth_shallow: Finding<Collapse>,
}

type Pair<'a> = (&'a Curve, &'a Yield);

/// Values that occur, ascending, each once.
fn kinds(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() <= SAME_FROUDE * b.abs());
    all
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_FROUDE * b.abs()
}

/// All scalings of one material.
pub(super) fn scaling(material: Material, curves: &[Pair]) -> Scaling {
    let both: Finding<Scaled> = both(curves).into();
    // Beds do not settle to the depth that was asked for: yields are brought to one depth.
    let slope = both
        .found()
        .and_then(|s| s.fit.parameter("alpha"))
        .map_or(1.0, |p| p.value);
    let phi = phi(curves, slope);
    let alpha = alpha(curves);
    let exponent = |list: &[Exponent]| {
        let found = list.iter().filter_map(|e| e.fit.found());
        let values: Vec<Value> = found
            .filter_map(|fit| fit.parameter("p"))
            .map(|p| Value {
                value: p.value,
                error: p.error,
            })
            .collect();
        mean(&values)
    };
    let (size, depth) = (exponent(&phi), exponent(&alpha));
    let no_phi = || Finding::refused("a collapse takes the exponent phi, which was not found");
    let no_alpha = || Finding::refused("a collapse takes the exponent alpha, which was not found");
    let by_size = size.map_or_else(no_phi, |phi| {
        collapse(
            curves,
            |c| c.depth_asked,
            |c| libm::pow(c.effective_diameter(), phi.value) * libm::pow(c.depth, slope),
        )
        .into()
    });
    let by_depth = |wanted: fn(f64) -> bool| {
        let deep = |(c, _): &&Pair| wanted(c.depth_asked / c.mean_diameter);
        let own: Vec<Pair> = curves.iter().filter(deep).copied().collect();
        depth.map_or_else(no_alpha, |alpha| {
            collapse(&own, |c| c.diameter, |c| libm::pow(c.depth, alpha.value)).into()
        })
    };
    let alpha_at_speed = alpha_at_speed(curves);
    let speeds: Vec<Value> = alpha_at_speed
        .iter()
        .filter_map(|s| s.fit.found()?.parameter("p"))
        .map(|p| Value {
            value: p.value,
            error: p.error,
        })
        .collect();
    let alpha_mean = plain_mean(&speeds);
    Scaling {
        material,
        by_size,
        by_depth: by_depth(|_| true),
        by_depth_deep: by_depth(|h| h > SHALLOW),
        by_depth_shallow: by_depth(|h| h <= SHALLOW),
        phi,
        alpha,
        alpha_at_speed,
        alpha_mean,
        both,
    }
}

/// Weighted mean; none of none.
fn mean(values: &[Value]) -> Option<Value> {
    let weight = |v: &Value| 1.0 / (v.error * v.error);
    let weights: f64 = values.iter().map(weight).sum();
    let value = values.iter().map(|v| weight(v) * v.value).sum::<f64>() / weights;
    (weights > 0.0 && value.is_finite()).then(|| Value {
        value,
        error: 1.0 / weights.sqrt(),
    })
}

/// Plain mean, with the error of its values or their scatter, whichever is larger.
fn plain_mean(values: &[Value]) -> Finding<Value> {
    let n = values.len() as f64;
    if values.len() < 2 {
        return Finding::refused("a mean over speeds takes two speeds with an exponent each");
    }
    let value = values.iter().map(|v| v.value).sum::<f64>() / n;
    let own = values.iter().map(|v| v.error * v.error).sum::<f64>().sqrt() / n;
    let squares = values
        .iter()
        .map(|v| (v.value - value) * (v.value - value))
        .sum::<f64>();
    let seen = (squares / (n - 1.0) / n).sqrt();
    Finding::Found(Value {
        value,
        error: if seen > own { seen } else { own },
    })
}

fn phi(curves: &[Pair], alpha: f64) -> Vec<Exponent> {
    let depths = kinds(curves.iter().map(|(c, _)| c.depth_asked));
    let at = |depth: f64| {
        let own = curves.iter().filter(|(c, _)| near(c.depth_asked, depth));
        let data: Vec<Datum> = own
            .filter_map(|(c, y)| {
                let force = y.force.found()?;
                let to = libm::pow(depth / c.depth, alpha);
                Some(Datum {
                    x: c.effective_diameter(),
                    y: force.value * to,
                    error: force.error * to,
                })
            })
            .collect();
        Exponent {
            at: depth,
            fit: power(&data, "D + d").into(),
        }
    };
    depths.into_iter().map(at).collect()
}

fn alpha(curves: &[Pair]) -> Vec<Exponent> {
    let diameters = kinds(curves.iter().map(|(c, _)| c.diameter));
    let at = |diameter: f64| {
        let own = curves.iter().filter(|(c, _)| near(c.diameter, diameter));
        let data: Vec<Datum> = own
            .filter_map(|(c, y)| {
                let force = y.force.found()?;
                Some(Datum {
                    x: c.depth,
                    y: force.value,
                    error: force.error,
                })
            })
            .collect();
        Exponent {
            at: diameter,
            fit: power(&data, "the depth h").into(),
        }
    };
    diameters.into_iter().map(at).collect()
}

fn alpha_at_speed(curves: &[Pair]) -> Vec<AtSpeed> {
    let mut out = Vec::new();
    for diameter in kinds(curves.iter().map(|(c, _)| c.diameter)) {
        let own: Vec<&Curve> = curves
            .iter()
            .map(|(c, _)| *c)
            .filter(|c| near(c.diameter, diameter))
            .collect();
        if kinds(own.iter().map(|c| c.depth_asked)).len() < 2 {
            continue;
        }
        for speed in kinds(own.iter().flat_map(|c| c.points.iter().map(|p| p.speed))) {
            let at = |c: &&Curve| -> Vec<Datum> {
                let points = c.points.iter().filter(|p| near(p.speed, speed));
                points
                    .map(|p| Datum {
                        x: c.depth,
                        y: p.drag.value,
                        error: p.drag.error,
                    })
                    .collect()
            };
            let data: Vec<Datum> = own.iter().flat_map(at).collect();
            if kinds(data.iter().map(|d| d.x)).len() > 2 {
                let fit = power(&data, "the depth h").into();
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
    let known: Vec<(&Curve, Value)> = curves
        .iter()
        .filter_map(|(c, y)| Some((*c, *y.force.found()?)))
        .collect();
    let positive = known.iter().all(|(_, force)| force.value > 0.0);
    if known.len() < 4 || !positive {
        return Err(Refusal(format!(
            "both exponents at once take four yield forces above zero or more; there are {}",
            known.len()
        )));
    }
    for (what, of) in [
        ("D + d", (|c| c.effective_diameter()) as fn(&Curve) -> f64),
        ("the depth h", |c| c.depth),
    ] {
        let all = kinds(known.iter().map(|(c, _)| of(c)));
        let decades = libm::log10(all[all.len() - 1] / all[0]);
        if decades < DECADES_MIN {
            return Err(Refusal(format!(
                "an exponent takes a range of {DECADES_MIN} decades or more in {what}; the yield forces span \
                 {decades:.2}"
            )));
        }
    }
    let data: Vec<Datum> = known
        .iter()
        .map(|(c, force)| Datum {
            x: c.depth,
            y: libm::log(force.value),
            error: force.relative(),
        })
        .collect();
    let column = |name: &'static str, of: &dyn Fn(&Curve) -> f64| Column {
        name,
        values: known.iter().map(|(c, _)| of(c)).collect(),
    };
    let model = [
        column("ln A", &|_| 1.0),
        column("phi", &|c| libm::log(c.effective_diameter())),
        column("alpha", &|c| libm::log(c.depth)),
    ];
    let fit = columns(
        &data,
        "ln F = ln A + phi ln(D + d) + alpha ln h",
        &model,
        Exact::Refused,
    )?;
    let worst = fit.parameters[1..]
        .iter()
        .find(|p| p.error > EXPONENT_ERROR_MAX);
    if let Some(p) = worst {
        return Err(Refusal(format!(
            "the standard error of {} is {:.2}, beyond {EXPONENT_ERROR_MAX}: more or longer runs are wanted",
            p.name, p.error
        )));
    }
    let c = &fit.covariance;
    let sum = Value {
        value: fit.parameters[1].value + fit.parameters[2].value,
        error: (c[1][1] + c[2][2] + 2.0 * c[1][2]).sqrt(),
    };
    Ok(Scaled { fit, sum })
}

/// How well the drags over `scale` agree at equal Froude numbers, among curves that `group` puts together.
fn collapse(
    curves: &[Pair],
    group: impl Fn(&Curve) -> f64,
    scale: impl Fn(&Curve) -> f64,
) -> Result<Collapse, Refusal> {
    let mut speeds = Vec::new();
    for kind in kinds(curves.iter().map(|(c, _)| group(c))) {
        let own: Vec<&Curve> = curves
            .iter()
            .map(|(c, _)| *c)
            .filter(|c| near(group(c), kind))
            .collect();
        for froude in kinds(own.iter().flat_map(|c| c.points.iter().map(|p| p.froude))) {
            let at = |c: &&Curve| -> Vec<Value> {
                let scale = scale(c);
                let points = c.points.iter().filter(|p: &&Point| near(p.froude, froude));
                points
                    .map(|p| Value {
                        value: p.drag.value / scale,
                        error: p.drag.error / scale,
                    })
                    .collect()
            };
            let values: Vec<Value> = own.iter().flat_map(at).collect();
            if own.iter().filter(|c| !at(c).is_empty()).count() > 1 {
                speeds.push(spread(froude, &values));
            }
        }
    }
    let n: f64 = speeds.iter().map(|s| s.runs as f64 - 1.0).sum();
    if speeds.is_empty() {
        return Err(Refusal(
            "a collapse takes two curves or more with runs at equal Froude numbers".into(),
        ));
    }
    let whole = |of: fn(&Spread) -> f64| {
        let squares = speeds.iter().map(|s| (s.runs as f64 - 1.0) * of(s) * of(s));
        (squares.sum::<f64>() / n).sqrt()
    };
    Ok(Collapse {
        spread: whole(|s| s.spread),
        expected: whole(|s| s.expected),
        speeds,
    })
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
