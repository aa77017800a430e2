//! The lists that an owned world lends to the kernel, and how they grow.

use std::collections::TryReserveError;

use bitgrain_kernel::{PairList, Real, Row};

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
    pub touch_grain: Vec<u32>,
    /// The obstacles.
    pub touch_obstacle: Vec<u32>,
    /// Springs on obstacles.
    pub touch_spring: Vec<Row<R>>,
}

/// Makes a list at least so long.
fn lengthen<T: Clone>(list: &mut Vec<T>, least: usize, with: T) -> Grown {
    reserve(list, least)?;
    if list.len() < least {
        list.resize(least, with);
    }
    Ok(())
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
        lengthen(&mut self.touch_grain, touches, 0)?;
        lengthen(&mut self.touch_obstacle, touches, 0)?;
        lengthen(&mut self.touch_spring, touches, [R::ZERO; 4])
    }

    /// Lends it to the kernel.
    pub fn lend(&mut self) -> PairList<'_, R> {
        PairList {
            lower: &mut self.lower,
            partner: &mut self.partner,
            spring: self.spring.each_mut().map(|s| &mut s[..]),
            touch_grain: &mut self.touch_grain,
            touch_obstacle: &mut self.touch_obstacle,
            touch_spring: &mut self.touch_spring,
        }
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let springs: usize = self.spring.iter().map(Vec::capacity).sum();
        4 * (self.lower.capacity() + self.partner.capacity() + 2 * self.touch_grain.capacity())
            + size_of::<R>() * springs
            + size_of::<Row<R>>() * self.touch_spring.capacity()
    }
}
