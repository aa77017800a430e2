//! How much room a world needs.

use crate::contact::kept::MEMORY_MAX;
use crate::neighbors::stretch::{NEIGHBORS, STRETCH};

/// How many bodies and list entries there is room for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Capacity {
    /// Grains.
    pub grains: usize,
    /// Pairs of grains in a list.
    pub pairs: usize,
    /// Candidates for the list.
    pub candidates: usize,
    /// Contacts of grains with obstacles in a list.
    pub obstacle_contacts: usize,
    /// Cells of the search, 1 at least.
    pub cells: usize,
    /// Obstacles.
    pub obstacles: usize,
    /// Groups, 256 at most.
    pub groups: usize,
    /// Words of a contact that the law keeps; see [`Law::MEMORY`](crate::contact::Law::MEMORY).
    pub memory: usize,
}

impl Capacity {
    /// Room for a bed of so many grains among so many obstacles, with 8 groups and a law that keeps no words:
    ///
    /// * pairs and candidates `8 grains + 64`. Balls of any sizes that do not overlap touch each other in fewer than
    ///   `(4 + 2 sqrt 3) grains = 7.46 grains` pairs (Kuperberg and Schramm, 1994). Grains of one size or nearly so
    ///   have at most 4.5 pairs each within a skin of a tenth of a diameter; wide distributions with a wide skin may
    ///   need more, and the error of a full list says how many;
    /// * obstacle contacts `2 grains + 64`: each grain touches two obstacles, as in a corner;
    /// * cells `2 grains + 64`.
    ///
    /// A host that knows its world better takes other numbers. Nothing but the memory depends on them.
    pub const fn for_bed(grains: usize, obstacles: usize) -> Self {
        Self {
            grains,
            pairs: grains.saturating_mul(8).saturating_add(64),
            candidates: grains.saturating_mul(8).saturating_add(64),
            obstacle_contacts: grains.saturating_mul(2).saturating_add(64),
            cells: grains.saturating_mul(2).saturating_add(64),
            obstacles,
            groups: 8,
            memory: 0,
        }
    }

    /// Stretches of grains that renew their pairs together: one for each 64 grains, and one more.
    pub const fn stretches(&self) -> usize {
        self.grains / STRETCH + 1
    }

    /// Numbers of the world's type that its rows, springs and words take: `20 grains + (6 + 2 memory) pairs +
    /// (8 + 2 memory) obstacle_contacts + 3 stretches`. `None` if that cannot be counted, or there are more than
    /// [`MEMORY_MAX`] words.
    pub const fn numbers(&self) -> Option<usize> {
        if self.memory > MEMORY_MAX {
            return None;
        }
        sum([
            (20, self.grains),
            (6 + 2 * self.memory, self.pairs),
            (8 + 2 * self.memory, self.obstacle_contacts),
            (3, self.stretches()),
        ])
    }

    /// Words of 32 bits that ids, lists and cells take: `3 grains + 4 pairs + candidates + 4 obstacle_contacts + cells
    /// + 32 stretches + 4`. `None` if that cannot be counted.
    pub const fn words(&self) -> Option<usize> {
        let lists = sum([
            (3, self.grains),
            (4, self.pairs),
            (1, self.candidates),
            (4, self.obstacle_contacts),
        ]);
        let others = sum([
            (1, self.cells),
            (4 + NEIGHBORS, self.stretches()),
            (1, 4),
            (0, 0),
        ]);
        match (lists, others) {
            (Some(lists), Some(others)) => lists.checked_add(others),
            _ => None,
        }
    }
}

/// The sum of some products.
const fn sum(terms: [(usize, usize); 4]) -> Option<usize> {
    let [a, b, c, d] = terms;
    let (Some(a), Some(b)) = (a.0.checked_mul(a.1), b.0.checked_mul(b.1)) else {
        return None;
    };
    let (Some(c), Some(d)) = (c.0.checked_mul(c.1), d.0.checked_mul(d.1)) else {
        return None;
    };
    match (a.checked_add(b), c.checked_add(d)) {
        (Some(one), Some(other)) => one.checked_add(other),
        _ => None,
    }
}
