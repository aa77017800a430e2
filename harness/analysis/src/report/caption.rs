//! What captions say of a drag.

use super::text::{escape, typeset};
use bitgrain_lab::summary::{DragSummary, Summary};
use bitgrain_sim::format::short;

/// Height of the axis over D, if beds of this diameter have it at several.
fn axis_text(summary: &Summary, run: &DragSummary) -> String {
    let same = |diameter: f64| diameter == run.diameter;
    let beds = summary
        .inputs
        .beds()
        .iter()
        .filter(|bed| same(bed.diameter));
    let Some(own) = beds.clone().find(|bed| bed.name == run.bed) else {
        return String::new();
    };
    let height = own.center[2];
    if beds.map(|bed| bed.center[2]).all(|other| other == height) {
        return String::new();
    }
    format!(
        ", axis {}&nbsp;D above the floor",
        short(height / run.diameter)
    )
}

/// Effective depth, place of the axis, gradient and seed of a run.
pub(super) fn depth_text(summary: &Summary, run: &DragSummary) -> String {
    let bed = summary.beds.iter().find(|bed| bed.name == run.bed);
    let (Some(flow), Some(rig)) = (&run.flow, bed.and_then(|bed| bed.rig.as_ref())) else {
        return String::new();
    };
    let gradient = match flow.pressure_gradient {
        true => "with",
        false => "without",
    };
    format!(
        ", h\u{303}&nbsp;=&nbsp;{}&nbsp;{}{}, {gradient} pressure gradient, seed {}",
        short(flow.effective_depth),
        escape(&typeset(&summary.units.length)),
        axis_text(summary, run),
        rig.seed
    )
}
