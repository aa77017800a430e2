//! What the runs of flowing beds say of each claim of Guillard 2014.

use super::fits::{drag_slope, plateau};
use super::judged::{FAR_FIELD_LEAST, TRAVEL_LEAST, least};
use super::kumar::{Found, farthest};
use super::load::loads;
use super::load_claims::measure as measure_loads;
use super::points::{Group, Point, Spread, Way, groups};
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
        "drag-gradient" => ratio(&pairs(group), 1.0, |p| p.drag_over_pressure),
        "lift-saturates" => deepest_over_next(group),
        "lift-thirty" | "lift-thin" => lift(group),
        "lift-simulation" => lift(group).map(|(v, note)| (v.divided(EXPERIMENT), note)),
        "no-lift" => no_lift(group),
        "steady" => halves(summary),
        "zone" => zones(summary, group, true),
        "symmetry" => zones(summary, group, false),
        _ => measure_loads(rest, &loads(summary, group))?,
    };
    Some(found.and_then(|found| steady(group, found)))
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
    Ok((Value::new(fit.slope, fit.error), note))
}

/// Points with and without a gradient at one effective depth.
fn pairs(group: &Group) -> Vec<(&Point, &Point)> {
    let with = group.with_gradient(true);
    let same = |a: &Point, b: &Point| (a.asked / b.asked - 1.0).abs() <= super::SAME_DEPTH;
    let partner = |b: &&'_ Point| with.iter().find(|a| same(a, b)).copied();
    let without = group.with_gradient(false).into_iter();
    without.filter_map(|b| Some((partner(&b)?, b))).collect()
}

const NO_PAIR: &str = "no two runs with and without gradient have one effective depth";

impl From<Spread> for Value {
    fn from(spread: Spread) -> Self {
        Value::new(spread.mean, spread.error)
    }
}

/// A quantity of each pair, without a gradient over with it: what is farthest from a number.
fn ratio(pairs: &[(&Point, &Point)], from: f64, of: fn(&Point) -> Spread) -> Found {
    let over = |(with, without): &(&Point, &Point)| {
        let ratio = Value::from(of(without)).over(of(with).into());
        (ratio, format!("without over with, farthest from {from}"))
    };
    farthest(pairs.iter().map(over).collect(), from, NO_PAIR)
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
        let note = format!("plateau of {} points", flat.points);
        return Ok((Value::new(flat.lift, flat.error), note));
    }
    let deepest = points.last().ok_or("no run has a gradient")?;
    let over = deepest.effective_depth / group.diameter;
    if over < DEEP {
        return Err(format!(
            "no plateau can be told, and the deepest run is at h~/D = {over:.0}, not {DEEP}"
        ));
    }
    Ok((deepest.lift.into(), format!("at h~/D = {over:.0}")))
}

fn deepest_over_next(group: &Group) -> Found {
    let points = group.with_gradient(true);
    seeds(&points)?;
    let [.., next, deepest] = &points[..] else {
        return Err("two depths with a gradient are wanted".into());
    };
    let over = [deepest, next].map(|p| p.effective_depth / group.diameter);
    Ok((
        Value::from(deepest.lift).over(next.lift.into()),
        format!("h~/D = {:.0} over {:.0}", over[0], over[1]),
    ))
}

fn no_lift(group: &Group) -> Found {
    let pairs = pairs(group);
    let points: Vec<&Point> = pairs.iter().flat_map(|(a, b)| [*a, *b]).collect();
    seeds(&points)?;
    ratio(&pairs, 0.0, |p| p.lift)
}

/// How far the bed is disturbed above over below: mean over the depths under lids with a gradient, and of those
/// without what is farthest from one. Few seeds tell little of their spread: it is taken over all depths.
fn zones(summary: &Summary, group: &Group, gradient: bool) -> Found {
    // Without a lid the surface is near.
    let points = group.with_gradient(gradient);
    let deep = points.into_iter().filter(|p| p.way != Way::Own);
    let of = |p: &Point| -> Option<Vec<f64>> {
        let over = |&k: &usize| {
            let [above, below] = summary.runs[k].flow.as_ref()?.disturbance?;
            Some(above / below)
        };
        p.runs.iter().map(over).collect()
    };
    let all: Vec<(&Point, Vec<f64>)> = deep.filter_map(|p| Some((p, of(p)?))).collect();
    if all.is_empty() {
        return Err("no run under a lid has fields: measure.fields asks for them".into());
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let free: usize = all.iter().map(|(_, runs)| runs.len() - 1).sum();
    if free == 0 {
        return Err(format!(
            "the zone is told from {SEEDS} seeds or more; there is 1"
        ));
    }
    let off = |runs: &Vec<f64>| {
        runs.iter()
            .map(|x| (x - mean(runs)) * (x - mean(runs)))
            .sum::<f64>()
    };
    let deviation = (all.iter().map(|(_, runs)| off(runs)).sum::<f64>() / free as f64).sqrt();
    let value = |(p, runs): &(&Point, Vec<f64>)| {
        let error = deviation / (runs.len() as f64).sqrt();
        let note = format!("h~/D = {:.0}", p.effective_depth / group.diameter);
        (Value::new(mean(runs), error), note)
    };
    let values: Vec<(Value, String)> = all.iter().map(value).collect();
    if !gradient {
        return farthest(values, 1.0, "");
    }
    let own: Vec<(f64, f64)> = values.iter().map(|(v, _)| (v.value, v.error)).collect();
    Ok((
        Spread::of(&own).into(),
        format!("mean of {} effective depths", own.len()),
    ))
}

/// The drag's two halves of the window, which begins after 2 D: farthest from equal.
fn halves(summary: &Summary) -> Found {
    let one = |run: &RunSummary| {
        let [first, second] = run.flow.as_ref()?.drag_halves;
        // Each half is known a root of two worse than the whole.
        let error = 2.0 * run.drag.standard_error / run.drag.mean;
        let note = "first half of the window over the second".to_string();
        Some((Value::new(first / second, error), note))
    };
    let all = summary.runs.iter().filter_map(one).collect();
    farthest(all, 1.0, "no bed flowed")
}
