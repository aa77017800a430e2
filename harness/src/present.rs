//! From the files of a run directory to its report.

use crate::error::{Error, Result};
use crate::export::{FROZEN_TYPE, OBSTACLE_TYPE};
use crate::files::{packed_name, write_whole};
use crate::folder::Folder;
use crate::lammps::{Atom, read_dump};
use crate::observe::INTRUDER;
use crate::report::{self, BedPicture, FlowGrain, FlowPicture, PictureGrain};
use crate::scenario::RunPlan;
use crate::series::{SeriesRow, read_series};
use crate::summary::{BedSummary, RunSummary, read_summary};
use crate::{bed, checkpoint};

/// Writes the report of a run directory from the files in it.
///
/// # Errors
/// [`Error::Input`] where one of them is missing or damaged, [`Error::Write`].
pub fn write_report(folder: &Folder<'_>) -> Result<()> {
    let whole = read_summary(&folder.summary())?;
    let text = std::fs::read_to_string(folder.scenario())
        .map_err(|e| Error::read(&folder.scenario(), &e))?;
    let series = whole
        .runs
        .iter()
        .map(|run| read_series(&folder.series(&run.name)));
    let series: Vec<Vec<SeriesRow>> = series.collect::<Result<_>>()?;
    let pictures = whole.beds.iter().map(|bed| picture(folder, bed));
    let pictures: Vec<BedPicture> = pictures.collect::<Result<_>>()?;
    let (plans, packed) = (whole.inputs.runs(), whole.inputs.measure.gzip);
    let flows = whole
        .runs
        .iter()
        .zip(&plans)
        .map(|(run, plan)| flow(folder, run, plan, packed));
    let flows: Vec<Option<FlowPicture>> = flows.collect::<Result<_>>()?;
    let flows: Vec<FlowPicture> = flows.into_iter().flatten().collect();
    let page = report::page(&whole, &text, &series, &pictures, &flows);
    write_whole(&folder.report(), page.as_bytes())
}

fn picture(folder: &Folder<'_>, bed: &BedSummary) -> Result<BedPicture> {
    let sim = checkpoint::read(&folder.bed(&bed.name))?;
    let body = &sim.obstacles[INTRUDER as usize];
    let grain = |i: usize| PictureGrain {
        position: [sim.position[i][0], sim.position[i][1], sim.position[i][2]],
        radius: sim.position[i][3],
        frozen: sim.group[i] == bed::FROZEN,
    };
    Ok(BedPicture {
        name: bed.name.clone(),
        // The floor of the bed; the box goes on below it so that a leak is seen.
        lo: [sim.domain.lo()[0], sim.domain.lo()[1], 0.0],
        hi: sim.domain.hi(),
        surface: bed.surface,
        grains: (0..sim.count()).map(grain).collect(),
        intruder: (body.point, body.reach()),
    })
}

/// The snapshot nearest to half way, where the intruder has not yet come to its own wake; `None` of a
/// drag without snapshots.
fn flow(
    folder: &Folder<'_>,
    run: &RunSummary,
    plan: &RunPlan,
    packed: bool,
) -> Result<Option<FlowPicture>> {
    let Some(&step) = plan
        .snapshots
        .get(plan.snapshots.len().saturating_sub(1) / 2)
    else {
        return Ok(None);
    };
    let mut path = folder.snapshot(&run.name, "grains", step, "dump");
    if packed {
        path = packed_name(&path);
    }
    let damaged = |what: &str| Error::input(path.display().to_string(), what);
    let frame = read_dump(&path)?
        .pop()
        .ok_or_else(|| damaged("holds no frame"))?;
    let (ball, grains): (Vec<&Atom>, Vec<&Atom>) =
        frame.atoms.iter().partition(|a| a.kind == OBSTACLE_TYPE);
    let ball = ball
        .first()
        .ok_or_else(|| damaged("holds no intruder (type 2)"))?;
    let grain = |a: &&Atom| FlowGrain {
        position: a.position,
        radius: 0.5 * a.diameter,
        velocity: a.velocity,
        frozen: a.kind == FROZEN_TYPE,
    };
    Ok(Some(FlowPicture {
        run: run.name.clone(),
        froude: run.froude,
        speed: run.speed,
        travel: step as f64 / run.steps as f64 * run.distance,
        lo: [frame.lo[0], frame.lo[1], 0.0],
        hi: frame.hi,
        intruder: (ball.position, 0.5 * ball.diameter),
        grains: grains.iter().map(grain).collect(),
    }))
}
