//! Replaying a case: one JSON line for each sampled step.

use std::io::Write;
use std::path::Path;

use bitgrain_kernel::{Partner, Pushed, vec3};
use serde::Serialize;

use crate::audit::{Audit, EnergyRow};
use crate::case;
use crate::error::{Error, Result};
use crate::sim::{Sim, hex};

/// What to replay.
#[derive(Clone, Debug)]
pub struct Replay {
    /// Steps to run.
    pub steps: u64,
    /// Steps between samples; the first and the last step are always sampled.
    pub every: u64,
    /// Whether to list the contacts.
    pub contacts: bool,
    /// Whether to account for the energy.
    pub energy: bool,
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
    force: [f64; 3],
    torque: [f64; 3],
}

/// One contact; forces are vectors on grain `i`.
#[derive(Serialize)]
struct ContactState {
    i: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    j: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    obstacle: Option<u32>,
    normal_force: [f64; 3],
    tangential_force: [f64; 3],
}

/// Replays the case in `path` and writes JSON Lines to `out`.
///
/// # Errors
/// A refused case, a run that went wrong (what was sampled before has been written), or `out`.
pub fn replay(path: &Path, what: &Replay, out: &mut impl Write) -> Result<()> {
    let name = path.display().to_string();
    let case = case::read(path)?;
    let mut seen = Vec::new();
    let mut sim = case.start(&name, |p| seen.push(p))?;
    let mut audit = what.energy.then(|| Audit::new(&mut sim));
    let energy = |audit: &Option<Audit>| audit.map(|audit| audit.row(0));
    write_sample(
        &mut sim,
        what.contacts.then_some(&seen),
        energy(&audit),
        out,
    )?;
    let every = what.every.max(1);
    while sim.step_count() < what.steps {
        let next = (sim.step_count() / every * every + every).min(what.steps);
        let fault = |sim: &Sim, f| Error::run(&name, sim.step_count() + 1, f);
        let between = next - 1 - sim.step_count();
        let done = match &mut audit {
            None => sim.steps(between),
            Some(audit) => (0..between).try_for_each(|_| audit.step(&mut sim)),
        };
        done.map_err(|f| fault(&sim, f))?;
        seen.clear();
        let done = match &mut audit {
            None => sim.step_watched(|p| seen.push(p)),
            Some(audit) => audit.step_watched(&mut sim, |p| seen.push(p)),
        };
        done.map_err(|f| fault(&sim, f))?;
        write_sample(
            &mut sim,
            what.contacts.then_some(&seen),
            energy(&audit),
            out,
        )?;
    }
    out.flush().map_err(Error::Output)
}

fn write_sample(
    sim: &mut Sim,
    contacts: Option<&Vec<Pushed<f64>>>,
    energy: Option<EnergyRow>,
    out: &mut impl Write,
) -> Result<()> {
    let digest = hex(&sim.digest().whole);
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
            force: body.force,
            torque: body.torque,
        });
    let name = |place: u32| sim.id[place as usize];
    let contacts = contacts.map(|seen| {
        seen.iter()
            .map(|c| {
                let (j, obstacle) = match c.partner {
                    Partner::Grain(j) => (Some(name(j)), None),
                    Partner::Obstacle(k) => (None, Some(k)),
                };
                ContactState {
                    i: name(c.i),
                    j,
                    obstacle,
                    normal_force: vec3::scale(c.normal, c.normal_force),
                    tangential_force: c.tangential_force,
                }
            })
            .collect()
    });
    let sample = Sample {
        step: sim.step_count(),
        digest,
        grains: grains.collect(),
        obstacles: obstacles.collect(),
        contacts,
        energy,
    };
    let mut line = serde_json::to_vec(&sample).map_err(|e| Error::Output(e.into()))?;
    line.push(b'\n');
    out.write_all(&line).map_err(Error::Output)
}
