//! Which grains a part has and which it shows to others: found anew at each search.

use bitgrain_kernel::parts::{GONE, GhostMotion, renumber};
use bitgrain_kernel::phases::Extent;
use bitgrain_kernel::{ContactHistory, Domain, KeptContact, Row};

use crate::histories::Histories;

use super::exchange::Exchange;
use super::letter::{Letter, Offer};
use super::rows::Rows;
use crate::owned_world::OwnedWorld;
use crate::pass::Fallible;

/// The grains of a part among those of the whole world, and between parts.
pub(super) struct Ghosts {
    /// The number of the part.
    number: usize,
    /// Place in the whole world of each grain of the part, ascending.
    home: Vec<u32>,
    /// Places of own grains whose rows go to each other part, ascending.
    sent: Vec<Vec<u32>>,
    /// Places of the ghosts whose rows come from each other part, ascending.
    received: Vec<Vec<u32>>,
    /// Of each part, before the search.
    pub extents: Vec<Extent<f64>>,
    scratch: Scratch,
}

/// Lists that are made anew at each search, in the same memory.
#[derive(Default)]
struct Scratch {
    /// Place in the whole world, part and number among what it offers, of each ghost that arrives.
    arriving: Vec<(u32, usize, usize)>,
    /// The new place of each grain.
    table: Vec<u32>,
    home: Vec<u32>,
    rows: Rows,
    /// The part that each grain comes from.
    source: Vec<usize>,
}

impl Ghosts {
    /// Of a part that owns grains at these places of the whole world, and has no ghosts yet, among so many parts.
    pub fn none(number: usize, home: Vec<u32>, parts: usize) -> Self {
        Self {
            number,
            home,
            sent: vec![Vec::new(); parts],
            received: vec![Vec::new(); parts],
            extents: Vec::new(),
            scratch: Scratch::default(),
        }
    }

    /// How many parts there are.
    pub fn parts(&self) -> usize {
        self.sent.len()
    }

    /// Place in the whole world of each grain.
    pub fn home(&self) -> &[u32] {
        &self.home
    }

    /// Places of the ghosts of another part.
    pub fn received(&self, from: usize) -> &[u32] {
        &self.received[from]
    }

    /// The extent of all parts.
    pub fn extent(&self) -> Extent<f64> {
        let all = self.extents.iter().copied().reduce(Extent::and);
        all.expect("there are parts")
    }

    /// Histories in places of the part; [`u32::MAX`] of a grain that it does not have.
    pub fn here(&self, histories: &Histories) -> impl Iterator<Item = KeptContact<f64>> {
        let place = |home: u32| {
            let found = self.home.binary_search(&home);
            found.map_or(u32::MAX, |place| place as u32)
        };
        histories.iter().map(move |mut contact| {
            match &mut contact.history {
                ContactHistory::Pair { i, j, .. } => (*i, *j) = (place(*i), place(*j)),
                ContactHistory::Obstacle { i, .. } => *i = place(*i),
            }
            contact
        })
    }

    /// Writes the rows of own grains for each part that has them as ghosts; none if they have not moved.
    pub fn write_rows(
        &self,
        world: &OwnedWorld<f64>,
        moved: bool,
        rows: &mut Vec<Vec<GhostMotion<f64>>>,
    ) {
        rows.resize_with(self.parts(), Vec::new);
        for (rows, places) in rows.iter_mut().zip(&self.sent) {
            rows.clear();
            if moved {
                rows.extend(places.iter().map(|place| motion(world, *place as usize)));
            }
        }
    }

    /// Chooses the own grains that may come near another part before the next search, by the extents of all parts.
    pub fn choose(&mut self, world: &OwnedWorld<f64>) {
        let all = self.extent();
        let far = 2.0 * all.radius + world.skin.max(0.0) + world.outer_skin;
        // Far more than what the search adds for rounding.
        let far = far + 1e-11 * (far + all.largest + all.reach);
        let own = self.extents[self.number];
        for (to, places) in self.sent.iter_mut().enumerate() {
            places.clear();
            let other = &self.extents[to];
            let gap = gap2(&world.domain, (own.lo, own.hi), other);
            if to == self.number || gap > far * far {
                continue;
            }
            let near = |place: &u32| {
                let [x, y, z, _] = world.position[*place as usize];
                gap2(&world.domain, ([x, y, z], [x, y, z]), other) <= far * far
            };
            places.extend(world.owned_places().filter(near));
        }
    }

    /// Writes what was chosen for each part.
    pub fn write_offers(&self, world: &OwnedWorld<f64>, offers: &mut Vec<Vec<Offer>>) {
        offers.resize_with(self.parts(), Vec::new);
        for (offers, places) in offers.iter_mut().zip(&self.sent) {
            offers.clear();
            offers.extend(places.iter().map(|place| {
                let place = *place as usize;
                Offer {
                    home: self.home[place],
                    id: world.id[place],
                    group: world.group[place],
                    rows: [
                        world.position[place],
                        world.velocity[place],
                        world.spin[place],
                    ],
                }
            }));
        }
    }

    /// Takes the ghosts that are offered in the place of those that there were; own grains stay. All keep the histories
    /// of their contacts.
    pub fn take(
        &mut self,
        world: &mut OwnedWorld<f64>,
        letters: &Exchange<Letter>,
    ) -> Fallible<()> {
        let Scratch {
            arriving,
            table,
            home,
            rows,
            ..
        } = &mut self.scratch;
        arriving.clear();
        for (from, received) in self.received.iter_mut().enumerate() {
            received.clear();
            if from != self.number {
                let offers = &letters.read(self.number, from).offers[self.number];
                let numbered = offers.iter().enumerate();
                arriving.extend(numbered.map(|(k, offer)| (offer.home, from, k)));
            }
        }
        arriving.sort_unstable();
        table.clear();
        table.resize(self.home.len(), GONE);
        home.clear();
        rows.clear();
        let mut ghosts = arriving.iter().peekable();
        let mut own = world.owned_places().peekable();
        let mut old = 0;
        loop {
            let next_own = own.peek().map(|place| self.home[*place as usize]);
            let next_ghost = ghosts.peek().map(|(home, ..)| *home);
            let Some(next) = next_own.into_iter().chain(next_ghost).min() else {
                break;
            };
            let place = home.len() as u32;
            home.push(next);
            while old < table.len() && self.home[old] < next {
                old += 1;
            }
            if old < table.len() && self.home[old] == next {
                table[old] = place;
            }
            if let Some((_, from, k)) = ghosts.next_if(|(home, ..)| *home == next) {
                self.received[*from].push(place);
                let letter = letters.read(self.number, *from);
                let offer = &letter.offers[self.number][*k];
                rows.add_ghost(offer.id, offer.group, offer.rows);
            } else if let Some(place) = own.next() {
                rows.add_own(world, place as usize);
            }
        }
        rows.end();
        drop(own);
        for places in &mut self.sent {
            for place in places {
                *place = table[*place as usize];
            }
        }
        renumber(&mut world.world(), table, home.len())?;
        rows.swap_with(world);
        std::mem::swap(&mut self.home, home);
        Ok(())
    }

    /// Keeps, of the ghosts here and of own grains sent elsewhere, those that the search made candidates. Both sides
    /// have the same candidates of two parts, so each knows what the other one keeps. The other ghosts stay in their
    /// rows, but nothing comes near them before the next search.
    pub fn trim(&mut self, world: &OwnedWorld<f64>) {
        const OWN: usize = usize::MAX;
        let source = &mut self.scratch.source;
        source.clear();
        source.resize(self.home.len(), OWN);
        for (from, places) in self.received.iter_mut().enumerate() {
            for place in places.drain(..) {
                source[place as usize] = from;
            }
        }
        self.sent.iter_mut().for_each(Vec::clear);
        for i in 0..self.home.len() {
            let row = world.candidate_row[i] as usize..world.candidate_row[i + 1] as usize;
            for j in &world.candidate[row] {
                let (i, j) = (i as u32, *j);
                let (own, ghost, part) = match (source[i as usize], source[j as usize]) {
                    (OWN, OWN) => continue,
                    (OWN, part) => (i, j, part),
                    (part, _) => (j, i, part),
                };
                self.sent[part].push(own);
                self.received[part].push(ghost);
            }
        }
        for places in self.sent.iter_mut().chain(&mut self.received) {
            places.sort_unstable();
            places.dedup();
        }
    }
}

fn motion(world: &OwnedWorld<f64>, place: usize) -> GhostMotion<f64> {
    let rows = [&world.position, &world.velocity, &world.spin];
    rows.map(|rows: &Vec<Row<f64>>| {
        let [x, y, z, _] = rows[place];
        [x, y, z]
    })
}

/// The square of the least distance between a box and the box of a part, the nearest images of both.
fn gap2(domain: &Domain<f64>, (lo, hi): ([f64; 3], [f64; 3]), other: &Extent<f64>) -> f64 {
    let [edge_lo, edge_hi] = [domain.lo(), domain.hi()];
    let mut sum = 0.0;
    for a in 0..3 {
        let mut gap = (other.lo[a] - hi[a]).max(lo[a] - other.hi[a]);
        if domain.periodic()[a] {
            let period = edge_hi[a] - edge_lo[a];
            gap = gap.min(other.lo[a] - hi[a] + period);
            gap = gap.min(lo[a] - other.hi[a] + period);
        }
        let gap = gap.max(0.0);
        sum += gap * gap;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_go_round_periodic_sides() {
        let domain = Domain::new([0.0; 3], [10.0; 3], [true, false, false]).unwrap();
        let other = Extent {
            lo: [8.0, 8.0, 1.0],
            hi: [9.0, 9.0, 2.0],
            largest: 9.0,
            radius: 0.5,
            least: 0.5,
            reach: 1.0,
        };
        let gap = |x: [f64; 3]| gap2(&domain, (x, x), &other);
        assert_eq!(gap([8.5, 8.5, 1.5]), 0.0, "within");
        assert_eq!(gap([5.0, 8.5, 1.5]), 9.0, "below");
        assert_eq!(gap([1.0, 8.5, 1.5]), 4.0, "round the edge: 11 - 9");
        assert_eq!(gap([9.5, 8.5, 1.5]), 0.25, "above");
        assert_eq!(gap([8.5, 1.0, 1.5]), 49.0, "not round a closed side");
        assert_eq!(gap([5.0, 5.0, 1.5]), 18.0);
    }
}
