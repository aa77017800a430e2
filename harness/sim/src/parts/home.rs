//! From the whole world to its parts and back.

use std::sync::{Arc, MutexGuard};

use bitgrain_kernel::parts::{listed_springs, take_lists};
use bitgrain_kernel::phases::{ObstacleShare, sum_on_obstacles};
use bitgrain_kernel::{ContactHistory, Error as KernelError, Obstacle, TOUCHING};

use super::crew::Crew;
use super::cut::{cut, fairer};
use super::ghosts::Ghosts;
use super::part::{End, Errand, Part};
use super::rows::Rows;
use super::{Cutting, Parts, Settings};
use crate::notes::{Note, Notebook, Watch, join};
use crate::owned_world::OwnedWorld;
use crate::pass::Fallible;
use crate::threads::{RowsFrom, each};

type Guards<'a> = Vec<MutexGuard<'a, Box<Part>>>;

impl Parts {
    /// Cuts a world into so many parts, with histories in its own places.
    pub(super) fn enter(
        &mut self,
        home: &OwnedWorld<f64>,
        settings: &Settings,
        count: usize,
        histories: Vec<ContactHistory<f64>>,
    ) {
        if self.fractions.len() != count {
            self.fractions = vec![1.0 / count as f64; count];
        }
        self.owner = match settings.cutting {
            Cutting::Planes => {
                let work = work_of(home.position.len(), &histories);
                cut(&home.position, &work, &home.domain, &self.fractions)
            }
            Cutting::Scattered(seed) => scattered(&home.id, seed ^ home.clock.step, count),
        };
        let errand = Errand::none(settings.law);
        let mut places = vec![Vec::new(); count];
        for (place, owner) in self.owner.iter().enumerate() {
            places[usize::from(*owner)].push(place as u32);
        }
        let parts = places.into_iter().enumerate().map(|(number, places)| {
            let world = part_of(home, &places);
            Part::new(number, world, Ghosts::none(number, places, count), errand)
        });
        let mut parts: Vec<Part> = parts.collect();
        let owner = |place: u32| usize::from(self.owner[place as usize]);
        for history in histories {
            match history {
                ContactHistory::Pair { i, j, .. } => {
                    parts[owner(i)].histories.push(history);
                    if owner(j) != owner(i) {
                        parts[owner(j)].histories.push(history);
                    }
                }
                ContactHistory::Obstacle { i, .. } => parts[owner(i)].histories.push(history),
            }
        }
        self.counted = [0; 2];
        self.crew = Some(Arc::new(Crew::new(parts)));
    }

    /// Gives all parts what the host may change between two calls, and what it wants to know of each step.
    pub(super) fn set_out(&mut self, home: &OwnedWorld<f64>, crew: &Crew, watch: Option<&Watch>) {
        for part in &mut crew.parts() {
            part.notes = watch.map(Notebook::new);
            part.world.clock.step = home.clock.step;
            part.world.obstacles.clone_from(&home.obstacles);
            part.world.policy = home.policy;
            (part.world.skin, part.world.outer_skin) = (home.skin, home.outer_skin);
        }
    }

    /// Takes the rows of all grains home, the sums on obstacles and the clock; contacts stay with the parts. Returns
    /// how the parts ended.
    pub(super) fn gather(&mut self, home: &mut OwnedWorld<f64>, crew: &Crew) -> End {
        let parts = crew.parts();
        home.obstacles.clone_from(&parts[0].world.obstacles);
        (home.skin, home.outer_skin) = (parts[0].world.skin, parts[0].world.outer_skin);
        let clock = &parts[0].world.clock;
        let now = [clock.outer_list_rebuilds(), clock.prunes()];
        home.clock
            .rejoin(clock, now[0] - self.counted[0], now[1] - self.counted[1]);
        self.counted = now;
        let mut end = parts[0].end().expect("all parts have ended");
        // Before, the sums are those of the last step of the whole world.
        if parts.iter().all(|part| part.has_summed) {
            sum_on_obstacles(&mut home.obstacles, shares(&parts).into_iter());
        }
        // Of finite shares, a sum that is not finite is found here, and not in the step that made it.
        if end == End::Reached
            && let Some(obstacle) = unsound(&home.obstacles)
        {
            home.clock.stop();
            end = End::Fault(KernelError::ObstacleNotFinite { obstacle });
        }
        let from: Vec<&Part> = parts.iter().map(|part| &***part).collect();
        let mut world = home.world();
        let rows = RowsFrom(world.grain_motion(), 0);
        each(rows, parts.len(), &|rows| bring(rows, &from), &|(), ()| ());
        self.away = true;
        self.mark = Some(home.clock);
        end
    }

    /// What the parts noted of the steps up to `last`.
    pub(super) fn noted(&self, crew: &Crew, last: u64) -> Vec<Note> {
        let mut parts = crew.parts();
        let books = parts.iter_mut().filter_map(|part| part.notes.as_mut());
        join(&mut books.collect::<Vec<_>>(), last)
    }

    /// Gives the next cut fairer fractions, by the times that parts took.
    pub(super) fn adjust(&mut self, settings: &Settings, crew: &Crew) {
        if settings.cutting == Cutting::Planes {
            let busy: Vec<f64> = crew
                .parts()
                .iter()
                .map(|part| part.busy.as_secs_f64())
                .collect();
            self.fractions = fairer(&self.fractions, &busy);
        }
    }

    /// Takes the contacts home too, if they are with the parts.
    ///
    /// # Errors
    /// If there is no memory for them.
    pub fn come_home(&mut self, home: &mut OwnedWorld<f64>) -> Fallible<()> {
        self.show(home)?;
        if std::mem::take(&mut self.away) {
            self.mark = Some(home.clock);
        }
        Ok(())
    }

    /// Puts the contacts that are with the parts into the lists of a world, theirs or a copy of it.
    ///
    /// # Errors
    /// If there is no memory for them.
    pub fn show(&self, home: &mut OwnedWorld<f64>) -> Fallible<()> {
        let Some(crew) = self.crew.as_ref().filter(|_| self.away) else {
            return Ok(());
        };
        let pairs = self.pairs(crew);
        let contacts = contacts(&crew.parts());
        home.while_full(|home| {
            let (pairs, contacts) = (pairs.iter().copied(), contacts.iter().copied());
            take_lists(&mut home.world(), pairs, contacts)
        })
    }

    /// Places of the grains that touch an obstacle, ascending, if contacts are with the parts.
    pub fn touching(&self, obstacle: u32) -> Option<Vec<u32>> {
        let crew = self.crew.as_ref().filter(|_| self.away)?;
        let contacts = contacts(&crew.parts());
        let touching = contacts
            .iter()
            .filter(|(_, word, _)| *word == (obstacle | TOUCHING));
        Some(touching.map(|(grain, ..)| *grain).collect())
    }

    /// Pairs and obstacle contacts that are listed, if contacts are with the parts; pairs of two parts twice.
    pub fn listed(&self) -> Option<(usize, usize)> {
        let crew = self.crew.as_ref().filter(|_| self.away)?;
        let parts = crew.parts();
        let clocks = parts.iter().map(|part| &part.world.clock);
        Some(clocks.fold((0, 0), |(pairs, contacts), clock| {
            (pairs + clock.listed(), contacts + clock.obstacle_contacts())
        }))
    }

    /// Bytes that the parts hold.
    pub fn bytes(&self) -> usize {
        let crew = self.crew.as_ref();
        let parts = crew.map_or(Vec::new(), |crew| crew.parts());
        parts.iter().map(|part| part.world.bytes()).sum()
    }

    /// Histories of touching contacts in places of the whole world.
    pub(super) fn histories(&self, crew: &Crew) -> Vec<ContactHistory<f64>> {
        let pairs = self.pairs(crew).into_iter();
        let pairs = pairs.filter(|(.., spring)| *spring != [0.0; 3]);
        let pairs = pairs.map(|(i, j, spring)| ContactHistory::Pair { i, j, spring });
        let contacts = contacts(&crew.parts()).into_iter();
        let contacts = contacts.filter(|(_, word, _)| word & TOUCHING != 0);
        let contacts = contacts.map(|(i, word, [x, y, z, _])| ContactHistory::Obstacle {
            i,
            obstacle: word & !TOUCHING,
            spring: [x, y, z],
        });
        pairs.chain(contacts).collect()
    }

    /// The listed pairs of the whole world with their springs: those of a grain are as its own part lists them.
    fn pairs(&self, crew: &Crew) -> Vec<(u32, u32, [f64; 3])> {
        let mut parts = crew.parts();
        let worlds = parts.iter_mut().map(|part| {
            let Part { world, ghosts, .. } = &mut ***part;
            (world.world(), ghosts.home())
        });
        let worlds: Vec<_> = worlds.collect();
        let listed = worlds.iter().map(|(world, home)| {
            let home = |place: u32| home[place as usize];
            let pairs = listed_springs(world);
            let pairs = pairs.map(move |(i, j, spring)| (home(i), home(j), spring));
            pairs.peekable()
        });
        let mut listed: Vec<_> = listed.collect();
        let mut all = Vec::new();
        for (owner, i) in self.owner.iter().zip(0u32..) {
            let own = &mut listed[usize::from(*owner)];
            // Those of ghosts before it.
            while own.next_if(|(lower, ..)| *lower < i).is_some() {}
            while let Some(pair) = own.next_if(|(lower, ..)| *lower == i) {
                all.push(pair);
            }
        }
        all
    }
}

/// The first obstacle whose force or torque is not finite.
fn unsound(obstacles: &[Obstacle<f64>]) -> Option<u32> {
    let sums = |body: &Obstacle<f64>| [body.force, body.torque].concat();
    let is_unsound = |body: &Obstacle<f64>| !sums(body).iter().all(|x| x.is_finite());
    let first = obstacles.iter().position(is_unsound);
    first.map(|k| k as u32)
}

/// What each grain costs: about as much as a pair, which belongs to both of its grains.
fn work_of(grains: usize, histories: &[ContactHistory<f64>]) -> Vec<f64> {
    let mut work = vec![1.0; grains];
    for history in histories {
        if let ContactHistory::Pair { i, j, .. } = history {
            work[*i as usize] += 0.5;
            work[*j as usize] += 0.5;
        }
    }
    work
}

/// Any grain to any part; every part has one.
fn scattered(id: &[u32], seed: u64, count: usize) -> Vec<u16> {
    let owner = |(place, id): (usize, &u32)| {
        let key = (u64::from(*id) ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let any = (key ^ (key >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 33;
        match place < count {
            true => place as u16,
            false => (any % count as u64) as u16,
        }
    };
    id.iter().enumerate().map(owner).collect()
}

/// The grains at these places as a world that has begun.
fn part_of(home: &OwnedWorld<f64>, places: &[u32]) -> OwnedWorld<f64> {
    let mut world = OwnedWorld {
        skin: home.skin,
        outer_skin: home.outer_skin,
        groups: home.groups.clone(),
        obstacles: home.obstacles.clone(),
        policy: home.policy,
        clock: home.clock.of_part(places.len()),
        ..OwnedWorld::new(home.domain, home.dt)
    };
    let mut rows = Rows::default();
    for place in places {
        rows.add_own(home, *place as usize);
    }
    rows.end();
    rows.swap_with(&mut world);
    let n = places.len();
    // What is too short grows later, or says that it cannot.
    let _ = world.reserve(3 * n + 64, 4 * n + 64, n / 8 + 64);
    world
}

/// What obstacle contacts took from their obstacles in the last step, in the order of the contract.
fn shares(parts: &Guards<'_>) -> Vec<ObstacleShare<f64>> {
    let mut shares = Vec::new();
    for part in parts {
        let (home, list) = (part.ghosts.home(), &part.world.lists[0]);
        let grains = list.obstacle_contact_grain.iter();
        let named = grains.map(|grain| home[*grain as usize]);
        shares.extend(named.zip(part.shares.iter().copied()));
    }
    // Stable: the contacts of a grain are in one part, by obstacle.
    shares.sort_by_key(|(grain, _)| *grain);
    shares.into_iter().map(|(_, share)| share).collect()
}

/// All listed obstacle contacts: grain, obstacle and spring, in order.
fn contacts(parts: &Guards<'_>) -> Vec<(u32, u32, [f64; 4])> {
    let mut contacts = Vec::new();
    for part in parts {
        let (home, list) = (part.ghosts.home(), &part.world.lists[0]);
        for t in 0..part.world.clock.obstacle_contacts() {
            let grain = home[list.obstacle_contact_grain[t] as usize];
            let spring = list.obstacle_contact_spring[t];
            contacts.push((grain, list.obstacle_contact_obstacle[t], spring));
        }
    }
    contacts.sort_by_key(|(grain, ..)| *grain);
    contacts
}

/// Copies rows of own grains of all parts to the whole world.
fn bring(rows: RowsFrom<'_>, parts: &[&Part]) {
    let RowsFrom(to, first) = rows;
    let end = first + to.count();
    for part in parts {
        let (home, world) = (part.ghosts.home(), &part.world);
        let from = home.partition_point(|place| (*place as usize) < first) as u32;
        let until = home.partition_point(|place| (*place as usize) < end) as u32;
        for run in world.owned.chunks_exact(2) {
            for place in run[0].max(from)..run[1].min(until) {
                let place = place as usize;
                let k = home[place] as usize - first;
                to.position[k] = world.position[place];
                to.velocity[k] = world.velocity[place];
                to.spin[k] = world.spin[place];
                to.force[k] = world.force[place];
                to.torque[k] = world.torque[place];
                to.image[k] = world.image[place];
            }
        }
    }
}
