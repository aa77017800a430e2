//! What the runs of flowing beds say of each claim of Guillard 2014.

use super::fits::{drag_slope, plateau};
use super::judged::{FAR_FIELD_LEAST, TRAVEL_LEAST, least};
use super::kumar::Found;
use super::points::{Group, Point, groups};
use crate::analysis::Value;
use crate::scenario::Shape;
use crate::summary::{RunSummary, Summary};

/// D/d of the paper's simulations (Guillard 2014, Fig. 8).
const THIN: f64 = 3.3;
/// How far another D/d may lie from it.
const NEAR: f64 = 0.05;
/// Lift over buoyancy of the experiment below D/d = 5, as far as the text names it (Guillard 2014, Fig. 5).
const EXPERIMENT: f64 = 60.0;
/// Effective depth over D from which a lift counts as saturated without a plateau to tell it.
const DEEP: f64 = 16.0;
/// Fewest seeds of every point whose lift is told.
const SEEDS: usize = 2;

/// The measurement of a claim of Guillard 2014; `None` where this paper has no such claim, or nothing here
/// measures it.
pub fn measure(id: &str, summary: &Summary) -> Option<Found> {
    let rest = id.strip_prefix("guillard-")?;
    let groups = groups(summary);
    let group = groups.iter().find(|g| (g.over_grain - THIN).abs() <= NEAR);
    let cylinder = summary.inputs.intruder.shape == Shape::Cylinder;
    let Some(group) = group.filter(|_| cylinder) else {
        return Some(Err(format!("no run has a cylinder of D/d = {THIN}")));
    };
    let found = match rest {
        "drag" => drag(group),
        "drag-gradient" => drag_ratio(group),
        "lift-saturates" => deepest_over_next(group),
        "lift-thirty" | "lift-thin" => lift(group),
        "lift-simulation" => lift(group).map(|(v, note)| (scaled(v, EXPERIMENT), note)),
        "no-lift" => no_lift(group),
        "steady" => halves(summary),
        _ => return None,
    };
    Some(found.and_then(|found| steady(group, found)))
}

fn scaled(value: Value, by: f64) -> Value {
    Value {
        value: value.value / by,
        error: value.error / by,
    }
}

/// Nothing counts that rests on a bed that slips, or on too little travel.
fn steady(group: &Group, found: (Value, String)) -> Found {
    let slowest = least(group.points.iter().map(|p| p.far_field));
    let shortest = least(group.points.iter().map(|p| p.travel));
    if slowest >= FAR_FIELD_LEAST && shortest >= TRAVEL_LEAST {
        return Ok(found);
    }
    let (value, note) = found;
    Err(format!(
        "{:.3} +- {:.3} ({note}), but the windows hold {shortest:.0} grain diameters of travel of \
         {TRAVEL_LEAST} or more, and the slowest bed went at {slowest:.3} of its speed",
        value.value, value.error
    ))
}

fn drag(group: &Group) -> Found {
    let fit = drag_slope(group).ok_or("no drag was measured")?;
    let note = format!("slope of the drag over {} depths", fit.depths);
    Ok((
        Value {
            value: fit.slope,
            error: fit.error,
        },
        note,
    ))
}

/// Points with and without a gradient at one effective depth.
fn pairs(group: &Group) -> Vec<(&Point, &Point)> {
    let with = group.with_gradient(true);
    let same = |a: &Point, b: &Point| (a.asked / b.asked - 1.0).abs() <= super::SAME_DEPTH;
    let partner = |b: &&'_ Point| with.iter().find(|a| same(a, b)).copied();
    let without = group.with_gradient(false).into_iter();
    without.filter_map(|b| Some((partner(&b)?, b))).collect()
}

fn drag_ratio(group: &Group) -> Found {
    let one = |(with, without): &(&Point, &Point)| {
        let (a, b) = (with.drag_over_pressure, without.drag_over_pressure);
        let value = |s: super::Spread| Value {
            value: s.mean,
            error: s.error,
        };
        value(b).over(value(a))
    };
    let all: Vec<Value> = pairs(group).iter().map(one).collect();
    let far = all.into_iter().reduce(|a, b| {
        if (b.value - 1.0).abs() > (a.value - 1.0).abs() {
            b
        } else {
            a
        }
    });
    far.map(|v| (v, "without over with, farthest from 1".to_string()))
        .ok_or_else(|| "no two runs with and without gradient have one effective depth".into())
}

fn seeds(points: &[&Point]) -> Result<(), String> {
    match Group::seeds(points) {
        n if n < SEEDS => Err(format!(
            "a lift is told from {SEEDS} seeds or more; there are {n}"
        )),
        _ => Ok(()),
    }
}

/// The plateau, or the deepest points where they are deep enough for one.
fn lift(group: &Group) -> Found {
    let points = group.with_gradient(true);
    seeds(&points)?;
    if let Some(flat) = plateau(&points) {
        let value = Value {
            value: flat.lift,
            error: flat.error,
        };
        return Ok((value, format!("plateau of {} points", flat.points)));
    }
    let deepest = points.last().ok_or("no run has a gradient")?;
    let over = deepest.effective_depth / group.diameter;
    if over < DEEP {
        return Err(format!(
            "no plateau can be told, and the deepest run is at h~/D = {over:.0}, not {DEEP}"
        ));
    }
    let value = Value {
        value: deepest.lift.mean,
        error: deepest.lift.error,
    };
    Ok((value, format!("at h~/D = {over:.0}")))
}

fn deepest_over_next(group: &Group) -> Found {
    let points = group.with_gradient(true);
    seeds(&points)?;
    let [.., next, deepest] = &points[..] else {
        return Err("two depths with a gradient are wanted".into());
    };
    let value = |p: &Point| Value {
        value: p.lift.mean,
        error: p.lift.error,
    };
    let over = [deepest, next].map(|p| p.effective_depth / group.diameter);
    Ok((
        value(deepest).over(value(next)),
        format!("h~/D = {:.0} over {:.0}", over[0], over[1]),
    ))
}

fn no_lift(group: &Group) -> Found {
    let pairs = pairs(group);
    let points: Vec<&Point> = pairs.iter().flat_map(|(a, b)| [*a, *b]).collect();
    seeds(&points)?;
    let value = |p: &Point| Value {
        value: p.lift.mean,
        error: p.lift.error,
    };
    let all = pairs
        .iter()
        .map(|(with, without)| value(without).over(value(with)));
    let far = all.reduce(|a, b| if b.value.abs() > a.value.abs() { b } else { a });
    far.map(|v| (v, "without over with, farthest from 0".to_string()))
        .ok_or_else(|| "no two runs with and without gradient have one effective depth".into())
}

/// The drag's two halves of the window, which begins after 2 D: farthest from equal.
fn halves(summary: &Summary) -> Found {
    let one = |run: &RunSummary| {
        let [first, second] = run.flow.as_ref()?.drag_halves;
        // Each half is known a root of two worse than the whole.
        let error = 2.0 * run.drag.standard_error / run.drag.mean;
        Some(Value {
            value: first / second,
            error,
        })
    };
    let all = summary.runs.iter().filter_map(one);
    let far = all.reduce(|a, b| {
        if (b.value - 1.0).abs() > (a.value - 1.0).abs() {
            b
        } else {
            a
        }
    });
    far.map(|v| (v, "first half of the window over the second".to_string()))
        .ok_or_else(|| "no bed flowed".into())
}
