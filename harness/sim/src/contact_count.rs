//! Contacts of grains counted, and their deepest overlap, without their springs: what a row of measurements needs.

use bitgrain_kernel::parts::listed_pairs;
use bitgrain_kernel::vec3::{dot, head};
use bitgrain_kernel::{Domain, Row, TOUCHING, World, obstacle_of};

use crate::simulation::Simulation;

/// What is counted.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactCount {
    /// Contacts of each grain with grains and with surfaces of obstacles, by place.
    pub contacts: Vec<u32>,
    /// Deepest overlap of two grains (length); 0 if none touch.
    pub deepest: f64,
}

/// Where the grains of the whole world are.
#[derive(Clone, Copy)]
pub(crate) struct Places<'a> {
    pub domain: &'a Domain<f64>,
    pub position: &'a [Row<f64>],
}

/// Counts the pairs of each grain of a world, whose grains have these places in the whole one. A pair without overlap
/// counts if the law has kept something of it.
pub(crate) fn count_pairs(
    world: &World<'_, f64>,
    home: impl Fn(u32) -> u32,
    whole: Places<'_>,
) -> ContactCount {
    let mut count = ContactCount {
        contacts: vec![0; world.grains.position.len()],
        deepest: 0.0,
    };
    for (i, j, kept) in listed_pairs(world) {
        let [x, y] = [i, j].map(|k| whole.position[home(k) as usize]);
        let d = whole.domain.separation(head(x), head(y));
        let overlap = (x[3] + y[3]) - dot(d, d).sqrt();
        if overlap > 0.0 || kept.is_any() {
            count.contacts[i as usize] += 1;
            count.contacts[j as usize] += 1;
        }
        if overlap > count.deepest {
            count.deepest = overlap;
        }
    }
    count
}

impl Simulation {
    /// Contacts of all grains, with one another and with surfaces of obstacles, counted where they are.
    pub fn count_contacts(&mut self) -> ContactCount {
        if let Some(count) = self.parts.count_contacts(&self.owned) {
            return count;
        }
        // Another process has some of them, or all are here.
        drop(self.world());
        let position = self.owned.position.clone();
        let domain = self.owned.domain;
        let whole = Places {
            domain: &domain,
            position: &position,
        };
        let mut count = count_pairs(&self.owned.world(), |k| k, whole);
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
