//! What the runs of flowing beds say of each claim of Guillard 2014.

use super::book::Claim;
use super::fits::{drag_slope, drag_slope_by_weight, same_depth};
use super::lifts::{lift, no_lift, no_lift_in_the_middle, saturation};
use super::load::loads;
use super::load_claims::measure as measure_loads;
use super::number::{Found, Number};
use super::pairs::{NO_PAIR, ratio};
use super::points::SEEDS;
use super::points::{FAR_FIELD_LEAST, TRAVEL_LEAST, least};
use super::points::{Group, Point, Spread, Way, groups};
use super::wake;
use crate::analysis::Value;
use bitgrain_lab::scenario::IntruderShape;
use bitgrain_lab::summary::{DragSummary, Summary};
use bitgrain_sim::format::plural;

/// D/d of the paper's simulations (Guillard 2014, Fig. 8).
const THIN: f64 = 3.3;
/// How far another D/d may lie from it.
const NEAR: f64 = 0.05;

/// Whether this is the cylinder of the paper's simulations.
pub(crate) fn is_thin(group: &Group) -> bool {
    (group.over_grain - THIN).abs() <= NEAR
}

/// The measurement of a claim of Guillard 2014; `None` if this paper has no such claim, or nothing here
/// measures it.
pub fn measure(claim: &Claim, summary: &Summary) -> Option<Found> {
    let rest = claim.id.strip_prefix("guillard-")?;
    let mut groups = groups(summary);
    groups.retain(is_thin);
    // The paper's cylinder lies in the middle of the bed.
    let off = |g: &Group| least(g.points.iter().map(|p| p.place.above_middle().abs()));
    groups.sort_by(|a, b| off(a).total_cmp(&off(b)));
    let cylinder = summary.inputs.intruder.shape == IntruderShape::Cylinder;
    let Some(group) = groups.first().filter(|_| cylinder) else {
        return Some(Err(format!("no run has a cylinder of D/d = {THIN}")));
    };
    let found = match rest {
        "half-turn" => wake::left_in_wake(summary, group),
        _ if wake::is_met(summary, group) => {
            Err("the cylinder has met its own wake in these runs".into())
        }
        "drag" => drag(group),
        "drag-gradient" => ratio(claim, group, |p| p.drag_over_pressure, |_| String::new()),
        "lift-saturates" => saturation(group),
        "lift-thirty" | "lift-thin" => lift(group),
        "no-lift" => no_lift(claim, group),
        "no-lift-middle" => no_lift_in_the_middle(claim, summary, &groups),
        "steady" => halves(summary),
        "zone" => zone(summary, group),
        "symmetry" => symmetry(claim, summary, group),
        _ => measure_loads(rest, claim, &loads(summary, group))?,
    };
    Some(found.and_then(|found| steady(group, found)))
}

/// Runs with a bed that slips or with too little travel do not count.
fn steady(group: &Group, found: Number) -> Found {
    let slowest = least(group.points.iter().map(|p| p.far_field));
    let shortest = least(group.points.iter().map(|p| p.travel));
    if slowest >= FAR_FIELD_LEAST && shortest >= TRAVEL_LEAST {
        return Ok(found);
    }
    let (value, note) = (found.value, found.note);
    Err(format!(
        "{:.3} +- {:.3} ({note}), but the windows hold {shortest:.0} grain diameters of travel of \
         {TRAVEL_LEAST} or more, and the slowest bed went at {slowest:.3} of its speed",
        value.value, value.error
    ))
}

fn drag(group: &Group) -> Found {
    let fit = drag_slope(group).ok_or("no drag was measured")?;
    let by_weight = drag_slope_by_weight(group).map_or(String::new(), |fit| {
        format!(
            "; {:.2} +- {:.2} times the weight measured above the axis",
            fit.slope, fit.error
        )
    });
    let depths = plural(fit.depths, "depth");
    let note = format!("slope of the drag over {depths}{by_weight}");
    Ok(Number::one(Value::new(fit.slope, fit.error), note))
}

/// How far the bed is disturbed above over below with a gradient, over the same without one: base and surface are
/// not as far from the cylinder, which affects both. Mean over the effective depths.
fn zone(summary: &Summary, group: &Group) -> Found {
    let (with, without) = (zones(summary, group, true)?, zones(summary, group, false)?);
    let same = |a: &Point, b: &Point| same_depth(a.asked, b.asked);
    let partner = |a: &Point| without.iter().find(|(b, _)| same(a, b));
    let both = with.iter().filter_map(|(a, value)| {
        let over = value.over(partner(a)?.1);
        Some((over.value, over.error))
    });
    let both: Vec<(f64, f64)> = both.collect();
    if both.is_empty() {
        return Err(NO_PAIR.into());
    }
    let note = format!(
        "mean of {}; {} with gradient alone",
        plural(both.len(), "effective depth"),
        with.iter()
            .map(|(_, v)| format!("{:.2}", v.value))
            .collect::<Vec<_>>()
            .join(", ")
    );
    Ok(Number::one(Spread::of(&both).into(), note))
}

/// The same without a gradient, at each effective depth.
fn symmetry(claim: &Claim, summary: &Summary, group: &Group) -> Found {
    let note = |p: &Point| format!("h~/D = {:.0}", p.effective_depth / group.diameter);
    let all = zones(summary, group, false)?.into_iter();
    claim.together(all.map(|(p, value)| (value, note(p))).collect(), NO_PAIR)
}

/// How far the bed is disturbed above over below, at each effective depth under a lid. The spread of few seeds is
/// poorly known: it is taken over all depths.
fn zones<'a>(
    summary: &Summary,
    group: &'a Group,
    gradient: bool,
) -> Result<Vec<(&'a Point, Value)>, String> {
    // Without a lid the surface is near.
    let points = group.with_gradient(gradient);
    let deep = points.into_iter().filter(|p| p.way != Way::Own);
    let mut all: Vec<(&Point, Vec<f64>)> = Vec::new();
    for point in deep {
        let mut ratios = Vec::new();
        for run in point.runs.iter().map(|&k| &summary.runs[k]) {
            let Some([above, below]) = run.flow.as_ref().and_then(|flow| flow.disturbance) else {
                continue;
            };
            if above <= 0.0 || below <= 0.0 {
                let name = &run.name;
                return Err(format!(
                    "{name}: the zone is not told from the noise of the far field"
                ));
            }
            ratios.push(above / below);
        }
        if !ratios.is_empty() {
            all.push((point, ratios));
        }
    }
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
    let value = |(point, runs): (&'a Point, Vec<f64>)| {
        let error = deviation / (runs.len() as f64).sqrt();
        (point, Value::new(mean(&runs), error))
    };
    Ok(all.into_iter().map(value).collect())
}

/// The drag's two halves of the window, which begins after 2 D: mean over the runs, each counted once. A run that
/// drifts has larger errors, so that weights would favour those that do not.
fn halves(summary: &Summary) -> Found {
    let one = |run: &DragSummary| {
        let [first, second] = run.flow.as_ref()?.drag_halves;
        // The error of each half is larger by a root of two.
        let error = (2.0 * run.drag.standard_error / run.drag.mean).abs();
        Some((first / second, error))
    };
    let all: Vec<(f64, f64)> = summary.runs.iter().filter_map(one).collect();
    if all.is_empty() {
        return Err("no bed flowed".into());
    }
    let spread = Spread::of(&all);
    let note = format!(
        "first half of the window over the second, mean of {} runs, from {:.2} to {:.2}",
        all.len(),
        spread.least,
        spread.most
    );
    Ok(Number::one(spread.into(), note))
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{self, Asked};
    use super::*;
    use bitgrain_lab::summary::Flow;
    use bitgrain_sim::coarse_graining::load::{Load, POINTS, Sum, theta};

    /// Fields of the paper's form: 15 P_0 cos(theta) in front, a disturbed zone of 3 above and 2 below
    /// with a gradient.
    fn with_fields(flow: &mut Flow) {
        let p = flow.pressure_measured;
        let front = |m: usize| 15.0 * p * libm::cos(theta(m)).max(0.0);
        let part = Sum {
            drag: 11.0 * p,
            lift: 0.0,
            normal_drag: 10.45 * p,
            normal_lift: 0.0,
            sine_square: 5.0 * p,
        };
        flow.load = Some(Load {
            normal: (0..POINTS).map(front).collect(),
            normal_error: vec![0.1 * p; POINTS],
            tangential: vec![0.5 * p; POINTS],
            tangential_error: vec![0.1 * p; POINTS],
            parts: vec![part; 8],
        });
        flow.disturbance = Some(if flow.pressure_gradient {
            [3.0, 2.0]
        } else {
            [2.1, 2.0]
        });
    }

    fn found(id: &str, change: fn(&mut Flow), seeds: u64) -> Found {
        let asked = Asked {
            change,
            seeds,
            ..Asked::default()
        };
        measure(&synthetic::shipped(id), &synthetic::summary(&asked)).unwrap()
    }

    #[test]
    fn fields_of_runs_are_measured() {
        let value = |id: &str| found(id, with_fields, 2).unwrap().value;
        // The axis bears half of the lift besides the weight: a hundredth.
        assert!((value("guillard-front").value / 15.0 - 1.0).abs() < 0.01);
        assert!(
            (value("guillard-equation-4").value / (10.0 / std::f64::consts::PI) - 1.0).abs() < 0.01
        );
        assert!((value("guillard-tangential").value - 0.05).abs() < 1e-12);
        assert!((value("guillard-zone").value - 1.5 / 1.05).abs() < 1e-12);
        assert!((value("guillard-symmetry").value - 1.05).abs() < 1e-12);
    }

    #[test]
    fn zones_have_the_spread_of_their_seeds() {
        // The deepest differs from the others, and is the farthest from one.
        let wide = |flow: &mut Flow| {
            let deep = flow.effective_depth > 0.15;
            flow.disturbance = Some([if deep { 2.4 } else { 2.0 }, 2.0]);
        };
        let number = found("guillard-symmetry", wide, 2).unwrap();
        assert_eq!(number.value, Value::new(1.2, 0.0));
        assert_eq!(number.note, "h~/D = 32, worst of 4");
        // The lift of a synthetic run differs by seed.
        let seeds = |flow: &mut Flow| {
            let more =
                flow.lift_over_buoyancy > 30.0 || (0.1..20.0).contains(&flow.lift_over_buoyancy);
            flow.disturbance = Some([if more { 2.2 } else { 1.8 }, 2.0]);
        };
        let number = found("guillard-zone", seeds, 2).unwrap();
        assert!(number.value.error > 0.0, "{number:?}");
    }

    #[test]
    fn zones_that_cannot_be_told_are_refused() {
        let why = |change: fn(&mut Flow), seeds| found("guillard-zone", change, seeds).unwrap_err();
        assert!(why(|_| (), 2).contains("measure.fields"));
        assert!(why(with_fields, 1).contains("2 seeds"));
        let noise = |flow: &mut Flow| flow.disturbance = Some([-0.2, -0.1]);
        assert!(why(noise, 2).contains("noise"));
    }

    /// Every run counts once: a run that drifts has a larger error, and does not count less.
    #[test]
    fn halves_of_the_window_are_compared_run_by_run() {
        let drifts = |flow: &mut Flow| {
            if flow.pressure_gradient {
                flow.drag_halves[0] *= 0.8;
                flow.drag_coefficient_error *= 5.0;
            }
        };
        let number = found("guillard-steady", drifts, 2).unwrap();
        assert!((number.value.value - 0.9).abs() < 1e-12, "{number:?}");
        assert!(
            number.note.contains("16 runs, from 0.80 to 1.00"),
            "{number:?}"
        );
    }
}
