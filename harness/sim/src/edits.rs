//! Changes of a simulation between two steps that keep the histories of all other grains, and forces of a host.

use bitgrain_kernel::{
    ContactHistory, Departure, Error as KernelError, GrainState, NewGrain, insert, nudge,
    obstacle_of, regroup, remove, surface_of, take_out,
};

use crate::grain::{Grain, sphere_mass};
use crate::histories::Histories;
use crate::law_work::{Push, Pushed};
use crate::simulation::Simulation;

impl Simulation {
    /// Puts grains in, by ids that ascend; see [`bitgrain_kernel::insert`].
    ///
    /// # Errors
    /// What the kernel refuses; all is as it was.
    pub fn insert(&mut self, grains: &[Grain]) -> Result<(), KernelError> {
        let new: Vec<_> = grains.iter().map(new_grain).collect();
        let count = self.count();
        self.set_rows(count + grains.len());
        self.fit_storage();
        let inserted = self.grow_while_full(|sim| insert(&mut sim.world(), new.iter().copied()));
        if inserted.is_err() {
            self.set_rows(count);
        }
        self.fit_storage();
        inserted
    }

    /// Takes grains out, by ids that ascend; see [`bitgrain_kernel::remove`].
    ///
    /// # Errors
    /// What the kernel refuses; all is as it was.
    pub fn remove(&mut self, ids: &[u32]) -> Result<(), KernelError> {
        remove(&mut self.world(), ids)?;
        self.forget_rows();
        Ok(())
    }

    /// Puts grains into another group, by ids that ascend; see [`bitgrain_kernel::regroup`].
    ///
    /// # Errors
    /// What the kernel refuses; all is as it was.
    pub fn regroup(&mut self, ids: &[u32], group: u8) -> Result<(), KernelError> {
        self.grow_while_full(|sim| regroup(&mut sim.world(), ids, group))
    }

    /// Gives a grain another velocity and spin; see [`bitgrain_kernel::nudge`].
    ///
    /// # Errors
    /// [`KernelError::UnknownGrain`]; what the kernel refuses; all is as it was.
    pub fn nudge(
        &mut self,
        id: u32,
        velocity: [f64; 3],
        spin: [f64; 3],
    ) -> Result<(), KernelError> {
        let mut world = self.world();
        let place = world.place_of(id);
        let place = place.ok_or(KernelError::UnknownGrain { id })?;
        nudge(&mut world, place, velocity, spin)
    }

    /// Changes obstacles or groups, as the place of an obstacle, between two steps. Contacts keep their histories;
    /// those on obstacles end where bodies do not touch any more.
    ///
    /// # Errors
    /// What the kernel finds wrong with the changed world. It is changed then, and must be started or changed again.
    pub fn rearrange(&mut self, act: impl FnOnce(&mut Self)) -> Result<(), KernelError> {
        let histories = self.contact_histories();
        act(self);
        let still = histories.iter().filter(|one| self.touches(&one.history));
        let still: Histories = still.collect();
        self.resume(&still)
    }

    /// Whether the bodies of a contact touch where they are now; two grains do, which have not moved.
    fn touches(&self, contact: &ContactHistory<f64>) -> bool {
        let ContactHistory::Obstacle { i, obstacle, .. } = *contact else {
            return true;
        };
        let [x, y, z, radius] = self.position[i as usize];
        let (body, surface) = (obstacle_of(obstacle), surface_of(obstacle));
        let body = self.obstacles.get(body as usize);
        // A triangle of a mesh that is near enough may hand its history on to the one beside it.
        body.is_some_and(|body| {
            let met = body.meet(surface, &self.facets, &self.domain, [x, y, z], radius);
            met.overlap >= 0.0
        })
    }

    /// Takes out the grains that were lost in the last step, and shows each; see [`bitgrain_kernel::take_out`]. Call it
    /// when [`Simulation::steps`] ends with [`KernelError::GrainsLeaving`], and then step on.
    ///
    /// # Errors
    /// As the kernel.
    pub fn take_out(&mut self, departed: impl FnMut(Departure<f64>)) -> Result<(), KernelError> {
        if self.clock.rests() && !self.clock.is_losing() {
            return Ok(());
        }
        take_out(&mut self.world(), departed)?;
        self.forget_rows();
        Ok(())
    }

    /// [`Simulation::steps`] that also takes out the grains that the policy lets go, and shows each as it leaves.
    ///
    /// # Errors
    /// As [`Simulation::steps`].
    pub fn steps_losing(
        &mut self,
        count: u64,
        mut departed: impl FnMut(Departure<f64>),
    ) -> Result<(), KernelError> {
        let end = self.step_count().saturating_add(count);
        loop {
            self.take_out(&mut departed)?;
            let stepped = self.steps(end.saturating_sub(self.step_count()));
            if stepped != Err(KernelError::GrainsLeaving) {
                stepped?;
                return self.take_out(&mut departed);
            }
        }
    }

    /// Steps with a force and a torque on each grain besides those of its contacts, on one thread; see
    /// [`bitgrain_kernel::step_with`]. Grains that the policy lets go are shown as they leave.
    ///
    /// # Errors
    /// As [`Simulation::steps`].
    pub fn steps_with(
        &mut self,
        count: u64,
        mut external: impl FnMut(&GrainState<f64>) -> Push,
        mut departed: impl FnMut(Departure<f64>),
    ) -> Result<(), KernelError> {
        let end = self.step_count().saturating_add(count);
        self.take_out(&mut departed)?;
        while self.step_count() < end {
            self.step_with(&mut external)?;
            self.take_out(&mut departed)?;
        }
        Ok(())
    }

    /// One step of [`Simulation::steps_with`], which may be one of a stretch that [`Simulation::hold`] began: the rows
    /// are then sealed once for all of them. Grains that leave wait for [`Simulation::take_out`].
    ///
    /// # Errors
    /// As [`Simulation::steps`].
    pub fn step_with(
        &mut self,
        mut external: impl FnMut(&GrainState<f64>) -> Push,
    ) -> Result<(), KernelError> {
        self.grow_while_full(|sim| {
            let (law, registers) = (sim.law.clone(), sim.stepping.registers);
            law.with(Pushed {
                world: sim.world(),
                external: &mut external,
                registers,
            })
        })
    }

    /// Takes away the rows that the kernel's world no longer covers.
    fn forget_rows(&mut self) {
        let count = self.clock.count();
        if count != self.count() {
            self.set_rows(count);
            self.fit_storage();
        }
    }
}

/// A grain as the kernel takes it.
fn new_grain(grain: &Grain) -> NewGrain<f64> {
    NewGrain {
        id: grain.id,
        group: grain.group,
        position: grain.position,
        radius: 0.5 * grain.diameter,
        mass: sphere_mass(grain.diameter, grain.density),
        velocity: grain.velocity,
        spin: grain.spin,
    }
}
