//! An owned world as the fuzz bodies use it: with every slice as long as it happens to be.

use bitgrain::owned_world::OwnedWorld;
use bitgrain_kernel::{Digest, Error as KernelError, Real, Row, digest};

/// A world's storage.
pub(super) type Lent<R> = OwnedWorld<R>;

/// Adds a grain, named by its place.
pub(super) fn add<R: Real>(
    lent: &mut Lent<R>,
    group: u8,
    position: Row<R>,
    velocity: Row<R>,
    spin: [R; 3],
) {
    let id = 3 * lent.id.len() as u32 + 1;
    lent.add(id, group, position, velocity, spin);
}

/// Gives the grains that were added their cells, and lists of at least this many entries.
pub(super) fn reserve<R: Real>(
    lent: &mut Lent<R>,
    pairs: usize,
    candidates: usize,
    touches: usize,
) {
    let n = lent.position.len();
    let lengthen = |list: &mut Vec<u32>, least: usize| list.resize(list.len().max(least), 0);
    lengthen(&mut lent.cell_start, 2);
    lengthen(&mut lent.cell_grain, n);
    lengthen(&mut lent.candidate_row, n + 1);
    let made = lent.reserve(pairs, candidates, touches);
    made.expect("memory for a small world");
}

/// Room for everything that these grains and obstacles can list.
pub(super) fn reserve_all<R: Real>(lent: &mut Lent<R>) {
    let n = lent.position.len();
    let surfaces = lent.obstacles.iter().map(|body| body.shape.surfaces());
    let touches = n * surfaces.map(|count| count as usize).sum::<usize>();
    reserve(lent, n * n / 2, n * n / 2, touches);
}

/// Does something, with more room as often as a list proves full, which must leave everything as it was.
pub(super) fn growing<R: Real>(
    lent: &mut Lent<R>,
    mut act: impl FnMut(&mut Lent<R>) -> Result<(), KernelError>,
) -> Result<(), KernelError> {
    loop {
        let before = told(lent);
        let done = act(lent);
        match done {
            Err(fault) if lent.grow(fault) => {
                assert_eq!(told(lent), before, "{fault} changes something");
            }
            _ => return done,
        }
    }
}

/// What a full list must not change.
pub(super) fn told<R: Real>(lent: &mut Lent<R>) -> (Result<Digest, KernelError>, u64) {
    (digest(&lent.world()), lent.clock.step)
}
