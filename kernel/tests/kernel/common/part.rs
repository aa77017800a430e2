//! A part of a world, with storage of its own.

use bitgrain_kernel::phases::ObstacleShare;
use bitgrain_kernel::{
    CellList, Clock, Domain, Facet, Grains, Group, KeptContact, LossPolicy, NEIGHBORS, Obstacle,
    OuterList, PairList, Real, Row, StretchList, World, memory_columns,
};

/// What all parts of a world share.
pub struct Frame<R> {
    pub domain: Domain<R>,
    pub dt: R,
    pub skin: R,
    pub outer_skin: R,
    pub policy: LossPolicy<R>,
    pub groups: Vec<Group<R>>,
    /// Of every grain of the whole world.
    pub id: Vec<u32>,
    pub group: Vec<u8>,
    pub owner: Vec<u8>,
    /// Triangles of all meshes.
    pub facets: Vec<Facet<R>>,
}

/// Room for this many pairs and contacts.
struct List<R> {
    lower: Vec<u32>,
    partner: Vec<u32>,
    spring: [Vec<R>; 3],
    obstacle_contact_grain: Vec<u32>,
    obstacle_contact_obstacle: Vec<u32>,
    obstacle_contact_spring: Vec<Row<R>>,
    /// Words of a law, of pairs and of contacts with obstacles.
    memory: [[Vec<R>; WORDS]; 2],
}

/// More words of a contact than any law here keeps.
const WORDS: usize = 4;

impl<R: Real> List<R> {
    fn new(pairs: usize, contacts: usize) -> Self {
        Self {
            lower: vec![0; pairs],
            partner: vec![0; pairs],
            spring: [0; 3].map(|_| vec![R::ZERO; pairs]),
            obstacle_contact_grain: vec![0; contacts],
            obstacle_contact_obstacle: vec![0; contacts],
            obstacle_contact_spring: vec![[R::ZERO; 4]; contacts],
            memory: [pairs, contacts].map(|length| [0; WORDS].map(|_| vec![R::ZERO; length])),
        }
    }

    fn lend(&mut self) -> PairList<'_, R> {
        let [of_pairs, on_obstacles] = self.memory.each_mut();
        PairList {
            lower: &mut self.lower,
            partner: &mut self.partner,
            spring: self.spring.each_mut().map(|s| &mut s[..]),
            memory: memory_columns(of_pairs.iter_mut().map(|w| &mut w[..])),
            obstacle_contact_grain: &mut self.obstacle_contact_grain,
            obstacle_contact_obstacle: &mut self.obstacle_contact_obstacle,
            obstacle_contact_spring: &mut self.obstacle_contact_spring,
            obstacle_contact_memory: memory_columns(on_obstacles.iter_mut().map(|w| &mut w[..])),
        }
    }
}

/// Position, velocity and spin of a grain, with its radius and masses.
pub type Seen<R> = [Row<R>; 3];

/// The rows of one grain that only its owner needs: force, torque and crossings.
pub type Inner<R> = (Row<R>, Row<R>, [i32; 3]);

/// Own grains and ghosts, in one order of ids.
pub struct Part<R> {
    /// Place of each grain in the whole world.
    pub home: Vec<u32>,
    /// Where runs of own grains begin and end.
    pub owned: Vec<u32>,
    /// Position, velocity and spin of each grain.
    pub position: Vec<Row<R>>,
    pub velocity: Vec<Row<R>>,
    pub spin: Vec<Row<R>>,
    pub force: Vec<Row<R>>,
    pub torque: Vec<Row<R>>,
    pub image: Vec<[i32; 3]>,
    pub obstacles: Vec<Obstacle<R>>,
    /// What each listed obstacle contact took from the force on its obstacle.
    pub shares: Vec<ObstacleShare<R>>,
    /// Histories that wait for the first list, in places of the whole world.
    pub histories: Vec<KeptContact<R>>,
    pub clock: Clock<R>,
    id: Vec<u32>,
    group: Vec<u8>,
    lists: [List<R>; 2],
    stretch_words: Vec<u32>,
    stretch_numbers: Vec<R>,
    candidate_row: Vec<u32>,
    candidate: Vec<u32>,
    cell_start: Vec<u32>,
    cell_grain: Vec<u32>,
}

impl<R: Real> Part<R> {
    /// A part without grains, with room for all pairs of so many, of a world with this clock.
    pub fn new(grains: usize, obstacles: &[Obstacle<R>], clock: &Clock<R>) -> Self {
        let surfaces = obstacles.iter().map(|body| body.shape.surfaces() as usize);
        let (pairs, contacts) = (grains * grains / 2, grains * surfaces.sum::<usize>());
        let stretches = grains / 8 + 1;
        Self {
            home: Vec::new(),
            owned: vec![0, 0],
            position: Vec::new(),
            velocity: Vec::new(),
            spin: Vec::new(),
            force: Vec::new(),
            torque: Vec::new(),
            image: Vec::new(),
            obstacles: obstacles.to_vec(),
            shares: Vec::new(),
            histories: Vec::new(),
            clock: *clock,
            id: Vec::new(),
            group: Vec::new(),
            lists: [0; 2].map(|_| List::new(pairs, contacts)),
            stretch_words: vec![0; stretches * (4 + NEIGHBORS) + 2],
            stretch_numbers: vec![R::ZERO; 3 * stretches],
            candidate_row: Vec::new(),
            candidate: vec![0; pairs],
            cell_start: vec![0; 2 * grains + 2],
            cell_grain: vec![0; grains],
        }
    }

    pub fn world<'p>(&'p mut self, frame: &'p Frame<R>) -> World<'p, R> {
        let [pairs, spare] = &mut self.lists;
        World {
            domain: &frame.domain,
            dt: frame.dt,
            skin: frame.skin,
            outer_skin: frame.outer_skin,
            owned: &self.owned,
            policy: frame.policy,
            grains: Grains {
                id: &mut self.id,
                group: &mut self.group,
                groups: &frame.groups,
                position: &mut self.position,
                velocity: &mut self.velocity,
                spin: &mut self.spin,
                force: &mut self.force,
                torque: &mut self.torque,
                image: &mut self.image,
            },
            obstacles: &mut self.obstacles,
            facets: &frame.facets,
            pairs: pairs.lend(),
            spare: spare.lend(),
            stretches: StretchList::new(&mut self.stretch_words, &mut self.stretch_numbers),
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

    /// Puts grains in the place of those that it has: their places in the whole world, and their rows.
    pub fn settle(
        &mut self,
        frame: &Frame<R>,
        number: u8,
        home: Vec<u32>,
        rows: impl Fn(usize) -> (Seen<R>, Inner<R>),
    ) {
        let all: Vec<_> = home.iter().map(|place| rows(*place as usize)).collect();
        self.position = all.iter().map(|one| one.0[0]).collect();
        self.velocity = all.iter().map(|one| one.0[1]).collect();
        self.spin = all.iter().map(|one| one.0[2]).collect();
        self.force = all.iter().map(|one| one.1.0).collect();
        self.torque = all.iter().map(|one| one.1.1).collect();
        self.image = all.iter().map(|one| one.1.2).collect();
        self.id = home.iter().map(|k| frame.id[*k as usize]).collect();
        self.group = home.iter().map(|k| frame.group[*k as usize]).collect();
        self.candidate_row.resize(home.len() + 1, 0);
        self.owned.clear();
        let mut before = false;
        for (place, k) in home.iter().enumerate() {
            let own = frame.owner[*k as usize] == number;
            if own != before {
                self.owned.push(place as u32);
            }
            before = own;
        }
        if before {
            self.owned.push(home.len() as u32);
        }
        if self.owned.is_empty() {
            // Without bounds all would be own.
            self.owned = vec![0, 0];
        }
        self.home = home;
    }

    /// Places of the own grains.
    pub fn own(&self) -> impl Iterator<Item = usize> + use<R> {
        let runs: Vec<[u32; 2]> = self.owned.as_chunks().0.to_vec();
        runs.into_iter()
            .flat_map(|[from, to]| from as usize..to as usize)
    }

    /// Place in this part of a grain of the whole world.
    pub fn place_of(&self, home: u32) -> Option<u32> {
        self.home
            .binary_search(&home)
            .ok()
            .map(|place| place as u32)
    }

    /// The rows that all parts may see.
    pub fn seen(&self, place: usize) -> Seen<R> {
        [self.position[place], self.velocity[place], self.spin[place]]
    }

    /// The rows that others do not need.
    pub fn inner(&self, place: usize) -> Inner<R> {
        (self.force[place], self.torque[place], self.image[place])
    }
}
