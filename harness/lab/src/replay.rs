//! Replaying a case, or a stretch of a run: one JSON line for each sampled step.

use std::io::Write;
use std::path::{Path, PathBuf};

use bitgrain_kernel::{ContactForce, Partner, vec3};
use serde::{Deserialize, Serialize};

use crate::beside::refuse_result;
use crate::case::{self, Case};
use crate::folder::Folder;
use crate::progress::Progress;
use crate::rerun::RunArchive;
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk::{make_folder, other_than, write_whole};
use bitgrain_sim::energy_budget::{Audit, EnergyRow};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::export;
use bitgrain_sim::files::bits;
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::{Simulation, hex};

/// What to replay.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Steps to run.
    pub steps: u64,
    /// Steps between samples; the first and the last step are always sampled.
    pub every: u64,
    /// Whether to list the contacts.
    pub contacts: bool,
    /// Whether to account for the energy: cases only.
    pub energy: bool,
    /// Whether to print digests alone, part by part.
    pub digests: bool,
    /// A folder for each sample as files for ParaView: `grains.STEP.vtk` and `bodies.STEP.vtk`, and with `contacts`
    /// also `contacts.STEP.vtk`.
    pub vtk: Option<PathBuf>,
    /// Whether a time step beyond the shortest Rayleigh time is taken too, of a case.
    pub beyond_rayleigh: bool,
}

/// Which stretch of a run to replay.
#[derive(Clone, Debug)]
pub struct Stretch {
    /// Name of the stage.
    pub stage: String,
    /// The first sample.
    pub from: u64,
    /// Where to write the last state as a checkpoint.
    pub save: Option<PathBuf>,
}

/// A line of digests alone.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Digests {
    /// The step.
    pub step: u64,
    /// Digest of the state, in hex.
    pub digest: String,
    /// Digests of its parts, in the order of [`bitgrain_kernel::PARTS`].
    pub parts: [String; 6],
}

#[derive(Serialize)]
struct Sample {
    step: u64,
    digest: String,
    grains: Vec<GrainState>,
    obstacles: Vec<ObstacleState>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contacts: Option<Vec<ContactState>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    energy: Option<EnergyRow>,
}

#[derive(Serialize)]
struct GrainState {
    id: u32,
    position: [f64; 3],
    velocity: [f64; 3],
    spin: [f64; 3],
    force: [f64; 3],
    torque: [f64; 3],
}

#[derive(Serialize)]
struct ObstacleState {
    index: usize,
    /// Its point, wrapped into the box.
    center: [f64; 3],
    orientation: [f64; 4],
    velocity: [f64; 3],
    angular_velocity: [f64; 3],
    force: [f64; 3],
    torque: [f64; 3],
}

/// One contact; forces are vectors on grain `i`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactState {
    /// The grain (the lower one of two).
    pub i: u32,
    /// The other grain.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub j: Option<u32>,
    /// Or the obstacle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub obstacle: Option<u32>,
    /// And which of its surfaces, if it has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub surface: Option<u32>,
    /// Normal force on `i`.
    pub normal_force: [f64; 3],
    /// Tangential force on `i`.
    pub tangential_force: [f64; 3],
    /// Torque on `i` beside that of the tangential force, if the law resists rolling.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub torque: Option<[f64; 3]>,
}

/// Replays the case in `path`, or goes on from the checkpoint there, and writes JSON Lines to `out`. Steps count
/// from the case or the checkpoint; of the latter the first sample has no contacts. A time step that does not resolve
/// the waves and the collisions of the state at the beginning is warned of.
///
/// # Errors
/// A refused case, a damaged checkpoint, a run that failed (what was sampled before has been written), or `out`.
pub fn replay(path: &Path, what: &Replay, progress: &Progress, out: &mut impl Write) -> Result<()> {
    let name = path.display().to_string();
    what.vtk.as_deref().map_or(Ok(()), make_vtk_folder)?;
    let mut seen = Vec::new();
    let saved = path.extension().is_some_and(|end| end == "safetensors");
    let mut sim = match saved {
        true => checkpoint::read(path)?,
        false => read_case(path, what)?.start(&name, |p| seen.push(p))?,
    };
    let times = sim.shortest_times();
    if let Some(problem) = sim.long_step(&times) {
        let refused = !saved && !what.beyond_rayleigh && sim.dt > times.rayleigh;
        match refused {
            true => return Err(Error::input(format!("{name}: `dt`"), problem + BEYOND)),
            false => progress.warn(&format!("warning: {name}: `dt`: {problem}")),
        }
    }
    let begin = sim.step_count();
    let mut audit = what.energy.then(|| Audit::new(&mut sim));
    let energy = |step, audit: &Option<Audit>| audit.map(|audit| audit.row(step));
    let first = Replay {
        contacts: what.contacts && !saved,
        ..what.clone()
    };
    write_sample(0, &mut sim, &first, (&seen, energy(0, &audit)), out)?;
    let (every, mut done) = (what.every.max(1), 0);
    while done < what.steps {
        let next = (done / every * every + every).min(what.steps);
        let fault = |sim: &Simulation, f| Error::run(&name, sim.step_count() - begin + 1, f);
        let between = next - 1 - done;
        let went = match &mut audit {
            None => sim.steps(between),
            Some(audit) => (0..between).try_for_each(|_| audit.step(&mut sim)),
        };
        went.map_err(|f| fault(&sim, f))?;
        seen.clear();
        let went = match &mut audit {
            None => sim.step_seen(&mut seen),
            Some(audit) => audit.step_seen(&mut sim, &mut seen),
        };
        went.map_err(|f| fault(&sim, f))?;
        done = sim.step_count() - begin;
        write_sample(done, &mut sim, what, (&seen, energy(done, &audit)), out)?;
    }
    out.flush().map_err(Error::Output)
}

/// How a time step beyond the Rayleigh time is accepted.
const BEYOND: &str = "; --beyond-rayleigh takes a time step above the Rayleigh time";

/// The case in a file; one whose time step is beyond the Rayleigh time of its grains is refused unless it is asked for.
fn read_case(path: &Path, what: &Replay) -> Result<Case> {
    let most = if what.beyond_rayleigh {
        f64::INFINITY
    } else {
        1.0
    };
    case::read_up_to(path, most).map_err(|error| match error {
        Error::Input { place, problem } if place.ends_with("`dt`") => {
            Error::input(place, problem + BEYOND)
        }
        other => other,
    })
}

/// Replays a stretch of the run in a folder, beginning at the last state kept before it, and writes JSON
/// Lines to `out`. Steps are the stage's own.
///
/// # Errors
/// Not a folder or stage of a run, a checkpoint that cannot be read, a run that fails, or `out`.
pub fn replay_run(
    folder: &Folder<'_>,
    stretch: &Stretch,
    what: &Replay,
    progress: &Progress,
    out: &mut impl Write,
) -> Result<()> {
    let past = RunArchive::open(folder)?;
    stretch.save.as_deref().map_or(Ok(()), refuse_result)?;
    what.vtk.as_deref().map_or(Ok(()), make_vtk_folder)?;
    let part = past.part(&stretch.stage)?;
    let past_all = || Error::input(&stretch.stage, "does not have so many steps");
    let to = stretch.from.checked_add(what.steps).ok_or_else(past_all)?;
    let mut tape = StatePrinter {
        from: stretch.from,
        to,
        what,
        save: stretch.save.as_deref(),
        out: &mut *out,
        last: None,
    };
    // Contacts are seen as a step evaluates them: begin before it.
    let before = stretch.from.saturating_sub(u64::from(what.contacts));
    past.rerun(part, before, progress, &mut tape)?;
    let last = tape.last;
    out.flush().map_err(Error::Output)?;
    if last == Some(to) {
        return Ok(());
    }
    let told = last.map_or("before that".into(), |step| format!("after step {step}"));
    let problem = format!("step {to} was asked for, but the stage ends {told}");
    Err(Error::input(&stretch.stage, problem))
}

/// Prints the states of a stretch.
struct StatePrinter<'a, W> {
    from: u64,
    to: u64,
    what: &'a Replay,
    save: Option<&'a Path>,
    out: &'a mut W,
    /// The last step that was printed.
    last: Option<u64>,
}

impl<W: Write> Observer for StatePrinter<'_, W> {
    fn on_start(&mut self, step: u64, sim: &mut Simulation) -> Result<()> {
        if step == self.from {
            self.on_step(step, sim, &[])?;
        }
        Ok(())
    }

    fn wants_step(&self, step: u64) -> bool {
        let sampled = |n: u64| n.is_multiple_of(self.what.every.max(1));
        (self.from..=self.to).contains(&step) && (step == self.to || sampled(step - self.from))
    }

    fn wants_contacts(&self, step: u64) -> bool {
        self.what.contacts && self.wants_step(step)
    }

    fn on_step(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        contacts: &[ContactForce<f64>],
    ) -> Result<()> {
        write_sample(step, sim, self.what, (contacts, None), self.out)?;
        self.last = Some(step);
        match self.save {
            Some(path) if step == self.to => checkpoint::write(path, sim),
            _ => Ok(()),
        }
    }

    fn last_step(&self) -> u64 {
        self.to
    }
}

/// Makes a folder for files of ParaView; one that holds other files is refused.
fn make_vtk_folder(folder: &Path) -> Result<()> {
    match other_than(folder, |name| {
        name.ends_with(".vtk").then_some("BITS_VERSION")
    })? {
        None => make_folder(folder),
        Some(other) => {
            let problem =
                format!("holds {other}, which is no VTK file of a replay; choose another folder");
            Err(Error::input(folder.display().to_string(), problem))
        }
    }
}

/// A state for ParaView.
fn write_vtk(
    folder: &Path,
    step: u64,
    sim: &Simulation,
    contacts: Option<&[ContactForce<f64>]>,
) -> Result<()> {
    let title = format!("step {step}; {}", bits());
    let contacts = contacts.map(|contacts| export::vtk_contacts(sim, contacts, &title));
    let files = [
        ("grains", Some(export::vtk_grains(sim, &title))),
        ("bodies", Some(export::vtk_bodies(sim, &title))),
        ("contacts", contacts),
    ];
    for (what, text) in files {
        if let Some(text) = text {
            write_whole(&folder.join(format!("{what}.{step}.vtk")), text.as_bytes())?;
        }
    }
    Ok(())
}

fn write_line(value: &impl Serialize, out: &mut impl Write) -> Result<()> {
    let mut line = serde_json::to_vec(value).map_err(|e| Error::Output(e.into()))?;
    line.push(b'\n');
    out.write_all(&line).map_err(Error::Output)
}

fn write_sample(
    step: u64,
    sim: &mut Simulation,
    what: &Replay,
    (seen, energy): (&[ContactForce<f64>], Option<EnergyRow>),
    out: &mut impl Write,
) -> Result<()> {
    if let Some(folder) = &what.vtk {
        write_vtk(folder, step, sim, what.contacts.then_some(seen))?;
    }
    let digest = sim.digest();
    let digest = digest.map_err(|fault| Error::run("a replay", step, fault))?;
    if what.digests {
        let line = Digests {
            step,
            digest: hex(&digest.whole),
            parts: digest.parts().map(|part| hex(part)),
        };
        return write_line(&line, out);
    }
    let grains = (0..sim.count()).map(|i| GrainState {
        id: sim.id[i],
        position: vec3::head(sim.position[i]),
        velocity: vec3::head(sim.velocity[i]),
        spin: vec3::head(sim.spin[i]),
        force: vec3::head(sim.force[i]),
        torque: vec3::head(sim.torque[i]),
    });
    let obstacles = sim
        .obstacles
        .iter()
        .enumerate()
        .map(|(index, body)| ObstacleState {
            index,
            center: body.point,
            orientation: body.orientation,
            velocity: body.velocity,
            angular_velocity: body.angular_velocity,
            force: body.force,
            torque: body.torque,
        });
    let name = |place: u32| sim.id[place as usize];
    let turns = sim.law.words() > 0;
    let contacts = what.contacts.then(|| {
        seen.iter()
            .map(|c| {
                let (j, obstacle) = match c.partner {
                    Partner::Grain(j) => (Some(name(j)), None),
                    Partner::Obstacle(k) => (None, Some(k)),
                };
                let surfaces = |k: u32| sim.obstacles[k as usize].shape.surfaces();
                let has_several = obstacle.is_some_and(|k| surfaces(k) > 1);
                ContactState {
                    i: name(c.i),
                    j,
                    obstacle,
                    surface: has_several.then_some(c.surface),
                    normal_force: vec3::scale(c.normal, c.normal_force),
                    tangential_force: c.tangential_force,
                    torque: turns.then_some(c.torque),
                }
            })
            .collect()
    });
    let sample = Sample {
        step,
        digest: hex(&digest.whole),
        grains: grains.collect(),
        obstacles: obstacles.collect(),
        contacts,
        energy,
    };
    write_line(&sample, out)
}
