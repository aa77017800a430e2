//! Storage of fixed capacity for rigs without an allocator: a whole world in one value.

use heapless::Vec;

use crate::edit::{NewGrains, insert};
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::neighbors::cell_list::CellList;
use crate::neighbors::memory::memory_columns;
use crate::neighbors::outer_list::OuterList;
use crate::neighbors::pair_list::PairList;
use crate::neighbors::stretch::StretchList;
use crate::saved::Saved;
use crate::state::domain::Domain;
use crate::state::facet::Facet;
use crate::state::grains::{Grains, Group, NewGrain};
use crate::state::losses::LossPolicy;
use crate::state::obstacle::Obstacle;
use crate::world::{Clock, World};

/// A world of at most `GRAINS` grains, `PAIRS` listed pairs, `OBSTACLE_CONTACTS` listed obstacle contacts and
/// `BODIES` obstacles and as many groups, all inside one value.
///
/// `MEMORY` is how many words of a contact the law keeps ([`Law::MEMORY`](crate::contact::Law::MEMORY)): 0 for
/// [`HertzHistory`](crate::contact::HertzHistory) and [`HertzTsuji`](crate::contact::HertzTsuji), 3 for
/// [`Rolling`](crate::contact::Rolling).
///
/// With too few `PAIRS` for its skin a store can be given a smaller skin; at skin 0 it lists what
/// may touch in one step, and a fault then means that `PAIRS` is too small for the bed itself.
///
/// ```
/// use bitgrain_kernel::Store;
/// // In zeroed static memory; `clear` gives it a box before use.
/// static EMPTY: Store<f64, 8, 32, 8, 2> = Store::vacant();
/// ```
pub struct Store<
    R: 'static,
    const GRAINS: usize,
    const PAIRS: usize,
    const OBSTACLE_CONTACTS: usize,
    const BODIES: usize,
    const MEMORY: usize = 0,
> {
    domain: Domain<R>,
    dt: R,
    skin: R,
    outer_skin: R,
    policy: LossPolicy<R>,
    id: Vec<u32, GRAINS>,
    group: Vec<u8, GRAINS>,
    groups: Vec<Group<R>, BODIES>,
    position: Vec<Row<R>, GRAINS>,
    velocity: Vec<Row<R>, GRAINS>,
    spin: Vec<Row<R>, GRAINS>,
    force: Vec<Row<R>, GRAINS>,
    torque: Vec<Row<R>, GRAINS>,
    image: Vec<[i32; 3], GRAINS>,
    obstacles: Vec<Obstacle<R>, BODIES>,
    facets: &'static [Facet<R>],
    lists: [List<R, PAIRS, OBSTACLE_CONTACTS, MEMORY>; 2],
    stretch: OneStretch<R>,
    /// One entry more than grains.
    candidate_row: Vec<u32, PAIRS>,
    candidate: [u32; PAIRS],
    cell_start: [u32; PAIRS],
    cell_grain: [u32; GRAINS],
    clock: Clock<R>,
}

struct List<R, const PAIRS: usize, const OBSTACLE_CONTACTS: usize, const MEMORY: usize> {
    lower: [u32; PAIRS],
    partner: [u32; PAIRS],
    spring: [[R; PAIRS]; 3],
    memory: [[R; PAIRS]; MEMORY],
    obstacle_contact_grain: [u32; OBSTACLE_CONTACTS],
    obstacle_contact_obstacle: [u32; OBSTACLE_CONTACTS],
    obstacle_contact_spring: [Row<R>; OBSTACLE_CONTACTS],
    obstacle_contact_memory: [[R; OBSTACLE_CONTACTS]; MEMORY],
}

/// All grains as one stretch: stretches save time in beds of thousands.
struct OneStretch<R> {
    place: [u32; 2],
    begin: [u32; 2],
    pairs: [u32; 1],
    touching: [u32; 1],
    budget: [R; 1],
    travel: [R; 1],
    approach: [R; 1],
}

impl<R: Real> OneStretch<R> {
    const EMPTY: Self = Self {
        place: [0; 2],
        begin: [0; 2],
        pairs: [0],
        touching: [0],
        budget: [R::ZERO],
        travel: [R::ZERO],
        approach: [R::ZERO],
    };

    fn lend(&mut self) -> StretchList<'_, R> {
        StretchList {
            place: &mut self.place,
            begin: &mut self.begin,
            pairs: &mut self.pairs,
            touching: &mut self.touching,
            neighbor: &mut [],
            budget: &mut self.budget,
            travel: &mut self.travel,
            approach: &mut self.approach,
        }
    }
}

impl<R: Real, const PAIRS: usize, const OBSTACLE_CONTACTS: usize, const MEMORY: usize>
    List<R, PAIRS, OBSTACLE_CONTACTS, MEMORY>
{
    const EMPTY: Self = Self {
        lower: [0; PAIRS],
        partner: [0; PAIRS],
        spring: [[R::ZERO; PAIRS]; 3],
        memory: [[R::ZERO; PAIRS]; MEMORY],
        obstacle_contact_grain: [0; OBSTACLE_CONTACTS],
        obstacle_contact_obstacle: [0; OBSTACLE_CONTACTS],
        obstacle_contact_spring: [[R::ZERO; 4]; OBSTACLE_CONTACTS],
        obstacle_contact_memory: [[R::ZERO; OBSTACLE_CONTACTS]; MEMORY],
    };

    fn lend(&mut self) -> PairList<'_, R> {
        PairList {
            lower: &mut self.lower,
            partner: &mut self.partner,
            spring: self.spring.each_mut().map(|s| &mut s[..]),
            memory: memory_columns(self.memory.iter_mut().map(|w| &mut w[..])),
            obstacle_contact_grain: &mut self.obstacle_contact_grain,
            obstacle_contact_obstacle: &mut self.obstacle_contact_obstacle,
            obstacle_contact_spring: &mut self.obstacle_contact_spring,
            obstacle_contact_memory: memory_columns(
                self.obstacle_contact_memory.iter_mut().map(|w| &mut w[..]),
            ),
        }
    }
}

impl<
    R: Real,
    const GRAINS: usize,
    const PAIRS: usize,
    const OBSTACLE_CONTACTS: usize,
    const BODIES: usize,
    const MEMORY: usize,
> Store<R, GRAINS, PAIRS, OBSTACLE_CONTACTS, BODIES, MEMORY>
{
    /// A store without a box, for static memory: every byte of it is zero. [`Store::clear`] makes an
    /// empty world of it; until then [`crate::start`] refuses it. `PAIRS` must be at least
    /// `GRAINS + 1` and 2.
    pub const fn vacant() -> Self {
        const { assert!(PAIRS > GRAINS && PAIRS >= 2, "PAIRS must exceed GRAINS") };
        Self {
            domain: Domain::VACANT,
            dt: R::ZERO,
            skin: R::ZERO,
            outer_skin: R::ZERO,
            policy: LossPolicy::STOP,
            id: Vec::new(),
            group: Vec::new(),
            groups: Vec::new(),
            position: Vec::new(),
            velocity: Vec::new(),
            spin: Vec::new(),
            force: Vec::new(),
            torque: Vec::new(),
            image: Vec::new(),
            obstacles: Vec::new(),
            facets: &[],
            lists: [const { List::EMPTY }; 2],
            stretch: OneStretch::EMPTY,
            candidate_row: Vec::new(),
            candidate: [0; PAIRS],
            cell_start: [0; PAIRS],
            cell_grain: [0; GRAINS],
            clock: Clock::ZERO,
        }
    }

    /// An empty world; as for [`Store::vacant`], `PAIRS` must be at least `GRAINS + 1` and 2.
    pub fn new(domain: Domain<R>, dt: R, skin: R) -> Self {
        let mut store = Self::vacant();
        store.clear(domain, dt, skin);
        store
    }

    /// Makes this an empty world at step 0, whatever it was.
    pub fn clear(&mut self, domain: Domain<R>, dt: R, skin: R) {
        (self.domain, self.dt) = (domain, dt);
        (self.skin, self.outer_skin) = (skin, R::ZERO);
        self.policy = LossPolicy::STOP;
        self.id.clear();
        self.group.clear();
        self.groups.clear();
        self.position.clear();
        self.velocity.clear();
        self.spin.clear();
        self.force.clear();
        self.torque.clear();
        self.image.clear();
        self.obstacles.clear();
        self.facets = &[];
        self.clock = Clock::ZERO;
    }

    /// How far beyond touching pairs are listed from now on (length): speed only, never a bit.
    pub fn set_skin(&mut self, skin: R) {
        self.skin = skin;
    }

    /// How far beyond the skin pairs are candidates from now on (length; 0 at first): speed only, never
    /// a bit. Candidates are stored in `PAIRS` entries too.
    pub fn set_outer_skin(&mut self, outer_skin: R) {
        self.outer_skin = outer_skin;
    }

    /// Adds a group and returns its number.
    ///
    /// # Errors
    /// The group, if there are `BODIES` or 256 already.
    pub fn add_group(&mut self, group: Group<R>) -> Result<u8, Group<R>> {
        let Ok(number) = u8::try_from(self.groups.len()) else {
            return Err(group);
        };
        self.groups.push(group)?;
        self.clock.unstart();
        Ok(number)
    }

    /// Adds an obstacle.
    ///
    /// # Errors
    /// The obstacle, if there are `BODIES` already.
    pub fn add_obstacle(&mut self, obstacle: Obstacle<R>) -> Result<(), Obstacle<R>> {
        self.obstacles.push(obstacle)?;
        self.clock.unstart();
        Ok(())
    }

    /// The triangles of all meshes, instead of those before; see [`Obstacle::mesh`].
    pub fn set_facets(&mut self, facets: &'static [Facet<R>]) {
        self.facets = facets;
        self.clock.unstart();
    }

    /// What becomes of grains that leave, from now on; at first they stop the world.
    pub fn set_policy(&mut self, policy: LossPolicy<R>) {
        self.policy = policy;
    }

    /// Adds a resting grain of this radius and mass before the world is started; ids must ascend.
    ///
    /// # Errors
    /// [`Error::GrainsFull`] if there are `GRAINS` already.
    pub fn add_grain(
        &mut self,
        id: u32,
        group: u8,
        position: [R; 3],
        radius: R,
        mass: R,
    ) -> Result<(), Error> {
        self.fit();
        let count = self.id.len();
        self.lengthen(1)?;
        self.clock.unstart();
        self.clock.count = count + 1;
        self.lend().grains.put(
            count,
            &NewGrain {
                id,
                group,
                position,
                radius,
                mass,
                velocity: [R::ZERO; 3],
                spin: [R::ZERO; 3],
            },
        );
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
        self.fit();
        self.lengthen(grains.len())?;
        let inserted = insert(&mut self.lend(), grains);
        self.fit();
        inserted
    }

    /// Goes on from what [`save`](crate::save) wrote: box, time step, groups, obstacles, grains and histories are those
    /// of the saved world; skins and triangles of meshes stay as they are. Bytes behind the saved world are not looked
    /// at.
    ///
    /// # Errors
    /// All is as it was: [`Error::BadSave`], [`Error::OtherVersion`], [`Error::GrainsFull`]; [`Error::BadStorage`] if
    /// there is no room for its groups or obstacles. The store is stopped: a list that is too short for its skin (set
    /// a smaller one and load again), and whatever [`resume`](crate::resume) finds wrong with forged bytes.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let saved = Saved::<R>::open(bytes)?;
        saved.check_room(GRAINS, BODIES, BODIES)?;
        let (outer_skin, facets) = (self.outer_skin, self.facets);
        self.clear(saved.domain(), saved.dt(), self.skin);
        (self.outer_skin, self.facets) = (outer_skin, facets);
        self.policy = saved.policy();
        for group in saved.groups() {
            self.add_group(group).map_err(|_| Error::BadStorage)?;
        }
        for obstacle in saved.obstacles() {
            self.add_obstacle(obstacle).map_err(|_| Error::BadStorage)?;
        }
        self.lengthen(saved.count())?;
        self.clock.count = saved.count();
        let mut world = self.lend();
        saved.fill(&mut world);
        saved.resume(&mut world)
    }

    /// Takes away the rows of grains that were taken out of the world.
    fn fit(&mut self) {
        let count = self.clock.count;
        self.id.truncate(count);
        self.group.truncate(count);
        self.position.truncate(count);
        self.velocity.truncate(count);
        self.spin.truncate(count);
        self.force.truncate(count);
        self.torque.truncate(count);
        self.image.truncate(count);
    }

    /// Adds rows for so many grains.
    fn lengthen(&mut self, more: usize) -> Result<(), Error> {
        let needed = self.id.len().saturating_add(more);
        // Every list has the same capacity: all are resized or none.
        let full = |_| Error::GrainsFull { needed };
        self.id.resize(needed, 0).map_err(full)?;
        self.group.resize(needed, 0).map_err(full)?;
        self.position.resize(needed, [R::ZERO; 4]).map_err(full)?;
        self.velocity.resize(needed, [R::ZERO; 4]).map_err(full)?;
        self.spin.resize(needed, [R::ZERO; 4]).map_err(full)?;
        self.force.resize(needed, [R::ZERO; 4]).map_err(full)?;
        self.torque.resize(needed, [R::ZERO; 4]).map_err(full)?;
        self.image.resize(needed, [0; 3]).map_err(full)
    }

    /// Lends everything as a world.
    pub fn world(&mut self) -> World<'_, R> {
        self.fit();
        self.lend()
    }

    fn lend(&mut self) -> World<'_, R> {
        let rows = self.id.len() + 1;
        // GRAINS + 1 <= PAIRS, so this always fits.
        let _ = self.candidate_row.resize(rows, 0);
        let [first, second] = &mut self.lists;
        World {
            domain: &self.domain,
            dt: self.dt,
            skin: self.skin,
            outer_skin: self.outer_skin,
            owned: &[],
            policy: self.policy,
            grains: Grains {
                id: &mut self.id,
                group: &mut self.group,
                groups: &self.groups,
                position: &mut self.position,
                velocity: &mut self.velocity,
                spin: &mut self.spin,
                force: &mut self.force,
                torque: &mut self.torque,
                image: &mut self.image,
            },
            obstacles: &mut self.obstacles,
            facets: self.facets,
            pairs: first.lend(),
            spare: second.lend(),
            stretches: self.stretch.lend(),
            candidates: OuterList {
                row: &mut self.candidate_row,
                partner: &mut self.candidate,
            },
            cells: CellList {
                start: &mut self.cell_start,
                grain: &mut self.cell_grain,
            },
            clock: &mut self.clock,
        }
    }
}
