//! From the files of a run directory to its report.

use std::path::{Path, PathBuf};

mod picture;
mod snapshot;

use picture::picture;
use snapshot::{Still, flow, panel_of, scene};

use crate::report::{self, BedPicture, Drawings, FieldPicture, Film, FlowSeries, TankSeries};
use bitgrain_lab::bed::library::BedCache;
use bitgrain_lab::beside::write_beside;
use bitgrain_lab::flow::{FLOW, PROFILE};
use bitgrain_lab::folder::Folder;
use bitgrain_lab::frames::{self, Frame};
use bitgrain_lab::manifest::{FolderKind, Vouched};
use bitgrain_lab::progress::Progress;
use bitgrain_lab::run::{self, Setting};
use bitgrain_lab::scenario::{CheckedScenario, DragPlan, IntruderMotion};
use bitgrain_lab::series::{SeriesRow, parse_series};
use bitgrain_lab::summary::{BedSummary, DragSummary, Summary, read_folder};
use bitgrain_lab::tank_tables::{BAR, VELOCITY};
use bitgrain_sim::checkpoint;
use bitgrain_sim::coarse_graining::intruder_outline;
use bitgrain_sim::coarse_graining::read::plane;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::simulation::Role;
use bitgrain_sim::table::Table;

/// Writes the report of a run directory from the files in it: of what is done, if the run has not come to its
/// end. Nothing is drawn that the manifest does not vouch for.
///
/// # Errors
/// [`Error::Input`] if one of them is missing or not as it was written, [`Error::Write`].
pub fn write_report(folder: &Folder<'_>) -> Result<()> {
    let vouched = &Vouched::open(folder.0, FolderKind::Run)?;
    let (_, whole) = read_folder(folder, vouched)?;
    let text = vouched.text(&folder.scenario())?;
    let series = series(folder, vouched, &whole)?;
    let inputs = &whole.inputs;
    let stills = whole.beds.iter();
    let stills = stills.map(|bed| still(folder, vouched, bed, inputs));
    let stills: Vec<Still> = stills.collect::<Result<_>>()?;
    let packed = whole.inputs.measure.gzip;
    let planned = plans(&whole)?;
    let still_of = |run: &DragSummary| {
        let mut beds = stills.iter();
        let found = beds.find(|still| still.picture.name == run.bed);
        found.ok_or_else(|| unplanned(&run.bed))
    };
    let d = whole.inputs.mean_diameter();
    let (mut flows, mut films) = (Vec::new(), Vec::new());
    for (run, plan) in &planned {
        if plan.half_turn.is_some() {
            // What a bar sweeps is shown as means.
            continue;
        }
        let still = still_of(run)?;
        let frames = frames_of(folder, vouched, run, plan)?;
        let panel = frames.iter().find(|frame| frame.step == plan.panel);
        match panel {
            Some(frame) => flows.push(panel_of(frame, run, still, d)),
            None => flows.extend(flow(folder, vouched, (run, plan), still, (packed, d))?),
        }
        // Frames of a drag that was saved without them begin later.
        if frames.len() > 1 && frames.len() == plan.frames.len() {
            let (centre, radius) = still.picture.intruder;
            films.push(Film {
                run: run.name.clone(),
                radius: radius / d,
                floor: (centre[2] - still.picture.lo[2]) / d,
                moves: still.picture.moves,
                frames,
            });
        }
    }
    let scene = match planned.last() {
        Some(last) => scene(folder, vouched, last, still_of(last.0)?, (packed, d))?,
        None => None,
    };
    let maps = whole
        .runs
        .iter()
        .map(|run| map(folder, vouched, &whole.inputs, run, still_of(run)?));
    let maps: Vec<Option<FieldPicture>> = maps.collect::<Result<_>>()?;
    let maps: Vec<FieldPicture> = maps.into_iter().flatten().collect();
    let pictures: Vec<BedPicture> = stills.into_iter().map(|still| still.picture).collect();
    let closing = match vouched.manifest.finished {
        true => vouched.manifest.closing.as_str(),
        false => "",
    };
    let drawings = Drawings {
        closing,
        series: &series,
        beds: &pictures,
        flows: &flows,
        films: &films,
        ..Drawings::default()
    };
    let drawings = Drawings {
        maps: &maps,
        scene: scene.as_ref(),
        ..drawings
    };
    let page = page(folder, vouched, (&whole, &text), drawings)?;
    write_beside(&folder.report(), page.as_bytes())
}

/// The page of the kind that the scenario asks for.
fn page(
    folder: &Folder<'_>,
    vouched: &Vouched,
    (whole, text): (&Summary, &str),
    drawings: Drawings<'_>,
) -> Result<String> {
    if whole.inputs.is_tank() {
        let tanks = whole.runs.iter().map(|run| tank(folder, vouched, run));
        let tanks: Vec<TankSeries> = tanks.collect::<Result<_>>()?;
        let drawings = Drawings {
            tanks: &tanks,
            ..drawings
        };
        return Ok(report::tank_page(whole, text, &drawings));
    }
    if whole.inputs.intruder.motion != IntruderMotion::Dragged {
        return released_page(folder, vouched, (whole, text), drawings);
    }
    if whole.runs.iter().all(|run| run.flow.is_none()) {
        return Ok(report::page(whole, text, &drawings));
    }
    let courses = whole.runs.iter().map(|run| course(folder, vouched, run));
    let courses: Vec<FlowSeries> = courses.collect::<Result<_>>()?;
    let drawings = Drawings {
        courses: &courses,
        ..drawings
    };
    Ok(report::flowing_page(whole, text, &drawings))
}

/// Runs a scenario into a folder, saving now and then, and returns the path of its report: [`run::run_in`].
///
/// # Errors
/// As [`run::run_in`].
pub fn run(
    scenario: &CheckedScenario,
    out: &Path,
    library: &BedCache,
    threads: usize,
    progress: &Progress,
) -> Result<PathBuf> {
    run::run_in(Setting {
        scenario,
        folder: &Folder(out),
        library,
        threads,
        save: run::SaveEvery::default(),
        frames: true,
        only: &[],
        write_report,
        progress,
    })
    .map(|done| done.expect("all drags were wanted").report)
}

/// The force series of the runs of a summary.
///
/// # Errors
/// [`Error::Input`] if one of them is missing or not as it was written.
pub fn series(
    folder: &Folder<'_>,
    vouched: &Vouched,
    summary: &Summary,
) -> Result<Vec<Vec<SeriesRow>>> {
    let one = |run: &DragSummary| {
        let path = folder.series(&run.name);
        parse_series(&vouched.text(&path)?, &path.display().to_string())
    };
    summary.runs.iter().map(one).collect()
}

/// The drags of a summary with their plans.
fn plans(whole: &Summary) -> Result<Vec<(&DragSummary, DragPlan)>> {
    let plans = whole.inputs.drags();
    let plan = |run: &DragSummary| plans.iter().find(|plan| plan.name == run.name).cloned();
    let each = whole.runs.iter();
    each.map(|run| Ok((run, plan(run).ok_or_else(|| unplanned(&run.name))?)))
        .collect()
}

fn unplanned(name: &str) -> Error {
    Error::input(
        name,
        "does not belong to the scenario beside it; was summary.json changed?",
    )
}

fn still(
    folder: &Folder<'_>,
    vouched: &Vouched,
    bed: &BedSummary,
    inputs: &CheckedScenario,
) -> Result<Still> {
    let path = folder.bed(&bed.name);
    let sim = checkpoint::unpack(&vouched.read(&path)?, &path.display().to_string())?.0;
    let lid = (0..sim.count()).filter(|&i| sim.role(i) == Role::Lid);
    Ok(Still {
        hole: intruder_outline(&sim),
        lid: lid.map(|i| sim.id[i]).collect(),
        picture: BedPicture {
            moves: inputs.drag.moves,
            arrow: !inputs.is_dropped(),
            ..picture(&sim, &bed.name, bed.surface)
        },
    })
}

/// The page of runs whose intruders forces move.
fn released_page(
    folder: &Folder<'_>,
    vouched: &Vouched,
    (whole, text): (&Summary, &str),
    drawings: Drawings<'_>,
) -> Result<String> {
    let ends = whole.runs.iter().map(|run| end(folder, vouched, run));
    let ends: Vec<Option<BedPicture>> = ends.collect::<Result<_>>()?;
    let ends: Vec<BedPicture> = ends.into_iter().flatten().collect();
    let ends = &ends[..];
    Ok(report::released_page(
        whole,
        text,
        &Drawings { ends, ..drawings },
    ))
}

/// The last state of a run whose intruder forces move, below the surface of its settled bed.
fn end(folder: &Folder<'_>, vouched: &Vouched, run: &DragSummary) -> Result<Option<BedPicture>> {
    let Some(released) = &run.released else {
        return Ok(None);
    };
    let path = folder.checkpoint(&run.name, run.steps);
    let sim = checkpoint::unpack(&vouched.read(&path)?, &path.display().to_string())?.0;
    Ok(Some(BedPicture {
        arrow: false,
        ..picture(&sim, &run.name, released.surface)
    }))
}

/// The flow series and the profile of a run; empty ones for a run that has none.
fn course(folder: &Folder<'_>, vouched: &Vouched, run: &DragSummary) -> Result<FlowSeries> {
    if run.flow.is_none() {
        return Ok(FlowSeries::default());
    }
    Ok(FlowSeries {
        rows: rows(folder, vouched, run, "flow.csv", &FLOW)?,
        profile: rows(folder, vouched, run, "profile.csv", &PROFILE)?,
    })
}

/// The tables of a run in a tank.
fn tank(folder: &Folder<'_>, vouched: &Vouched, run: &DragSummary) -> Result<TankSeries> {
    Ok(TankSeries {
        bar: rows(folder, vouched, run, "bar.csv", &BAR)?,
        velocity: rows(folder, vouched, run, "velocity.csv", &VELOCITY)?,
    })
}

/// The rows of a table of a run.
fn rows<R: Clone + Default>(
    folder: &Folder<'_>,
    vouched: &Vouched,
    run: &DragSummary,
    file: &str,
    table: &Table<R>,
) -> Result<Vec<R>> {
    let path = folder.of_run(&run.name, file);
    let damaged = |line: usize| {
        Error::input(
            format!("{}:{line}", path.display()),
            "is not a row of finite numbers, one for each column; is the file cut off? The same \
             run writes it again",
        )
    };
    table.parse(&vouched.text(&path)?).map_err(damaged)
}

/// The mean fields of a run; `None` if they were not asked for, or if the bed is at rest, since no page shows them.
fn map(
    folder: &Folder<'_>,
    vouched: &Vouched,
    inputs: &CheckedScenario,
    run: &DragSummary,
    still: &Still,
) -> Result<Option<FieldPicture>> {
    let (Some(grid), Some(_)) = (inputs.fields_grid(), &run.flow) else {
        return Ok(None);
    };
    let path = folder.of_run(&run.name, "plane.csv");
    let text = vouched.text(&path)?;
    let fields = plane(&text, grid).map_err(|line| {
        let problem =
            "is not a row of the plane's table; is the file cut off? The same run writes it again";
        Error::input(format!("{}:{line}", path.display()), problem)
    })?;
    Ok(Some(FieldPicture {
        run: run.name.clone(),
        fields,
        hole: still.hole,
        window: inputs.fields_window(),
        surface: still.picture.surface,
        far: inputs.far_velocity(run.speed),
    }))
}

/// The frames of a run; none if it was run without.
fn frames_of(
    folder: &Folder<'_>,
    vouched: &Vouched,
    run: &DragSummary,
    plan: &DragPlan,
) -> Result<Vec<Frame>> {
    let mut all = Vec::new();
    for &step in &plan.checkpoints {
        let path = folder.frames(&run.name, step);
        if !vouched.lists(&path) {
            continue;
        }
        let found = frames::parse(&vouched.text(&path)?).map_err(|line| {
            let problem =
                "is not a row of a frame; is the file cut off? The same run writes it again";
            Error::input(format!("{}:{line}", path.display()), problem)
        })?;
        all.extend(found);
    }
    Ok(all)
}
