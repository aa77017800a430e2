//! What is printed of a drag that has come to its end.

use crate::plug_flow::{self, PlugFlow};
use crate::progress::Progress;
use crate::scenario::CheckedScenario;
use crate::summary::DragSummary;
use bitgrain_sim::format::short;

/// A line or two of it.
pub(super) fn report(
    scenario: &CheckedScenario,
    run: &DragSummary,
    how: &str,
    seconds: f64,
    progress: &Progress,
) {
    if let Some(known) = &run.released {
        let units = scenario.units();
        let [x, y, z] = known.end.map(short);
        progress.line(&format!(
            "{}: the intruder is at {x}, {y}, {z} {} and goes at {} {} along z ({how}, {seconds:.1} s)",
            run.name,
            units.length,
            short(known.end_velocity[2]),
            units.speed,
        ));
        return;
    }
    progress.line(&format!(
        "{}: Fr {}, drag {} +- {} {} ({how}, {seconds:.1} s)",
        run.name,
        short(run.froude),
        short(run.drag.mean),
        short(run.drag.standard_error),
        scenario.units().force,
    ));
    if run.plug == PlugFlow::Slides {
        let found = plug_flow::found(
            scenario.law.mu(),
            run.plug_ratio,
            run.drift.map(|drift| drift.mean),
        );
        progress.line(&format!(
            "{}: {found}: the bed slides along, and the drag depends on the box as much as on the intruder; make \
             bed.box wider",
            run.name
        ));
    }
    if let Some(tank) = &run.tank {
        progress.line(&format!(
            "{}: drag/(rho g h D L) {:.2} +- {:.2}, lift {:.1} +- {:.1} buoyancies in the first half turn of {}",
            run.name,
            tank.drag_coefficient,
            tank.drag_coefficient_error,
            tank.lift_over_buoyancy,
            tank.lift_over_buoyancy_error,
            short(2.0 * tank.turns),
        ));
    }
    if let Some(flow) = &run.flow {
        progress.line(&format!(
            "{}: drag/(rho g h D L) {:.2} +- {:.2}, lift {:.1} +- {:.1} buoyancies, far bed at {:.3} of \
             the speed",
            run.name,
            flow.drag_coefficient,
            flow.drag_coefficient_error,
            flow.lift_over_buoyancy,
            flow.lift_over_buoyancy_error,
            flow.far_field
        ));
    }
}
