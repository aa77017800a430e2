//! Changes of grains between two steps, one after the other.

use bitgrain::law::{Sprung, WithLaw};
use bitgrain::simulation::{Grain, Simulation, sphere_mass};
use bitgrain_kernel::contact::Law;
use bitgrain_kernel::{ContactHistory, Error as KernelError, GrainState, World, nudge, step_with};

use crate::simulated::Push;

/// A change of some grains, which are named by id.
#[derive(Clone, Debug)]
pub enum Change {
    /// New velocities.
    Velocities(Vec<u32>, Vec<[f64; 3]>),
    /// New spins.
    Spins(Vec<u32>, Vec<[f64; 3]>),
    /// More grains; their ids ascend and are above all others.
    Insert(Vec<Grain>),
    /// Fewer grains.
    Remove(Vec<u32>),
    /// Another group.
    Group(Vec<u32>, u8),
}

/// Why a change was refused.
#[derive(Clone, Copy, Debug)]
pub enum Refusal {
    /// By the kernel.
    Kernel(KernelError),
    /// There is no grain of this id.
    Unknown(u32),
}

impl From<KernelError> for Refusal {
    fn from(fault: KernelError) -> Self {
        Self::Kernel(fault)
    }
}

/// The place of a grain among the rows.
fn place(sim: &Simulation, id: u32) -> Result<usize, Refusal> {
    sim.id.binary_search(&id).map_err(|_| Refusal::Unknown(id))
}

fn head(row: [f64; 4]) -> [f64; 3] {
    [row[0], row[1], row[2]]
}

/// Makes one change.
///
/// # Errors
/// [`Refusal`]; the simulation may have changed in part.
pub fn apply(sim: &mut Simulation, change: &Change) -> Result<(), Refusal> {
    match change {
        Change::Velocities(ids, velocities) => {
            for (id, velocity) in ids.iter().zip(velocities) {
                let at = place(sim, *id)?;
                let spin = head(sim.spin[at]);
                nudge(&mut sim.world(), at, *velocity, spin)?;
            }
        }
        Change::Spins(ids, spins) => {
            for (id, spin) in ids.iter().zip(spins) {
                let at = place(sim, *id)?;
                let velocity = head(sim.velocity[at]);
                nudge(&mut sim.world(), at, velocity, *spin)?;
            }
        }
        Change::Insert(grains) => insert(sim, grains)?,
        Change::Remove(ids) => remove(sim, ids)?,
        Change::Group(ids, group) => {
            let histories = sim.contact_histories();
            for id in ids {
                let at = place(sim, *id)?;
                sim.group[at] = *group;
            }
            sim.resume(&histories)?;
            try_a_step(sim)?;
        }
    }
    Ok(())
}

/// The rows of grains, behind those that there are.
pub fn add_rows(sim: &mut Simulation, grains: &[Grain]) {
    for g in grains {
        let mass = sphere_mass(g.diameter, g.density);
        let [x, y, z] = g.position;
        let [u, v, w] = g.velocity;
        let (position, velocity) = ([x, y, z, 0.5 * g.diameter], [u, v, w, mass]);
        sim.add(g.id, g.group, position, velocity, g.spin);
    }
}

/// New grains come behind the others, so that every contact keeps its places.
pub fn insert(sim: &mut Simulation, grains: &[Grain]) -> Result<(), KernelError> {
    let histories = sim.contact_histories();
    add_rows(sim, grains);
    sim.fit_storage();
    sim.resume(&histories)?;
    try_a_step(sim)
}

/// Does a step of a copy: bodies that lie too deep in each other are found before the world has them.
///
/// # Errors
/// What stopped it.
pub fn try_a_step(sim: &Simulation) -> Result<(), KernelError> {
    sim.clone().steps(1)
}

/// Contacts of grains that are gone are forgotten, all others keep their histories.
fn remove(sim: &mut Simulation, ids: &[u32]) -> Result<(), Refusal> {
    let mut stays = vec![true; sim.count()];
    for id in ids {
        stays[place(sim, *id)?] = false;
    }
    let histories = sim.contact_histories();
    let mut places: Vec<Option<u32>> = Vec::with_capacity(stays.len());
    let mut next = 0;
    for stay in &stays {
        places.push(stay.then_some(next));
        next += u32::from(*stay);
    }
    let moved = |place: u32| places[place as usize];
    let kept = histories.into_iter().filter_map(|one| match one {
        ContactHistory::Pair { i, j, spring } => {
            let (i, j) = (moved(i)?, moved(j)?);
            Some(ContactHistory::Pair { i, j, spring })
        }
        ContactHistory::Obstacle {
            i,
            obstacle,
            spring,
        } => {
            let i = moved(i)?;
            Some(ContactHistory::Obstacle {
                i,
                obstacle,
                spring,
            })
        }
    });
    let kept: Vec<ContactHistory<f64>> = kept.collect();
    keep(&mut sim.id, &stays);
    keep(&mut sim.group, &stays);
    keep(&mut sim.position, &stays);
    keep(&mut sim.velocity, &stays);
    keep(&mut sim.spin, &stays);
    keep(&mut sim.force, &stays);
    keep(&mut sim.torque, &stays);
    keep(&mut sim.image, &stays);
    sim.range_bounds.clear();
    sim.fit_storage();
    Ok(sim.resume(&kept)?)
}

fn keep<T>(rows: &mut Vec<T>, stays: &[bool]) {
    let mut stays = stays.iter();
    rows.retain(|_| stays.next().is_some_and(|stay| *stay));
}

/// One step with forces from outside.
struct Pushed<'a, 'w, 'p> {
    world: &'a mut World<'w, f64>,
    push: &'p Push,
}

impl WithLaw for Pushed<'_, '_, '_> {
    type Output = Result<(), KernelError>;

    fn run<L: Law<f64> + Sprung>(self, law: &L) -> Self::Output {
        let Push { force, torque } = self.push;
        let given = |grain: &GrainState<f64>| (force[grain.place], torque[grain.place]);
        step_with(self.world, law, given)
    }
}

/// Steps with a push on each grain.
///
/// # Errors
/// What stopped a step.
pub fn pushed_steps(sim: &mut Simulation, count: u64, push: &Push) -> Result<(), KernelError> {
    let mut left = count;
    while left > 0 {
        let law = sim.law;
        let mut world = sim.world();
        match law.with(Pushed {
            world: &mut world,
            push,
        }) {
            Ok(()) => left -= 1,
            Err(full) if sim.grow(full) => {}
            Err(fault) => return Err(fault),
        }
    }
    Ok(())
}
