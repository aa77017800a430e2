//! What a part brings home from its way, beside the rows of its grains, and its contacts if they are wanted.

use bitgrain_kernel::parts::{listed_obstacle_contacts, listed_pairs};
use bitgrain_kernel::phases::Owned;
use bitgrain_kernel::{Clock, ContactHistory, KeptContact, Obstacle};
use serde::{Deserialize, Serialize};

use super::part::{End, Part};
use super::share::{Share, is_free};
use crate::histories::Histories;
use crate::notes::Notebook;

/// What a part brings home.
#[derive(Serialize, Deserialize)]
pub(super) struct Report {
    pub end: End,
    pub clock: Clock<f64>,
    /// Skin and reach.
    pub skins: [f64; 2],
    pub obstacles: Vec<Obstacle<f64>>,
    /// Whether it summed forces since the last cut.
    pub has_summed: bool,
    /// What each listed obstacle contact took from its obstacle in the last step.
    pub shares: Vec<Share>,
    /// Seconds of work since the last cut.
    pub busy: f64,
    pub notes: Option<Notebook>,
    /// Pairs and obstacle contacts that are listed, and bytes that the part holds.
    pub listed: [usize; 3],
}

/// Contacts in places of the whole world.
#[derive(Serialize, Deserialize)]
pub(super) struct PartContacts {
    /// Listed pairs whose lower grain is own.
    pub pairs: Histories,
    /// Listed obstacle contacts; the word of the obstacle has the touching bit.
    pub touches: Histories,
}

impl Part {
    /// What it brings home at the end of its way; notes are handed over.
    pub fn report(&mut self) -> Report {
        let contacts = self.world.clock.obstacle_contacts();
        Report {
            end: self.end().expect("it has ended"),
            clock: self.world.clock,
            skins: [self.world.skin, self.world.outer_skin],
            obstacles: self.world.obstacles.clone(),
            has_summed: self.has_summed,
            shares: self.listed_shares().collect(),
            busy: self.busy.as_secs_f64(),
            listed: [self.world.clock.listed(), contacts, self.world.bytes()],
            notes: self.notes.take(),
        }
    }

    /// Its contacts.
    pub fn contacts(&mut self) -> PartContacts {
        let home = self.ghosts.home();
        let runs = self.world.owned.clone();
        let owned = Owned::new(&runs);
        let world = self.world.world();
        let touches = listed_obstacle_contacts(&world).map(|(grain, word, kept)| KeptContact {
            history: ContactHistory::Obstacle {
                i: home[grain as usize],
                obstacle: word,
                spring: kept.spring,
            },
            memory: kept.memory,
        });
        let touches = touches.collect();
        let pairs = listed_pairs(&world).filter(|(i, ..)| owned.has(*i as usize));
        let pairs = pairs.map(|(i, j, kept)| KeptContact {
            history: ContactHistory::Pair {
                i: home[i as usize],
                j: home[j as usize],
                spring: kept.spring,
            },
            memory: kept.memory,
        });
        PartContacts {
            pairs: pairs.collect(),
            touches,
        }
    }
}

impl Part {
    /// The listed obstacle contacts, with what each took from its obstacle in the last step.
    pub(super) fn listed_shares(&self) -> impl Iterator<Item = Share> + '_ {
        let (home, list) = (self.ghosts.home(), &self.world.lists[0]);
        let listed = list
            .obstacle_contact_grain
            .iter()
            .zip(&list.obstacle_contact_obstacle);
        let listed = listed.take(self.world.clock.obstacle_contacts());
        listed.enumerate().map(|(t, (grain, word))| Share {
            grain: home[*grain as usize],
            word: *word,
            share: self.shares.get(t).copied().unwrap_or_default(),
        })
    }

    /// Whether an obstacle moves freely.
    pub(super) fn has_free(&self) -> bool {
        self.world.obstacles.iter().any(is_free)
    }

    /// Writes what own grains take from obstacles that move freely over an old list.
    pub(super) fn write_pushes(&self, pushes: &mut Vec<Share>) {
        pushes.clear();
        if self.has_free() {
            let touching = |share: &Share| {
                let body = share.touched().map(|k| &self.world.obstacles[k as usize]);
                body.is_some_and(is_free)
            };
            pushes.extend(self.listed_shares().filter(touching));
        }
    }
}
