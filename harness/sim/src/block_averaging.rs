//! Means of a fluctuating quantity and their standard errors, by block averaging.
//!
//! Values of neighbouring steps are alike, so their spread does not say how well the mean is
//! known; means over blocks longer than the memory do (Flyvbjerg and Petersen, J. Chem. Phys. 91, 461,
//! 1989). Blocks are doubled until `B^3 > 2 n (e_B / e_1)^4`, with `e_B` the error from blocks of `B`
//! base blocks and `n` base blocks in all: the length at which the errors of the estimate, too short a
//! block against too few blocks, balance (Wolff 2004; Lee et al., Phys. Rev. E 83, 066706, 2011). At
//! least eight blocks are left; if that is too few for the criterion the mean says so.

use serde::{Deserialize, Serialize};

/// Base blocks kept; twice as many are merged in pairs.
const KEPT: usize = 1024;

/// Fewest blocks that an error comes from.
pub const BLOCKS_MIN: usize = 8;

/// How errors are found, in a sentence for the files that hold some.
pub const METHOD: &str = "block averaging: blocks are doubled in length until \
    B^3 > 2 n (e_B/e_1)^4 (B base blocks in a block, n in all, e_B the error from such blocks), \
    eight blocks at least; converged says whether that was reached; block_length counts steps, for \
    contact_angle contacts, for new_contact_angle contacts that begin, for coordination and floating \
    grains of the samples, for moving and drift samples";

/// A mean over the averaging window with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mean {
    /// The mean over every value of the window.
    pub mean: f64,
    /// Standard error from the means of equal blocks of the window.
    pub standard_error: f64,
    /// How many blocks it came from.
    pub blocks: usize,
    /// Values in a block: steps; for what is sampled, contacts or grains.
    pub block_length: u64,
    /// Whether blocks as long as the criterion asks for were available. If not, the window is short
    /// for the quantity's memory, and the error is likely too small; or the quantity drifts, and the
    /// drift is counted as error.
    pub converged: bool,
}

/// Sums of a quantity, value by value, over all of them and over blocks whose number stays bounded.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockSums {
    values: u64,
    all: f64,
    /// Values in a base block.
    length: u64,
    /// Sums of whole base blocks.
    blocks: Vec<f64>,
    /// The block that is being filled.
    open: f64,
    open_values: u64,
}

impl BlockSums {
    /// Adds the next value.
    pub fn add(&mut self, value: f64) {
        self.length = self.length.max(1);
        self.all += value;
        self.values += 1;
        self.open += value;
        self.open_values += 1;
        if self.open_values == self.length {
            self.blocks.push(self.open);
            (self.open, self.open_values) = (0.0, 0);
        }
        if self.blocks.len() == 2 * KEPT {
            let pairs = self.blocks.as_chunks::<2>().0;
            self.blocks = pairs.iter().map(|[a, b]| a + b).collect();
            self.length *= 2;
        }
    }

    /// How many values were added.
    pub fn count(&self) -> u64 {
        self.values
    }

    /// The mean with its standard error, or `None` before sixteen values.
    pub fn mean(&self) -> Option<Mean> {
        if self.blocks.len() < 2 * BLOCKS_MIN {
            return None;
        }
        let n = self.blocks.len();
        let single = self.error(1);
        let mut size = 1;
        let mut converged = false;
        loop {
            let ratio = if single > 0.0 {
                self.error(size) / single
            } else {
                0.0
            };
            let squared = ratio * ratio;
            if (size * size * size) as f64 > 2.0 * n as f64 * squared * squared {
                converged = true;
                break;
            }
            if n / (2 * size) < BLOCKS_MIN {
                break;
            }
            size *= 2;
        }
        Some(Mean {
            mean: self.all / self.values as f64,
            standard_error: self.error(size),
            blocks: n / size,
            block_length: self.length * size as u64,
            converged,
        })
    }

    /// Standard error from the means of blocks of `size` base blocks; a rest is left out.
    fn error(&self, size: usize) -> f64 {
        let whole = self.blocks.chunks_exact(size);
        let values = self.length as f64 * size as f64;
        let means: Vec<f64> = whole.map(|b| b.iter().sum::<f64>() / values).collect();
        let count = means.len() as f64;
        let middle = means.iter().sum::<f64>() / count;
        let spread: f64 = means.iter().map(|m| (m - middle) * (m - middle)).sum();
        (spread / (count - 1.0) / count).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, uniforms};

    fn noise(k: u32) -> f64 {
        uniforms::<1>(3, Purpose::Shift, k)[0] - 0.5
    }

    /// Errors are right on the average: over 200 chains with this memory, the mean square of (mean less
    /// truth) over error, and how many were reported as long enough.
    fn coverage(memory: f64, steps: u32) -> (f64, usize) {
        let (mut square, mut converged) = (0.0, 0);
        for chain in 0..200 {
            let mut sums = BlockSums::default();
            let mut x = 0.0;
            for k in 0..steps {
                x = memory * x + noise(chain * steps + k);
                sums.add(x);
            }
            let mean = sums.mean().unwrap();
            let off = mean.mean / mean.standard_error;
            square += off * off / 200.0;
            converged += usize::from(mean.converged);
        }
        (square.sqrt(), converged)
    }

    #[test]
    fn errors_are_right_whatever_the_memory() {
        // The mean square of 200 is known to 5 %; errors from tens of blocks are some 10 % uncertain,
        // and those of remembering chains a little too small.
        let (independent, converged) = coverage(0.0, 4000);
        assert!((0.85..1.15).contains(&independent), "{independent}");
        assert!(converged > 190, "{converged}");
        let (short, converged) = coverage(0.9, 4000);
        assert!((0.85..1.25).contains(&short), "{short}");
        assert!(converged > 190, "{converged}");
        // The memory is a hundredth of the chain: the spread of single steps would be wrong by a factor of 14.
        let (long, _) = coverage(0.99, 10_000);
        assert!((0.85..1.4).contains(&long), "{long}");
    }

    /// Too short a chain is reported as such.
    #[test]
    fn a_memory_as_long_as_the_window_is_told() {
        let (_, converged) = coverage(0.999, 4000);
        assert!(converged < 60, "{converged}");
    }

    #[test]
    fn a_drift_is_told() {
        let mut sums = BlockSums::default();
        (0..3000).for_each(|k| sums.add(f64::from(k)));
        let mean = sums.mean().unwrap();
        assert!(!mean.converged && mean.blocks < 16, "{mean:?}");
        assert_eq!(mean.mean, 1499.5);
    }

    #[test]
    fn blocks_are_merged_in_order() {
        let mut sums = BlockSums::default();
        (0..10_000).for_each(|k| sums.add(f64::from(k % 7)));
        assert_eq!(sums.length, 8);
        let first: f64 = (0..8).map(|k| f64::from(k % 7)).sum();
        assert_eq!((sums.blocks[0], sums.blocks.len()), (first, 1250));
        assert!(BlockSums::default().mean().is_none());
    }
}
