//! What captions say of a drag.

use super::text::{escape, typeset};
use bitgrain_lab::summary::{DragSummary, Summary};
use bitgrain_sim::format::short;

/// Effective depth, gradient and seed of a run.
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
        ", h\u{303}&nbsp;=&nbsp;{}&nbsp;{}, {gradient} pressure gradient, seed {}",
        short(flow.effective_depth),
        escape(&typeset(&summary.units.length)),
        rig.seed
    )
}
