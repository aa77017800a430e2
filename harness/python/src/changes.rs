//! Changes of grains between two steps, one after the other, and steps with forces from outside.

use bitgrain::simulation::{Grain, Simulation, sphere_mass};
use bitgrain_kernel::Error as KernelError;

/// A change of some grains, which are named by id.
#[derive(Clone, Debug)]
pub enum Change {
    /// New velocities.
    Velocities(Vec<u32>, Vec<[f64; 3]>),
    /// New spins.
    Spins(Vec<u32>, Vec<[f64; 3]>),
    /// More grains; their ids ascend.
    Insert(Vec<Grain>),
    /// Fewer grains; their ids ascend.
    Remove(Vec<u32>),
    /// Another group; ids ascend.
    Group(Vec<u32>, u8),
}

/// A force and a torque on each grain, by their places, that act in each step of a call.
#[derive(Debug, Default)]
pub struct Push {
    /// Forces.
    pub force: Vec<[f64; 3]>,
    /// Torques.
    pub torque: Vec<[f64; 3]>,
}

/// The place of a grain among the rows.
fn place(sim: &Simulation, id: u32) -> Result<usize, KernelError> {
    let found = sim.id.binary_search(&id);
    found.map_err(|_| KernelError::UnknownGrain { id })
}

fn head(row: [f64; 4]) -> [f64; 3] {
    [row[0], row[1], row[2]]
}

/// Makes one change.
///
/// # Errors
/// What the kernel refuses; the simulation may have changed in part.
pub fn apply(sim: &mut Simulation, change: &Change) -> Result<(), KernelError> {
    match change {
        Change::Velocities(ids, velocities) => {
            for (id, velocity) in ids.iter().zip(velocities) {
                let spin = head(sim.spin[place(sim, *id)?]);
                sim.nudge(*id, *velocity, spin)?;
            }
            Ok(())
        }
        Change::Spins(ids, spins) => {
            for (id, spin) in ids.iter().zip(spins) {
                let velocity = head(sim.velocity[place(sim, *id)?]);
                sim.nudge(*id, velocity, *spin)?;
            }
            Ok(())
        }
        Change::Insert(grains) => sim.insert(grains),
        Change::Remove(ids) => sim.remove(ids),
        Change::Group(ids, group) => sim.regroup(ids, *group),
    }
}

/// The rows of grains, behind those that there are, in a world that has not started.
pub fn add_rows(sim: &mut Simulation, grains: &[Grain]) {
    for g in grains {
        let mass = sphere_mass(g.diameter, g.density);
        let [x, y, z] = g.position;
        let [u, v, w] = g.velocity;
        let (position, velocity) = ([x, y, z, 0.5 * g.diameter], [u, v, w, mass]);
        sim.add(g.id, g.group, position, velocity, g.spin);
    }
}

/// Does a step of a copy: bodies that lie too deep in each other are found before the world has them.
///
/// # Errors
/// What stopped it.
pub fn try_a_step(sim: &Simulation) -> Result<(), KernelError> {
    sim.clone().steps(1)
}

/// A step with a push on each grain; it may be one of a stretch that is held.
///
/// # Errors
/// What stopped the step.
pub fn pushed_step(sim: &mut Simulation, push: &Push) -> Result<(), KernelError> {
    sim.step_with(|grain| (push.force[grain.place], push.torque[grain.place]))
}
