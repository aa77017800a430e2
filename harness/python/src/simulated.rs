//! A simulation with what a Python world adds to it: mean forces, groups by kind, a number that says whether a view is
//! of the present state. Nothing here knows Python.

use bitgrain::mesh::{Triangle, add_mesh};
use bitgrain::notes::Watch;
use bitgrain::simulation::{Grain, Simulation};
use bitgrain_kernel::{Departure, Error as KernelError, OBSTACLES_MAX, Obstacle};

use crate::changes::{Change, Push, add_rows, apply, pushed_step, try_a_step};
use crate::kinds::{KINDS, Kind};
use crate::threads::Pool;
use crate::watch::StepWatch;

/// Steps that a driven obstacle still goes, and sums of the force and torque on it over the steps of a call.
#[derive(Clone, Copy, Debug, Default)]
pub struct Driven {
    /// Steps until it rests; 0 if it is not driven.
    pub left: u64,
    /// Whether it turns until then.
    pub turns: bool,
    /// Sum of the force, then of the torque.
    pub sum: [[f64; 3]; 2],
}

/// The state behind a Python world.
pub struct Core {
    /// The simulation.
    pub sim: Simulation,
    /// Acceleration of free grains.
    pub gravity: [f64; 3],
    /// Rises with every change of the state.
    pub generation: u64,
    /// Whether forces were evaluated and contacts have histories.
    pub started: bool,
    /// One entry an obstacle.
    pub driven: Vec<Driven>,
    /// Threads to step on.
    pub threads: usize,
    /// The next id that no grain has had.
    pub next_id: u32,
    /// Names of the materials; none if there is one only.
    pub materials: Vec<String>,
    /// The grains that left in the steps of the last call.
    pub lost: Vec<Departure<f64>>,
    /// Steps that the means are over.
    counted: u64,
    /// What is said of a time step that is too long.
    pub watch: StepWatch,
    /// Those that were started.
    pub pool: Option<Pool>,
}

impl Core {
    /// A world of this simulation without grains or obstacles, with one group of each kind.
    pub fn new(
        mut sim: Simulation,
        gravity: [f64; 3],
        threads: usize,
        materials: Vec<String>,
    ) -> Self {
        let kinds = KINDS.iter().map(|(kind, _)| kind.group(gravity, 0));
        sim.groups = kinds.collect();
        Self {
            materials,
            ..Self::of(sim, gravity, threads)
        }
    }

    /// A world of a simulation that was saved. Its materials have their numbers for names.
    pub fn loaded(sim: Simulation, threads: usize) -> Self {
        let free = sim
            .groups
            .iter()
            .find(|group| group.integrates == [true; 3]);
        let gravity = free.map_or([0.0; 3], |group| group.gravity);
        let several = 0..sim.law.materials();
        Self {
            started: true,
            materials: match several.len() {
                1 => Vec::new(),
                _ => several.map(|number| number.to_string()).collect(),
            },
            ..Self::of(sim, gravity, threads)
        }
    }

    fn of(sim: Simulation, gravity: [f64; 3], threads: usize) -> Self {
        Self {
            generation: 0,
            gravity,
            started: false,
            driven: vec![Driven::default(); sim.obstacles.len()],
            threads,
            next_id: sim.id.last().map_or(1, |id| id.saturating_add(1)),
            sim,
            materials: Vec::new(),
            lost: Vec::new(),
            counted: 0,
            watch: StepWatch::default(),
            pool: None,
        }
    }

    /// The number of the first group of a kind and a material under the gravity of this world.
    pub fn group_of(&self, kind: Kind, material: u8) -> Option<u8> {
        let wanted = kind.group(self.gravity, material);
        let found = self.sim.groups.iter().position(|group| *group == wanted);
        found.and_then(|number| u8::try_from(number).ok())
    }

    /// Adds grains, behind those that there are.
    ///
    /// # Errors
    /// Of a world that has started, what the kernel finds wrong with it; it is as it was.
    pub fn put(&mut self, grains: &[Grain]) -> Result<(), KernelError> {
        if self.started {
            let change = Change::Insert(grains.to_vec());
            self.edit(|sim| apply(sim, &change))?;
        } else {
            add_rows(&mut self.sim, grains);
            self.generation += 1;
        }
        self.use_ids(grains);
        Ok(())
    }

    /// Takes the ids of these grains as used.
    pub fn use_ids(&mut self, grains: &[Grain]) {
        if let Some(last) = grains.last() {
            self.next_id = last.id + 1;
        }
    }

    /// Starts the world, if it has not started: an empty history, forces of the state as it is.
    ///
    /// # Errors
    /// What the kernel finds wrong with the world.
    pub fn start(&mut self) -> Result<(), KernelError> {
        if !self.started {
            self.generation += 1;
            self.sim.fit_storage();
            self.sim.choose_skin();
            self.sim.start()?;
            self.started = true;
        }
        Ok(())
    }

    /// The state.
    ///
    /// # Errors
    /// [`KernelError::NotStarted`] after a fault that stopped a step: there is none.
    pub fn state(&self) -> Result<&Simulation, KernelError> {
        match self.sim.clock.has_state() {
            true => Ok(&self.sim),
            false => Err(KernelError::NotStarted),
        }
    }

    /// Changes a copy of the simulation, which takes its place if all of the change succeeds.
    ///
    /// # Errors
    /// What `act` returns; the world is as it was.
    pub fn edit(
        &mut self,
        act: impl FnOnce(&mut Simulation) -> Result<(), KernelError>,
    ) -> Result<(), KernelError> {
        let mut sim = self.state()?.clone();
        act(&mut sim)?;
        self.sim = sim;
        self.generation += 1;
        self.watch.looked = None;
        Ok(())
    }

    /// Changes something other than grains; contacts that still touch keep their histories.
    ///
    /// # Errors
    /// What the kernel finds wrong with the changed world; the world is as it was.
    pub fn rearrange(&mut self, act: impl FnOnce(&mut Simulation)) -> Result<(), KernelError> {
        let started = self.started;
        self.edit(|sim| {
            if started {
                sim.rearrange(act)?;
                return try_a_step(sim);
            }
            act(sim);
            Ok(())
        })
    }

    /// The number of an obstacle that is to be added.
    fn next_obstacle(&self) -> Result<usize, KernelError> {
        let (number, most) = (self.driven.len(), OBSTACLES_MAX);
        match number < most {
            true => Ok(number),
            false => Err(KernelError::TooManyObstacles {
                count: number as u32 + 1,
                most: most as u32,
            }),
        }
    }

    /// Adds an obstacle and returns its number.
    ///
    /// # Errors
    /// [`KernelError::BadObstacle`] if it does not fit the box; [`KernelError::TooManyObstacles`].
    pub fn add_obstacle(&mut self, mut body: Obstacle<f64>) -> Result<usize, KernelError> {
        let number = self.next_obstacle()?;
        self.sim.domain.wrap(&mut body.point, &mut [0; 3]);
        body.check(&self.sim.domain, number as u32)?;
        self.rearrange(|sim| sim.obstacles.push(body))?;
        self.driven.push(Driven::default());
        Ok(number)
    }

    /// Adds a mesh and returns its number.
    ///
    /// # Errors
    /// [`KernelError::BadObstacle`] if it does not fit the box.
    pub fn add_mesh(
        &mut self,
        (point, orientation): ([f64; 3], [f64; 4]),
        velocity: [f64; 3],
        material: u8,
        triangles: &[Triangle],
    ) -> Result<usize, KernelError> {
        let number = self.next_obstacle()?;
        self.rearrange(|sim| {
            let mut body = add_mesh(sim, point, triangles);
            (body.velocity, body.material) = (velocity, material);
            body.orientation = orientation;
            let domain = sim.domain;
            domain.wrap(&mut body.point, &mut [0; 3]);
            sim.obstacles.push(body);
        })?;
        self.driven.push(Driven::default());
        Ok(number)
    }

    /// Changes an obstacle at once; contacts that still touch keep their histories.
    ///
    /// # Errors
    /// [`KernelError::BadObstacle`] if it does not fit the box then.
    pub fn change_obstacle(
        &mut self,
        number: usize,
        change: impl FnOnce(&mut Obstacle<f64>),
    ) -> Result<(), KernelError> {
        let mut body = self.sim.obstacles[number];
        change(&mut body);
        self.sim.domain.wrap(&mut body.point, &mut [0; 3]);
        body.check(&self.sim.domain, number as u32)?;
        self.rearrange(|sim| {
            let image = sim.obstacles[number].image;
            sim.obstacles[number] = Obstacle { image, ..body };
        })
    }

    /// Moves an obstacle to a place at once.
    ///
    /// # Errors
    /// [`KernelError::BadObstacle`] if it does not fit the box there.
    pub fn place_obstacle(&mut self, number: usize, point: [f64; 3]) -> Result<(), KernelError> {
        self.change_obstacle(number, |body| body.point = point)?;
        self.stop_drive(number);
        Ok(())
    }

    /// Begins a call that steps: means are over the steps from here on, and so are losses.
    pub fn begin_call(&mut self) {
        self.lost.clear();
        self.counted = 0;
        self.driven
            .iter_mut()
            .for_each(|one| one.sum = [[0.0; 3]; 2]);
    }

    /// Mean force and torque on an obstacle over the steps since [`Core::begin_call`]; NaN if there are none.
    pub fn means(&self, number: usize) -> [[f64; 3]; 2] {
        let count = self.counted as f64;
        self.driven[number].sum.map(|sum| sum.map(|x| x / count))
    }

    /// Advances by `count` steps, on the threads of this world, and ends drives when they are due.
    ///
    /// # Errors
    /// What stopped a step.
    pub fn steps(&mut self, count: u64, push: &mut Option<Push>) -> Result<(), KernelError> {
        self.generation += 1;
        match self.pool.take() {
            None => self.steps_here(count, push),
            Some(pool) => {
                let done = pool.threads.install(|| self.steps_here(count, push));
                self.pool = Some(pool);
                done
            }
        }
    }

    /// [`Core::steps`] on the threads that it is called on.
    fn steps_here(&mut self, count: u64, push: &mut Option<Push>) -> Result<(), KernelError> {
        let mut left = count;
        self.take_out(push)?;
        while left > 0 {
            let drives = self.driven.iter().map(|one| one.left);
            let stretch = drives.filter(|left| *left > 0).fold(left, u64::min);
            let before = self.sim.step_count();
            let went = self.stretch(stretch, push.as_ref());
            let done = self.sim.step_count() - before;
            self.count_drives(done);
            went?;
            left -= done;
            self.take_out(push)?;
        }
        Ok(())
    }

    /// Takes out the grains that were lost in the last step, with what pushes them.
    fn take_out(&mut self, push: &mut Option<Push>) -> Result<(), KernelError> {
        if !self.sim.clock.is_losing() {
            return Ok(());
        }
        let first = self.lost.len();
        self.sim.take_out(|departure| self.lost.push(departure))?;
        let mut places: Vec<usize> = self.lost[first..]
            .iter()
            .map(|one| one.grain.place)
            .collect();
        places.sort_unstable();
        if let Some(Push { force, torque }) = push {
            for place in places.into_iter().rev() {
                force.remove(place);
                torque.remove(place);
            }
        }
        Ok(())
    }

    /// Steps in which no drive ends, up to one in which grains are lost; after each the forces on obstacles are added
    /// up.
    fn stretch(&mut self, count: u64, push: Option<&Push>) -> Result<(), KernelError> {
        let done = match push {
            None if self.driven.is_empty() => self.sim.steps(count),
            None => {
                let watch = Watch {
                    obstacles: (0..self.driven.len() as u32).collect(),
                    grains: Vec::new(),
                };
                let (driven, counted) = (&mut self.driven, &mut self.counted);
                self.sim.steps_noted(count, &watch, |note| {
                    *counted += 1;
                    add_up(driven, note.obstacles.iter().map(|noted| &noted.body));
                })
            }
            Some(push) => self.pushed(count, push),
        };
        match done {
            Err(KernelError::GrainsLeaving) => Ok(()),
            done => done,
        }
    }

    /// The same with forces of the host.
    fn pushed(&mut self, count: u64, push: &Push) -> Result<(), KernelError> {
        // Nothing is written to between the steps, so that the rows are sealed once.
        self.sim.hold()?;
        for _ in 0..count {
            if let Err(fault) = pushed_step(&mut self.sim, push) {
                // The fault says more than that the stretch cannot be ended well.
                let _ = self.sim.release();
                return Err(fault);
            }
            self.counted += 1;
            add_up(&mut self.driven, self.sim.obstacles.iter());
            if self.sim.clock.is_losing() {
                break;
            }
        }
        self.sim.release()
    }
}

/// Adds what pushes each obstacle.
fn add_up<'a>(driven: &mut [Driven], bodies: impl Iterator<Item = &'a Obstacle<f64>>) {
    for (one, body) in driven.iter_mut().zip(bodies) {
        for a in 0..3 {
            one.sum[0][a] += body.force[a];
            one.sum[1][a] += body.torque[a];
        }
    }
}
