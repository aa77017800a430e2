//! Contacts counted by the parts that have them, on their threads.

use rayon::prelude::*;

use super::Parts;
use super::part::Part;
use crate::contact_count::{ContactCount, Places, count_pairs};
use crate::owned_world::OwnedWorld;
use crate::threads::threads;
use bitgrain_kernel::phases::Owned;

impl Parts {
    /// Counts contacts, if they are with parts and all of those are in this process.
    pub fn count_contacts(&self, home: &OwnedWorld<f64>) -> Option<ContactCount> {
        let here = self.away && self.elsewhere.is_none();
        let crew = self.crew.as_ref().filter(|_| here)?;
        let whole = Places {
            domain: &home.domain,
            position: &home.position,
        };
        let mut parts = crew.parts();
        let mut parts: Vec<&mut Part> = parts.iter_mut().map(|part| &mut ***part).collect();
        let count = |part: &mut &mut Part| part.count_contacts(whole);
        let found: Vec<_> = match threads() {
            1 => parts.iter_mut().map(count).collect(),
            _ => parts.par_iter_mut().map(count).collect(),
        };
        let mut all = ContactCount {
            contacts: vec![0; home.position.len()],
            deepest: 0.0,
        };
        for (deepest, own) in found {
            if deepest > all.deepest {
                all.deepest = deepest;
            }
            for (place, count) in own {
                all.contacts[place as usize] = count;
            }
        }
        for (place, _) in &self.gathered.touching {
            all.contacts[*place as usize] += 1;
        }
        Some(all)
    }
}

impl Part {
    /// The deepest overlap, and the pairs of each own grain, by its place in the whole world: a pair of two parts is
    /// listed in both.
    fn count_contacts(&mut self, whole: Places<'_>) -> (f64, Vec<(u32, u32)>) {
        let home = self.ghosts.home();
        let runs = self.world.owned.clone();
        let owned = Owned::new(&runs);
        let count = count_pairs(&self.world.world(), |k| home[k as usize], whole);
        let all = home.iter().copied().zip(count.contacts).enumerate();
        let own = all.filter(|(place, _)| owned.has(*place));
        (count.deepest, own.map(|(_, one)| one).collect())
    }
}
