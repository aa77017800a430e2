//! Steps on several threads: a world is cut into parts, each a world by itself with copies of the grains beside it.
//! Nothing here can change a result, only when it comes; but a
//! force on an obstacle that is not finite is found at the end of a call, and not in its step.
//!
//! The data flow of a step, for each part: `hear` (what all found, where ghosts are now) -> renew old pairs -> forces,
//! sums and motion of own grains -> `tell` (what it found, where its grains at the border are now). A part waits for
//! the letters of the others and for nothing else (`exchange`); any thread drives any part (`crew`). Before a
//! search the parts agree on how far they reach and offer each other ghosts (`ghosts`). Rows come home to the whole
//! world at the end of each call, and contacts only if someone asks for them.

mod channels;
mod crew;
mod cut;
mod exchange;
mod ghosts;
mod helpers;
mod home;
mod letter;
mod part;
mod post;
mod ranks;
mod report;
mod rows;
mod seed;
mod service;
mod share;
mod survey;
mod sync;

use std::fmt;
use std::sync::Arc;

use bitgrain_kernel::Clock;

use crate::isa::Isa;
use crate::law::AnyLaw;
use crate::notes::Taken;
use crate::owned_world::OwnedWorld;
use crate::pass::Fallible;
use crew::Crew;
use helpers::Helpers;
use part::{End, Errand};
use service::{Departure, Elsewhere};

pub use channels::{Channels, on_ranks};
pub use ranks::{Carrier, LAUNCHED, Message, Ranks, Sharing, alone, silence};
pub use service::{dismiss, peaks, serve};

/// How parts step.
#[derive(Clone)]
pub(crate) struct Settings {
    pub law: AnyLaw,
    pub registers: Isa,
    pub tunes: bool,
    /// Processes that share the world.
    pub ranks: Option<Arc<Ranks>>,
    /// How grains are given to parts.
    pub cutting: Cutting,
}

/// How grains are given to parts: speed only, never a bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cutting {
    /// By planes where few pairs cross, so that all parts take the same time.
    #[default]
    Planes,
    /// Any grain to any part, as a number says, and otherwise at each search: the worst there is, for tests.
    Scattered(u64),
}

/// The parts of a world, from one call to the next.
#[derive(Default)]
pub(crate) struct Parts {
    crew: Option<Arc<Crew>>,
    /// The parts that other processes have.
    elsewhere: Option<Elsewhere>,
    helpers: Arc<Helpers>,
    /// The part of each grain.
    owner: Vec<u16>,
    /// What each part is to have of all grains.
    fractions: Vec<f64>,
    /// The clock of the whole world as it was left: another one is of a world that was changed.
    mark: Option<Clock<f64>>,
    /// Whether contacts are with the parts alone.
    away: bool,
    /// Searches and renewals of the first part that the clock of the whole world has.
    counted: [u64; 2],
    gathered: Gathered,
}

/// What all parts told when they last came home.
#[derive(Default)]
struct Gathered {
    /// Grains and the obstacles that they touch, by grain.
    touching: Vec<(u32, u32)>,
    /// Pairs and obstacle contacts that are listed, pairs of two parts twice, and bytes that the parts hold.
    listed: [usize; 3],
    /// Seconds of work of each since the last cut.
    busy: Vec<f64>,
}

impl fmt::Debug for Parts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Parts")
            .field("count", &self.count())
            .field("fractions", &self.fractions)
            .finish_non_exhaustive()
    }
}

impl Parts {
    /// How many there are; none before the first call.
    pub fn count(&self) -> usize {
        self.crew.as_ref().map_or(0, |_| self.fractions.len())
    }

    /// Whether they are those of a world with this clock.
    pub fn fit(&self, clock: &Clock<f64>) -> bool {
        let with_its_step = |mut mark: Clock<f64>| {
            mark.step = clock.step;
            mark
        };
        self.mark.map(with_its_step) == Some(*clock)
    }

    /// Notes that the clock was changed and the world was not.
    pub fn note(&mut self, clock: &Clock<f64>) {
        self.mark = Some(*clock);
    }

    /// Advances a world that has begun to step `last`, in so many parts.
    ///
    /// # Errors
    /// What stopped a step; the world has no state then.
    pub fn steps(
        &mut self,
        home: &mut OwnedWorld<f64>,
        settings: &Settings,
        (count, last): (usize, u64),
        mut notes: Option<&mut Taken>,
    ) -> Fallible<()> {
        if self.count() != count || !self.fit(&home.clock) {
            self.come_home(home)?;
            let histories = home.world().kept_contacts().collect();
            // Two sets of parts at once would take twice the memory.
            self.leave();
            self.enter(home, settings, count, histories);
        }
        let mut searches = false;
        loop {
            let crew = Arc::clone(self.crew.as_ref().expect("it was entered"));
            let departure = Departure {
                errand: Errand {
                    law: settings.law.clone(),
                    last,
                    registers: settings.registers,
                    tunes: settings.tunes,
                    recuts: settings.tunes,
                    recuts_always: settings.cutting != Cutting::Planes,
                },
                searches,
                step: home.clock.step,
                obstacles: home.obstacles.clone(),
                policy: home.policy,
                skins: [home.skin, home.outer_skin],
                watch: notes.as_ref().map(|taken| taken.watch.clone()),
            };
            if let Some(elsewhere) = &self.elsewhere {
                elsewhere.depart(&departure);
            }
            departure.prepare(&crew);
            self.helpers.ask(&crew);
            // Should a thread panic, the whole world is stopped and the parts are gone.
            self.crew = None;
            home.clock.stop();
            crew.work(rayon::current_thread_index().unwrap_or_default());
            self.helpers.dismiss();
            self.crew = Some(Arc::clone(&crew));
            let end = self.gather(home, &crew, notes.as_deref_mut());
            match end {
                End::Recut => {
                    let histories = self.histories(&crew);
                    self.adjust(settings);
                    drop(crew);
                    self.leave();
                    self.enter(home, settings, count, histories);
                    searches = true;
                }
                End::Reached => return Ok(()),
                End::Fault(fault) => return Err(fault),
            }
        }
    }

    /// Lets go of the parts.
    fn leave(&mut self) {
        self.crew = None;
        self.elsewhere = None;
    }
}
