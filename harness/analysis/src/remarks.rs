//! What to know before the numbers of a run are believed: printed when it ends, and at the top of its report.

use crate::claims::{FAR_FIELD_LEAST, groups, same_depth};
use bitgrain_lab::plug_flow::PlugFlow;
use bitgrain_lab::scenario::IntruderMotion;
use bitgrain_lab::summary::{BedSummary, DragSummary, Flow, LARGE_OVERLAP, Released, Summary};
use bitgrain_sim::format::short;

/// Packing fraction above which equal spheres are not a random packing (random close packing).
const CLOSE: f64 = 0.64;

/// Largest part of the drag that may be carried by nothing measured.
const BALANCE: f64 = 0.01;

/// Standard errors of the difference of a window's halves up to which they are alike.
const HALVES: f64 = 3.0;

/// A remark that weakens numbers, as plain text; keys of a scenario stand between backticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// What it is, without a full stop.
    pub title: String,
    /// What follows from it, and what helps.
    pub words: String,
}

fn remark(title: impl Into<String>, words: String) -> Remark {
    Remark {
        title: title.into(),
        words,
    }
}

/// All remarks on the numbers of a run.
pub fn remarks(summary: &Summary) -> Vec<Remark> {
    // What weakens a mean drag says nothing of intruders that forces move.
    let held = summary.runs.iter().filter(|run| run.released.is_none());
    let runs: &[DragSummary] = &held.cloned().collect::<Vec<_>>();
    let flows = runs.iter().any(|run| run.flow.is_some());
    let mut out: Vec<Remark> = part(summary).into_iter().collect();
    out.extend(still_moving(summary));
    out.extend(own_wake(summary));
    out.extend(near_the_base(summary));
    out.extend(summary.beds.iter().filter_map(unrest));
    out.extend(slips(runs));
    out.extend(balance(runs));
    out.extend(drifts(runs));
    out.extend(crystal(summary));
    out.extend(floating(runs));
    out.extend(open_errors(runs));
    out.extend(start_up(runs, flows));
    out.extend(overlap(summary));
    out.extend(plug(runs));
    out
}

/// Names of the runs for which something holds.
fn names(runs: &[DragSummary], so: impl Fn(&DragSummary) -> bool) -> String {
    let found = runs.iter().filter(|run| so(run));
    let names: Vec<&str> = found.map(|run| &run.name[..]).collect();
    names.join(", ")
}

/// Numbers of some runs as a range.
fn range(values: impl Iterator<Item = f64> + Clone) -> String {
    let least = values.clone().fold(f64::INFINITY, f64::min);
    let most = values.fold(f64::NEG_INFINITY, f64::max);
    match (short(least), short(most)) {
        (least, most) if least == most => least,
        (least, most) => format!("{least} to {most}"),
    }
}

fn part(summary: &Summary) -> Option<Remark> {
    let (done, planned) = (summary.runs.len(), summary.inputs.drags().len());
    (done < planned).then(|| {
        let words = format!("{done} of {planned} drags are done; everything here is about these.");
        remark("A part", words)
    })
}

/// The runs of a summary for which something holds of an intruder that forces move.
fn released(summary: &Summary, so: impl Fn(&DragSummary, &Released) -> bool) -> String {
    names(&summary.runs, |run| {
        run.released.as_ref().is_some_and(|known| so(run, known))
    })
}

/// Spheres that were dropped and did not come to rest.
fn still_moving(summary: &Summary) -> Option<Remark> {
    let moving = released(summary, |_, known| known.rest.is_none());
    (summary.inputs.is_dropped() && !moving.is_empty()).then(|| {
        let words = format!(
            "In {moving} the sphere still moved at the end: its depth is that of a moment. A longer `drag.duration` \
             helps, unless it rolls on the surface."
        );
        remark("Not at rest", words)
    })
}

/// Spheres that were pulled through the place where they began.
fn own_wake(summary: &Summary) -> Option<Remark> {
    let length = summary.inputs.bed.size[0];
    let pulled = summary.inputs.intruder.force.is_some();
    let far = released(summary, |run, _| run.distance > length - run.diameter);
    (pulled && !far.is_empty()).then(|| {
        let words = format!(
            "In {far} the sphere went on beyond the length of the box, {}, through its own wake: its late speed is \
             that in a disturbed bed. A shorter `drag.duration` or a longer `bed.box` helps.",
            short(length)
        );
        remark("Own wake", words)
    })
}

/// Spheres that came within a diameter of the base.
fn near_the_base(summary: &Summary) -> Option<Remark> {
    let base = summary.inputs.bed.base;
    let deep = released(summary, |run, known| {
        known.lowest - base < 1.5 * run.diameter
    });
    let moves_down = summary.inputs.intruder.motion != IntruderMotion::Pulled;
    (moves_down && !deep.is_empty()).then(|| {
        let words = format!(
            "In {deep} the lowest point of the sphere came within a diameter of the base, which then carries a part of \
             it. A deeper bed helps."
        );
        remark("Near the base", words)
    })
}

/// A bed that is not at rest, as one from a file may be.
fn unrest(bed: &BedSummary) -> Option<Remark> {
    ((bed.support / bed.weight - 1.0).abs() > 1e-3).then(|| {
        let words = format!(
            "Base, floor and intruder carry {} of its weight, and its kinetic energy per grain is {} of the \
             weight times d: the first measurements are of a bed that still comes to rest.",
            short(bed.support / bed.weight),
            short(bed.kinetic_energy_over_weight_d)
        );
        remark(format!("{} is not at rest", bed.name), words)
    })
}

fn flow_names(runs: &[DragSummary], so: impl Fn(&Flow) -> bool) -> String {
    names(runs, |run| run.flow.as_ref().is_some_and(&so))
}

fn slips(runs: &[DragSummary]) -> Option<Remark> {
    let slow = flow_names(runs, |f| {
        f.far_field < FAR_FIELD_LEAST || f.far_field.is_nan()
    });
    (!slow.is_empty()).then(|| {
        let words = format!(
            "In {slow} the grains far from the intruder move at less than {FAR_FIELD_LEAST} of the speed of \
             the base: its forces belong to another speed and to a bed that shears. A longer box lets base \
             and lid carry more."
        );
        remark("The bed slips", words)
    })
}

/// Runs in which the force that holds the bed is not the force on the intruder.
fn balance(runs: &[DragSummary]) -> Option<Remark> {
    let missing = |f: &Flow| (f.carried_by_base + f.carried_by_lid - 1.0 - f.inertia).abs();
    let open = flow_names(runs, |f| missing(f) > BALANCE || missing(f).is_nan());
    (!open.is_empty()).then(|| {
        let words = format!(
            "In {open} more than {BALANCE} of the drag is balanced neither by base and lid nor by the bed's momentum."
        );
        remark("Forces do not balance", words)
    })
}

/// Runs whose halves differ in mean drag by more than chance gives.
fn drifts(runs: &[DragSummary]) -> Option<Remark> {
    let apart = |run: &DragSummary, f: &Flow| {
        // The error of a difference of halves is twice that of the mean.
        let [a, b] = f.drag_halves;
        (a - b).abs() > HALVES * 2.0 * run.drag.standard_error
    };
    let open = names(runs, |run| run.flow.as_ref().is_some_and(|f| apart(run, f)));
    (!open.is_empty()).then(|| {
        let words = format!(
            "The mean drags of the two halves of the window of {open} differ by more than {HALVES} standard errors \
             of their difference: the state is not steady. A longer `drag.discard` and `drag.distance` help."
        );
        remark("The drag still changes", words)
    })
}

fn crystal(summary: &Summary) -> Option<Remark> {
    let [least, most] = summary.inputs.bed.diameters;
    let close = flow_names(&summary.runs, |f| f.packing_fraction > CLOSE);
    (least == most && !close.is_empty()).then(|| {
        let words = format!(
            "In {close} the packing fraction is above {CLOSE}, higher than in any random packing of equal spheres."
        );
        remark("The bed crystallises", words)
    })
}

fn floating(runs: &[DragSummary]) -> Option<Remark> {
    let flows = runs.iter().filter_map(|run| run.flow.as_ref());
    let most = flows.map(|flow| flow.floating).max().unwrap_or(0);
    (most > 0).then(|| {
        let grains = if most == 1 { "grain" } else { "grains" };
        let words = format!(
            "Up to {most} free {grains} came to lie above the lid at one time (in {}): they are counted, and \
             stay there.",
            flow_names(runs, |flow| flow.floating > 0)
        );
        remark("Grains above the lid", words)
    })
}

/// Runs whose errors did not converge.
fn open_errors(runs: &[DragSummary]) -> Option<Remark> {
    let open = names(runs, |run| !run.drag.converged);
    (!open.is_empty()).then(|| {
        let words = format!(
            "The averaging window of {open} is too short for the error of the mean drag: it may be larger \
             than stated. A longer `drag.distance` helps."
        );
        remark("Errors that did not converge", words)
    })
}

/// Runs whose drag from the start is not that of the window.
fn start_up(runs: &[DragSummary], flows: bool) -> Option<Remark> {
    let ratio = |run: &DragSummary| run.drag_uncut / run.drag.mean;
    let off = |run: &DragSummary| {
        let change = (run.drag_uncut - run.drag.mean).abs();
        change > 2.0 * run.drag.standard_error && ratio(run).is_finite()
    };
    let found = names(runs, off);
    (!found.is_empty()).then(|| {
        let paper = match flows {
            true => "Guillard 2014 averages after a travel of 2 D (section III A), as the window does",
            false => "Kumar 2018 averages from the start (Fig. 4)",
        };
        let words = format!(
            "The mean drag from the start of {found} is {} times that of the averaging window, more than two \
             standard errors off. Before you compare, check which of the two means the other work \
             reports: {paper}.",
            range(runs.iter().filter(|run| off(run)).map(ratio))
        );
        remark("Start-up", words)
    })
}

/// The largest of some numbers; `None` of none.
fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(|a, b| if b > a { b } else { a })
}

/// Deepest overlap of some runs, over the mean diameter, and the largest share of their contacts beyond
/// [`LARGE_OVERLAP`], if one of them says it.
fn overlaps<'a>(runs: impl Iterator<Item = &'a DragSummary> + Clone) -> (f64, Option<f64>) {
    let deepest = largest(runs.clone().map(|run| run.overlap_max));
    let share = largest(runs.filter_map(|run| run.large_overlaps));
    (deepest.unwrap_or(0.0), share)
}

/// A share in percent.
fn percent(share: f64) -> String {
    format!("{} %", short(100.0 * share))
}

/// Overlaps of beds that flow, by the effective depth asked for over D: they grow with the pressure.
fn overlaps_by_depth(summary: &Summary) -> Vec<String> {
    let mut depths: Vec<(f64, Vec<&DragSummary>)> = Vec::new();
    for group in groups(summary) {
        for point in &group.points {
            let over = point.asked / group.diameter;
            let runs = point.runs.iter().map(|&k| &summary.runs[k]);
            match depths
                .iter_mut()
                .find(|(depth, _)| same_depth(*depth, over))
            {
                Some((_, all)) => all.extend(runs),
                None => depths.push((over, runs.collect())),
            }
        }
    }
    depths.sort_by(|a, b| a.0.total_cmp(&b.0));
    let words = |(depth, runs): (f64, Vec<&DragSummary>)| {
        let (deepest, share) = overlaps(runs.into_iter());
        let share = share.map_or(String::new(), |share| format!(", {}", percent(share)));
        format!("{} at {} D{share}", short(deepest), short(depth))
    };
    depths.into_iter().map(words).collect()
}

/// Grains that overlap deeply: how deep, what share of the contacts, and in beds that flow at which effective depths.
fn overlap(summary: &Summary) -> Option<Remark> {
    let (deepest, share) = overlaps(summary.runs.iter());
    if deepest <= LARGE_OVERLAP {
        return None;
    }
    let share = match share {
        None => String::new(),
        Some(0.0) => " In the last state of no drag is a contact beyond it.".into(),
        Some(share) => format!(
            " Of the contacts in the last state of a drag up to {} are beyond it.",
            percent(share)
        ),
    };
    let by_depth = match overlaps_by_depth(summary) {
        all if all.is_empty() => String::new(),
        all => format!(" By effective depth: {}.", all.join("; ")),
    };
    let lid = match summary.inputs.lid {
        Some(_) => ", a lighter lid",
        None => "",
    };
    let words = format!(
        "The deepest overlap is {} of the mean diameter, beyond {LARGE_OVERLAP}: grains are too soft for \
         Hertz's law, which assumes narrow contacts, and forces may depend on the stiffness.{share}{by_depth} \
         Stiffer grains, with a shorter time step{lid}, or a slower drag lower the overlap.",
        short(deepest)
    );
    Some(remark("Soft contacts", words))
}

/// Layers above the intruder that move along with it.
fn plug(runs: &[DragSummary]) -> Option<Remark> {
    let class = |wanted| names(runs, move |run| run.plug == wanted);
    let (slides, drifts) = (class(PlugFlow::Slides), class(PlugFlow::Drifts));
    let parts = [
        (
            &slides,
            "they slide along, and the drag depends on the box as much as on the intruder",
        ),
        (&drifts, "they drift along, and the drag may be too small"),
    ];
    let parts = parts.iter().filter(|(names, _)| !names.is_empty());
    let parts: Vec<String> = parts
        .map(|(names, what)| format!("in {names} {what}"))
        .collect();
    (!parts.is_empty()).then(|| {
        let moved = runs
            .iter()
            .filter(|run| matches!(run.plug, PlugFlow::Slides | PlugFlow::Drifts));
        let drift = moved.clone().filter_map(|run| Some(run.drift?.mean));
        let speed = match drift.clone().count() {
            0 => String::new(),
            _ => format!(" Their speed is {} of the intruder's.", range(drift)),
        };
        let words = format!(
            "In a periodic box only friction holds the layers above the intruder back, and the drag is \
             {} of their weight (the plug ratio): {}.{speed} A wider `bed.box` lowers the ratio; before \
             quoting numbers, check that a wider box gives the same drag.",
            range(moved.map(|run| run.plug_ratio)),
            parts.join(", "),
        );
        remark("Plug flow", words)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_sim::block_averaging::Mean;

    fn run() -> DragSummary {
        let mut whole = crate::claims::synthetic::summary(&Default::default());
        let mut run = whole.runs.swap_remove(0);
        (run.name, run.flow) = ("fr".into(), None);
        run.drag = Mean {
            mean: 1.0,
            standard_error: 0.1,
            converged: true,
            ..Mean::default()
        };
        run.drag_uncut = 1.0;
        run
    }

    #[test]
    fn layers_that_go_along_are_told_with_their_drift() {
        let mut slow = run();
        (slow.plug_ratio, slow.plug) = (0.2, PlugFlow::Sound);
        assert_eq!(plug(&[slow.clone()]), None);
        slow.plug = PlugFlow::Slides;
        slow.drift = Some(Mean {
            mean: 0.25,
            ..Mean::default()
        });
        let mut fast = slow.clone();
        (fast.name, fast.plug_ratio, fast.plug) = ("fast".into(), 0.32, PlugFlow::Drifts);
        let said = plug(&[slow, fast]).unwrap().words;
        for part in [
            "in fr they slide",
            "in fast they drift",
            "0.2 to 0.32",
            "is 0.25 of",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
    }

    /// The share of deep contacts is told if a run says it, and of beds that flow the effective depths.
    #[test]
    fn deep_overlaps_are_told_with_their_share_and_depth() {
        let mut whole = crate::claims::synthetic::summary(&Default::default());
        whole.runs.iter_mut().for_each(|run| run.overlap_max = 0.05);
        assert_eq!(overlap(&whole), None);
        // The deepest of the four effective depths, 0.16 m at D = 0.00495 m.
        let deep = |run: &&mut DragSummary| run.flow.as_ref().unwrap().effective_depth > 0.15;
        let overlaps = [0.125, 0.13, 0.11, 0.12];
        for (run, deepest) in whole.runs.iter_mut().filter(deep).zip(overlaps) {
            run.overlap_max = deepest;
        }
        let said = overlap(&whole).unwrap().words;
        assert!(said.starts_with("The deepest overlap is 0.13 of"), "{said}");
        assert!(said.contains("0.05 at 24.24 D; 0.13 at 32.32 D."), "{said}");
        assert!(
            !said.contains('%') && said.contains("a lighter lid"),
            "{said}"
        );
        let mut none = whole.clone();
        none.runs[0].large_overlaps = Some(0.0);
        let said = overlap(&none).unwrap().words;
        assert!(said.contains("of no drag is a contact beyond"), "{said}");
        for (run, share) in whole.runs.iter_mut().filter(deep).zip([0.02, 0.031]) {
            run.large_overlaps = Some(share);
        }
        let said = overlap(&whole).unwrap().words;
        for part in [
            "up to 3.1 % are",
            "0.05 at 24.24 D; 0.13 at 32.32 D, 3.1 %.",
        ] {
            assert!(said.contains(part), "{part}: {said}");
        }
        // A drag through a bed at rest has no effective depth.
        whole.runs.iter_mut().for_each(|run| run.flow = None);
        let said = overlap(&whole).unwrap().words;
        assert!(
            said.contains("3.1 % are") && !said.contains("depth"),
            "{said}"
        );
    }

    #[test]
    fn means_that_differ_and_errors_that_are_open_are_told() {
        let mut run = run();
        assert_eq!(open_errors(&[run.clone()]), None);
        assert_eq!(start_up(&[run.clone()], false), None);
        run.drag_uncut = 1.3;
        let said = |flows| start_up(&[run.clone()], flows).unwrap().words;
        assert!(said(false).contains("of fr is 1.3 times"));
        assert!(said(false).contains("Kumar") && said(true).contains("Guillard"));
        run.drag.converged = false;
        assert!(open_errors(&[run]).unwrap().words.contains("window of fr"));
    }
}
