//! A simulation's state for other programs: atoms and frames for LAMMPS' files, VTK for ParaView.
//!
//! The VTK files are the legacy text format, version 3.0, which every ParaView and VTK reads. They
//! are written here, by a few lines: the crate that would do it, `vtkio`, has had nothing but
//! candidates for its next release since 2023.

mod bodies;
mod vtk;

pub use bodies::vtk_bodies;

use bitgrain_kernel::{ContactForce, Obstacle, Partner, Shape};

use crate::lammps::{Atom, DataFile, DumpFrame};
use crate::simulation::{Role, Simulation, sphere_mass};
use vtk::{push_reals, push_rows, push_vectors, push_whole, vtk_head};

/// Type of the grains that move.
pub const GRAIN_TYPE: u32 = 1;
/// Type of obstacle spheres: the intruder.
pub const OBSTACLE_TYPE: u32 = 2;
/// Type of the base's grains, frozen or carried.
pub const FROZEN_TYPE: u32 = 3;
/// Type of the lid's grains.
pub const LID_TYPE: u32 = 4;

/// The grains (type 1; the base's 3, the lid's 4) and, if asked for, the obstacle spheres (type 2, numbered on
/// from the last grain) as a data file. Planes and cylinders have no place in one.
///
/// Each density gives the mass back to the bit. An infinitely heavy obstacle, which a
/// file cannot express, gets density 1. The box of open space is drawn round what is in it.
pub fn atoms(sim: &Simulation, obstacles: bool) -> DataFile {
    let row = |i: usize| {
        let (x, v, w) = (sim.position[i], sim.velocity[i], sim.spin[i]);
        let kind = match sim.role(i) {
            Role::Free => GRAIN_TYPE,
            Role::Base => FROZEN_TYPE,
            Role::Lid => LID_TYPE,
        };
        Atom {
            id: sim.id[i],
            kind,
            diameter: 2.0 * x[3],
            density: density_of(2.0 * x[3], v[3]),
            position: [x[0], x[1], x[2]],
            image: sim.image[i],
            velocity: [v[0], v[1], v[2]],
            spin: [w[0], w[1], w[2]],
        }
    };
    let mut atoms: Vec<Atom> = (0..sim.count()).map(row).collect();
    if obstacles {
        let last = sim.id.last().copied().unwrap_or(0);
        for (k, (body, radius)) in balls(sim).enumerate() {
            let density = match body.inverse_mass {
                0.0 => 1.0,
                inverse => density_of(2.0 * radius, 1.0 / inverse),
            };
            atoms.push(Atom {
                id: last.saturating_add(1 + k as u32),
                kind: OBSTACLE_TYPE,
                diameter: 2.0 * radius,
                density,
                position: body.point,
                image: body.image,
                velocity: body.velocity,
                spin: [0.0; 3],
            });
        }
    }
    let [lo, hi] = edges(sim, &atoms);
    DataFile {
        lo,
        hi,
        periodic: Some(sim.domain.periodic()),
        atoms,
    }
}

/// Grains and obstacle spheres as a frame of a dump, and the contact force on each; on an obstacle,
/// the sum of its grains' forces.
pub fn frame(sim: &Simulation) -> (DumpFrame, Vec<[f64; 3]>) {
    let data = atoms(sim, true);
    let mut forces: Vec<[f64; 3]> = sim.force.iter().map(|f| [f[0], f[1], f[2]]).collect();
    forces.extend(balls(sim).map(|(body, _)| body.force));
    let frame = DumpFrame {
        step: sim.step_count(),
        lo: data.lo,
        hi: data.hi,
        periodic: sim.domain.periodic(),
        atoms: data.atoms,
    };
    (frame, forces)
}

/// The obstacles that are spheres, and their radii.
fn balls(sim: &Simulation) -> impl Iterator<Item = (&Obstacle<f64>, f64)> {
    sim.obstacles.iter().filter_map(|body| match body.shape {
        Shape::Sphere { radius } => Some((body, radius)),
        _ => None,
    })
}

/// The density that gives this mass back to the bit: the quotient or a neighbour of it, and of
/// these the one that is shortest to write (2500, not 2500.0000000000005).
fn density_of(diameter: f64, mass: f64) -> f64 {
    let quotient = mass / sphere_mass(diameter, 1.0);
    [quotient, quotient.next_down(), quotient.next_up()]
        .into_iter()
        .filter(|density| sphere_mass(diameter, *density) == mass)
        .min_by_key(|density| density.to_string().len())
        .unwrap_or(quotient)
}

/// The box, or for open space one that leaves a largest diameter round every atom.
fn edges(sim: &Simulation, atoms: &[Atom]) -> [[f64; 3]; 2] {
    let (mut lo, mut hi) = (sim.domain.lo(), sim.domain.hi());
    let margin = atoms.iter().fold(1.0, |m: f64, a| m.max(a.diameter));
    for a in 0..3 {
        if !(hi[a] - lo[a]).is_finite() {
            let places = || atoms.iter().map(|atom| atom.position[a]);
            lo[a] = places().fold(0.0, f64::min) - margin;
            hi[a] = places().fold(0.0, f64::max) + margin;
        }
    }
    [lo, hi]
}

/// Grains and obstacle spheres as points of a VTK file, with id, type, radius, speed, velocity,
/// spin and contact force; `title` is its second line. ParaView draws them with a Glyph filter:
/// spheres scaled by `radius` with a factor of 2.
pub fn vtk_grains(sim: &Simulation, title: &str) -> String {
    let (DumpFrame { atoms, .. }, forces) = frame(sim);
    let n = atoms.len();
    let mut out = vtk_head(title);
    out.push_str(&format!("POINTS {n} double\n"));
    push_rows(&mut out, atoms.iter().map(|a| a.position));
    out.push_str(&format!("VERTICES {n} {}\n", 2 * n));
    (0..n).for_each(|k| out.push_str(&format!("1 {k}\n")));
    out.push_str(&format!("POINT_DATA {n}\n"));
    push_whole(
        &mut out,
        "id",
        "unsigned_int",
        atoms.iter().map(|a| i64::from(a.id)),
    );
    push_whole(
        &mut out,
        "type",
        "unsigned_int",
        atoms.iter().map(|a| i64::from(a.kind)),
    );
    push_reals(&mut out, "radius", atoms.iter().map(|a| 0.5 * a.diameter));
    push_reals(&mut out, "speed", atoms.iter().map(|a| length(a.velocity)));
    push_vectors(&mut out, "velocity", atoms.iter().map(|a| a.velocity));
    push_vectors(&mut out, "spin", atoms.iter().map(|a| a.spin));
    push_vectors(&mut out, "force", forces.into_iter());
    out
}

/// The contacts of a step ([`Simulation::step_watched`]) as lines of a VTK file, with the normal force,
/// the tangential force (on the grain that the line begins at), the overlap, and the obstacle's
/// number (-1 between grains).
///
/// A line runs from the centre of the lower grain to that of the other, or to the obstacle's
/// surface. Across a periodic edge it ends at the nearest image, outside the box, so that none
/// crosses the box.
pub fn vtk_contacts(sim: &Simulation, contacts: &[ContactForce<f64>], title: &str) -> String {
    let n = contacts.len();
    let mut out = vtk_head(title);
    out.push_str(&format!("POINTS {} double\n", 2 * n));
    push_rows(&mut out, contacts.iter().flat_map(|c| ends(sim, c)));
    out.push_str(&format!("LINES {n} {}\n", 3 * n));
    (0..n).for_each(|k| out.push_str(&format!("2 {} {}\n", 2 * k, 2 * k + 1)));
    out.push_str(&format!("CELL_DATA {n}\n"));
    push_reals(
        &mut out,
        "normal_force",
        contacts.iter().map(|c| c.normal_force),
    );
    push_vectors(
        &mut out,
        "tangential_force",
        contacts.iter().map(|c| c.tangential_force),
    );
    push_reals(&mut out, "overlap", contacts.iter().map(|c| c.overlap));
    let number = |c: &ContactForce<f64>| match c.partner {
        Partner::Grain(_) => -1,
        Partner::Obstacle(k) => i64::from(k),
    };
    push_whole(&mut out, "obstacle", "int", contacts.iter().map(number));
    out
}

/// Where the line of a contact begins and ends.
fn ends(sim: &Simulation, contact: &ContactForce<f64>) -> [[f64; 3]; 2] {
    let [x, y, z, radius] = sim.position[contact.i as usize];
    let from = [x, y, z];
    let branch = match contact.partner {
        Partner::Grain(j) => {
            let other = sim.position[j as usize];
            sim.domain.separation(from, [other[0], other[1], other[2]])
        }
        Partner::Obstacle(_) => contact.normal.map(|n| n * (radius - contact.overlap)),
    };
    [from, [x - branch[0], y - branch[1], z - branch[2]]]
}

fn length(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}
