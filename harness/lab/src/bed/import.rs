//! Imported beds: grains and intruder from a LAMMPS data file or dump, dragged through without
//! pouring. Type 2 is the intruder, type 3 is frozen, every other type moves.

use std::path::Path;

use bitgrain_kernel::{Domain, Error as KernelError, Group, Obstacle};

use super::groups::{BASE, FREE};
use crate::scenario::CheckedScenario;
use crate::scenario::source::{check_grains, hash, split};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::export::{FROZEN_TYPE, OBSTACLE_TYPE as INTRUDER_TYPE};
use bitgrain_sim::files::read_text;
use bitgrain_sim::lammps::{Atom, DataFile, parse_atoms};
use bitgrain_sim::simulation::{AnyLaw, Grain, Simulation, sphere_mass};
use bitgrain_sim::spatial_order::spatial_order;

/// Height of the box over that of the bed in it.
const HEADROOM: f64 = 20.0;

/// A bed of a scenario whose `bed.file` was named and lies at `path`, as it is before the drag: its
/// intruder at rest, its forces evaluated with empty histories.
///
/// # Errors
/// [`Error::Input`] if the file has changed since, or grains and box do not fit together.
pub fn bed(scenario: &CheckedScenario, path: &Path) -> Result<Simulation> {
    let name = path.display().to_string();
    let wrong = |what: String| Error::input(name.clone(), what);
    let text = read_text(path)?;
    if scenario.bed.hash.as_deref() != Some(&hash(&text)) {
        return Err(wrong(
            "is not the file that the scenario was checked with".into(),
        ));
    }
    let data = parse_atoms(&text, &name)?;
    let (_, grains) = split(&data).map_err(wrong)?;
    check_grains(scenario, &grains).map_err(wrong)?;
    let law = scenario.contact_law();
    let made = world(&data, law, scenario.drag.dt, scenario.gravity).map_err(wrong)?;
    let (mut sim, names) = made;
    if scenario.bed.floor {
        let plane = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
        sim.obstacles.push(plane);
    }
    sim.start().map_err(|fault| {
        let fault = with_names(fault, &names);
        match crate::case::refuse(&name, fault, |id| format!("atom {id}")) {
            // A row of a campaign, in which no folder of this machine is named.
            Error::Run { step, fault, .. } => {
                let file = path.file_name().unwrap_or_default();
                Error::run(file.to_string_lossy(), step, fault)
            }
            refused => refused,
        }
    })?;
    Ok(sim)
}

/// A fault that names grains as their file does.
fn with_names(fault: KernelError, names: &[u32]) -> KernelError {
    let name = |id: u32| names.get(id as usize - 1).copied().unwrap_or(id);
    match fault {
        KernelError::BadGrain { id } => KernelError::BadGrain { id: name(id) },
        KernelError::NotFinite { id } => KernelError::NotFinite { id: name(id) },
        KernelError::TooFast { id } => KernelError::TooFast { id: name(id) },
        KernelError::TooSlow { id } => KernelError::TooSlow { id: name(id) },
        KernelError::Escaped { id } => KernelError::Escaped { id: name(id) },
        KernelError::OverlapTooDeep { i, j } => KernelError::OverlapTooDeep {
            i: name(i),
            j: name(j),
        },
        KernelError::ObstacleTooDeep { id, obstacle } => KernelError::ObstacleTooDeep {
            id: name(id),
            obstacle,
        },
        other => other,
    }
}

/// The atoms of a file as a world, not yet started: spheres of type 2 as resting obstacles with their
/// own mass, the rest as grains numbered in spatial order, periodic in x and y. Beside it the names
/// that the file gives to grains 1, 2, ...
///
/// # Errors
/// What is impossible about box or grains.
pub fn world(
    data: &DataFile,
    law: AnyLaw,
    dt: f64,
    gravity: f64,
) -> std::result::Result<(Simulation, Vec<u32>), String> {
    let (balls, atoms): (Vec<&Atom>, Vec<&Atom>) =
        data.atoms.iter().partition(|a| a.kind == INTRUDER_TYPE);
    if !atoms.iter().any(|a| a.kind != FROZEN_TYPE) {
        return Err(format!(
            "holds no grain of a type other than {INTRUDER_TYPE} and {FROZEN_TYPE}"
        ));
    }
    if data.periodic.is_some_and(|p| p != [true, true, false]) {
        return Err("is not periodic along x and y and closed along z; beds are".into());
    }
    let [x, y, z] = data.hi;
    // The boxes of files end close above the bed; grains that fly up must not leave the box. The height is
    // taken from the bed, so that a bed that is exported and imported again does not get an ever higher box.
    let top = atoms
        .iter()
        .fold(data.lo[2], |top, a| top.max(a.position[2]));
    let hi = [x, y, z.max(data.lo[2] + HEADROOM * (top - data.lo[2]))];
    let domain = Domain::new(data.lo, hi, [true, true, false]).map_err(|f| f.to_string())?;
    let obstacles = balls.iter().map(|a| {
        let mut center = a.position;
        domain.wrap(&mut center, &mut [0; 3]);
        Obstacle {
            inverse_mass: 1.0 / sphere_mass(a.diameter, a.density),
            ..Obstacle::sphere(center, 0.5 * a.diameter)
        }
    });
    let points: Vec<[f64; 4]> = atoms
        .iter()
        .map(|a| [a.position[0], a.position[1], a.position[2], 0.0])
        .collect();
    let width = atoms.iter().map(|a| a.diameter).sum::<f64>() / atoms.len() as f64;
    let mut images = Vec::with_capacity(atoms.len());
    let grain = |(k, from): (usize, usize)| {
        let a = atoms[from];
        let frozen = a.kind == FROZEN_TYPE;
        let (mut position, mut image) = (a.position, a.image);
        domain.wrap(&mut position, &mut image);
        images.push(image);
        Grain {
            id: k as u32 + 1,
            group: if frozen { BASE } else { FREE },
            diameter: a.diameter,
            density: a.density,
            position,
            velocity: if frozen { [0.0; 3] } else { a.velocity },
            spin: if frozen { [0.0; 3] } else { a.spin },
        }
    };
    let order = spatial_order(&points, width);
    let names = order.iter().map(|&from| atoms[from].id).collect();
    let grains: Vec<Grain> = order.into_iter().enumerate().map(grain).collect();
    let groups = vec![Group::free([0.0, 0.0, -gravity]), Group::frozen()];
    let mut sim = Simulation::new(law, domain, dt, groups, &grains, obstacles.collect());
    sim.image = images;
    Ok((sim, names))
}
