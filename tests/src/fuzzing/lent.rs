//! Everything that a world borrows, owned, with every slice as long as it happens to be.

use bitgrain_kernel::{
    CellList, Clock, Digest, Domain, Error as KernelError, Grains, Group, Obstacle, OuterList,
    PairList, Real, Row, World, digest,
};

/// Storage of one list.
#[derive(Clone, Default)]
pub(super) struct List<R> {
    pub lower: Vec<u32>,
    pub partner: Vec<u32>,
    pub spring: [Vec<R>; 3],
    pub touch_grain: Vec<u32>,
    pub touch_obstacle: Vec<u32>,
    pub touch_spring: Vec<Row<R>>,
}

impl<R: Real> List<R> {
    fn reserve(&mut self, pairs: usize, touches: usize) {
        lengthen(&mut self.lower, pairs);
        lengthen(&mut self.partner, pairs);
        for component in &mut self.spring {
            lengthen(component, pairs);
        }
        lengthen(&mut self.touch_grain, touches);
        lengthen(&mut self.touch_obstacle, touches);
        lengthen(&mut self.touch_spring, touches);
    }

    fn lend(&mut self) -> PairList<'_, R> {
        PairList {
            lower: &mut self.lower,
            partner: &mut self.partner,
            spring: self.spring.each_mut().map(|s| &mut s[..]),
            touch_grain: &mut self.touch_grain,
            touch_obstacle: &mut self.touch_obstacle,
            touch_spring: &mut self.touch_spring,
        }
    }
}

fn lengthen<T: Clone + Default>(entries: &mut Vec<T>, least: usize) {
    if entries.len() < least {
        entries.resize(least, T::default());
    }
}

/// A world's storage.
#[derive(Clone)]
pub(super) struct Lent<R> {
    pub domain: Domain<R>,
    pub dt: R,
    pub skin: R,
    pub reach: R,
    pub range_bounds: Vec<u32>,
    pub id: Vec<u32>,
    pub group: Vec<u8>,
    pub groups: Vec<Group<R>>,
    pub position: Vec<Row<R>>,
    pub velocity: Vec<Row<R>>,
    pub spin: Vec<Row<R>>,
    pub force: Vec<Row<R>>,
    pub torque: Vec<Row<R>>,
    pub image: Vec<[i32; 3]>,
    pub obstacles: Vec<Obstacle<R>>,
    pub lists: [List<R>; 2],
    pub candidate_row: Vec<u32>,
    pub candidate: Vec<u32>,
    pub cell_start: Vec<u32>,
    pub cell_grain: Vec<u32>,
    pub clock: Clock<R>,
}

impl<R: Real> Lent<R> {
    /// No grains and no storage yet.
    pub fn new(domain: Domain<R>, dt: R) -> Self {
        Self {
            domain,
            dt,
            skin: R::ZERO,
            reach: R::ZERO,
            range_bounds: vec![],
            id: vec![],
            group: vec![],
            groups: vec![],
            position: vec![],
            velocity: vec![],
            spin: vec![],
            force: vec![],
            torque: vec![],
            image: vec![],
            obstacles: vec![],
            lists: [List::default(), List::default()],
            candidate_row: vec![],
            candidate: vec![],
            cell_start: vec![],
            cell_grain: vec![],
            clock: Clock::default(),
        }
    }

    /// Adds a grain, named by its place.
    pub fn add(&mut self, group: u8, position: Row<R>, velocity: Row<R>, spin: [R; 3]) {
        self.id.push(3 * self.id.len() as u32 + 1);
        self.group.push(group);
        self.position.push(position);
        self.velocity.push(velocity);
        self.spin.push([spin[0], spin[1], spin[2], R::ZERO]);
        self.force.push([R::ZERO; 4]);
        self.torque.push([R::ZERO; 4]);
        self.image.push([0; 3]);
    }

    /// Gives the grains that were added their cells, and lists of at least so many entries.
    pub fn reserve(&mut self, pairs: usize, candidates: usize, touches: usize) {
        let n = self.position.len();
        lengthen(&mut self.cell_start, 2);
        lengthen(&mut self.cell_grain, n);
        lengthen(&mut self.candidate_row, n + 1);
        lengthen(&mut self.candidate, candidates);
        for list in &mut self.lists {
            list.reserve(pairs, touches);
        }
    }

    /// Room for whatever these grains and obstacles can list.
    pub fn reserve_all(&mut self) {
        let n = self.position.len();
        let touches = n * self.obstacles.len();
        self.reserve(n * n / 2, n * n / 2, touches);
    }

    /// Makes room where a list is full; whether one was.
    pub fn grow(&mut self, fault: KernelError) -> bool {
        match fault {
            KernelError::PairListFull { needed } => self.reserve(needed, 0, 0),
            KernelError::OuterListFull { needed } => self.reserve(0, needed, 0),
            KernelError::ObstacleContactsFull { needed } => self.reserve(0, 0, needed),
            _ => return false,
        }
        true
    }

    pub fn world(&mut self) -> World<'_, R> {
        let [first, second] = &mut self.lists;
        World {
            domain: &self.domain,
            dt: self.dt,
            skin: self.skin,
            reach: self.reach,
            range_bounds: &self.range_bounds,
            grains: Grains {
                id: &self.id,
                group: &self.group,
                groups: &self.groups,
                position: &mut self.position,
                velocity: &mut self.velocity,
                spin: &mut self.spin,
                force: &mut self.force,
                torque: &mut self.torque,
                image: &mut self.image,
            },
            obstacles: &mut self.obstacles,
            pairs: first.lend(),
            spare: second.lend(),
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

/// Does something, with more room as often as a list proves full, which must leave everything as it was.
pub(super) fn growing<R: Real>(
    lent: &mut Lent<R>,
    mut act: impl FnMut(&mut Lent<R>) -> Result<(), KernelError>,
) -> Result<(), KernelError> {
    loop {
        let before = told(lent);
        let done = act(lent);
        match done {
            Err(fault) if lent.grow(fault) => {
                assert_eq!(told(lent), before, "{fault} changes something");
            }
            _ => return done,
        }
    }
}

/// What a full list must not change.
pub(super) fn told<R: Real>(lent: &mut Lent<R>) -> (Digest, u64) {
    (digest(&lent.world()), lent.clock.step)
}
