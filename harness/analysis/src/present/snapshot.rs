//! Snapshots and frames of a run as pictures.

use std::collections::BTreeSet;

use crate::report::{BedPicture, FlowGrain, FlowPicture, GRAINS_MAX, Scene};
use bitgrain_lab::folder::Folder;
use bitgrain_lab::frames::{self, Frame, Slice};
use bitgrain_lab::manifest::Vouched;
use bitgrain_lab::scenario::DragPlan;
use bitgrain_lab::summary::DragSummary;
use bitgrain_sim::coarse_graining::IntruderOutline;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::export::{FROZEN_TYPE, OBSTACLE_TYPE};
use bitgrain_sim::files::packed_name;
use bitgrain_sim::lammps::{Atom, parse_dump};
use bitgrain_sim::motion::Moves;
use bitgrain_sim::simulation::Role;

/// A settled bed: its picture, its intruder, and which of its grains are the lid's, which dumps do not say.
pub(super) struct Still {
    pub picture: BedPicture,
    pub hole: IntruderOutline,
    pub lid: BTreeSet<u32>,
}

/// A frame as a picture.
pub(super) fn panel_of(frame: &Frame, run: &DragSummary, still: &Still, d: f64) -> FlowPicture {
    let bed = &still.picture;
    let (centre, radius) = bed.intruder;
    let half = 0.5 * (bed.hi[0] - bed.lo[0]);
    // Each grain once: the picture draws its images itself.
    let once = frame.cuts.iter().filter(|cut| cut.x.abs() * d <= half);
    let grain = |cut: &Slice| FlowGrain {
        position: [centre[0] + cut.x * d, centre[1], centre[2] + cut.z * d],
        radius: cut.radius * d,
        velocity: {
            let rest = cut.speed * cut.speed - cut.u * cut.u - cut.w * cut.w;
            [cut.u, rest.max(0.0).sqrt(), cut.w].map(|v| v * run.speed)
        },
        role: cut.role,
    };
    FlowPicture {
        run: run.name.clone(),
        froude: run.froude,
        speed: run.speed,
        travel: frame.travel * d,
        lo: bed.lo,
        hi: bed.hi,
        intruder: (centre, radius),
        reach: frames::reach(radius / d) * d,
        moves: bed.moves,
        grains: once.map(grain).collect(),
    }
}

/// The snapshot nearest to the travel at which all drags are compared; `None` for a drag without snapshots.
pub(super) fn flow(
    folder: &Folder<'_>,
    vouched: &Vouched,
    (run, plan): (&DragSummary, &DragPlan),
    still: &Still,
    (packed, d): (bool, f64),
) -> Result<Option<FlowPicture>> {
    let off = |step: &&u64| step.abs_diff(plan.panel);
    let Some(&step) = plan.snapshots.iter().min_by_key(off) else {
        return Ok(None);
    };
    snapshot(folder, vouched, (run, step), still, (packed, d)).map(Some)
}

/// The last snapshot of a run for a view in three dimensions; `None` if none was kept, if it has more grains than a
/// page shows, and of a bar, which turns.
pub(super) fn scene(
    folder: &Folder<'_>,
    vouched: &Vouched,
    (run, plan): &(&DragSummary, DragPlan),
    still: &Still,
    (packed, d): (bool, f64),
) -> Result<Option<Scene>> {
    let turns = plan.half_turn.is_some();
    let few = still.picture.grains.len() <= GRAINS_MAX;
    let Some(&step) = plan.snapshots.last().filter(|_| few && !turns) else {
        return Ok(None);
    };
    let state = snapshot(folder, vouched, (run, step), still, (packed, d))?;
    let half_length = still.picture.half_length;
    Ok(Some(Scene { state, half_length }))
}

/// A snapshot of a run.
fn snapshot(
    folder: &Folder<'_>,
    vouched: &Vouched,
    (run, step): (&DragSummary, u64),
    still: &Still,
    (packed, d): (bool, f64),
) -> Result<FlowPicture> {
    let mut path = folder.snapshot(&run.name, "grains", step, "dump");
    if packed {
        path = packed_name(&path);
    }
    let damaged = |what: &str| Error::input(path.display().to_string(), what);
    let frame = parse_dump(&vouched.text(&path)?, &path.display().to_string())?
        .pop()
        .ok_or_else(|| damaged("holds no frame"))?;
    let (ball, grains): (Vec<&Atom>, Vec<&Atom>) =
        frame.atoms.iter().partition(|a| a.kind == OBSTACLE_TYPE);
    let travel = step as f64 / run.steps as f64 * run.distance;
    let picture = &still.picture;
    let intruder = match ball.first() {
        Some(ball) => (ball.position, 0.5 * ball.diameter),
        // A cylinder has no place in a dump; it is where it was, or as far on as it moved.
        None if run.flow.is_some() => {
            let ([x, y, z], radius) = picture.intruder;
            let way = match picture.moves {
                Moves::Intruder => travel,
                Moves::Bed => 0.0,
            };
            ([x + way, y, z], radius)
        }
        None => return Err(damaged("holds no intruder (type 2)")),
    };
    let frame_speed = match picture.moves {
        Moves::Intruder => 0.0,
        Moves::Bed => run.speed,
    };
    let grain = |a: &&Atom| FlowGrain {
        position: a.position,
        radius: 0.5 * a.diameter,
        // Of the base, or of the box if the base is at rest.
        velocity: [a.velocity[0] - frame_speed, a.velocity[1], a.velocity[2]],
        role: match a.kind {
            FROZEN_TYPE => Role::Base,
            _ if still.lid.contains(&a.id) => Role::Lid,
            _ => Role::Free,
        },
    };
    Ok(FlowPicture {
        run: run.name.clone(),
        froude: run.froude,
        speed: run.speed,
        travel,
        lo: [frame.lo[0], frame.lo[1], 0.0],
        hi: frame.hi,
        intruder,
        reach: frames::reach(intruder.1 / d) * d,
        moves: picture.moves,
        grains: grains.iter().map(grain).collect(),
    })
}
