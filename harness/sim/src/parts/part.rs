//! A part of a world: its own grains, copies of those that may come near them, and its way through the steps.
//!
//! The way is made of legs. A leg begins when all other parts have answered the last letter, and ends with a letter. So
//! whoever finds a part whose letter is answered can do its next leg, and nobody waits within one.

use std::time::{Duration, Instant};

use bitgrain_kernel::contact::Law;
use bitgrain_kernel::parts::{is_search_due, restore, take_in};
use bitgrain_kernel::phases::{
    After, ObstacleShare, Owned, check_forces, drift, finish, is_draining, measure,
};
use bitgrain_kernel::{Error as KernelError, LossPolicy, check_arithmetic};
use serde::{Deserialize, Serialize};

use super::exchange::Exchange;
use super::ghosts::Ghosts;
use super::letter::{Found, Letter, Told};
use super::share::sum_on_free;
use crate::histories::Histories;
use crate::isa::Isa;
use crate::law::{AnyLaw, Sprung, WithLaw};
use crate::notes::Notebook;
use crate::owned_world::OwnedWorld;
use crate::pass::{Drift, Fallible, Forces, Renew, Search};
use crate::skin::Skin;

/// What the parts are to do.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Errand {
    /// The contact law.
    pub law: AnyLaw,
    /// The step to end at.
    pub last: u64,
    /// Instructions.
    pub registers: Isa,
    /// Whether skin and reach are adjusted.
    pub tunes: bool,
    /// Whether, at a search, parts that took unlike times are cut anew.
    pub recuts: bool,
    /// Whether parts are cut anew at every search.
    pub recuts_always: bool,
}

impl Errand {
    /// None, until a part is sent off.
    pub fn none(law: &AnyLaw) -> Self {
        Self {
            law: law.clone(),
            last: 0,
            registers: Isa::Plain,
            tunes: false,
            recuts: false,
            recuts_always: false,
        }
    }
}

/// How a part's way ended; all of them end alike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum End {
    /// At the last step, or before it because grains wait to be taken out.
    Reached,
    /// Before a search, so that the parts are cut anew.
    Recut,
    /// At a fault.
    Fault(KernelError),
}

/// The next leg of a part's way.
#[derive(Clone, Copy, PartialEq)]
enum Leg {
    /// To the drift that begins a step.
    Drift,
    /// On from there.
    Drifted,
    /// To a search, with the extent of all parts unknown.
    Measure,
    /// With the extent known, and ghosts to be offered.
    Measured,
    /// With ghosts offered.
    Offered,
    /// On from the forces of a step.
    Summed,
}

/// A part.
pub(super) struct Part {
    /// Its number.
    number: usize,
    /// Its grains, own ones and ghosts.
    pub world: OwnedWorld<f64>,
    pub ghosts: Ghosts,
    /// What each listed obstacle contact took from its obstacle in the last step.
    pub shares: Vec<ObstacleShare<f64>>,
    /// What the host wants to know of each step.
    pub notes: Option<Notebook>,
    /// Histories to be put in after the first search, in places of the whole world.
    pub histories: Histories,
    /// Time of work since the last cut.
    pub busy: Duration,
    /// Whether it did a search since the last cut, as then all parts did.
    has_searched: bool,
    /// Whether it summed forces since then.
    pub has_summed: bool,
    skin: Skin,
    errand: Errand,
    leg: Leg,
    end: Option<End>,
}

impl Part {
    /// The part of this number.
    pub fn new(number: usize, world: OwnedWorld<f64>, ghosts: Ghosts, errand: Errand) -> Self {
        Self {
            number,
            world,
            ghosts,
            shares: Vec::new(),
            notes: None,
            histories: Histories::default(),
            busy: Duration::ZERO,
            has_searched: false,
            has_summed: false,
            skin: Skin::default(),
            errand,
            leg: Leg::Drift,
            end: None,
        }
    }

    /// Makes it ready for an errand: before the drift of a step, or, cut anew, before a search.
    pub fn depart(&mut self, errand: &Errand, searches: bool) {
        self.errand = errand.clone();
        self.leg = if searches { Leg::Measure } else { Leg::Drift };
        self.end = None;
        self.find_watched();
    }

    /// Finds the watched grains after places were given.
    fn find_watched(&mut self) {
        let owned = Owned::new(&self.world.owned);
        let home = self.ghosts.home();
        if let Some(notes) = &mut self.notes {
            notes.find(|grain| {
                let place = home.binary_search(&grain).ok()?;
                owned.has(place).then_some(place as u32)
            });
        }
    }

    /// How its way ended, if it did.
    pub fn end(&self) -> Option<End> {
        self.end
    }

    /// Goes a leg; its last letter must be answered.
    pub fn advance(&mut self, exchange: &Exchange<Letter>) {
        let law = self.errand.law.clone();
        law.with(Advance {
            part: self,
            exchange,
        });
    }
}

/// A leg, whatever the law.
struct Advance<'a> {
    part: &'a mut Part,
    exchange: &'a Exchange<Letter>,
}

impl WithLaw for Advance<'_> {
    type Output = ();

    fn run<L: Law<f64> + Sprung>(self, law: &L) {
        let began = Instant::now();
        self.part.end = match self.part.go(law, self.exchange) {
            Ok(end) => end,
            Err(fault) => {
                self.part.world.clock.stop();
                Some(End::Fault(fault))
            }
        };
        self.part.busy += began.elapsed();
    }
}

type Letters = Exchange<Letter>;

impl Part {
    fn go<L: Law<f64>>(&mut self, law: &L, letters: &Letters) -> Fallible<Option<End>> {
        match self.leg {
            Leg::Drift => Ok(self.begin_step(letters)),
            Leg::Drifted => {
                let found = self.hear(letters)?;
                drift(&mut self.world.world(), found.motion)?;
                Ok(self.push(law, letters))
            }
            Leg::Measure => Ok(self.say_extent(letters)),
            Leg::Measured => Ok(self.offer(letters)),
            Leg::Offered => {
                let searched = self.search(letters);
                Ok(self.sum(law, letters, searched))
            }
            Leg::Summed => self.go_on(law, letters),
        }
    }

    /// What all parts found; the ghosts are where their parts have moved them.
    fn hear(&mut self, letters: &Letters) -> Fallible<Found> {
        let mut found = Found::NOTHING;
        for from in 0..self.ghosts.parts() {
            found = found.and(letters.read(self.number, from).found);
        }
        if let Some(fault) = found.alone {
            return Err(fault);
        }
        for from in 0..self.ghosts.parts() {
            let letter = letters.read(self.number, from);
            if from == 0 {
                [self.world.skin, self.world.outer_skin] = letter.skins;
            }
            let rows = &letter.rows[self.number];
            debug_assert!(rows.is_empty() || rows.len() == self.ghosts.received(from).len());
            take_in(&mut self.world.world(), self.ghosts.received(from), rows);
        }
        Ok(found)
    }

    /// Writes what this part found, and the rows of its grains that are ghosts elsewhere if they have moved.
    fn tell(&mut self, letters: &Letters, mut found: Found, moved: bool) {
        // Each thread has its own modes, and a library may change them at any time.
        found.alone = found.alone.or(check_arithmetic::<f64>().err());
        letters.write(self.number, |letter| {
            letter.told = Told::Found;
            letter.found = found;
            letter.skins = [self.world.skin, self.world.outer_skin];
            self.ghosts.write_rows(&self.world, moved, &mut letter.rows);
            self.write_pushes(&mut letter.pushes);
        });
    }

    /// Sums the forces on obstacles that move freely over all parts.
    fn sum_free(&mut self, letters: &Letters) {
        if self.has_free() {
            let all = 0..self.ghosts.parts();
            let all: Vec<_> = all.map(|from| letters.read(self.number, from)).collect();
            sum_on_free(
                &mut self.world.obstacles,
                all.iter().map(|letter| &letter.pushes),
            );
        }
    }

    fn begin_step(&mut self, letters: &Letters) -> Option<End> {
        let mut found = Found::NOTHING;
        found.motion = self.errand.registers.run(Drift(&mut self.world.world()));
        self.tell(letters, found, true);
        self.leg = Leg::Drifted;
        None
    }

    /// The forces of a step, after its drift; or what comes before a search.
    fn push<L: Law<f64>>(&mut self, law: &L, letters: &Letters) -> Option<End> {
        if is_search_due(&self.world.world()) {
            return self.say_extent(letters);
        }
        let registers = self.errand.registers;
        let renewed = self.listing(|part| {
            part.world
                .while_full(|world| registers.run(Renew(&mut world.world())))
        });
        self.sum(law, letters, renewed)
    }

    /// Makes the list of a step, and measures what that costs, in the part that decides over the skin.
    fn listing(&mut self, list: impl FnOnce(&mut Self) -> Fallible<()>) -> Fallible<()> {
        let (searches, began) = (self.world.clock.outer_list_rebuilds(), Instant::now());
        list(self)?;
        if self.errand.tunes && self.number == 0 {
            let mut world = self.world.world();
            self.skin.listed(&mut world, searches, began);
            (self.world.skin, self.world.outer_skin) = (world.skin, world.outer_skin);
        }
        Ok(())
    }

    fn say_extent(&mut self, letters: &Letters) -> Option<End> {
        let extent = measure(&self.world.world());
        letters.write(self.number, |letter| {
            letter.told = Told::Extent;
            letter.extent = Some(extent);
            letter.skins = [self.world.skin, self.world.outer_skin];
            letter.busy = self.busy.as_secs_f64();
            letter.grains = self.world.owned_places().count();
        });
        self.leg = Leg::Measured;
        None
    }

    /// Offers own grains near other parts to them; or ends here, if all are to be cut anew.
    fn offer(&mut self, letters: &Letters) -> Option<End> {
        let mut times = Times::default();
        self.ghosts.extents.clear();
        for from in 0..self.ghosts.parts() {
            let letter = letters.read(self.number, from);
            times.add(&letter);
            self.ghosts.extents.extend(letter.extent);
            if from == 0 {
                [self.world.skin, self.world.outer_skin] = letter.skins;
            }
        }
        // Before the first search the histories are not in the lists yet.
        let recuts = self.errand.recuts_always || self.errand.recuts && times.are_uneven();
        if recuts && self.has_searched {
            return Some(End::Recut);
        }
        self.ghosts.choose(&self.world);
        letters.write(self.number, |letter| {
            letter.told = Told::Offers;
            self.ghosts.write_offers(&self.world, &mut letter.offers);
        });
        self.leg = Leg::Offered;
        None
    }

    /// Takes the ghosts that are offered, and searches.
    fn search(&mut self, letters: &Letters) -> Fallible<()> {
        self.ghosts.take(&mut self.world, letters)?;
        let (extent, registers) = (self.ghosts.extent(), self.errand.registers);
        self.listing(|part| {
            part.world
                .while_full(|world| registers.run(Search(&mut world.world(), &extent)))
        })?;
        self.ghosts.trim(&self.world);
        self.find_watched();
        self.has_searched = true;
        let histories = std::mem::take(&mut self.histories);
        restore(&mut self.world.world(), self.ghosts.here(&histories))
    }

    /// Forces, sums and the motion that follows them.
    fn sum<L: Law<f64>>(
        &mut self,
        law: &L,
        letters: &Letters,
        listed: Fallible<()>,
    ) -> Option<End> {
        let mut found = Found::NOTHING;
        let mut moved = false;
        match listed {
            Err(fault) => found.alone = Some(fault),
            Ok(()) => {
                self.has_summed = true;
                let contacts = self.world.clock.obstacle_contacts();
                self.shares.resize(contacts, ObstacleShare::default());
                let is_last = self.world.clock.step + 1 == self.errand.last;
                // Grains that leave do so at the end of a step, before the next one moves any.
                moved = !is_last && self.world.policy == LossPolicy::STOP;
                let after = if moved {
                    After::FinishAndBegin
                } else {
                    After::Rest
                };
                let mut world = self.world.world();
                (found.forces, found.motion) = self.errand.registers.run(Forces {
                    world: &mut world,
                    law,
                    shares: &mut self.shares,
                    notes: self.notes.as_mut(),
                    after,
                });
                if let Some(notes) = &mut self.notes {
                    let home = self.ghosts.home();
                    notes.end(|place| home[place as usize]);
                }
                found.motion.draining = is_draining(&world);
                if self.errand.tunes && self.number == 0 {
                    self.skin.stepped(&mut world);
                }
                (self.world.skin, self.world.outer_skin) = (world.skin, world.outer_skin);
            }
        }
        self.tell(letters, found, moved);
        self.leg = Leg::Summed;
        None
    }

    /// Ends a step, and begins the next.
    fn go_on<L: Law<f64>>(&mut self, law: &L, letters: &Letters) -> Fallible<Option<End>> {
        let found = self.hear(letters)?;
        self.sum_free(letters);
        let mut world = self.world.world();
        check_forces(&mut world, found.forces)?;
        finish(&mut world, found.motion)?;
        if world.clock.is_losing() || world.clock.step >= self.errand.last {
            return Ok(Some(End::Reached));
        }
        if world.policy != LossPolicy::STOP {
            return Ok(self.begin_step(letters));
        }
        drift(&mut world, found.motion)?;
        Ok(self.push(law, letters))
    }
}

/// Seconds that a new cut costs for each grain: 3 ms for 10,000, measured.
const RECUT: f64 = 4e-7;

/// The least part of its time that a thread waits at which they are cut anew: less may be noise.
const UNEVEN: f64 = 0.01;

/// The times that parts took since they were cut.
#[derive(Default)]
struct Times {
    parts: f64,
    grains: f64,
    all: f64,
    most: f64,
}

impl Times {
    fn add(&mut self, letter: &Letter) {
        self.parts += 1.0;
        self.grains += letter.grains as f64;
        self.all += letter.busy;
        self.most = self.most.max(letter.busy);
    }

    /// Whether all have waited so long for one that it pays to cut anew.
    fn are_uneven(&self) -> bool {
        let lost = self.most - self.all / self.parts;
        lost > RECUT * self.grains && lost > UNEVEN * self.most
    }
}
