//! The lists that a simulation lends to the kernel, and how they grow.

use std::collections::TryReserveError;

use bitgrain_kernel::{PairList, Row};

/// Whether there was memory for a longer list.
pub(crate) type Grown = Result<(), TryReserveError>;

/// Makes room in a list that is to be so long.
pub(crate) fn reserve<T>(list: &mut Vec<T>, length: usize) -> Grown {
    list.try_reserve(length.saturating_sub(list.len()))
}

/// A list of pairs and obstacle contacts with their springs, as the kernel borrows it.
#[derive(Clone, Debug, Default)]
pub(crate) struct List {
    pub lower: Vec<u32>,
    pub partner: Vec<u32>,
    spring: [Vec<f64>; 3],
    pub touch_grain: Vec<u32>,
    pub touch_obstacle: Vec<u32>,
    touch_spring: Vec<Row<f64>>,
}

impl List {
    /// Makes it so long; where there is no memory for that it stays as it is.
    pub fn resize(&mut self, pairs: usize, touches: usize) -> Grown {
        reserve(&mut self.lower, pairs)?;
        reserve(&mut self.partner, pairs)?;
        for component in &mut self.spring {
            reserve(component, pairs)?;
        }
        reserve(&mut self.touch_grain, touches)?;
        reserve(&mut self.touch_obstacle, touches)?;
        reserve(&mut self.touch_spring, touches)?;
        self.lower.resize(pairs, 0);
        self.partner.resize(pairs, 0);
        for component in &mut self.spring {
            component.resize(pairs, 0.0);
        }
        self.touch_grain.resize(touches, 0);
        self.touch_obstacle.resize(touches, 0);
        self.touch_spring.resize(touches, [0.0; 4]);
        Ok(())
    }

    /// Lends it to the kernel.
    pub fn lend(&mut self) -> PairList<'_, f64> {
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
            + 8 * springs
            + 32 * self.touch_spring.capacity()
    }
}
