//! A simulation that owns its storage.

pub use crate::grain::{Grain, Role, hex, sphere_mass};
pub use crate::law::AnyLaw;

use std::ops::{Deref, DerefMut};

use bitgrain_kernel::contact::Materials;
use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{
    Clock, ContactForce, Digest, Domain, Error as KernelError, Group, Obstacle, Partner, World,
    check_arithmetic,
};

use crate::crowd::deep_pair;
use crate::histories::Histories;
use crate::law_work::Watched;
use crate::lists::List;
use crate::notes::{Note, ObstacleNote, Taken, Watch};
use crate::owned_world::OwnedWorld;
use crate::parts::Parts;
use crate::stepping::Stepping;
use crate::threads::threads;

/// Entries of notes that are kept before they are read: some 100 MB.
const NOTED_MAX: usize = 1 << 20;

/// A world and everything it borrows, owned.
#[derive(Debug)]
pub struct Simulation {
    /// The contact law.
    pub law: AnyLaw,
    /// How it steps: speed only, never a bit.
    pub stepping: Stepping,
    pub(crate) owned: OwnedWorld<f64>,
    pub(crate) parts: Parts,
}

impl Simulation {
    /// A simulation of these grains, not yet started. Skin and reach are those of [`Simulation::choose_skin`].
    pub fn new(
        law: AnyLaw,
        domain: Domain<f64>,
        dt: f64,
        groups: Vec<Group<f64>>,
        grains: &[Grain],
        obstacles: Vec<Obstacle<f64>>,
    ) -> Self {
        let row = |v: [f64; 3], w: f64| [v[0], v[1], v[2], w];
        let n = grains.len();
        let mass = |g: &Grain| sphere_mass(g.diameter, g.density);
        let position = |g: &Grain| row(g.position, 0.5 * g.diameter);
        let velocity = |g: &Grain| row(g.velocity, mass(g));
        let owned = OwnedWorld {
            id: grains.iter().map(|g| g.id).collect(),
            group: grains.iter().map(|g| g.group).collect(),
            groups,
            position: grains.iter().map(position).collect(),
            velocity: grains.iter().map(velocity).collect(),
            spin: grains.iter().map(|g| row(g.spin, 0.0)).collect(),
            force: vec![[0.0; 4]; n],
            torque: vec![[0.0; 4]; n],
            image: vec![[0; 3]; n],
            obstacles,
            ..OwnedWorld::new(domain, dt)
        };
        let mut sim = Self {
            law,
            owned,
            stepping: Stepping::default(),
            parts: Parts::default(),
        };
        sim.fit_storage();
        sim.choose_skin();
        sim
    }

    /// Sets the skin to 0.006 mean diameters, and the reach beyond it to a tenth.
    pub fn choose_skin(&mut self) {
        let radii = self.position.iter().map(|x| x[3]).sum::<f64>();
        let diameter = 2.0 * radii / self.count().max(1) as f64;
        self.skin = 0.006 * diameter;
        self.outer_skin = 0.1 * diameter;
    }

    /// Fits the lists and cells to the number of grains, after grains were added or read.
    pub fn fit_storage(&mut self) {
        let n = self.count();
        self.fit_search();
        // What is too short grows later, or says that it cannot.
        let _ = self.reserve(3 * n + 64, 4 * n + 64, n / 8 + 64);
        self.fit_words();
    }

    /// Makes room for what the law keeps of each contact: a host may have put another law in its place.
    fn fit_words(&mut self) {
        let words = self.law.words();
        // If there is no memory for them the kernel says so.
        let _ = self.keep_words(words);
    }

    /// How many grains there are.
    pub fn count(&self) -> usize {
        self.id.len()
    }

    /// What a grain does, by its place.
    pub fn role(&self, i: usize) -> Role {
        match self.groups[self.group[i] as usize].integrates {
            [_, _, false] => Role::Base,
            [false, _, true] => Role::Lid,
            [true, _, true] => Role::Free,
        }
    }

    /// Steps done.
    pub fn step_count(&self) -> u64 {
        self.clock.step
    }

    /// Sets the number of steps done, as when a saved state is resumed.
    pub fn set_step_count(&mut self, step: u64) {
        self.clock.step = step;
    }

    /// Searches done, pairs listed and obstacle contacts listed: for timings, never for results. On several threads
    /// pairs of two parts count twice.
    pub fn list_counts(&self) -> (u64, usize, usize) {
        let here = (self.clock.listed(), self.clock.obstacle_contacts());
        let (pairs, contacts) = self.parts.listed().unwrap_or(here);
        (self.clock.outer_list_rebuilds(), pairs, contacts)
    }

    /// Times that pairs were picked from the candidates of a search.
    pub fn prunes(&self) -> u64 {
        self.clock.prunes()
    }

    /// Bytes that the simulation holds.
    pub fn bytes(&self) -> usize {
        self.owned.bytes() + self.parts.bytes()
    }

    /// Lends everything as a world of the kernel.
    ///
    /// # Panics
    /// Without memory for the contacts of all grains.
    pub fn world(&mut self) -> World<'_, f64> {
        let home = self.parts.come_home(&mut self.owned);
        home.expect("memory for the contacts");
        self.owned.world()
    }

    /// How many grains touch an obstacle.
    pub fn touch_count(&self, obstacle: u32) -> u32 {
        self.touching(obstacle).len() as u32
    }

    /// Lends lists of this many entries, and cells, until they prove too short: speed and memory only,
    /// never a bit. Contacts are forgotten: [`Simulation::resume`] or start again.
    pub fn lend(&mut self, entries: usize) {
        let words = self.law.words();
        for list in &mut self.lists {
            *list = List::default();
            let made = list.keep_words(words).and(list.reserve(entries, entries));
            made.expect("a caller asks for what there is");
        }
        self.candidate.resize(entries, 0);
        self.cell_start.resize(entries.max(2), 0);
        let step = self.clock.step;
        self.clock = Clock::default();
        self.clock.step = step;
        self.stepping = self.stepping.clone();
        self.parts = Parts::default();
    }

    /// Runs `act`, enlarging the lists, or with less in them, as often as it finds them full: neither affects a result.
    /// Lists that would even so be longer than bodies beside each other can make them, or than there is memory for,
    /// stay full, and that is returned.
    pub(crate) fn grow_while_full(
        &mut self,
        mut act: impl FnMut(&mut Self) -> Result<(), KernelError>,
    ) -> Result<(), KernelError> {
        loop {
            match act(self) {
                Err(full) if self.fit_lists(full) => (),
                done => return done,
            }
        }
    }

    /// Refuses crowds of overlapping grains, before all their pairs are listed.
    ///
    /// # Errors
    /// [`KernelError::OverlapTooDeep`] with two of them.
    pub(crate) fn check_crowds(&self) -> Result<(), KernelError> {
        let light = |i: usize| {
            let group = self.groups.get(usize::from(self.group[i]));
            group.is_some_and(|group| !group.infinite_mass)
        };
        match deep_pair(&self.position, light) {
            Some((i, j)) => Err(KernelError::OverlapTooDeep {
                i: self.id[i],
                j: self.id[j],
            }),
            None => Ok(()),
        }
    }

    /// Starts from an empty history; see [`bitgrain_kernel::start`].
    ///
    /// # Errors
    /// What the kernel finds wrong with the world.
    pub fn start(&mut self) -> Result<(), KernelError> {
        self.start_watched(|_| {})
    }

    /// [`Simulation::start`], showing every touching contact to `watch`.
    ///
    /// # Errors
    /// As [`Simulation::start`].
    pub fn start_watched(
        &mut self,
        mut watch: impl FnMut(ContactForce<f64>),
    ) -> Result<(), KernelError> {
        self.check_crowds()?;
        self.fit_words();
        self.shown(true, &mut watch)
    }

    /// Materials of a grain, by its place, and of its partner in a contact.
    pub(crate) fn materials_of(&self, i: usize, partner: Partner) -> Materials {
        let of_grain = |place: usize| self.groups[usize::from(self.group[place])].material;
        let other = match partner {
            Partner::Grain(j) => of_grain(j as usize),
            Partner::Obstacle(k) => self.obstacles[k as usize].material,
        };
        [of_grain(i), other]
    }

    /// A start or a step, with more room as often as a list proves full.
    fn shown(
        &mut self,
        starts: bool,
        watch: &mut dyn FnMut(ContactForce<f64>),
    ) -> Result<(), KernelError> {
        self.grow_while_full(|sim| {
            let law = sim.law.clone();
            law.with(Watched {
                world: sim.world(),
                watch: &mut *watch,
                starts,
            })
        })
    }

    /// Advances by one step, showing every touching contact to `watch`.
    ///
    /// # Errors
    /// As [`Simulation::steps`].
    pub fn step_watched(
        &mut self,
        mut watch: impl FnMut(ContactForce<f64>),
    ) -> Result<(), KernelError> {
        self.shown(false, &mut watch)
    }

    /// [`Simulation::step_watched`], adding every touching contact to `seen`: compiled here, as all that takes long.
    ///
    /// # Errors
    /// As [`Simulation::steps`].
    pub fn step_seen(&mut self, seen: &mut Vec<ContactForce<f64>>) -> Result<(), KernelError> {
        self.shown(false, &mut |contact| seen.push(contact))
    }

    /// Goes on from saved rows and histories; see [`bitgrain_kernel::resume`].
    ///
    /// # Errors
    /// What the kernel finds wrong with the world.
    pub fn resume(&mut self, histories: &Histories) -> Result<(), KernelError> {
        self.check_crowds()?;
        self.fit_words();
        self.grow_while_full(|sim| bitgrain_kernel::resume(&mut sim.world(), histories.iter()))
    }

    /// Advances by `count` steps, on the threads of the rayon pool that this is called in.
    ///
    /// # Errors
    /// What stopped a step; [`Simulation::step_count`] says how many were finished. The simulation has no state then
    /// ([`Clock::has_state`]): rows, obstacles and contacts are of no one step, and no two ways of stepping leave the
    /// same. [`KernelError::Edited`], if rows were written to since the last step: [`Simulation::resume`] or start
    /// again. A list for which there is no memory stops a step too: on one thread it goes on once there is memory.
    pub fn steps(&mut self, count: u64) -> Result<(), KernelError> {
        // A file may say that any number of steps was done.
        self.go_to(self.clock.step.saturating_add(count), None)
    }

    fn go_to(&mut self, step: u64, notes: Option<&mut Taken>) -> Result<(), KernelError> {
        let world = (&mut self.owned, &mut self.parts);
        self.stepping
            .steps(world, &self.law, (threads(), step), notes)
    }

    /// [`Simulation::steps`] with a note of every step that was finished, also if one fails: faster than to look at the
    /// rows after each.
    ///
    /// # Errors
    /// As [`Simulation::steps`].
    ///
    /// # Panics
    /// If `watch` has an obstacle or a grain that there is not.
    pub fn steps_noted(
        &mut self,
        count: u64,
        watch: &Watch,
        mut read: impl FnMut(&Note),
    ) -> Result<(), KernelError> {
        let end = self.clock.step.saturating_add(count);
        while self.clock.step < end {
            let (_, _, contacts) = self.list_counts();
            let a_step = contacts + watch.grains.len() + watch.obstacles.len() + 1;
            let fit = (NOTED_MAX / a_step).max(1) as u64;
            let mut taken = Taken::new(watch);
            let done = self.go_to(
                end.min(self.clock.step.saturating_add(fit)),
                Some(&mut taken),
            );
            taken.notes.iter().for_each(&mut read);
            done?;
        }
        Ok(())
    }

    /// The note of the last step, which was done by itself.
    ///
    /// # Panics
    /// As [`Simulation::steps_noted`].
    pub fn note(&self, watch: &Watch) -> Note {
        let place = |i: u32| (i, head(self.position[i as usize]));
        let obstacle = |k: &u32| ObstacleNote {
            body: self.obstacles[*k as usize],
            touching: self.touching(*k).into_iter().map(place).collect(),
        };
        let force = |i: &u32| head(self.force[*i as usize]);
        Note {
            step: self.step_count(),
            obstacles: watch.obstacles.iter().map(obstacle).collect(),
            forces: watch.grains.iter().map(force).collect(),
        }
    }

    /// Begins a stretch of steps for an observer of each step that writes to no row until [`Simulation::release`]:
    /// the rows are sealed once, and not at each call. A write to them in between is not found.
    ///
    /// # Errors
    /// [`KernelError::Edited`], of rows that were written to since the last stretch ended.
    pub fn hold(&mut self) -> Result<(), KernelError> {
        self.stepping
            .hold(&mut self.owned, &mut self.parts, threads())
    }

    /// Ends the stretch that [`Simulation::hold`] began.
    ///
    /// # Errors
    /// [`KernelError::Arithmetic`]; [`KernelError::NotStarted`] if a fault stopped the steps.
    pub fn release(&mut self) -> Result<(), KernelError> {
        self.stepping.end(&mut self.owned, &mut self.parts)
    }

    /// The digest of the state, on a thread whose arithmetic is that of the bit contract.
    ///
    /// # Errors
    /// [`KernelError::Arithmetic`], if something changed the processor's modes since the last step: what was
    /// measured of the state since then may be wrong. [`KernelError::NotStarted`] after a fault that stopped a step.
    pub fn digest(&mut self) -> Result<Digest, KernelError> {
        check_arithmetic::<f64>()?;
        bitgrain_kernel::digest(&self.world())
    }

    /// The touching contacts with what the law keeps of them, by places.
    pub fn contact_histories(&mut self) -> Histories {
        self.world().kept_contacts().collect()
    }

    /// Kinetic energy of all grains, translation and rotation, summed by id.
    pub fn kinetic_energy(&self) -> f64 {
        let mut energy = 0.0;
        for i in 0..self.count() {
            energy += self.kinetic_energy_of(i);
        }
        energy
    }

    /// Kinetic energy of one grain, by its place.
    pub fn kinetic_energy_of(&self, i: usize) -> f64 {
        let (v, w, r) = (self.velocity[i], self.spin[i], self.position[i][3]);
        let v2 = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
        let w2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
        0.5 * v[3] * (v2 + 0.4 * r * r * w2)
    }
}

/// A copy has all contacts with it, wherever they are.
impl Clone for Simulation {
    fn clone(&self) -> Self {
        let mut owned = self.owned.clone();
        let shown = self.parts.show(&mut owned);
        shown.expect("memory for the contacts");
        Self {
            law: self.law.clone(),
            stepping: self.stepping.clone(),
            owned,
            parts: Parts::default(),
        }
    }
}

/// The rows, obstacles and clock as they are. The lists of contacts are old after steps on several threads, until
/// [`Simulation::world`] brings them.
impl Deref for Simulation {
    type Target = OwnedWorld<f64>;

    fn deref(&self) -> &OwnedWorld<f64> {
        &self.owned
    }
}

impl DerefMut for Simulation {
    fn deref_mut(&mut self) -> &mut OwnedWorld<f64> {
        &mut self.owned
    }
}
