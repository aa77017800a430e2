//! Steps with the machine's widest instructions, here or in parts on several threads. The phases are the kernel's, so
//! nothing here can change a result.

use std::sync::Arc;
use std::time::Instant;

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::phases::{
    After, MotionCheck, ObstacleShare, Sealed, begin, check_forces, drift, end, finish, seal,
};
use bitgrain_kernel::{Error as KernelError, LossPolicy, World};

use crate::isa::{Isa, Kernel};
use crate::law::{AnyLaw, Sprung, WithLaw};
use crate::notes::{Notebook, Taken, join};
use crate::owned_world::OwnedWorld;
use crate::parts::{Cutting, Parts, Ranks, Settings};
use crate::pass::{Drift, Fallible, Forces, Renew};
use crate::skin::Skin;
use crate::threads::{RowsFrom, each, processors};

/// Fewest grains of a part: what it shares with others costs more than it saves if there are fewer.
const PART_MIN: usize = 500;

/// How a simulation steps: speed only, never a bit.
#[derive(Debug)]
pub struct Stepping {
    /// Instructions.
    pub registers: Isa,
    /// Fewest grains of a thread's part.
    pub part_min: usize,
    /// Most parts of a process: more than there are processors for it cost more than they bring.
    pub part_max: usize,
    /// Whether skin and reach, and cuts into parts, are adjusted to what they cost while it steps.
    pub tunes: bool,
    /// How grains are given to parts.
    pub cutting: Cutting,
    /// Processes that share the world: those that this one has joined.
    pub ranks: Option<Arc<Ranks>>,
    skin: Skin,
    /// Whether the owner began the present stretch, and will end it.
    held: bool,
    /// Parts of the last steps, or one.
    count: usize,
}

/// A copy has the settings, and what is known of the costs: a world that is copied at each edit is tuned as any other.
impl Clone for Stepping {
    fn clone(&self) -> Self {
        Self {
            registers: self.registers,
            part_min: self.part_min,
            part_max: self.part_max,
            tunes: self.tunes,
            cutting: self.cutting,
            ranks: self.ranks.clone(),
            skin: self.skin,
            ..Self::default()
        }
    }
}

impl Default for Stepping {
    fn default() -> Self {
        let ranks = Ranks::joined();
        let part_min = ranks.as_ref().and_then(|ranks| ranks.sharing().part_min);
        let part_max = part_min.map_or_else(processors, |_| usize::MAX);
        Self {
            registers: Isa::best(),
            part_min: part_min.unwrap_or(PART_MIN),
            part_max,
            tunes: true,
            cutting: Cutting::default(),
            ranks,
            skin: Skin::default(),
            held: false,
            count: 1,
        }
    }
}

impl Stepping {
    /// As many parts as threads, however few grains there are or processors: for tests of parts.
    pub fn divide_always(&mut self) {
        (self.part_min, self.part_max) = (1, usize::MAX);
    }

    /// Parts of the last steps: how many threads could take part in them.
    pub fn parts(&self) -> usize {
        self.count
    }

    /// Advances a world to step `last` on so many threads of the pool that this is called in, and takes notes of the
    /// steps if they are wanted.
    pub(crate) fn steps(
        &mut self,
        (home, parts): (&mut OwnedWorld<f64>, &mut Parts),
        law: &AnyLaw,
        (threads, last): (usize, u64),
        notes: Option<&mut Taken>,
    ) -> Fallible<()> {
        self.set_count(home, threads);
        if home.clock.step >= last {
            return Ok(());
        }
        if home.clock.is_losing() {
            return Err(KernelError::GrainsLeaving);
        }
        if home.clock.rests() {
            self.begin(home, parts)?;
            self.held = false;
        }
        let went = if self.count > 1 && home.clock.has_begun() {
            let settings = Settings {
                law: law.clone(),
                registers: self.registers,
                tunes: self.tunes,
                ranks: self.ranks.clone(),
                cutting: self.cutting,
            };
            parts.steps(home, &settings, (self.count, last), notes)
        } else {
            let came = parts.come_home(home);
            came.and_then(|()| self.whole(home, law, last, notes))
        };
        // What could not begin a step is the world that it was.
        if !self.held && home.clock.has_begun() {
            self.end(home, parts)?;
        }
        went?;
        match home.clock.step < last {
            true => Err(KernelError::GrainsLeaving),
            false => Ok(()),
        }
    }

    /// Steps of a whole world, with longer lists as often as one is full.
    fn whole(
        &mut self,
        home: &mut OwnedWorld<f64>,
        law: &AnyLaw,
        last: u64,
        notes: Option<&mut Taken>,
    ) -> Fallible<()> {
        let mut book = notes.as_ref().map(|taken| Notebook::new(taken.watch));
        if let Some(book) = &mut book {
            book.find(Some);
        }
        let done = loop {
            let mut world = home.world();
            let done = law.with(Here {
                world: &mut world,
                stepping: self,
                last,
                notes: book.as_mut(),
            });
            (home.skin, home.outer_skin) = (world.skin, world.outer_skin);
            match done {
                Err(full) if home.fit_lists(full) => (),
                done => break done,
            }
        };
        if let Some(taken) = notes {
            let all = join(taken.watch, book.into_iter(), home.clock.step);
            taken.notes.extend(all);
        }
        done
    }

    /// Sets how many parts there will be.
    fn set_count(&mut self, home: &OwnedWorld<f64>, threads: usize) {
        let ranks = self.ranks.as_ref().map_or(1, |ranks| ranks.count());
        let threads = threads.min(self.part_max).saturating_mul(ranks);
        let most = home.id.len() / self.part_min.max(1);
        self.count = threads.min(most).clamp(1, usize::from(u16::MAX));
    }

    /// Begins a stretch of steps that its owner will end, if nothing was written to since the last one.
    pub(crate) fn hold(
        &mut self,
        home: &mut OwnedWorld<f64>,
        parts: &mut Parts,
        threads: usize,
    ) -> Fallible<()> {
        self.set_count(home, threads);
        self.begin(home, parts)?;
        self.held = true;
        Ok(())
    }

    fn begin(&mut self, home: &mut OwnedWorld<f64>, parts: &mut Parts) -> Fallible<()> {
        let parts_fit = parts.fit(&home.clock);
        let sealed = self.sealed(home);
        begin(&mut home.world(), sealed)?;
        if parts_fit {
            parts.note(&home.clock);
        }
        Ok(())
    }

    /// Ends a stretch of steps.
    pub(crate) fn end(&mut self, home: &mut OwnedWorld<f64>, parts: &mut Parts) -> Fallible<()> {
        self.held = false;
        let parts_fit = parts.fit(&home.clock);
        let sealed = self.sealed(home);
        end(&mut home.world(), sealed)?;
        if parts_fit {
            parts.note(&home.clock);
        }
        Ok(())
    }

    /// The seal of all grains.
    fn sealed(&self, home: &mut OwnedWorld<f64>) -> Sealed {
        let work = |grains| self.registers.run(grains);
        let mut all = home.world();
        let rows = RowsFrom(all.grain_motion(), 0);
        each(rows, self.count, &work, &Sealed::and)
    }

    /// Steps of a whole world on this thread.
    ///
    /// Rows are fetched once a step: as soon as the force on a grain is complete, the pass that summed it ends the
    /// grain's step and begins the next one.
    fn steps_here<L: Law<f64>>(
        &mut self,
        world: &mut World<'_, f64>,
        law: &L,
        last: u64,
        mut notes: Option<&mut Notebook>,
    ) -> Fallible<()> {
        let mut shares = Vec::new();
        let registers = self.registers;
        // A full list may have interrupted these steps.
        if world.clock.has_begun() {
            let passed = registers.run(Drift(world));
            drift(world, passed)?;
        }
        while world.clock.step < last {
            self.refresh_pair_list(world)?;
            let is_last = world.clock.step + 1 == last;
            // Grains that leave do so at the end of a step, before the next one moves any.
            let pauses = is_last || world.policy != LossPolicy::STOP;
            if notes.is_some() {
                let contacts = world.clock.obstacle_contacts();
                shares.resize(contacts, ObstacleShare::default());
            }
            let (found, passed) = registers.run(Forces {
                world,
                law,
                shares: &mut shares,
                notes: notes.as_deref_mut(),
                after: if pauses {
                    After::Rest
                } else {
                    After::FinishAndBegin
                },
            });
            if let Some(notes) = &mut notes {
                notes.end(|place| place);
            }
            check_forces(world, found)?;
            self.skin.stepped(world);
            finish(world, passed)?;
            if world.clock.is_losing() {
                return Ok(());
            }
            if !is_last {
                let passed: MotionCheck<f64> = match pauses {
                    true => registers.run(Drift(world)),
                    false => passed,
                };
                drift(world, passed)?;
            }
        }
        Ok(())
    }

    /// Renews the pair list if it is too old, and measures what that costs.
    fn refresh_pair_list(&mut self, world: &mut World<'_, f64>) -> Fallible<()> {
        if !self.tunes {
            return self.registers.run(Renew(world));
        }
        let (searches, began) = (world.clock.outer_list_rebuilds(), Instant::now());
        self.registers.run(Renew(world))?;
        self.skin.listed(world, searches, began);
        Ok(())
    }
}

/// Steps here, whatever the law.
struct Here<'a, 'w> {
    world: &'a mut World<'w, f64>,
    stepping: &'a mut Stepping,
    last: u64,
    notes: Option<&'a mut Notebook>,
}

impl WithLaw for Here<'_, '_> {
    type Output = Fallible<()>;

    fn run<L: Law<f64> + Sprung>(self, law: &L) -> Self::Output {
        self.stepping
            .steps_here(self.world, law, self.last, self.notes)
    }
}

impl Kernel for RowsFrom<'_> {
    type Output = Sealed;

    #[inline(always)]
    fn run(self) -> Sealed {
        seal(&self.0, self.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Grain, Simulation};
    use crate::threads::on_threads;
    use bitgrain_kernel::contact::HertzHistory;
    use bitgrain_kernel::{Domain, Group, Obstacle};

    /// Eight grains in a row along x, of diameter 1 and 2 apart, that move along z or x as given.
    fn row(velocity: impl Fn(u32) -> [f64; 3]) -> Simulation {
        let law = HertzHistory {
            kn: 2e5,
            kt: 2e5,
            gamma_n: 0.0,
            gamma_t: 0.0,
            mu: 0.5,
        };
        let domain = Domain::new([0.0; 3], [20.0, 4.0, 4.0], [false; 3]).unwrap();
        let grain = |id: u32| Grain {
            id,
            group: 0,
            diameter: 1.0,
            density: 1.0,
            position: [2.0 * f64::from(id), 2.0, 2.0],
            velocity: velocity(id),
            spin: [0.0; 3],
        };
        let grains: Vec<Grain> = (1..=8).map(grain).collect();
        let groups = vec![Group::free([0.0; 3])];
        let mut sim = Simulation::new(
            AnyLaw::HertzHistory(law),
            domain,
            1e-3,
            groups,
            &grains,
            vec![],
        );
        sim.stepping.divide_always();
        sim.start().unwrap();
        sim
    }

    /// The fault that ends a row, and after how many steps, on this many threads.
    fn end(threads: usize, velocity: impl Fn(u32) -> [f64; 3]) -> (Option<KernelError>, u64) {
        let mut sim = row(velocity);
        let ended = on_threads(threads, || sim.steps(2000)).unwrap();
        (ended.err(), sim.step_count())
    }

    /// A search comes when the fastest grain of any part needs it: else grains would end past each other.
    #[test]
    fn a_fast_grain_of_any_part_is_heard() {
        for fast in 2..=8 {
            let mut states = Vec::new();
            for threads in [1, 2, 3, 8] {
                let mut sim = row(|id| [if id == fast { -30.0 } else { 0.0 }, 0.0, 0.0]);
                on_threads(threads, || sim.steps(60)).unwrap().unwrap();
                let left = sim.velocity[fast as usize - 2][0];
                assert!(left < -20.0, "grain {fast} hits the one before it: {left}");
                states.push(sim.digest());
            }
            assert!(states.iter().all(|state| *state == states[0]), "{fast}");
        }
    }

    /// A refused edit leaves the contacts as they were, also where parts have them.
    #[test]
    fn a_refused_edit_changes_nothing_on_any_threads() {
        let taken = Grain {
            id: 3,
            group: 0,
            diameter: 1.0,
            density: 1.0,
            position: [1.0; 3],
            velocity: [0.0; 3],
            spin: [0.0; 3],
        };
        let mut states = Vec::new();
        for threads in [1, 2, 3] {
            let mut sim = row(|id| [if id == 4 { -30.0 } else { 1.0 }, 0.0, 0.0]);
            on_threads(threads, || sim.steps(40)).unwrap().unwrap();
            assert!(sim.insert(&[taken]).is_err());
            sim.steps(40).unwrap();
            states.push(sim.digest());
        }
        assert!(states.iter().all(|state| *state == states[0]));
    }

    /// A fault before the first forces on threads leaves the sums on obstacles as they were.
    #[test]
    fn a_first_fault_leaves_the_sums_on_obstacles() {
        let mut sums = Vec::new();
        for threads in [1, 2, 3] {
            let mut sim = row(|_| [0.0; 3]);
            sim.obstacles = vec![Obstacle::sphere([2.0, 2.0, 2.9], 0.5)];
            sim.position[7][2] = 3.999;
            sim.velocity[7][2] = 100.0;
            sim.start().unwrap();
            let ended = on_threads(threads, || sim.steps(5)).unwrap();
            assert_eq!(ended, Err(KernelError::Escaped { id: 8 }));
            assert!(sim.obstacles[0].force[2] != 0.0);
            sums.push(sim.obstacles[0].force);
        }
        assert!(sums.iter().all(|sum| *sum == sums[0]));
    }

    /// Of several faults in one step the lowest grain's is reported, whichever part finds it.
    #[test]
    fn faults_are_those_of_one_thread() {
        // Grains 3, 5 and 8 leave the box through the top at the same step.
        let leaves = |id: u32| [0.0, 0.0, if [3, 5, 8].contains(&id) { 10.0 } else { 0.0 }];
        // Grains 4 and 7 hit the ones before them too fast for their stiffness.
        let hits = |id: u32| [if [4, 7].contains(&id) { -300.0 } else { 0.0 }, 0.0, 0.0];
        let (first, second) = (end(1, leaves), end(1, hits));
        assert_eq!(first.0, Some(KernelError::Escaped { id: 3 }));
        assert_eq!(second.0, Some(KernelError::OverlapTooDeep { i: 3, j: 4 }));
        for threads in [2, 3, 5, 8] {
            assert_eq!(end(threads, leaves), first);
            assert_eq!(end(threads, hits), second);
        }
    }
}
