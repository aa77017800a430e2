//! Sums that are the same in any order: over threads, over workers, over files that come as they come.
//!
//! A sum of floats depends on its order. Here each number is rounded once, to a multiple of `2^-64`, and the sum of
//! these is an integer of 128 bits. Series and means of a run are summed in the order of steps and need none of it.

use fixed::types::I64F64;

/// An exact sum of numbers, each a multiple of `2^-64` below 9e18 in magnitude.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExactSum(I64F64);

/// What an [`ExactSum`] does not hold: a number that is not finite, or a sum beyond 9e18.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a number or a sum is beyond 9e18: sum it in larger units")]
pub struct TooLarge;

impl ExactSum {
    /// Adds a number, rounded to the nearest multiple of `2^-64` (5e-20).
    ///
    /// # Errors
    /// [`TooLarge`]; the sum is as it was.
    pub fn add(&mut self, number: f64) -> Result<(), TooLarge> {
        let number = I64F64::checked_from_num(number).ok_or(TooLarge)?;
        self.0 = self.0.checked_add(number).ok_or(TooLarge)?;
        Ok(())
    }

    /// Adds the sum of another worker.
    ///
    /// # Errors
    /// [`TooLarge`]; the sum is as it was.
    pub fn merge(&mut self, other: Self) -> Result<(), TooLarge> {
        self.0 = self.0.checked_add(other.0).ok_or(TooLarge)?;
        Ok(())
    }

    /// The sum, rounded once.
    pub fn value(&self) -> f64 {
        self.0.to_num()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(numbers: impl Iterator<Item = f64>) -> f64 {
        let mut sum = ExactSum::default();
        numbers.for_each(|x| sum.add(x).unwrap());
        sum.value()
    }

    /// Forces of a thousand grains, as many workers would sum them.
    #[test]
    fn any_order_and_any_parts_give_one_sum() {
        let force = |k: u32| (f64::from(k) * 0.37).sin() * 1e3 / f64::from(k % 17 + 1);
        let numbers: Vec<f64> = (1..1000).map(force).collect();
        let forward: f64 = numbers.iter().sum();
        let backward: f64 = numbers.iter().rev().sum();
        assert_ne!(forward, backward, "floats depend on the order");
        let sum = exact(numbers.iter().copied());
        assert_eq!(sum, exact(numbers.iter().rev().copied()));
        assert!((sum - forward).abs() < 1e-9);
        for workers in [2, 3, 7] {
            let mut whole = ExactSum::default();
            for first in (0..workers).rev() {
                let mut own = ExactSum::default();
                let part = numbers.iter().skip(first).step_by(workers);
                part.for_each(|x| own.add(*x).unwrap());
                whole.merge(own).unwrap();
            }
            assert_eq!(whole.value(), sum);
        }
    }

    #[test]
    fn what_it_does_not_hold_is_refused() {
        let mut sum = ExactSum::default();
        sum.add(9e18).unwrap();
        for wrong in [f64::NAN, f64::INFINITY, 1e19, 9e18] {
            assert_eq!(sum.add(wrong), Err(TooLarge), "{wrong}");
        }
        assert_eq!(sum.merge(sum), Err(TooLarge));
        assert_eq!(sum.value(), 9e18);
    }
}
