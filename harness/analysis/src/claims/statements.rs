//! What Guillard 2014 says of a cylinder in a flowing bed, what these runs measured, and whether the two
//! agree.

use super::fits::{SAME_DEPTH, both, depths, drag_slope, flat, plateau};
use super::judged::{Judged, verdict_of};
use super::points::{Group, Point, groups};
use super::verdict::{Statement, Verdict};
use bitgrain_lab::scenario::{DRAG_COEFFICIENT, IntruderShape};
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::{number_with_error, short};

/// Largest relative difference between slopes that are near each other: the paper's own two, about 10 in
/// simulations and about 13 in the experiment, are called similar (Guillard 2014, section III B).
pub const DRAG_COEFFICIENT_NEAR: f64 = 0.3;
/// Largest residual of a line over its value, beyond which it is no line, if errors do not explain it.
const LINEAR: f64 = 0.1;
/// Fewest depths that a line or a plateau takes.
const DEPTHS: usize = 3;
/// Fewest seeds of every point whose lift is judged: it wanders by as much as itself.
const SEEDS: usize = 2;
/// Drags with and without a gradient are compared where the standard error of their ratio is below this.
const RESOLVED: f64 = 0.1;
/// They are equal within two standard errors or this.
const EQUAL: f64 = 0.05;
/// Saturated lift over buoyancy of a cylinder of D/d = 3.3 (Guillard 2014, section IV).
const LIFT: f64 = 30.0;
/// D/d of Guillard 2014, Fig. 8.
const OVER_GRAIN: f64 = 3.3;
/// How far another D/d may lie from it.
const OVER_GRAIN_NEAR: f64 = 0.05;
/// The lift is near the paper's within two standard errors or this part: what can be read off a figure
/// whose points scatter as much (Guillard 2014, Fig. 8(b)).
const LIFT_NEAR: f64 = 0.2;
/// A lift is none below so many standard errors, and below this part of the lift with a gradient.
const NO_LIFT: (f64, f64) = (3.0, 0.2);

/// All statements: four for each cylinder and speed, then three about the runs. Empty where no bed flows;
/// of a sphere the paper says nothing.
pub fn statements(summary: &Summary) -> Vec<Statement> {
    let groups = groups(summary);
    let mut out = Vec::new();
    let cylinder = summary.inputs.intruder.shape == IntruderShape::Cylinder;
    for group in groups.iter().filter(|_| cylinder) {
        let mut name = format!("D/d = {}", short(group.over_grain));
        if groups.iter().any(|g| g.speed != group.speed) {
            let unit = &summary.units.speed;
            name.push_str(&format!(", speed {} {unit}", short(group.speed)));
        }
        let length = &summary.units.length;
        out.push(drag_is_linear(group).into_statement(
            &format!("Drag against pressure, {name}"),
            "the drag over D L is proportional to the pressure rho g h~, with C_d about 10 \
             (section III B, Fig. 8(a))",
        ));
        out.push(drag_is_the_same(group, length).into_statement(
            &format!("Drag with and without gradient, {name}"),
            "no difference at the same pressure (section III B, Fig. 8(a))",
        ));
        out.push(lift_saturates(group, length).into_statement(
            &format!("Lift against depth, {name}"),
            "the lift saturates, at D/d = 3.3 near 30 times the buoyancy (sections III B and IV, \
             Fig. 8(b))",
        ));
        out.push(no_lift_without(group, length).into_statement(
            &format!("Lift without gradient, {name}"),
            "no significant lift without a pressure gradient (section III B, Fig. 8(b))",
        ));
    }
    if !groups.is_empty() {
        out.extend(super::soundness::statements(summary));
    }
    out
}

/// `3.1 ± 0.2` after the depth it belongs to.
fn at_depth(point: &Point, unit: &str, value: f64, error: f64) -> String {
    let depth = short(point.effective_depth);
    format!("{} at h~ = {depth} {unit}", number_with_error(value, error))
}

fn drag_is_linear(group: &Group) -> Judged {
    let Some(fit) = drag_slope(group) else {
        return Judged::unresolved("nothing", "No drag was measured.");
    };
    let measured = format!(
        "C_d = {}, largest residual {} of the line, {}",
        number_with_error(fit.slope, fit.error),
        short(fit.residual),
        several(fit.depths, "depth")
    );
    let apart = (fit.slope / DRAG_COEFFICIENT - 1.0).abs();
    let near =
        apart <= DRAG_COEFFICIENT_NEAR || (fit.slope - DRAG_COEFFICIENT).abs() <= 2.0 * fit.error;
    let straight = fit.residual <= LINEAR || fit.residual_in_errors <= 2.0;
    let judged = if fit.depths < DEPTHS {
        let near = if near { "within" } else { "not within" };
        Judged::unresolved(
            measured,
            format!(
                "C_d is {near} {DRAG_COEFFICIENT_NEAR} of {DRAG_COEFFICIENT}; whether the drag is linear \
                 takes {DEPTHS} depths."
            ),
        )
    } else if fit.error > DRAG_COEFFICIENT_NEAR * fit.slope.abs() {
        let reason =
            format!("The slope is not known to {DRAG_COEFFICIENT_NEAR}: more seeds are wanted.");
        Judged::unresolved(measured, reason)
    } else if near && straight {
        let reason = format!(
            "The slope is within {DRAG_COEFFICIENT_NEAR} of {DRAG_COEFFICIENT} or two of its errors, \
             and the residuals are below {LINEAR} or two errors."
        );
        Judged::new(Verdict::Agrees, measured, reason)
    } else {
        let reason = match (near, straight) {
            (false, true) => "The drag is linear, but with another slope.",
            (true, false) => {
                "The slope is the paper's, but the residuals are larger than errors allow."
            }
            _ => "The slope is another, and the residuals are larger than errors allow.",
        };
        Judged::new(Verdict::Disagrees, measured, reason)
    };
    judged.if_steady(group.points.iter())
}

/// `1 depth`, `3 depths`.
fn several(n: usize, name: &str) -> String {
    format!("{n} {name}{}", if n == 1 { "" } else { "s" })
}

/// Points with and without a gradient that were asked for at the same effective depth; what packing makes
/// of it is in the pressures.
fn pairs(group: &Group) -> Vec<(&Point, &Point)> {
    let with = group.with_gradient(true);
    let apart = |a: &Point, b: &Point| (a.asked / b.asked - 1.0).abs();
    let partner = |without: &'_ Point| {
        let near = with.iter().copied();
        near.min_by(|a, b| apart(a, without).total_cmp(&apart(b, without)))
            .filter(|a| apart(a, without) <= SAME_DEPTH)
    };
    let without = group.with_gradient(false).into_iter();
    without.filter_map(|p| Some((partner(p)?, p))).collect()
}

const NO_PAIR: &str =
    "No two runs with and without a pressure gradient have the same effective depth.";

fn drag_is_the_same(group: &Group, unit: &str) -> Judged {
    let pairs = pairs(group);
    if pairs.is_empty() {
        return Judged::unresolved("nothing", NO_PAIR);
    }
    let mut measured = Vec::new();
    let mut verdicts = Vec::new();
    for (with, without) in &pairs {
        let (a, b) = (with.drag_over_pressure, without.drag_over_pressure);
        let ratio = b.mean / a.mean;
        let error = both(a.error / a.mean, b.error / b.mean) * ratio.abs();
        measured.push(at_depth(without, unit, ratio, error));
        let off = (ratio - 1.0).abs();
        let converged = with.converged[0] && without.converged[0];
        let resolved = error < RESOLVED && off.is_finite() && converged;
        let equal = off <= 2.0 * error || off <= EQUAL;
        verdicts.push(match (resolved, equal) {
            (false, _) => Verdict::NotResolved,
            (true, true) => Verdict::Agrees,
            (true, false) => Verdict::Disagrees,
        });
    }
    let verdict = verdict_of(&verdicts);
    let open = verdicts
        .iter()
        .filter(|v| **v == Verdict::NotResolved)
        .count();
    let reason = match verdict {
        Verdict::Agrees if open > 0 => format!(
            "The ratios that are known to {RESOLVED} are 1 within two errors or {EQUAL}; {open} of {} \
             are not known so well.",
            verdicts.len()
        ),
        Verdict::Agrees => format!("Every ratio is 1 within two errors or {EQUAL}."),
        Verdict::Disagrees => format!("A ratio is off 1 by more than two errors and {EQUAL}."),
        Verdict::NotResolved => format!(
            "No ratio is known to {RESOLVED} with errors that converged: more seeds or travel are wanted."
        ),
    };
    let measured = format!(
        "drag over the stress at the axis, without over with: {}",
        measured.join("; ")
    );
    let points: Vec<&Point> = pairs.into_iter().flat_map(|(a, b)| [a, b]).collect();
    Judged::new(verdict, measured, reason).if_steady(points.into_iter())
}

fn lift_saturates(group: &Group, unit: &str) -> Judged {
    let points = group.with_gradient(true);
    let list = |points: &[&Point]| {
        let one = |p: &&Point| at_depth(p, unit, p.lift.mean, p.lift.error);
        points.iter().map(one).collect::<Vec<_>>().join("; ")
    };
    if points.is_empty() {
        return Judged::unresolved("nothing", "No run has a pressure gradient.");
    }
    let measured = format!("lift over buoyancy {}", list(&points));
    let (depths, seeds) = (depths(&points), Group::seeds(&points));
    if depths < DEPTHS || seeds < SEEDS {
        let reason = format!(
            "A plateau takes {DEPTHS} depths and {SEEDS} seeds of each; there are {} and {}.",
            several(depths, "depth"),
            several(seeds, "seed")
        );
        return Judged::unresolved(measured, reason);
    }
    let told = |p: &&Point| p.lift.mean.abs() > 2.0 * p.lift.error;
    if !points.iter().all(told) {
        let reason = "A lift is not told from zero by two errors: more seeds are wanted.";
        return Judged::unresolved(measured, reason);
    }
    let plateau = plateau(&points);
    if plateau.is_none() && flat(&points).is_some() {
        let reason = "The deepest points agree within two errors, but a lift that grows with depth would, \
                      too: more seeds are wanted.";
        return Judged::unresolved(measured, reason);
    }
    let Some(flat) = plateau else {
        let reason = "No shallower point agrees with the deepest within two errors: the lift still \
                      changes with depth.";
        let judged = Judged::new(Verdict::Disagrees, measured, reason);
        return judged.if_steady(points.into_iter());
    };
    let reached = flat.depth.map_or(String::new(), |depth| {
        let over = depth / group.diameter;
        format!(", 90 % of it at h~/D = {}", short(over))
    });
    let measured = format!(
        "plateau {} of {}{reached}; {measured}",
        number_with_error(flat.lift, flat.error),
        several(flat.points, "point")
    );
    let off = (flat.lift - LIFT).abs();
    let judged = if (group.over_grain - OVER_GRAIN).abs() > OVER_GRAIN_NEAR {
        Judged::unresolved(
            measured,
            format!("There is a plateau; its value is given for D/d = {OVER_GRAIN} alone."),
        )
    } else if flat.error > LIFT_NEAR * flat.lift.abs() {
        let reason = format!("The plateau is not known to {LIFT_NEAR}: more seeds are wanted.");
        Judged::unresolved(measured, reason)
    } else if off <= 2.0 * flat.error || off <= LIFT_NEAR * LIFT {
        let reason = format!("The plateau is {LIFT} within two errors or {LIFT_NEAR} of it.");
        Judged::new(Verdict::Agrees, measured, reason)
    } else {
        let reason =
            format!("The plateau is off {LIFT} by more than two errors and {LIFT_NEAR} of it.");
        Judged::new(Verdict::Disagrees, measured, reason)
    };
    judged.if_steady(points.into_iter())
}

fn no_lift_without(group: &Group, unit: &str) -> Judged {
    let pairs = pairs(group);
    if pairs.is_empty() {
        return Judged::unresolved("nothing", NO_PAIR);
    }
    let (errors, part) = NO_LIFT;
    let mut measured = Vec::new();
    let mut verdicts = Vec::new();
    for (with, without) in &pairs {
        let (a, b) = (with.lift, without.lift);
        measured.push(format!(
            "{} against {} with it",
            at_depth(without, unit, b.mean, b.error),
            number_with_error(a.mean, a.error)
        ));
        let none = b.mean.abs() < errors * b.error;
        let small = b.mean.abs() < part * a.mean;
        let known = a.mean > errors * a.error;
        verdicts.push(match (none, small) {
            (true, true) if known => Verdict::Agrees,
            (false, _) if b.mean.is_finite() => Verdict::Disagrees,
            _ => Verdict::NotResolved,
        });
    }
    let points: Vec<&Point> = pairs.into_iter().flat_map(|(a, b)| [a, b]).collect();
    let measured = format!("lift over buoyancy {}", measured.join("; "));
    let seeds = Group::seeds(&points);
    if seeds < SEEDS || points.iter().any(|p| !p.converged[1]) {
        let reason = format!(
            "A lift is judged from {SEEDS} seeds or more, with errors that converged; seeds here: {seeds}."
        );
        return Judged::unresolved(measured, reason).if_steady(points.into_iter());
    }
    let verdict = verdict_of(&verdicts);
    let reason = match verdict {
        Verdict::Agrees => format!(
            "It is below {errors} standard errors and below {part} of the lift with a gradient."
        ),
        Verdict::Disagrees => format!("Somewhere it is more than {errors} standard errors."),
        Verdict::NotResolved => format!(
            "It is zero within {errors} standard errors, but the errors with and without gradient are \
             too large to set it below {part} of the lift with one."
        ),
    };
    Judged::new(verdict, measured, reason).if_steady(points.into_iter())
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{self, Asked};
    use super::*;
    use crate::claims::Verdict::{Agrees, Disagrees, NotResolved};

    /// Verdicts on drag, its equality, the lift and its absence.
    fn verdicts(asked: &Asked) -> [Verdict; 4] {
        let all = statements(&synthetic::summary(asked));
        assert_eq!(all.len(), 7, "{all:?}");
        [0, 1, 2, 3].map(|k| all[k].verdict)
    }

    fn asked(change: impl Fn(&mut Asked)) -> Asked {
        let mut asked = Asked::default();
        change(&mut asked);
        asked
    }

    #[test]
    fn runs_as_the_paper_has_them_agree() {
        assert_eq!(verdicts(&Asked::default()), [Agrees; 4]);
    }

    #[test]
    fn another_drag_differs_and_two_depths_leave_it_open() {
        let steep = asked(|a| a.drag_coefficient = 20.0);
        assert_eq!(verdicts(&steep)[0], Disagrees);
        let few = asked(|a| a.depths = vec![0.08, 0.16]);
        assert_eq!(verdicts(&few)[0], NotResolved);
        let all = statements(&synthetic::summary(&few));
        assert!(all[0].measured.contains("C_d = 10"), "{:?}", all[0]);
        assert!(all[0].reason.contains("3 depths"), "{:?}", all[0]);
    }

    #[test]
    fn a_drag_that_the_gradient_changes_differs_where_errors_allow_to_tell() {
        let mut whole = synthetic::summary(&Asked::default());
        let change = |whole: &mut Summary, factor: f64| {
            for run in &mut whole.runs {
                if !run.flow.as_ref().unwrap().pressure_gradient {
                    run.drag.mean *= factor;
                }
            }
        };
        change(&mut whole, 1.5);
        assert_eq!(statements(&whole)[1].verdict, Disagrees);
        let mut vague = synthetic::summary(&asked(|a| a.error = 0.2));
        change(&mut vague, 1.5);
        let found = &statements(&vague)[1];
        assert_eq!(found.verdict, NotResolved, "{found:?}");
    }

    #[test]
    fn a_lift_takes_depths_seeds_and_a_plateau() {
        let one = asked(|a| a.seeds = 1);
        assert_eq!(verdicts(&one)[2], NotResolved);
        let few = asked(|a| a.depths = vec![0.08, 0.16]);
        assert_eq!(verdicts(&few)[2], NotResolved);
        let growing = asked(|a| a.lift = |depth| 400.0 * depth);
        assert_eq!(verdicts(&growing)[2], Disagrees);
        let high = asked(|a| a.lift = |_| 60.0);
        assert_eq!(verdicts(&high)[2], Disagrees);
    }

    #[test]
    fn a_lift_without_gradient_differs_and_large_errors_leave_it_open() {
        let there = asked(|a| a.lift_without = 15.0);
        assert_eq!(verdicts(&there)[3], Disagrees);
        let vague = asked(|a| (a.error, a.lift_without) = (0.3, 9.0));
        assert_eq!(verdicts(&vague)[3], NotResolved);
    }

    #[test]
    fn nothing_agrees_of_a_bed_that_slips_or_hardly_moved() {
        let slips = asked(|a| a.far_field = 0.9);
        assert_eq!(verdicts(&slips), [NotResolved; 4]);
        let all = statements(&synthetic::summary(&slips));
        assert!(all[0].reason.contains("0.9"), "{:?}", all[0]);
        let short = asked(|a| a.travel = 30.0);
        assert_eq!(verdicts(&short), [NotResolved; 4]);
        // What was measured is told all the same.
        assert!(
            all.iter()
                .all(|s| !s.measured.is_empty() && !s.reason.is_empty())
        );
    }

    #[test]
    fn what_is_no_number_agrees_with_nothing() {
        let mut whole = synthetic::summary(&Asked::default());
        for run in &mut whole.runs {
            run.drag.mean = f64::NAN;
            let flow = run.flow.as_mut().unwrap();
            (flow.lift_over_buoyancy, flow.far_field) = (f64::NAN, f64::NAN);
            flow.carried_by_base = f64::NAN;
            flow.travel = f64::NAN;
        }
        let all = statements(&whole);
        assert!(all.iter().all(|s| s.verdict != Agrees), "{all:?}");
    }

    #[test]
    fn a_summary_without_flowing_beds_says_nothing() {
        let mut whole = synthetic::summary(&Asked::default());
        whole.runs.iter_mut().for_each(|run| run.flow = None);
        assert!(statements(&whole).is_empty());
    }
}
