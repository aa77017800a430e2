//! What touches in a simulation, wherever its contacts are.

use bitgrain_kernel::{TOUCHING, obstacle_of};

use crate::contact_count::{ContactCount, Places, count_pairs};
use crate::simulation::Simulation;

impl Simulation {
    /// Contacts of all grains, with one another and with surfaces of obstacles, counted where they are.
    pub fn count_contacts(&mut self) -> ContactCount {
        if let Some(count) = self.parts.count_contacts(&self.owned) {
            return count;
        }
        // Another process has some of them, or all are here.
        let world = self.world();
        let whole = Places {
            domain: world.domain,
            position: &*world.grains.position,
        };
        let mut count = count_pairs(&world, |k| k, whole);
        for (grain, _) in self.listed_touches() {
            count.contacts[grain as usize] += 1;
        }
        count
    }

    /// Grains and the obstacles that they touch, by grain, once for each surface, as the lists here have them.
    fn listed_touches(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let list = &self.lists[0];
        let words = list.obstacle_contact_obstacle.iter();
        let listed = list.obstacle_contact_grain.iter().zip(words);
        let listed = listed.take(self.clock.obstacle_contacts());
        let touching = listed.filter(|(_, word)| **word & TOUCHING != 0);
        touching.map(|(grain, word)| (*grain, obstacle_of(*word)))
    }

    /// Places of the grains that touch an obstacle, ascending.
    pub fn touching(&self, obstacle: u32) -> Vec<u32> {
        let mut touching = self.parts.touching(obstacle).unwrap_or_else(|| {
            let touches = self.listed_touches();
            let of = touches.filter(|(_, of)| *of == obstacle);
            of.map(|(grain, _)| grain).collect()
        });
        // A grain may touch two surfaces of it.
        touching.dedup();
        touching
    }
}
