//! The lists that an owned world lends to the kernel, and how they grow.

use std::collections::TryReserveError;

use bitgrain_kernel::{NEIGHBORS, PairList, Real, Row, STRETCH, StretchList, memory_columns};

/// Whether there was memory for a longer list.
pub type Grown = Result<(), TryReserveError>;

/// Makes room in a list that is to be so long.
fn reserve<T>(list: &mut Vec<T>, length: usize) -> Grown {
    list.try_reserve(length.saturating_sub(list.len()))
}

/// A list of pairs and obstacle contacts with their springs, as the kernel borrows it.
#[derive(Clone, Debug, Default)]
pub struct List<R> {
    /// Places of the lower grains.
    pub lower: Vec<u32>,
    /// Places of their partners.
    pub partner: Vec<u32>,
    /// Springs of pairs, by components.
    pub spring: [Vec<R>; 3],
    /// Places of grains near obstacles.
    pub obstacle_contact_grain: Vec<u32>,
    /// The obstacles.
    pub obstacle_contact_obstacle: Vec<u32>,
    /// Springs on obstacles.
    pub obstacle_contact_spring: Vec<Row<R>>,
    /// Words of the law of pairs and of contacts with obstacles, a column for each word.
    pub memory: [Vec<Vec<R>>; 2],
}

/// Makes a list at least so long.
fn lengthen<T: Clone>(list: &mut Vec<T>, least: usize, with: T) -> Grown {
    reserve(list, least)?;
    if list.len() < least {
        list.resize(least, with);
    }
    Ok(())
}

/// Stretches of grains that renew their pairs together, as the kernel borrows them.
#[derive(Clone, Debug, Default)]
pub struct Stretches<R> {
    place: Vec<u32>,
    begin: Vec<u32>,
    pairs: Vec<u32>,
    touching: Vec<u32>,
    neighbor: Vec<u32>,
    budget: Vec<R>,
    travel: Vec<R>,
    approach: Vec<R>,
}

impl<R: Real> Stretches<R> {
    /// Makes at least as many as so many grains have, one at least.
    pub fn fit(&mut self, grains: usize) {
        let count = grains / STRETCH + 1;
        if count <= self.budget.len() {
            return;
        }
        self.place.resize(count + 1, 0);
        self.begin.resize(count + 1, 0);
        self.pairs.resize(count, 0);
        self.touching.resize(count, 0);
        self.neighbor.resize(count * NEIGHBORS, 0);
        self.budget.resize(count, R::ZERO);
        self.travel.resize(count, R::ZERO);
        self.approach.resize(count, R::ZERO);
    }

    /// Lends them to the kernel.
    pub fn lend(&mut self) -> StretchList<'_, R> {
        StretchList {
            place: &mut self.place,
            begin: &mut self.begin,
            pairs: &mut self.pairs,
            touching: &mut self.touching,
            neighbor: &mut self.neighbor,
            budget: &mut self.budget,
            travel: &mut self.travel,
            approach: &mut self.approach,
        }
    }

    /// Bytes that they hold.
    pub fn bytes(&self) -> usize {
        self.budget.len() * (4 * (4 + NEIGHBORS) + 3 * size_of::<R>())
    }
}

impl<R: Real> List<R> {
    /// Makes it at least so long.
    ///
    /// # Errors
    /// If there is no memory for that; what is longer stays longer.
    pub fn reserve(&mut self, pairs: usize, touches: usize) -> Grown {
        lengthen(&mut self.lower, pairs, 0)?;
        lengthen(&mut self.partner, pairs, 0)?;
        for component in &mut self.spring {
            lengthen(component, pairs, R::ZERO)?;
        }
        lengthen(&mut self.obstacle_contact_grain, touches, 0)?;
        lengthen(&mut self.obstacle_contact_obstacle, touches, 0)?;
        lengthen(&mut self.obstacle_contact_spring, touches, [R::ZERO; 4])?;
        self.fit_memory()
    }

    /// Makes room for so many words of the law of each contact.
    ///
    /// # Errors
    /// As [`List::reserve`].
    pub fn keep_words(&mut self, words: usize) -> Grown {
        for columns in &mut self.memory {
            columns.resize(words, Vec::new());
        }
        self.fit_memory()
    }

    /// How many words of each contact there is room for.
    pub fn words(&self) -> usize {
        self.memory[0].len()
    }

    /// Makes columns as long as the lists of their contacts.
    fn fit_memory(&mut self) -> Grown {
        let lengths = [self.lower.len(), self.obstacle_contact_grain.len()];
        for (columns, length) in self.memory.iter_mut().zip(lengths) {
            columns
                .iter_mut()
                .try_for_each(|word| lengthen(word, length, R::ZERO))?;
        }
        Ok(())
    }

    /// Lends it to the kernel.
    pub fn lend(&mut self) -> PairList<'_, R> {
        let [of_pairs, on_obstacles] = self.memory.each_mut();
        PairList {
            lower: &mut self.lower,
            partner: &mut self.partner,
            spring: self.spring.each_mut().map(|s| &mut s[..]),
            memory: memory_columns(of_pairs.iter_mut().map(|word| &mut word[..])),
            obstacle_contact_grain: &mut self.obstacle_contact_grain,
            obstacle_contact_obstacle: &mut self.obstacle_contact_obstacle,
            obstacle_contact_spring: &mut self.obstacle_contact_spring,
            obstacle_contact_memory: memory_columns(
                on_obstacles.iter_mut().map(|word| &mut word[..]),
            ),
        }
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let columns = self.spring.iter().chain(self.memory.iter().flatten());
        let columns: usize = columns.map(Vec::capacity).sum();
        4 * (self.lower.capacity()
            + self.partner.capacity()
            + 2 * self.obstacle_contact_grain.capacity())
            + size_of::<R>() * columns
            + size_of::<Row<R>>() * self.obstacle_contact_spring.capacity()
    }
}
