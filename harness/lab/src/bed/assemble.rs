//! A state taken apart and put together again: grains renumbered, frozen, taken out or added, while
//! the contacts that stay keep their springs.

use bitgrain_kernel::{ContactHistory, Error as KernelError, Group, KeptContact, Obstacle};

use bitgrain_sim::histories::Histories;
use bitgrain_sim::simulation::{Grain, Simulation, sphere_mass};

/// A grain of the new state.
#[derive(Clone, Copy, Debug)]
pub(super) enum Member {
    /// One of the old state, by its place, and its group.
    Old(usize, u8),
    /// Another one.
    New(Grain),
}

/// The new state: `members` in the order of their numbers, from 1; `obstacles`, each with the number it
/// had before, if any. Springs are seen from the grain that has the lower number; those of contacts
/// that are gone, or that two heavy bodies have, are dropped. Grains of a group that does not move along
/// z lose their velocity and spin.
pub(super) fn assemble(
    old: &mut Simulation,
    members: &[Member],
    groups: Vec<Group<f64>>,
    obstacles: Vec<(Obstacle<f64>, Option<u32>)>,
) -> Result<Simulation, KernelError> {
    let histories = old.contact_histories();
    let mut new = Simulation::new(old.law.clone(), old.domain, old.dt, groups, &[], vec![]);
    new.set_step_count(old.step_count());
    let mut place = vec![None; old.count()];
    for (k, member) in members.iter().enumerate() {
        new.id.push(k as u32 + 1);
        match *member {
            Member::Old(from, group) => {
                place[from] = Some(k as u32);
                new.group.push(group);
                new.position.push(old.position[from]);
                new.velocity.push(old.velocity[from]);
                new.spin.push(old.spin[from]);
                new.force.push(old.force[from]);
                new.torque.push(old.torque[from]);
                new.image.push(old.image[from]);
            }
            Member::New(grain) => {
                let row = |v: [f64; 3], w: f64| [v[0], v[1], v[2], w];
                let mass = sphere_mass(grain.diameter, grain.density);
                new.group.push(grain.group);
                new.position.push(row(grain.position, 0.5 * grain.diameter));
                new.velocity.push(row(grain.velocity, mass));
                new.spin.push(row(grain.spin, 0.0));
                new.force.push([0.0; 4]);
                new.torque.push([0.0; 4]);
                new.image.push([0; 3]);
            }
        }
        if !new.groups[new.group[k] as usize].integrates[2] {
            new.velocity[k] = [0.0, 0.0, 0.0, new.velocity[k][3]];
            new.spin[k] = [0.0; 4];
        }
    }
    let number: Vec<Option<u32>> = obstacles.iter().map(|(_, was)| *was).collect();
    new.obstacles = obstacles.into_iter().map(|(body, _)| body).collect();
    let renamed = Renamed {
        new: &new,
        place: &place,
        number: &number,
    };
    let kept: Histories = histories
        .iter()
        .filter_map(|contact| renamed.contact(contact))
        .collect();
    new.fit_storage();
    new.choose_skin();
    new.resume(&kept)?;
    Ok(new)
}

/// The new places of the grains and obstacles of the old state.
struct Renamed<'a> {
    new: &'a Simulation,
    place: &'a [Option<u32>],
    /// The number each of the new obstacles had.
    number: &'a [Option<u32>],
}

impl Renamed<'_> {
    fn heavy(&self, k: u32) -> bool {
        self.new.groups[self.new.group[k as usize] as usize].infinite_mass
    }

    fn contact(&self, mut contact: KeptContact<f64>) -> Option<KeptContact<f64>> {
        match &mut contact.history {
            ContactHistory::Pair { i, j, spring } => {
                let (a, b) = (self.place[*i as usize]?, self.place[*j as usize]?);
                if self.heavy(a) && self.heavy(b) {
                    return None;
                }
                (*i, *j) = (a, b);
                if a > b {
                    (*i, *j) = (b, a);
                    *spring = spring.map(|s| -s);
                    contact.memory = self.new.law.seen_by_partner(contact.memory);
                }
            }
            ContactHistory::Obstacle { i, obstacle, .. } => {
                *i = self.place[*i as usize]?;
                let number = self.number.iter().position(|was| *was == Some(*obstacle))?;
                let body = &self.new.obstacles[number];
                if self.heavy(*i) && body.inverse_mass == 0.0 {
                    return None;
                }
                *obstacle = number as u32;
            }
        }
        Some(contact)
    }
}
