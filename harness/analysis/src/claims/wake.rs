//! The drag where a cylinder meets its own wake (Guillard 2014, section II A, Fig. 2): after one box length, for the
//! box is periodic, as after half a turn of the paper's tank.

use super::number::{Found, Number};
use super::points::{Group, Spread};
use crate::analysis::Value;
use bitgrain_lab::summary::{DragSummary, Summary};
use bitgrain_sim::block_averaging::BlockSums;
use bitgrain_sim::format::short;

/// The runs of a group that go on beyond one box length.
fn runs<'a>(summary: &'a Summary, group: &Group) -> Vec<&'a DragSummary> {
    let all = group.points.iter().flat_map(|p| &p.runs);
    let beyond = |run: &&DragSummary| run.distance > summary.inputs.bed.size[0];
    all.map(|&k| &summary.runs[k]).filter(beyond).collect()
}

/// Whether a cylinder of the group meets its own wake.
pub(super) fn is_met(summary: &Summary, group: &Group) -> bool {
    !runs(summary, group).is_empty()
}

/// Mean of a part of the drag by travel, with the error of its blocks.
fn mean(part: &[f64]) -> Option<Value> {
    let mut sums = BlockSums::default();
    part.iter().for_each(|drag| sums.add(*drag));
    let mean = sums.mean()?;
    Some(Value::new(mean.mean, mean.standard_error))
}

/// Drag of a run beyond one box length over that of the first, from the beginning of the window on; diameters that are
/// in neither wholly are left out.
fn after_over_before(summary: &Summary, run: &DragSummary) -> Result<Value, String> {
    let d = summary.inputs.mean_diameter();
    let place = |travel: f64| travel / d;
    let (begin, met) = (place(run.window_start), place(summary.inputs.bed.size[0]));
    // Lengths that are whole numbers of diameters may come out a rounding beside them.
    let up = |x: f64| (x - 1e-6).ceil() as usize;
    let before = run.drag_by_travel.get(up(begin)..(met + 1e-6) as usize);
    let after = run.drag_by_travel.get(up(met)..);
    let [before, after] = [before, after].map(|part| part.and_then(mean));
    let missing = || {
        format!(
            "{} has no drag by travel of 16 diameters or more before and after one box length",
            run.name
        )
    };
    Ok(after.ok_or_else(missing)?.over(before.ok_or_else(missing)?))
}

/// The mean over the runs of a group.
pub(super) fn left_in_wake(summary: &Summary, group: &Group) -> Found {
    let runs = runs(summary, group);
    let each: Result<Vec<Value>, String> = runs
        .iter()
        .map(|run| after_over_before(summary, run))
        .collect();
    let each = each?;
    if each.is_empty() {
        return Err("no run goes on beyond one box length: drag.own_wake allows it".into());
    }
    let all: Vec<(f64, f64)> = each.iter().map(|v| (v.value, v.error)).collect();
    let longest = runs.iter().map(|run| run.distance).fold(0.0, f64::max);
    let note = format!(
        "mean of {} runs of {} box lengths at h~/D = {}: {}",
        each.len(),
        short(longest / summary.inputs.bed.size[0]),
        short(group.points[0].effective_depth / group.diameter),
        each.iter()
            .map(|v| format!("{:.3} +- {:.3}", v.value, v.error))
            .collect::<Vec<_>>()
            .join(", ")
    );
    Ok(Number::one(Spread::of(&all).into(), note))
}

#[cfg(test)]
mod tests {
    use super::super::guillard::measure;
    use super::super::synthetic::{self, Asked};
    use super::*;
    use crate::fit::synthetic::normal;

    /// Runs of two box lengths, 90 diameters each, whose drag has this part left in the second, and is far off in the
    /// first two D; single diameters scatter by a tenth.
    fn summary(left: f64) -> Summary {
        let asked = Asked {
            depths: vec![0.1275],
            ..Asked::default()
        };
        let mut summary = synthetic::summary(&asked);
        let twice = summary.inputs.changed(|inputs| {
            inputs.drag.distance = bitgrain_lab::scenario::OneOrMany::One(0.27);
            inputs.drag.own_wake = true;
        });
        summary.inputs = twice.unwrap();
        for (k, run) in summary.runs.iter_mut().enumerate() {
            run.distance = 0.27;
            let drag = |j: usize| {
                let scatter = 1.0 + 0.1 * normal(k as u64, j);
                match j {
                    0..7 => 7.0,
                    7..90 => scatter,
                    _ => left * scatter,
                }
            };
            run.drag_by_travel = (0..180).map(drag).collect();
        }
        summary
    }

    #[test]
    fn the_second_box_length_is_held_against_the_first() {
        for left in [1.0, 0.7] {
            let claim = synthetic::shipped("guillard-half-turn");
            let found = measure(&claim, &summary(left)).unwrap().unwrap();
            let (value, note) = (found.value, found.note);
            assert!((value.value - left).abs() < 3.0 * value.error, "{value:?}");
            // Two means of some 85 diameters, of four runs.
            let known = left * 0.1 * (2.0 / 85.0_f64).sqrt() / 2.0;
            assert!((0.6..2.0).contains(&(value.error / known)), "{value:?}");
            let begin = "mean of 4 runs of 2 box lengths at h~/D = 25.76: ";
            assert!(note.starts_with(begin), "{note}");
        }
    }

    /// In its own wake a cylinder measures no other claim, and without one it does not measure this.
    #[test]
    fn other_claims_are_measured_outside_the_wake() {
        let own = summary(0.7);
        let why = measure(&synthetic::shipped("guillard-drag"), &own)
            .unwrap()
            .unwrap_err();
        assert!(why.contains("own wake"), "{why}");
        let plain = synthetic::summary(&Asked::default());
        assert!(
            measure(&synthetic::shipped("guillard-drag"), &plain)
                .unwrap()
                .is_ok()
        );
        let why = measure(&synthetic::shipped("guillard-half-turn"), &plain)
            .unwrap()
            .unwrap_err();
        assert!(why.contains("drag.own_wake"), "{why}");
        let mut older = own;
        older.runs[1].drag_by_travel.clear();
        let why = measure(&synthetic::shipped("guillard-half-turn"), &older)
            .unwrap()
            .unwrap_err();
        assert!(why.contains(&older.runs[1].name), "{why}");
    }
}
