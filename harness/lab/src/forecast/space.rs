//! What the files of a run take.

use crate::scenario::{CheckedScenario, DragPlan};

/// Bytes of a grain in a checkpoint with its contacts.
const CHECKPOINT: f64 = 290.0;
/// Bytes of a grain in a data file.
const DATA: f64 = 300.0;
/// Bytes of a grain in a snapshot: dump, VTK grains, VTK contacts.
const SNAPSHOT: f64 = 1400.0;
/// Circles of a frame for each square d, and bytes of one.
const CUTS: f64 = 1.3;
const CUT: f64 = 55.0;
/// Bytes of a point of the fields in VTK image data.
const IMAGE: f64 = 95.0;
/// The same in a checkpoint, and of the sums in memory.
pub(super) const SUMS: f64 = 104.0;
/// Bytes of a row of the table of their plane.
const PLANE: f64 = 210.0;
/// Bytes of a row of the force series.
const ROW: f64 = 260.0;

/// Points of the fields along each axis; none if there are no fields.
pub(super) fn points(scenario: &CheckedScenario) -> [f64; 3] {
    let grid = scenario.fields_grid();
    grid.map_or([0; 3], |grid| grid.counts).map(|n| n as f64)
}

/// Bytes of all files of these drags and so many beds.
pub(crate) fn space(
    scenario: &CheckedScenario,
    runs: &[DragPlan],
    grains: usize,
    beds: usize,
) -> f64 {
    let grains = grains as f64;
    // Twice: in the library and in the run directory.
    let bed = grains * (2.0 * CHECKPOINT + DATA);
    let rows = |run: &DragPlan| (run.steps() / scenario.measure.every) as f64;
    let states = |run: &DragPlan| run.checkpoints.len() as f64 * grains * CHECKPOINT;
    let shown = |run: &DragPlan| run.snapshots.len() as f64 * grains * SNAPSHOT;
    let (points, plans) = (points(scenario), scenario.beds());
    let fields = |run: &DragPlan| {
        let whole = points[0] * points[1] * points[2];
        whole * (IMAGE + SUMS * run.checkpoints.len() as f64) + points[0] * points[2] * PLANE
    };
    let d = scenario.mean_diameter();
    let frames = |run: &DragPlan| {
        let reach = crate::frames::reach(0.5 * plans[run.bed].diameter / d);
        let width = (2.0 * reach).min(scenario.bed.size[0] / d);
        run.frames.len() as f64 * width * 2.0 * reach * CUTS * CUT
    };
    let drag =
        |run: &DragPlan| rows(run) * ROW + states(run) + shown(run) + fields(run) + frames(run);
    beds as f64 * bed + runs.iter().map(drag).sum::<f64>()
}
