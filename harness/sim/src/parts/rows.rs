//! Rows of the grains of a part, own ones and ghosts, as they are put together.

use bitgrain_kernel::Row;
use serde::{Deserialize, Serialize};

use crate::owned_world::OwnedWorld;

/// Rows that are put together by ascending id, and which of them are own.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Rows {
    id: Vec<u32>,
    group: Vec<u8>,
    position: Vec<Row<f64>>,
    velocity: Vec<Row<f64>>,
    spin: Vec<Row<f64>>,
    force: Vec<Row<f64>>,
    torque: Vec<Row<f64>>,
    image: Vec<[i32; 3]>,
    owned: Vec<u32>,
}

impl Rows {
    pub fn clear(&mut self) {
        self.id.clear();
        self.group.clear();
        self.position.clear();
        self.velocity.clear();
        self.spin.clear();
        self.force.clear();
        self.torque.clear();
        self.image.clear();
        self.owned.clear();
    }

    /// Adds a copy of a grain of another part. Nothing reads what is summed on it.
    pub fn add_ghost(&mut self, id: u32, group: u8, [position, velocity, spin]: [Row<f64>; 3]) {
        self.note(false);
        self.id.push(id);
        self.group.push(group);
        self.position.push(position);
        self.velocity.push(velocity);
        self.spin.push(spin);
        self.force.push([0.0; 4]);
        self.torque.push([0.0; 4]);
        self.image.push([0; 3]);
    }

    /// Adds a grain of a world as an own one.
    pub fn add_own(&mut self, from: &OwnedWorld<f64>, place: usize) {
        self.note(true);
        self.id.push(from.id[place]);
        self.group.push(from.group[place]);
        self.position.push(from.position[place]);
        self.velocity.push(from.velocity[place]);
        self.spin.push(from.spin[place]);
        self.force.push(from.force[place]);
        self.torque.push(from.torque[place]);
        self.image.push(from.image[place]);
    }

    /// Begins or ends a run of own grains before the next one, if need be.
    fn note(&mut self, is_own: bool) {
        let runs_on = self.owned.len() % 2 == 1;
        if is_own != runs_on {
            self.owned.push(self.id.len() as u32);
        }
    }

    /// Ends the last run.
    pub fn end(&mut self) {
        self.note(false);
    }

    /// Changes places with the rows of a world, and makes its search fit them.
    pub fn swap_with(&mut self, world: &mut OwnedWorld<f64>) {
        std::mem::swap(&mut self.id, &mut world.id);
        std::mem::swap(&mut self.group, &mut world.group);
        std::mem::swap(&mut self.position, &mut world.position);
        std::mem::swap(&mut self.velocity, &mut world.velocity);
        std::mem::swap(&mut self.spin, &mut world.spin);
        std::mem::swap(&mut self.force, &mut world.force);
        std::mem::swap(&mut self.torque, &mut world.torque);
        std::mem::swap(&mut self.image, &mut world.image);
        std::mem::swap(&mut self.owned, &mut world.owned);
        world.fit_search();
    }
}
