//! A world in memory that its host lends: for hosts that learn at run time how many grains there are.

use super::capacity::Capacity;
use crate::edit::{NewGrains, insert};
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::{Row, front_mut, prefix, set};
use crate::neighbors::cell_list::CellList;
use crate::neighbors::memory::memory_columns;
use crate::neighbors::outer_list::OuterList;
use crate::neighbors::pair_list::PairList;
use crate::neighbors::stretch::{NEIGHBORS, StretchList};
use crate::saved::Saved;
use crate::state::domain::Domain;
use crate::state::facet::Facet;
use crate::state::grains::{Grains, Group, NewGrain};
use crate::state::losses::{Drain, LossPolicy};
use crate::state::obstacle::Obstacle;
use crate::world::{Clock, World};

/// What a lent store keeps beside its rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head<R> {
    pub(super) domain: Domain<R>,
    dt: R,
    skin: R,
    outer_skin: R,
    pub(super) takes_out: bool,
    /// Whether there is a drain.
    pub(super) drains: bool,
    drain: Drain<R>,
    groups: usize,
    obstacles: usize,
    pub(super) clock: Clock<R>,
}

impl<R: Real> Head<R> {
    /// Of an empty world at step 0, with this time step and skin; see [`World`].
    pub fn new(domain: Domain<R>, dt: R, skin: R) -> Self {
        Self {
            domain,
            dt,
            skin,
            outer_skin: R::ZERO,
            takes_out: false,
            drains: false,
            drain: Drain {
                point: [R::ZERO; 3],
                normal: [R::ZERO; 3],
            },
            groups: 0,
            obstacles: 0,
            clock: Clock::ZERO,
        }
    }

    fn set_policy(&mut self, policy: LossPolicy<R>) {
        (self.takes_out, self.drains) = (policy.takes_out, policy.drain.is_some());
        self.drain = policy.drain.unwrap_or(self.drain);
    }
}

/// Memory that a host lends, of the lengths that a [`Capacity`] says or longer. What it holds matters only if it was
/// left by a store with the same capacity.
pub struct Memory<'a, R> {
    /// The store's own.
    pub head: &'a mut Head<R>,
    /// [`Capacity::numbers`] of them.
    pub numbers: &'a mut [R],
    /// [`Capacity::words`] of them.
    pub words: &'a mut [u32],
    /// One for each grain: crossings of the periodic axes.
    pub images: &'a mut [[i32; 3]],
    /// One for each grain: its group.
    pub group: &'a mut [u8],
    /// The groups.
    pub groups: &'a mut [Group<R>],
    /// The obstacles.
    pub obstacles: &'a mut [Obstacle<R>],
    /// The triangles of all meshes; empty if there are none.
    pub facets: &'a [Facet<R>],
}

/// A store in memory that its host lends, as [`Store`](crate::Store) is one in a value. It may be made again from the
/// same memory at any time and goes on as it was, so that a host need not keep it.
///
/// ```
/// use bitgrain_kernel::contact::HertzHistory;
/// use bitgrain_kernel::{Capacity, Domain, Group, Head, LentStore, Memory, Obstacle, start, step};
///
/// let capacity = Capacity::for_bed(100, 1);
/// let mut head = Head::new(Domain::open(), 1e-4, 0.05);
/// let mut numbers = vec![0.0; capacity.numbers().unwrap()];
/// let mut words = vec![0; capacity.words().unwrap()];
/// let (mut images, mut group) = (vec![[0; 3]; 100], vec![0; 100]);
/// let mut groups = [Group::frozen(); 8];
/// let mut obstacles = [Obstacle::sphere([0.0; 3], 1.0)];
/// let memory = Memory {
///     head: &mut head,
///     numbers: &mut numbers,
///     words: &mut words,
///     images: &mut images,
///     group: &mut group,
///     groups: &mut groups,
///     obstacles: &mut obstacles,
///     facets: &[],
/// };
/// let mut store = LentStore::new(memory, capacity).unwrap();
/// let free = store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
/// store.add_obstacle(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0])).unwrap();
/// for k in 0..100u32 {
///     store.add_grain(k + 1, free, [1.1 * f64::from(k), 0.0, 1.0], 0.5, 0.5236).unwrap();
/// }
/// let law = HertzHistory { kn: 2e5, kt: 2.45e5, gamma_n: 792.0, gamma_t: 792.0, mu: 0.5 };
/// start(&mut store.world(), &law).unwrap();
/// step(&mut store.world(), &law).unwrap();
/// ```
pub struct LentStore<'a, R> {
    capacity: Capacity,
    memory: Memory<'a, R>,
}

impl<'a, R: Real> LentStore<'a, R> {
    /// A store in this memory.
    ///
    /// # Errors
    /// [`Error::BadStorage`] for memory that is shorter than the capacity says, or whose head or stretches count more
    /// than that.
    pub fn new(memory: Memory<'a, R>, capacity: Capacity) -> Result<Self, Error> {
        let holds = |least: Option<usize>, length: usize| least.is_some_and(|n| n <= length);
        let head = &memory.head;
        let long = holds(capacity.numbers(), memory.numbers.len())
            && holds(capacity.words(), memory.words.len())
            && memory.images.len() >= capacity.grains
            && memory.group.len() >= capacity.grains
            && memory.groups.len() >= capacity.groups
            && memory.obstacles.len() >= capacity.obstacles;
        let within = head.clock.count <= capacity.grains
            && head.groups <= capacity.groups
            && head.obstacles <= capacity.obstacles;
        if !(long && within && capacity.cells > 0) {
            return Err(Error::BadStorage);
        }
        let mut store = Self { capacity, memory };
        let world = store.world();
        let (listed, pairs) = (world.clock.listed, world.pairs.lower.len());
        // No loop over what is listed is longer than the lists.
        let bounded = world.pairs.holds(listed)
            && world.stretches.holds(listed.stretches)
            && (world.stretches).is_within(listed.stretches, capacity.grains, pairs);
        match bounded {
            true => Ok(store),
            false => Err(Error::BadStorage),
        }
    }

    /// How many bodies and entries there is room for.
    pub fn capacity(&self) -> Capacity {
        self.capacity
    }

    /// How many grains there are.
    pub fn count(&self) -> usize {
        self.memory.head.clock.count
    }

    /// How far beyond touching pairs are listed from now on, and beyond that are candidates (length): speed only.
    pub fn set_skins(&mut self, skin: R, outer_skin: R) {
        (self.memory.head.skin, self.memory.head.outer_skin) = (skin, outer_skin);
    }

    /// What becomes of grains that leave, from now on.
    pub fn set_policy(&mut self, policy: LossPolicy<R>) {
        self.memory.head.set_policy(policy);
    }

    /// Adds a group and returns its number.
    ///
    /// # Errors
    /// [`Error::BadStorage`] if there is no room for it.
    pub fn add_group(&mut self, group: Group<R>) -> Result<u8, Error> {
        let head = &mut *self.memory.head;
        let number = u8::try_from(head.groups).map_err(|_| Error::BadStorage)?;
        if head.groups >= self.capacity.groups {
            return Err(Error::BadStorage);
        }
        set(self.memory.groups, head.groups, group);
        head.groups += 1;
        head.clock.unstart();
        Ok(number)
    }

    /// Adds an obstacle and returns its number.
    ///
    /// # Errors
    /// [`Error::BadStorage`] if there is no room for it.
    pub fn add_obstacle(&mut self, obstacle: Obstacle<R>) -> Result<u32, Error> {
        let head = &mut *self.memory.head;
        let number = u32::try_from(head.obstacles).map_err(|_| Error::BadStorage)?;
        if head.obstacles >= self.capacity.obstacles {
            return Err(Error::BadStorage);
        }
        set(self.memory.obstacles, head.obstacles, obstacle);
        head.obstacles += 1;
        head.clock.unstart();
        Ok(number)
    }

    /// Adds a resting grain before the world is started; ids must ascend.
    ///
    /// # Errors
    /// [`Error::GrainsFull`].
    pub fn add_grain(
        &mut self,
        id: u32,
        group: u8,
        position: [R; 3],
        radius: R,
        mass: R,
    ) -> Result<(), Error> {
        self.add(&NewGrain {
            id,
            group,
            position,
            radius,
            mass,
            velocity: [R::ZERO; 3],
            spin: [R::ZERO; 3],
        })
    }

    /// Adds a grain that may move before the world is started; ids must ascend.
    ///
    /// # Errors
    /// [`Error::GrainsFull`].
    pub fn add(&mut self, grain: &NewGrain<R>) -> Result<(), Error> {
        let count = self.count();
        self.check_room(1)?;
        let mut world = self.lend(count + 1);
        world.grains.put(count, grain);
        world.clock.count = count + 1;
        world.clock.unstart();
        Ok(())
    }

    /// Puts grains into a world between two steps; see [`insert`].
    ///
    /// # Errors
    /// [`Error::GrainsFull`]; as [`insert`]. All is as it was.
    pub fn insert<I>(&mut self, grains: I) -> Result<(), Error>
    where
        I: IntoIterator<Item = NewGrain<R>, IntoIter: NewGrains>,
    {
        let grains = grains.into_iter();
        self.check_room(grains.len())?;
        let rows = self.count() + grains.len();
        insert(&mut self.lend(rows), grains)
    }

    /// Goes on from what [`save`](crate::save) wrote: groups, obstacles, grains and histories are those of the saved
    /// world; skins stay as they are.
    ///
    /// # Errors
    /// As [`Store::load`](crate::Store::load).
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let saved = Saved::<R>::open(bytes)?;
        saved.check_room(
            self.capacity.grains,
            self.capacity.groups,
            self.capacity.obstacles,
        )?;
        let head = &mut *self.memory.head;
        let skins = (head.skin, head.outer_skin);
        *head = Head::new(saved.domain(), saved.dt(), skins.0);
        head.outer_skin = skins.1;
        head.set_policy(saved.policy());
        for group in saved.groups() {
            self.add_group(group)?;
        }
        for obstacle in saved.obstacles() {
            self.add_obstacle(obstacle)?;
        }
        let mut world = self.lend(saved.count());
        saved.fill(&mut world);
        saved.resume(&mut world)
    }

    fn check_room(&self, more: usize) -> Result<(), Error> {
        let needed = self.count().saturating_add(more);
        match needed <= self.capacity.grains {
            true => Ok(()),
            false => Err(Error::GrainsFull { needed }),
        }
    }

    /// Lends everything as a world.
    pub fn world(&mut self) -> World<'_, R> {
        self.lend(self.count())
    }

    /// Lends a world of so many rows.
    fn lend(&mut self, rows: usize) -> World<'_, R> {
        let Capacity {
            grains,
            pairs,
            candidates,
            obstacle_contacts,
            cells,
            memory,
            ..
        } = self.capacity;
        let stretches = self.capacity.stretches();
        let Memory {
            head,
            numbers,
            words,
            images,
            group,
            groups,
            obstacles,
            facets,
        } = &mut self.memory;
        let (mut numbers, mut words) = (Rest(numbers), Rest(words));
        let id = front_mut(words.take(grains), rows);
        let mut four = || front_mut(rows_of(numbers.take(4 * grains)), rows);
        let (position, velocity, spin) = (four(), four(), four());
        let (force, torque) = (four(), four());
        let mut list = || PairList {
            lower: words.take(pairs),
            partner: words.take(pairs),
            spring: [(); 3].map(|()| numbers.take(pairs)),
            memory: memory_columns((0..memory).map(|_| numbers.take(pairs))),
            obstacle_contact_grain: words.take(obstacle_contacts),
            obstacle_contact_obstacle: words.take(obstacle_contacts),
            obstacle_contact_spring: rows_of(numbers.take(4 * obstacle_contacts)),
            obstacle_contact_memory: memory_columns(
                (0..memory).map(|_| numbers.take(obstacle_contacts)),
            ),
        };
        let (first, second) = (list(), list());
        World {
            domain: &head.domain,
            dt: head.dt,
            skin: head.skin,
            outer_skin: head.outer_skin,
            owned: &[],
            policy: LossPolicy {
                takes_out: head.takes_out,
                drain: head.drains.then_some(head.drain),
            },
            grains: Grains {
                id,
                group: front_mut(group, rows),
                groups: prefix(groups, head.groups),
                position,
                velocity,
                spin,
                force,
                torque,
                image: front_mut(images, rows),
            },
            obstacles: front_mut(obstacles, head.obstacles),
            facets,
            pairs: first,
            spare: second,
            stretches: StretchList::new(
                words.take((4 + NEIGHBORS) * stretches + 2),
                numbers.take(3 * stretches),
            ),
            candidates: OuterList {
                row: front_mut(words.take(grains + 1), rows + 1),
                partner: words.take(candidates),
            },
            cells: CellList {
                start: words.take(cells + 1),
                grain: words.take(grains),
            },
            clock: &mut head.clock,
        }
    }
}

/// What is left of a slice.
struct Rest<'m, T>(&'m mut [T]);

impl<'m, T> Rest<'m, T> {
    /// Its next entries; none if it is shorter.
    fn take(&mut self, count: usize) -> &'m mut [T] {
        let all = core::mem::take(&mut self.0);
        let (taken, rest) = all.split_at_mut_checked(count).unwrap_or_default();
        self.0 = rest;
        taken
    }
}

/// Numbers as rows.
fn rows_of<R: Real>(numbers: &mut [R]) -> &mut [Row<R>] {
    numbers.as_chunks_mut().0
}
