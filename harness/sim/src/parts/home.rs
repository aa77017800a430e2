//! From the whole world to its parts and back.

use std::sync::Arc;

use bitgrain_kernel::parts::take_lists;
use bitgrain_kernel::phases::sum_on_obstacles;
use bitgrain_kernel::{ContactHistory, Error as KernelError, KeptContact, Obstacle, TOUCHING};

use super::crew::Crew;
use super::cut::{cut, fairer};
use super::part::{End, Errand, Part};
use super::report::{PartContacts, Report};
use super::seed::Seed;
use super::service::Elsewhere;
use super::{Cutting, Gathered, Parts, Settings};
use crate::histories::Histories;
use crate::notes::{Taken, by_grain, join};
use crate::owned_world::OwnedWorld;
use crate::pass::Fallible;
use crate::threads::{RowsFrom, each};

impl Parts {
    /// Cuts a world into so many parts, with histories in its own places.
    pub(super) fn enter(
        &mut self,
        home: &OwnedWorld<f64>,
        settings: &Settings,
        count: usize,
        histories: Histories,
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
        let mut places = vec![Vec::new(); count];
        for (place, owner) in self.owner.iter().enumerate() {
            places[usize::from(*owner)].push(place as u32);
        }
        let seeds = places.into_iter().map(|places| Seed::of(home, places));
        let mut seeds: Vec<Seed> = seeds.collect();
        let owner = |place: u32| usize::from(self.owner[place as usize]);
        for contact in histories.iter() {
            let first = owner(lower(&contact.history));
            seeds[first].histories.push(contact);
            if let ContactHistory::Pair { j, .. } = contact.history
                && owner(j) != first
            {
                seeds[owner(j)].histories.push(contact);
            }
        }
        self.counted = [0; 2];
        let mut post = None;
        if let Some(ranks) = &settings.ranks {
            let (elsewhere, staying) = Elsewhere::share_out(ranks, &settings.law, seeds);
            post = Some(elsewhere.post());
            self.elsewhere = Some(elsewhere);
            seeds = staying;
        }
        let errand = Errand::none(&settings.law);
        let numbered = seeds.into_iter().enumerate();
        let parts = numbered.map(|(number, seed)| seed.grow(number, count, &errand));
        self.crew = Some(Arc::new(Crew::new(parts.collect(), 0, count, post)));
    }

    /// Takes the rows of all grains home, the sums on obstacles, the clock and the notes; contacts stay with the parts.
    /// Returns how the parts ended.
    pub(super) fn gather(
        &mut self,
        home: &mut OwnedWorld<f64>,
        crew: &Crew,
        notes: Option<&mut Taken>,
    ) -> End {
        let mut reports: Vec<Report> = crew.parts().iter_mut().map(|part| part.report()).collect();
        bring_all(home, crew);
        if let Some(elsewhere) = &self.elsewhere {
            reports.extend(elsewhere.reports(home));
        }
        let first = &reports[0];
        home.obstacles.clone_from(&first.obstacles);
        [home.skin, home.outer_skin] = first.skins;
        let now = [first.clock.outer_list_rebuilds(), first.clock.prunes()];
        home.clock.rejoin(
            &first.clock,
            now[0] - self.counted[0],
            now[1] - self.counted[1],
        );
        self.counted = now;
        let mut end = first.end;
        let shares = by_grain(reports.iter().map(|one| &one.shares), |share| share.grain);
        // Before, the sums are those of the last step of the whole world.
        if reports.iter().all(|report| report.has_summed) {
            let in_order = shares.iter().map(|share| share.share);
            sum_on_obstacles(&mut home.obstacles, in_order);
        }
        // Of finite shares, a sum that is not finite is found here, and not in the step that made it.
        if end == End::Reached
            && let Some(obstacle) = unsound(&home.obstacles)
        {
            home.clock.stop();
            end = End::Fault(KernelError::ObstacleNotFinite { obstacle });
        }
        if let Some(taken) = notes {
            let books = reports.iter_mut().filter_map(|one| one.notes.take());
            taken
                .notes
                .extend(join(taken.watch, books, home.clock.step));
        }
        let touching = shares
            .iter()
            .filter_map(|share| Some((share.grain, share.touched()?)));
        let sum = |k: usize| reports.iter().map(|report| report.listed[k]).sum();
        self.gathered = Gathered {
            touching: touching.collect(),
            listed: [sum(0), sum(1), sum(2)],
            busy: reports.iter().map(|report| report.busy).collect(),
        };
        self.away = true;
        self.mark = Some(home.clock);
        end
    }

    /// Gives the next cut fairer fractions, by the times that parts took.
    pub(super) fn adjust(&mut self, settings: &Settings) {
        if settings.cutting == Cutting::Planes {
            self.fractions = fairer(&self.fractions, &self.gathered.busy);
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
        let (pairs, contacts) = self.contacts(crew);
        let both = |contact: KeptContact<f64>| {
            let kept = contact.kept();
            match contact.history {
                ContactHistory::Pair { i, j, .. } => (i, j, kept),
                ContactHistory::Obstacle { i, obstacle, .. } => (i, obstacle, kept),
            }
        };
        home.while_full(|home| {
            let (pairs, contacts) = (pairs.iter().map(both), contacts.iter().map(both));
            take_lists(&mut home.world(), pairs, contacts)
        })
    }

    /// Places of the grains that touch an obstacle, ascending, once for each surface, if contacts are with the parts.
    pub fn touching(&self, obstacle: u32) -> Option<Vec<u32>> {
        let touching = self.gathered.touching.iter();
        let touching = touching.filter(|(_, of)| *of == obstacle);
        self.away
            .then(|| touching.map(|(grain, _)| *grain).collect())
    }

    /// Pairs and obstacle contacts that are listed, if contacts are with the parts; pairs of two parts twice.
    pub fn listed(&self) -> Option<(usize, usize)> {
        let [pairs, contacts, _] = self.gathered.listed;
        self.away.then_some((pairs, contacts))
    }

    /// Bytes that the parts hold, wherever they are.
    pub fn bytes(&self) -> usize {
        self.crew.as_ref().map_or(0, |_| self.gathered.listed[2])
    }

    /// Histories of touching contacts in places of the whole world.
    pub(super) fn histories(&self, crew: &Crew) -> Histories {
        let (pairs, contacts) = self.contacts(crew);
        let contacts = contacts.iter().filter_map(|mut contact| {
            let ContactHistory::Obstacle { obstacle, .. } = &mut contact.history else {
                return None;
            };
            let touches = *obstacle & TOUCHING != 0;
            *obstacle &= !TOUCHING;
            touches.then_some(contact)
        });
        let pairs = pairs.iter().filter(|contact| contact.kept().is_any());
        pairs.chain(contacts).collect()
    }

    /// The listed pairs of the whole world with their histories, those of a grain as its own part lists them; and all
    /// listed obstacle contacts, in order.
    fn contacts(&self, crew: &Crew) -> (Histories, Histories) {
        let mut all: Vec<PartContacts> = crew
            .parts()
            .iter_mut()
            .map(|part| part.contacts())
            .collect();
        if let Some(elsewhere) = &self.elsewhere {
            all.extend(elsewhere.contacts());
        }
        let mut touches: Vec<_> = all.iter().flat_map(|part| part.touches.iter()).collect();
        touches.sort_by_key(|contact| lower(&contact.history));
        let own = all.iter().map(|part| part.pairs.iter().peekable());
        let mut own: Vec<_> = own.collect();
        let mut pairs = Histories::default();
        for (owner, i) in self.owner.iter().zip(0u32..) {
            let own = &mut own[usize::from(*owner)];
            while let Some(pair) = own.next_if(|pair| lower(&pair.history) == i) {
                pairs.push(pair);
            }
        }
        (pairs, touches.into_iter().collect())
    }
}

/// The grain of a contact, the lower one of two.
fn lower(history: &ContactHistory<f64>) -> u32 {
    let (ContactHistory::Pair { i, .. } | ContactHistory::Obstacle { i, .. }) = history;
    *i
}

/// The first obstacle whose force or torque is not finite.
fn unsound(obstacles: &[Obstacle<f64>]) -> Option<u32> {
    let sums = |body: &Obstacle<f64>| [body.force, body.torque].concat();
    let is_unsound = |body: &Obstacle<f64>| !sums(body).iter().all(|x| x.is_finite());
    let first = obstacles.iter().position(is_unsound);
    first.map(|k| k as u32)
}

/// What each grain costs: about as much as a pair, which belongs to both of its grains.
fn work_of(grains: usize, histories: &Histories) -> Vec<f64> {
    let mut work = vec![1.0; grains];
    for history in histories.contacts() {
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

/// Copies the rows of all parts of a crew to the whole world, on as many threads.
fn bring_all(home: &mut OwnedWorld<f64>, crew: &Crew) {
    let parts = crew.parts();
    let from: Vec<&Part> = parts.iter().map(|part| &***part).collect();
    let mut world = home.world();
    let rows = RowsFrom(world.grain_motion(), 0);
    each(rows, parts.len(), &|rows| bring(rows, &from), &|(), ()| ());
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
