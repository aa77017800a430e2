//! Cells: which of them a grain lies in, and which are beside each other.

use crate::math::real::{Real, larger, smaller};
use crate::math::rows::Row;
use crate::state::domain::Domain;

/// How coordinates become cells.
pub(crate) struct Grid<R> {
    lo: [R; 3],
    hi: [R; 3],
    per_length: [R; 3],
    pub(crate) count: [usize; 3],
    periodic: [bool; 3],
}

impl<R: Real> Grid<R> {
    /// Cells of at least `width`, as many as `capacity` allows. Periodic axes span the box, others the grains; if that
    /// takes too many cells, most of the grains: the cells at the ends hold those beyond too.
    pub(crate) fn new(domain: &Domain<R>, position: &[Row<R>], width: R, capacity: usize) -> Self {
        let periodic = domain.periodic();
        let mut lo = domain.lo();
        let mut hi = domain.hi();
        for a in 0..3 {
            if !periodic[a] {
                (lo[a], hi[a]) = (R::MAX, -R::MAX);
                for x in position {
                    lo[a] = smaller(lo[a], x[a]);
                    hi[a] = larger(hi[a], x[a]);
                }
            }
        }
        let mut width = width;
        // Whether it may help to leave out strays.
        let mut trims = true;
        loop {
            let mut count = [1usize; 3];
            let mut per_length = [R::ZERO; 3];
            for a in 0..3 {
                let length = hi[a] - lo[a];
                let fit = (length / width).to_index().clamp(1, 1 << 20);
                count[a] = fit;
                if length > R::ZERO {
                    per_length[a] = R::from_count(fit as u32) / length;
                }
            }
            let cells = count.iter().fold(1usize, |n, &c| n.saturating_mul(c));
            if cells <= capacity {
                return Self {
                    lo,
                    hi,
                    per_length,
                    count,
                    periodic,
                };
            }
            if trims {
                trims = false;
                for a in (0..3).filter(|a| !periodic[*a]) {
                    trims |= trim(position, a, &mut lo[a], &mut hi[a]);
                }
            }
            if !trims {
                width = width + width * R::HALF;
            }
        }
    }

    /// The cell of a grain. Along each axis it does not descend with the place, and two places no further apart than
    /// the width of a cell have the same cell or two beside each other, also beyond the ends.
    pub(crate) fn place(&self, x: &Row<R>) -> [usize; 3] {
        let mut cell = [0; 3];
        for a in 0..3 {
            let within = smaller(larger(x[a], self.lo[a]), self.hi[a]);
            let k = ((within - self.lo[a]) * self.per_length[a]).to_index();
            cell[a] = k.min(self.count[a] - 1);
        }
        cell
    }

    pub(crate) fn number(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.count[1] + cell[1]) * self.count[0] + cell[0]
    }

    /// The cells next to `k` along axis `a`, itself included, each once.
    pub(crate) fn around(&self, a: usize, k: usize) -> ([usize; 3], usize) {
        let n = self.count[a];
        if n <= 3 && (self.periodic[a] || n < 3) {
            return ([0, 1, 2], n);
        }
        if self.periodic[a] {
            let before = if k > 0 { k - 1 } else { n - 1 };
            let after = if k + 1 < n { k + 1 } else { 0 };
            return ([before, k, after], 3);
        }
        let first = k.saturating_sub(1);
        let last = (k + 1).min(n - 1);
        ([first, first + 1, first + 2], last - first + 1)
    }
}

/// Draws the ends of an axis in while at most a 32nd of the grains is beyond either; returns whether it did. The range
/// is cut in 16 parts, so that a few calls are enough however far a stray is.
fn trim<R: Real>(position: &[Row<R>], a: usize, lo: &mut R, hi: &mut R) -> bool {
    const PARTS: usize = 16;
    let strays = position.len() / 32;
    // Halves, so that the difference of the two ends is a number.
    let part = (*hi * R::HALF - *lo * R::HALF) / R::from_count(PARTS as u32 / 2);
    let spread = part > R::ZERO;
    if !spread {
        return false;
    }
    let mut within = [0usize; PARTS];
    for x in position {
        let k = ((x[a] - *lo) / part).to_index().min(PARTS - 1);
        if let Some(count) = within.get_mut(k) {
            *count += 1;
        }
    }
    let sparse = |parts: &mut dyn Iterator<Item = &usize>| {
        let mut beyond = 0;
        let few = parts.take_while(|count| {
            beyond += **count;
            beyond <= strays
        });
        R::from_count(few.count() as u32)
    };
    let below = sparse(&mut within.iter());
    let above = sparse(&mut within.iter().rev());
    let (first, last) = (*lo + part * below, *hi - part * above);
    let draws = (below > R::ZERO || above > R::ZERO) && first < last;
    if draws {
        (*lo, *hi) = (first, last);
    }
    draws
}
