//! Whether the runs are what they must be: the bed follows its base, forces balance, the state is steady.

use super::judged::{FAR_FIELD_LEAST, Judged, TRAVEL_LEAST};
use super::verdict::Statement;
use super::verdict::Verdict;
use bitgrain_lab::summary::{DragSummary, Flow, Summary};
use bitgrain_sim::format::{number_with_error, short};

/// Largest part of the drag that base and lid may not carry.
const BALANCE: f64 = 0.01;
/// The halves of a window are alike where they differ by less than so many standard errors of their
/// difference, which is twice the window's.
const HALVES: f64 = 3.0;

/// Deepest overlap over the mean diameter up to which grains are hard enough: at a twentieth the contact
/// of two equal grains is 0.45 of their radius wide, and Hertz's law takes it for narrow (Johnson, Contact
/// Mechanics, section 4.2).
pub const OVERLAP_MAX: f64 = 0.05;

/// What to beware of where the deepest overlap of a run, over the mean diameter, is beyond
/// [`OVERLAP_MAX`]; nothing where it is not. What is no number is beyond.
pub fn overlap_remark(deepest: f64) -> Option<String> {
    if deepest <= OVERLAP_MAX {
        return None;
    }
    Some(format!(
        "The deepest overlap is {} of the mean diameter, beyond {OVERLAP_MAX}: grains are too soft for \
         Hertz's law, which takes contacts for narrow, and forces may depend on the stiffness. Stiffer \
         grains, with a shorter time step, or a slower drag lower it.",
        short(deepest)
    ))
}

type Passage<'a> = (&'a DragSummary, &'a Flow);

/// The three statements about the runs themselves.
pub(super) fn statements(summary: &Summary) -> Vec<Statement> {
    let runs = summary.runs.iter();
    let runs: Vec<Passage> = runs
        .filter_map(|run| Some((run, run.flow.as_ref()?)))
        .collect();
    vec![
        follows(&runs).into_statement(
            "The bed follows its base",
            "far from the cylinder the bed moves as a block with its base (section III A)",
        ),
        balances(&runs).into_statement(
            "Base and lid carry the drag",
            "in a steady state nothing else holds the bed: the two carry all of it, to 0.01",
        ),
        steady(&runs, &summary.units.force).into_statement(
            "A steady state",
            "it is reached after 2 cylinder diameters (section III A)",
        ),
    ]
}

/// The least and the largest; NaN if one is no number.
fn span(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    if values.clone().any(f64::is_nan) {
        return (f64::NAN, f64::NAN);
    }
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    values.fold(start, |(low, high), x| {
        (
            if x < low { x } else { low },
            if x > high { x } else { high },
        )
    })
}

fn range((low, high): (f64, f64)) -> String {
    match (short(low), short(high)) {
        (low, high) if low == high => low,
        (low, high) => format!("{low} to {high}"),
    }
}

fn follows(runs: &[Passage]) -> Judged {
    let whole = span(runs.iter().map(|(_, flow)| flow.far_field));
    let layers = span(runs.iter().map(|(_, flow)| flow.far_field_least));
    let measured = format!(
        "far grains at {} of the speed, in the slowest layer {}",
        range(whole),
        range(layers)
    );
    if whole.0 >= FAR_FIELD_LEAST {
        let reason = format!("Every run is at {FAR_FIELD_LEAST} or more.");
        return Judged::new(Verdict::Agrees, measured, reason);
    }
    let reason = format!(
        "A run is below {FAR_FIELD_LEAST}: base and lid slip under the drag, and the speed past the \
         cylinder is not the one asked for."
    );
    Judged::new(Verdict::Disagrees, measured, reason)
}

fn balances(runs: &[Passage]) -> Judged {
    // What pushes the free grains changes their momentum: base and lid forward, the cylinder back.
    let carried = |flow: &Flow| flow.carried_by_base + flow.carried_by_lid;
    let missing = |flow: &Flow| carried(flow) - 1.0 - flow.inertia;
    let measured = format!(
        "base {}, lid {}, together {} of the drag; {} of it went into the bed's momentum",
        range(span(runs.iter().map(|(_, f)| f.carried_by_base))),
        range(span(runs.iter().map(|(_, f)| f.carried_by_lid))),
        range(span(runs.iter().map(|(_, f)| carried(f)))),
        range(span(runs.iter().map(|(_, f)| f.inertia))),
    );
    let all = |of: &dyn Fn(&Flow) -> f64| runs.iter().all(|(_, f)| of(f).abs() <= BALANCE);
    if all(&|f| carried(f) - 1.0) {
        let reason = format!("In every run the two carry the drag to {BALANCE}.");
        return Judged::new(Verdict::Agrees, measured, reason);
    }
    if all(&missing) {
        let reason = format!(
            "With the change of the bed's momentum forces balance to {BALANCE}, but without it they do \
             not: the window ends in another state than it begins."
        );
        return Judged::unresolved(measured, reason);
    }
    let reason = format!("More than {BALANCE} of the drag is carried by nothing that is measured.");
    Judged::new(Verdict::Disagrees, measured, reason)
}

/// The pair of halves that is farthest apart in standard errors of their difference, and how far.
fn farthest<'a>(
    runs: &'a [Passage<'a>],
    of: impl Fn(&Passage<'a>) -> ([f64; 2], f64),
) -> (f64, [f64; 2], f64) {
    let mut most = (-1.0, [f64::NAN; 2], f64::NAN);
    for run in runs {
        let (halves, error) = of(run);
        let apart = (halves[0] - halves[1]).abs() / (2.0 * error);
        // What is no number is farthest.
        if apart > most.0 || apart.is_nan() {
            most = (apart, halves, error);
        }
    }
    most
}

fn steady(runs: &[Passage], force: &str) -> Judged {
    let travel = span(runs.iter().map(|(_, f)| f.travel));
    let drag = farthest(runs, |(run, f)| (f.drag_halves, run.drag.standard_error));
    let lift = farthest(runs, |(_, f)| (f.lift_halves, f.lift_over_buoyancy_error));
    let halves = |(_, [a, b], error): (f64, [f64; 2], f64)| {
        format!(
            "{} and {}",
            short(a),
            number_with_error(b, 2f64.sqrt() * error)
        )
    };
    let open = |run: &&Passage| !(run.0.drag.converged && run.0.lift.converged);
    let open = runs.iter().filter(open).count();
    let measured = format!(
        "{} grain diameters of travel; halves that differ most: drag {} {force}, lift over buoyancy {}; \
         block errors converged in {} of {} runs",
        range(travel),
        halves(drag),
        halves(lift),
        runs.len() - open,
        runs.len()
    );
    let slowest = span(runs.iter().map(|(_, f)| f.far_field)).0;
    let (far, follows) = (travel.0 >= TRAVEL_LEAST, slowest >= FAR_FIELD_LEAST);
    if !far {
        let reason = format!("A steady state takes {TRAVEL_LEAST} grain diameters of travel.");
        return Judged::unresolved(measured, reason);
    }
    if !follows {
        let reason = format!(
            "The bed did not follow its base: its far grains went at {} of the speed.",
            short(slowest)
        );
        return Judged::unresolved(measured, reason);
    }
    if open > 0 {
        let reason = "Longer blocks were wanted for an error: the window is short for what the force \
                      remembers, or the force drifts.";
        return Judged::unresolved(measured, reason);
    }
    if drag.0 <= HALVES && lift.0 <= HALVES {
        let reason = "In every run the halves of the window agree within errors.";
        return Judged::new(Verdict::Agrees, measured, reason);
    }
    let reason = "A force drifts: the halves of a window differ by more than errors allow.";
    Judged::new(Verdict::Disagrees, measured, reason)
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{self, Asked};
    use super::*;
    use Verdict::{Agrees, Disagrees, NotResolved};

    /// Verdicts on following, balance and steadiness.
    fn verdicts(whole: &Summary) -> [Verdict; 3] {
        let all = statements(whole);
        [0, 1, 2].map(|k| all[k].verdict)
    }

    fn changed(change: fn(&mut Flow)) -> Summary {
        synthetic::summary(&Asked {
            change,
            ..Asked::default()
        })
    }

    #[test]
    fn soft_contacts_are_remarked_on() {
        assert_eq!(overlap_remark(OVERLAP_MAX), None);
        let told = overlap_remark(0.0724).unwrap();
        assert!(told.contains("0.0724 of the mean diameter"), "{told}");
        assert!(overlap_remark(f64::NAN).is_some());
    }

    #[test]
    fn sound_runs_are_sound() {
        assert_eq!(verdicts(&changed(|_| ())), [Agrees; 3]);
    }

    #[test]
    fn a_bed_that_slips_is_no_steady_state_either() {
        let found = verdicts(&changed(|f| f.far_field = 0.94));
        assert_eq!(found, [Disagrees, Agrees, NotResolved]);
    }

    #[test]
    fn forces_that_do_not_add_up_differ_unless_the_bed_takes_them_up() {
        assert_eq!(
            verdicts(&changed(|f| f.carried_by_lid = 0.45))[1],
            Disagrees
        );
        let speeds_up = |f: &mut Flow| (f.carried_by_lid, f.inertia) = (0.55, 0.05);
        assert_eq!(verdicts(&changed(speeds_up))[1], NotResolved);
        let wrong_way = |f: &mut Flow| (f.carried_by_lid, f.inertia) = (0.55, -0.05);
        assert_eq!(verdicts(&changed(wrong_way))[1], Disagrees);
    }

    #[test]
    fn a_drift_a_short_window_and_an_open_error_are_told() {
        assert_eq!(
            verdicts(&changed(|f| f.lift_halves[1] += 20.0))[2],
            Disagrees
        );
        assert_eq!(verdicts(&changed(|f| f.travel = 59.0))[2], NotResolved);
        let mut open = changed(|_| ());
        open.runs[3].lift.converged = false;
        let found = &statements(&open)[2];
        assert_eq!(found.verdict, NotResolved);
        let (all, rest) = (open.runs.len(), open.runs.len() - 1);
        assert!(found.measured.contains(&format!("in {rest} of {all} runs")));
    }
}
