//! A world of the kernel and everything that it borrows, owned.

use std::sync::Arc;

use bitgrain_kernel::{
    CellList, Clock, Domain, Error as KernelError, Facet, Grains, Group, LossPolicy, Obstacle,
    OuterList, Real, Row, World,
};

use crate::lists::{Grown, List, Stretches};

/// Most pairs, candidates and obstacle contacts for each grain, on the average: grains beside each other have ten.
const PAIRS_MAX: usize = 256;

/// And so many more: all pairs of a few hundred grains.
const PAIRS_FREE: usize = 65_536;

/// A world and everything it borrows.
#[derive(Clone, Debug)]
pub struct OwnedWorld<R> {
    /// The box.
    pub domain: Domain<R>,
    /// Time step.
    pub dt: R,
    /// How far beyond touching pairs are listed (length): speed only, never a bit.
    pub skin: R,
    /// How far beyond the skin pairs are candidates for the list (length): speed only, never a bit.
    pub outer_skin: R,
    /// Names of the grains, ascending.
    pub id: Vec<u32>,
    /// Group of each grain.
    pub group: Vec<u8>,
    /// The groups.
    pub groups: Vec<Group<R>>,
    /// Positions and radii.
    pub position: Vec<Row<R>>,
    /// Velocities and masses.
    pub velocity: Vec<Row<R>>,
    /// Spins and inverse contact masses.
    pub spin: Vec<Row<R>>,
    /// Contact forces of the last evaluation.
    pub force: Vec<Row<R>>,
    /// Contact torques.
    pub torque: Vec<Row<R>>,
    /// Crossings of the periodic axes.
    pub image: Vec<[i32; 3]>,
    /// Obstacles by number.
    pub obstacles: Vec<Obstacle<R>>,
    /// The triangles of all meshes; see [`crate::mesh::add_mesh`].
    pub facets: Arc<Vec<Facet<R>>>,
    /// The pair list, and storage for the next one; of a [`Simulation`](crate::simulation::Simulation) on threads, see
    /// there.
    pub lists: [List<R>; 2],
    /// Stretches of grains that renew their pairs together.
    pub stretches: Stretches<R>,
    /// What becomes of grains that leave.
    pub policy: LossPolicy<R>,
    /// Where runs of own grains begin and end, by turns; empty if all are own.
    pub owned: Vec<u32>,
    /// Where the candidates of each grain end.
    pub candidate_row: Vec<u32>,
    /// The candidates.
    pub candidate: Vec<u32>,
    /// Where the grains of each cell begin.
    pub cell_start: Vec<u32>,
    /// The grains by cells.
    pub cell_grain: Vec<u32>,
    /// Time, and how long the list holds.
    pub clock: Clock<R>,
}

impl<R: Real> OwnedWorld<R> {
    /// A world without grains and without storage for lists.
    pub fn new(domain: Domain<R>, dt: R) -> Self {
        Self {
            domain,
            dt,
            skin: R::ZERO,
            outer_skin: R::ZERO,
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
            facets: Arc::default(),
            lists: [List::default(), List::default()],
            stretches: Stretches::default(),
            policy: LossPolicy::STOP,
            owned: Vec::new(),
            candidate_row: Vec::new(),
            candidate: Vec::new(),
            cell_start: Vec::new(),
            cell_grain: Vec::new(),
            clock: Clock::default(),
        }
    }

    /// Adds a grain at rest in its forces; its radius is the fourth word of the position, its mass of the velocity.
    pub fn add(&mut self, id: u32, group: u8, position: Row<R>, velocity: Row<R>, spin: [R; 3]) {
        self.id.push(id);
        self.group.push(group);
        self.position.push(position);
        self.velocity.push(velocity);
        self.spin.push([spin[0], spin[1], spin[2], R::ZERO]);
        self.force.push([R::ZERO; 4]);
        self.torque.push([R::ZERO; 4]);
        self.image.push([0; 3]);
    }

    /// Makes so many rows, new ones empty.
    pub(crate) fn set_rows(&mut self, count: usize) {
        self.id.resize(count, 0);
        self.group.resize(count, 0);
        self.position.resize(count, [R::ZERO; 4]);
        self.velocity.resize(count, [R::ZERO; 4]);
        self.spin.resize(count, [R::ZERO; 4]);
        self.force.resize(count, [R::ZERO; 4]);
        self.torque.resize(count, [R::ZERO; 4]);
        self.image.resize(count, [0; 3]);
    }

    /// Places of own grains, where runs of them are noted.
    pub(crate) fn owned_places(&self) -> impl Iterator<Item = u32> + '_ {
        let runs = self.owned.chunks_exact(2);
        runs.flat_map(|run| run[0]..run[1])
    }

    /// Fits cells and candidates to the number of grains.
    pub(crate) fn fit_search(&mut self) {
        let n = self.id.len();
        self.cell_start.resize(2 * n + 64, 0);
        self.cell_grain.resize(n, 0);
        self.candidate_row.resize(n + 1, 0);
    }

    /// Runs `act`, enlarging the lists as often as it finds them full: capacity affects no result. Lists that would
    /// be longer than bodies beside each other can make them, or than there is memory for, stay full.
    ///
    /// # Errors
    /// That of `act`.
    pub(crate) fn while_full<T>(
        &mut self,
        mut act: impl FnMut(&mut Self) -> Result<T, KernelError>,
    ) -> Result<T, KernelError> {
        loop {
            match act(self) {
                Err(full) if self.make_room(full) => (),
                done => return done,
            }
        }
    }

    /// Enlarges the list that a call found full, by more than it needed; `false` of other errors and if that is too
    /// much.
    pub(crate) fn make_room(&mut self, full: KernelError) -> bool {
        let most = self.id.len().saturating_mul(PAIRS_MAX);
        let most = most.saturating_add(PAIRS_FREE);
        let needed = needed(full).filter(|needed| needed.iter().all(|entries| *entries <= most));
        needed.is_some_and(|needed| {
            let [pairs, candidates, touches] = needed.map(|entries| entries + entries / 8);
            self.reserve(pairs, candidates, touches).is_ok()
        })
    }

    /// Enlarges the list that a call found full, or lists less in it: with skins of a tenth of the smallest radius at
    /// most, and then with none. `false` of other errors, and if it is full without skins. Not for a part of a world,
    /// since all parts have the same.
    pub(crate) fn fit_lists(&mut self, full: KernelError) -> bool {
        if self.make_room(full) {
            return true;
        }
        let is_wider = |least: R| self.skin > least || self.outer_skin > least;
        if needed(full).is_none() || !is_wider(R::ZERO) {
            return false;
        }
        let tenth = self.clock.radius_min() * R::from_f64(0.1);
        let narrower = if is_wider(tenth) { tenth } else { R::ZERO };
        (self.skin, self.outer_skin) = (R::ZERO, narrower);
        true
    }

    /// Makes lists of at least this many entries.
    ///
    /// # Errors
    /// If there is no memory for them; what is longer stays longer.
    pub fn reserve(&mut self, pairs: usize, candidates: usize, touches: usize) -> Grown {
        let more = candidates.saturating_sub(self.candidate.len());
        self.candidate.try_reserve(more)?;
        self.candidate.resize(self.candidate.len() + more, 0);
        self.lists
            .iter_mut()
            .try_for_each(|list| list.reserve(pairs, touches))
    }

    /// How many words of the law of each contact there is room for.
    pub(crate) fn words(&self) -> usize {
        self.lists[0].words()
    }

    /// Makes room for so many words of the law of each contact: [`AnyLaw::words`](crate::law::AnyLaw::words).
    ///
    /// # Errors
    /// As [`OwnedWorld::reserve`].
    pub fn keep_words(&mut self, words: usize) -> Grown {
        self.lists
            .iter_mut()
            .try_for_each(|list| list.keep_words(words))
    }

    /// Enlarges the list that a call found full; `false` of other errors and if there is no memory for it.
    pub fn grow(&mut self, error: KernelError) -> bool {
        needed(error).is_some_and(|[pairs, candidates, touches]| {
            self.reserve(pairs, candidates, touches).is_ok()
        })
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        self.id.len() * (5 * size_of::<Row<R>>() + 4 + 1 + 12)
            + 4 * (self.cell_start.len() + self.cell_grain.len())
            + 4 * (self.candidate_row.len() + self.candidate.len())
            + self.lists.iter().map(List::bytes).sum::<usize>()
            + self.stretches.bytes()
            + self.facets.len() * size_of::<Facet<R>>()
    }

    /// Lends everything as a world of the kernel.
    pub fn world(&mut self) -> World<'_, R> {
        self.stretches.fit(self.position.len());
        let [first, second] = &mut self.lists;
        World {
            domain: &self.domain,
            dt: self.dt,
            skin: self.skin,
            outer_skin: self.outer_skin,
            owned: &self.owned,
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
            facets: &self.facets,
            pairs: first.lend(),
            spare: second.lend(),
            stretches: self.stretches.lend(),
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

/// Pairs, candidates and obstacle contacts that a call found no room for; none of another error.
fn needed(full: KernelError) -> Option<[usize; 3]> {
    match full {
        KernelError::PairListFull { needed } => Some([needed, 0, 0]),
        KernelError::OuterListFull { needed } => Some([0, needed, 0]),
        KernelError::ObstacleContactsFull { needed } => Some([0, 0, needed]),
        _ => None,
    }
}
