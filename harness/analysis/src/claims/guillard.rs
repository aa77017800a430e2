//! What the runs of flowing beds say of each claim of Guillard 2014.

use super::fits::{drag_slope, drag_slope_by_weight, plateau, same_depth};
use super::kumar_curves::{Found, farthest};
use super::load::loads;
use super::load_claims::measure as measure_loads;
use super::means::means_of;
use super::points::{DEEP, SEEDS};
use super::points::{FAR_FIELD_LEAST, TRAVEL_LEAST, least};
use super::points::{Group, Point, Spread, Way, groups};
use super::wake;
use crate::analysis::Value;
use bitgrain_lab::scenario::IntruderShape;
use bitgrain_lab::summary::{DragSummary, Summary};

/// D/d of the paper's simulations (Guillard 2014, Fig. 8).
const THIN: f64 = 3.3;
/// How far another D/d may lie from it.
const NEAR: f64 = 0.05;
/// Lift over buoyancy of the experiment below D/d = 5, as far as the text names it (Guillard 2014, Fig. 5).
const EXPERIMENT: f64 = 60.0;

/// The measurement of a claim of Guillard 2014; `None` if this paper has no such claim, or nothing here
/// measures it.
pub fn measure(id: &str, summary: &Summary) -> Option<Found> {
    let rest = id.strip_prefix("guillard-")?;
    let mut groups = groups(summary);
    groups.retain(|g| (g.over_grain - THIN).abs() <= NEAR);
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
        "drag-gradient" => ratio(&pairs(group), 1.0, |p| p.drag_over_pressure),
        "lift-saturates" => deepest_over_next(group),
        "lift-thirty" | "lift-thin" => lift(group),
        "lift-simulation" => lift(group).map(|(v, note)| (v.divided(EXPERIMENT), note)),
        "no-lift" => no_lift(group),
        "no-lift-middle" => no_lift_in_the_middle(summary, &groups),
        "steady" => halves(summary),
        "zone" => zone(summary, group),
        "symmetry" => symmetry(summary, group),
        _ => measure_loads(rest, &loads(summary, group))?,
    };
    Some(found.and_then(|found| steady(group, found)))
}

/// Runs with a bed that slips or with too little travel do not count.
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
    let by_weight = drag_slope_by_weight(group).map_or(String::new(), |fit| {
        format!(
            "; {:.2} +- {:.2} times the weight measured above the axis",
            fit.slope, fit.error
        )
    });
    let note = format!("slope of the drag over {} depths{by_weight}", fit.depths);
    Ok((Value::new(fit.slope, fit.error), note))
}

/// Points with and without a gradient at one effective depth.
fn pairs(group: &Group) -> Vec<(&Point, &Point)> {
    let with = group.with_gradient(true);
    let same = |a: &Point, b: &Point| same_depth(a.asked, b.asked);
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

/// A quantity of each pair, without a gradient over with it: the one farthest from a number.
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

/// The plateau, or the deepest points if they are deep enough for one.
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
    let (value, note) = ratio(&pairs, 0.0, |p| p.lift)?;
    let place = points[0].place.words(group.diameter);
    Ok((value, format!("{note}; axis {place}")))
}

/// The lift without a gradient with the axis in the middle of the bed, as in the paper. Base and surface may make a lift
/// of their own: the note has it with the axis at other places, too, where it would change sign with their distances.
fn no_lift_in_the_middle(summary: &Summary, groups: &[Group]) -> Found {
    let all: Vec<(&Group, &Point)> = groups
        .iter()
        .flat_map(|group| {
            let own = group.with_gradient(false).into_iter();
            own.map(move |point| (group, point))
        })
        .collect();
    let told = |(group, point): &(&Group, &Point)| {
        let odd = means_of(summary, group, point)
            .odd
            .map_or(String::new(), |odd| {
                format!(
                    ", odd part {:.1} +- {:.1} of eq. 4's curve,",
                    odd.value, odd.error
                )
            });
        format!(
            "{:.1} +- {:.1}{odd} with the axis {} at h~/D = {:.0}",
            point.lift.mean,
            point.lift.error,
            point.place.words(group.diameter),
            point.effective_depth / group.diameter
        )
    };
    let words = || all.iter().map(told).collect::<Vec<_>>().join("; ");
    let middle = all
        .iter()
        .filter(|(group, point)| point.place.is_middle(group.diameter));
    let middle: Vec<&Point> = middle.map(|(_, point)| *point).collect();
    match (all.len(), middle.len()) {
        (0, _) => return Err("no run is without a pressure gradient".into()),
        (_, 0) => {
            return Err(format!(
                "no axis lies in the middle of the bed: {}",
                words()
            ));
        }
        _ => {}
    }
    seeds(&middle)?;
    let lifts = middle.iter().map(|p| (p.lift.into(), words()));
    farthest(lifts.collect(), 0.0, "")
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
        "mean of {} effective depths; {} with gradient alone",
        both.len(),
        with.iter()
            .map(|(_, v)| format!("{:.2}", v.value))
            .collect::<Vec<_>>()
            .join(", ")
    );
    Ok((Spread::of(&both).into(), note))
}

/// The same without a gradient: of the effective depths the one farthest from one.
fn symmetry(summary: &Summary, group: &Group) -> Found {
    let note = |p: &Point| format!("h~/D = {:.0}", p.effective_depth / group.diameter);
    let all = zones(summary, group, false)?.into_iter();
    farthest(all.map(|(p, value)| (value, note(p))).collect(), 1.0, "")
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

/// The drag's two halves of the window, which begins after 2 D: farthest from equal.
fn halves(summary: &Summary) -> Found {
    let one = |run: &DragSummary| {
        let [first, second] = run.flow.as_ref()?.drag_halves;
        // The error of each half is larger by a root of two.
        let error = (2.0 * run.drag.standard_error / run.drag.mean).abs();
        let note = "first half of the window over the second".to_string();
        Some((Value::new(first / second, error), note))
    };
    let all = summary.runs.iter().filter_map(one).collect();
    farthest(all, 1.0, "no bed flowed")
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
        measure(id, &synthetic::summary(&asked)).unwrap()
    }

    #[test]
    fn fields_of_runs_are_measured() {
        let value = |id: &str| found(id, with_fields, 2).unwrap().0;
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
        let (value, note) = found("guillard-symmetry", wide, 2).unwrap();
        assert_eq!(
            (value.value, value.error, &note[..]),
            (1.2, 0.0, "h~/D = 32")
        );
        // The lift of a synthetic run differs by seed.
        let seeds = |flow: &mut Flow| {
            let more =
                flow.lift_over_buoyancy > 30.0 || (0.1..20.0).contains(&flow.lift_over_buoyancy);
            flow.disturbance = Some([if more { 2.2 } else { 1.8 }, 2.0]);
        };
        let (value, _) = found("guillard-zone", seeds, 2).unwrap();
        assert!(value.error > 0.0, "{value:?}");
    }

    #[test]
    fn zones_that_cannot_be_told_are_refused() {
        let why = |change: fn(&mut Flow), seeds| found("guillard-zone", change, seeds).unwrap_err();
        assert!(why(|_| (), 2).contains("measure.fields"));
        assert!(why(with_fields, 1).contains("2 seeds"));
        let noise = |flow: &mut Flow| flow.disturbance = Some([-0.2, -0.1]);
        assert!(why(noise, 2).contains("noise"));
    }

    /// A lift that base and surface make, 400 buoyancies for a metre off the middle: the claim's number is that of the
    /// axis in the middle, the note has the others.
    #[test]
    fn the_lift_without_a_gradient_is_that_of_the_middle() {
        let at = |heights: &[f64], seeds| {
            let asked = Asked {
                heights: heights.to_vec(),
                depths: vec![0.099],
                lift_without: |height| 400.0 * (height - 0.5 * synthetic::SURFACE),
                seeds,
                ..Asked::default()
            };
            measure("guillard-no-lift-middle", &synthetic::summary(&asked)).unwrap()
        };
        let (value, note) = at(&[0.024, 0.03, 0.036], 2).unwrap();
        assert!(value.value.abs() < 1e-12 && value.error > 0.1, "{value:?}");
        for part in [
            "0.0 +- 0.6 with the axis 6.1 D above the floor and 6.1 D below the surface at h~/D = 20",
            "-2.4 +- 0.6 with the axis 4.8 D above the floor and 7.3 D below",
            "2.4 +- 0.6 with the axis 7.3 D above the floor and 4.8 D below",
        ] {
            assert!(note.contains(part), "{part}: {note}");
        }
        assert!(at(&[0.03], 1).unwrap_err().contains("2 seeds"));
        let why = at(&[0.024], 2).unwrap_err();
        assert!(
            why.contains("in the middle") && why.contains("-2.4 +- 0.6"),
            "{why}"
        );
    }

    /// Of several places the one nearest to the middle is measured, and none is paired with another.
    #[test]
    fn claims_are_about_the_place_nearest_to_the_middle() {
        let asked = Asked {
            heights: vec![0.024, 0.031],
            lift_without: |height| if height < 0.03 { 15.0 } else { 3.0 },
            ..Asked::default()
        };
        let (value, note) = measure("guillard-no-lift", &synthetic::summary(&asked))
            .unwrap()
            .unwrap();
        // The shallowest has a lift of 20 with a gradient.
        assert!((value.value - 3.0 / 20.0).abs() < 1e-9, "{value:?}");
        assert!(note.contains("axis 6.3 D above the floor"), "{note}");
    }
}
