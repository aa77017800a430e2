//! The drags of a run: begun, or resumed from the latest of their checkpoints, and written down.

use std::path::Path;

use bitgrain_kernel::{BITS_VERSION, ContactForce};

use super::files;
use super::film::Frames;
use super::saving::{SaveEvery, Saver};
use super::summarise::summarise;
use super::taken::{KEPT, RESUMED};
use super::task::DragTask;
use super::told;
use crate::drag::Dragging;
use crate::flow;
use crate::folder::Folder;
use crate::json::json_text;
use crate::manifest::Ledger;
use crate::pace::StageKind;
use crate::performance::{StagePerformance, timed};
use crate::progress::Progress;
use crate::scenario::CheckedScenario;
use crate::series::series_text;
use crate::summary::{BedSummary, DragRecord, DragSummary};
use crate::tank_tables;
use bitgrain_sim::block_averaging::METHOD;
use bitgrain_sim::checkpoint::{self, StageState};
use bitgrain_sim::coarse_graining::intruder_outline;
use bitgrain_sim::disk::{self, Kind};
use bitgrain_sim::energy_budget::energy_text;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::{bits, text_file};
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;
use bitgrain_sim::{coarse_graining, export, lammps};

/// Does one drag, or what is left of it, and writes down what it measured.
pub(super) fn drag_one(
    drag: DragTask<'_>,
    ledger: &Ledger,
    save: SaveEvery,
    frames: bool,
    progress: &Progress,
) -> Result<(DragSummary, StagePerformance)> {
    let DragTask {
        folder,
        scenario,
        plan,
        ..
    } = drag;
    let mut stage = progress.paced_stage(
        &format!("{} Fr {:.2}", plan.name, plan.froude),
        plan.steps(),
        StageKind::Dragging,
    );
    // Asked to stop before it began.
    stage.look().map_err(Error::saved)?;
    let (how, (mut sim, mut dragging)) = match take_up(drag, ledger, progress)? {
        Some(found) if found.1.step < plan.steps() => (RESUMED, found),
        Some(found) => (KEPT, found),
        None => ("dragged", begin(drag)?),
    };
    let began = dragging.step;
    // What a manifest lists before a drag has begun is none of its files, unless it is written again.
    let doubted = (began == 0).then(|| format!("runs/{}/", plan.name));
    ledger.begin_stage(&plan.name, doubted.as_deref())?;
    stage.resume(began);
    let mut files = Files {
        drag,
        ledger,
        saver: Saver::new(ledger, save, folder.latest(&plan.name), began),
        frames: Frames::go_on(drag, frames, &mut dragging),
    };
    let went = dragging.go_on(&mut sim, plan, &stage, &mut files);
    if let Err(error @ Error::Contract { .. }) = went {
        // What was measured since the last save may be wrong: none of it is written.
        return Err(error);
    }
    if let Err(error) = went {
        let text = series_text(
            &scenario.units(),
            scenario.measure.columns(plan.release),
            &dragging.record.series,
        );
        let left = [
            (folder.partial_series(&plan.name), text),
            (folder.chain(&plan.name), dragging.chain.text()),
        ];
        let written = ledger.write_all(&left).and_then(|()| ledger.save());
        if error.is_physical() {
            // They belong to the failure, which is not one of the drag if they cannot be kept.
            written?;
        }
        if matches!(error, Error::Interrupted { .. }) {
            files
                .saver
                .save(&mut sim, &files.frames.note(dragging.note()))?;
        } else if error.is_physical() {
            // It would fail again from there: what is left does not tell whether the drag was ever stopped.
            files.saver.clear()?;
        }
        return Err(error.saved());
    }
    let performance = timed(stage, how, &sim, plan.steps() - began);
    let (mut tables, summary) = results(drag, &dragging, &mut sim)?;
    let place = folder.of_run(&plan.name, "summary.json");
    let text = json_text(&place, &record(folder, scenario, drag.bed, &summary))?;
    tables.push(("summary.json", text));
    let tables = tables.into_iter();
    let tables: Vec<_> = tables
        .map(|(file, text)| (folder.of_run(&plan.name, file), text))
        .collect();
    ledger.write_all(&tables)?;
    ledger.remove(&folder.partial_series(&plan.name))?;
    // What was not made again is no file of a finished drag: frames that are not wanted, an old failure.
    for file in ledger.damaged(&format!("runs/{}/", plan.name)) {
        ledger.remove(&folder.0.join(file))?;
    }
    ledger.finish_stage(&plan.name, &summary.chain)?;
    // If it stays it is older than the end, and harmless.
    let _ = files.saver.clear();
    told::report(scenario, &summary, how, performance.seconds, progress);
    Ok((summary, performance))
}

/// A settled bed whose drag begins.
///
/// # Errors
/// If the bed cannot be read or its drag not begun.
pub fn begin(drag: DragTask<'_>) -> Result<(Simulation, Dragging)> {
    let path = drag.folder.bed(&drag.bed.name);
    let (mut sim, note) = drag.folder.state(&path)?;
    let dragging = Dragging::begin(&mut sim, drag.plan, &note.link)?;
    Ok((sim, dragging))
}

/// The drag as its furthest sound checkpoint has it, but for those that come after a file which is missing or
/// not as it was written; `None` if there is none. Damaged ones are reported and passed over.
fn take_up(
    drag: DragTask<'_>,
    ledger: &Ledger,
    progress: &Progress,
) -> Result<Option<(Simulation, Dragging)>> {
    let (folder, name) = (drag.folder, &drag.plan.name);
    for file in ledger.damaged(&format!("runs/{name}/")) {
        let path = folder.0.join(file);
        progress.warn(&format!(
            "{} is missing or was changed since it was written: it is made again from the last sound state \
             before it",
            path.display()
        ));
    }
    let mut furthest: Option<(Simulation, Dragging)> = None;
    let kept = drag.plan.checkpoints.iter().rev();
    let kept = kept.map(|&step| (folder.checkpoint(name, step), Some(step)));
    // The kept ones descend, so that the first sound one is the furthest of them.
    for (path, step) in std::iter::once((folder.latest(name), None)).chain(kept) {
        let latest = step.is_none();
        if disk::kind(&path) != Some(Kind::File) || !latest && !ledger.vouches(&path) {
            continue;
        }
        let found = match read(drag, &path, step) {
            Err(damage @ Error::Damaged { .. }) => {
                progress.warn(&format!("{damage}; going on from a state before it"));
                continue;
            }
            found => found?,
        };
        if !drag.has_files_until(found.1.step, ledger) {
            continue;
        }
        if furthest.as_ref().is_none_or(|(_, f)| f.step < found.1.step) {
            furthest = Some(found);
        }
        if !latest {
            break;
        }
    }
    Ok(furthest)
}

/// A state of a drag; after this step, if one is given.
///
/// # Errors
/// [`Error::Damaged`], and [`Error::Input`] if it is another drag's or another version's.
pub fn read(drag: DragTask<'_>, path: &Path, step: Option<u64>) -> Result<(Simulation, Dragging)> {
    let (sim, note) = drag.folder.state(path)?;
    let place = path.display().to_string();
    let dragging = Dragging::of(&note).map_err(|problem| Error::Damaged {
        place: place.clone(),
        problem,
    })?;
    if dragging.key != drag.scenario.key(&drag.plan.name) {
        let problem = "was saved by a run of another scenario: was scenario.toml changed since? \
                       Restore it, or choose another folder";
        return Err(Error::input(place, problem));
    }
    if dragging.step > drag.plan.steps() || step.is_some_and(|step| dragging.step != step) {
        let problem = format!("holds step {}, at which it is not kept", dragging.step);
        return Err(Error::Damaged { place, problem });
    }
    if dragging.chain.begins != drag.bed.chain {
        let problem = "was dragged through a bed other than the one here now; choose another folder, \
                       or remove this file to drag again";
        return Err(Error::input(place, problem));
    }
    Ok((sim, dragging))
}

impl DragTask<'_> {
    /// Whether everything that the drag wrote up to a step is there as it was written.
    fn has_files_until(&self, step: u64, ledger: &Ledger) -> bool {
        let snapshots = self.plan.snapshots.iter().filter(|n| **n <= step);
        let kept = self.plan.checkpoints.iter().filter(|n| **n <= step);
        let mut shown = snapshots.flat_map(|&n| self.snapshot(n));
        let mut kept = kept.map(|&n| {
            let name = &self.plan.name;
            (self.folder.checkpoint(name, n), self.folder.frames(name, n))
        });
        // There may be no frames: they are for viewing only, and not all runs have them.
        shown.all(|path| ledger.vouches(&path))
            && kept.all(|(state, frames)| {
                ledger.vouches(&state) && (!ledger.lists(&frames) || ledger.vouches(&frames))
            })
    }

    /// Whether a snapshot is taken after this step.
    pub fn shows(&self, step: u64) -> bool {
        // They ascend, and there may be thousands.
        self.plan.snapshots.binary_search(&step).is_ok()
    }

    /// Whether the state after this step is a frame of its moving picture.
    pub fn films(&self, step: u64) -> bool {
        self.plan.frames.binary_search(&step).is_ok()
    }

    /// The files of a snapshot.
    fn snapshot(&self, step: u64) -> Vec<std::path::PathBuf> {
        files::snapshot(self.folder, self.scenario, self.plan, step)
    }

    /// A state as a LAMMPS dump for OVITO, and as VTK files, grains, contacts and the bodies of a tank, for ParaView:
    /// paths and bytes.
    ///
    /// # Errors
    /// [`Error::Write`] if packing fails.
    pub fn snapshot_files(
        &self,
        step: u64,
        sim: &Simulation,
        contacts: &[ContactForce<f64>],
    ) -> Result<Vec<(std::path::PathBuf, Vec<u8>)>> {
        let (folder, run) = (self.folder, &self.plan.name[..]);
        let (mut frame, forces) = export::frame(sim);
        frame.step = step;
        let title = format!("{run}, step {step}; {}", bits());
        let dump = folder.snapshot(run, "grains", step, "dump");
        let text = lammps::dump_text(&frame, Some(&forces));
        let dump = text_file(&dump, &text, self.scenario.measure.gzip)?;
        let mut texts = vec![
            export::vtk_grains(sim, &title),
            export::vtk_contacts(sim, contacts, &title),
        ];
        if files::shows_bodies(self.plan) {
            texts.push(export::vtk_bodies(sim, &title));
        }
        // The dump comes first.
        let others = self.snapshot(step).into_iter().skip(1).zip(texts);
        let others = others.map(|(path, text)| (path, text.into_bytes()));
        Ok([dump].into_iter().chain(others).collect())
    }
}

/// Writes the files of a drag while it runs.
struct Files<'a> {
    drag: DragTask<'a>,
    ledger: &'a Ledger,
    saver: Saver<'a>,
    frames: Frames,
}

impl Files<'_> {
    /// Whether the plan has a checkpoint after this step.
    fn is_planned(&self, step: u64) -> bool {
        self.drag.plan.checkpoints.binary_search(&step).is_ok()
    }
}

impl Observer for Files<'_> {
    fn wants_step(&self, step: u64) -> bool {
        self.drag.shows(step) || self.frames.wants(self.drag, step)
    }

    fn wants_contacts(&self, step: u64) -> bool {
        self.drag.shows(step)
    }

    fn on_step(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        contacts: &[ContactForce<f64>],
    ) -> Result<()> {
        if self.frames.wants(self.drag, step) {
            self.frames.add(self.drag, step, sim);
        }
        if !self.drag.shows(step) {
            return Ok(());
        }
        let files = self.drag.snapshot_files(step, sim, contacts)?;
        self.ledger.write_all(&files)
    }

    fn wants_checkpoint(&self, step: u64) -> bool {
        self.is_planned(step) || self.saver.wants_checkpoint(step)
    }

    fn on_checkpoint(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        note: &dyn Fn() -> StageState,
    ) -> Result<()> {
        if !self.is_planned(step) {
            let frames = &self.frames;
            return self.saver.on_checkpoint(step, sim, &|| frames.note(note()));
        }
        let (folder, name) = (self.drag.folder, &self.drag.plan.name);
        let film = self.frames.take().map(String::into_bytes);
        let film = film.map(|text| (folder.frames(name, step), text));
        let state = checkpoint::pack(sim, &note())?;
        let files: Vec<_> = film
            .into_iter()
            .chain([(folder.checkpoint(name, step), state)])
            .collect();
        self.ledger.write_all(&files)?;
        self.ledger.save()?;
        self.saver.saved(step);
        Ok(())
    }
}

/// The tables of a finished drag, by file, and its numbers.
///
/// # Errors
/// [`Error::Input`] if the window is too short for a mean.
pub fn results(
    drag: DragTask<'_>,
    dragging: &Dragging,
    sim: &mut Simulation,
) -> Result<(Vec<(&'static str, String)>, DragSummary)> {
    let DragTask { scenario, plan, .. } = drag;
    let means = dragging.means(plan, sim.dt)?;
    let (units, record) = (scenario.units(), &dragging.record);
    let mut tables = vec![
        (
            "forces.csv",
            series_text(
                &units,
                scenario.measure.columns(plan.release),
                &record.series,
            ),
        ),
        ("angles.csv", record.angles.text()),
        ("coordination.csv", record.coordination.text()),
        ("chain.csv", dragging.chain.text()),
    ];
    if scenario.measure.energy {
        tables.push(("energy.csv", energy_text(&units, &record.energy)));
    }
    if let Some(gauge) = &record.flow {
        tables.push(("flow.csv", flow::flow_text(&units, &gauge.rows)));
        tables.push(("profile.csv", gauge.profile.text()));
    }
    if let (Some(gauge), Some(length)) = (&record.tank, scenario.intruder.length) {
        tables.push(("bar.csv", tank_tables::bar_text(&units, &gauge.bar(length))));
        let velocity = tank_tables::velocity_text(&units, &gauge.velocity());
        tables.push(("velocity.csv", velocity));
    }
    if let Some(gauge) = &dragging.fields {
        let hole = intruder_outline(sim);
        let scales = coarse_graining::text::Scales {
            units: &units,
            diameter: scenario.mean_diameter(),
            density: scenario.bed.density,
            far: scenario.far_velocity(plan.motion.speed),
        };
        tables.push((
            "fields.vti",
            coarse_graining::text::vti(&gauge.points(hole), scales),
        ));
        let plane = coarse_graining::text::plane_text(&gauge.plane(hole), scales);
        tables.push(("plane.csv", plane));
    }
    let summary = summarise(scenario, plan, drag.bed, &means, dragging, sim)?;
    if let Some(load) = summary.flow.as_ref().and_then(|flow| flow.load.as_ref()) {
        tables.push((files::LOAD, coarse_graining::text::load_text(load, &units)));
    }
    Ok((tables, summary))
}

/// What `summary.json` of a drag's own folder holds.
pub fn record(
    folder: &Folder<'_>,
    scenario: &CheckedScenario,
    bed: &BedSummary,
    run: &DragSummary,
) -> DragRecord {
    DragRecord {
        version: env!("CARGO_PKG_VERSION").into(),
        bits_version: BITS_VERSION,
        units: scenario.units(),
        inputs: folder.inputs(scenario),
        standard_error_method: METHOD.into(),
        bed: bed.clone(),
        run: run.clone(),
    }
}
