//! The layout: words and numbers of each part.

use crate::math::real::Real;

/// The layouts that this version writes and reads: [`PLAIN`] of obstacles that are balls, endless bars and planes and
/// never turned, as before there were others, [`FORMAT`] of any, and [`KEEPING`] of laws that keep words of contacts
/// or act at a distance.
pub(crate) const KEEPING: u32 = 3;
pub(crate) const FORMAT: u32 = 2;
pub(crate) const PLAIN: u32 = 1;
pub(crate) const MAGIC: [u32; 2] = [u32::from_le_bytes(*b"bitg"), u32::from_le_bytes(*b"rain")];
/// Words before the numbers of the head, of which the last three are flags and the step.
const COUNTS: usize = 16;

/// The same of a layout: [`FORMAT`] has one more count, [`KEEPING`] two.
pub(crate) fn counts(format: u32) -> usize {
    match format {
        PLAIN => COUNTS,
        FORMAT => COUNTS + 1,
        _ => COUNTS + 2,
    }
}

/// Numbers of the head of a layout: [`KEEPING`] has the reach of the law too.
pub(crate) fn head(format: u32) -> usize {
    match format {
        KEEPING => HEAD + 1,
        _ => HEAD,
    }
}
/// Numbers of the head, of a group, an obstacle, a grain and a history, and words beside them.
const HEAD: usize = 13;
const GROUP: (usize, usize) = (1, 3);
const OBSTACLE: (usize, usize) = (8, 38);
const PLAIN_OBSTACLE: (usize, usize) = (4, 17);
const GRAIN: (usize, usize) = (5, 17);
const HISTORY: (usize, usize) = (2, 3);
const FACET: (usize, usize) = (0, 9);
/// Words of the two hashes.
pub(crate) const HASHES: usize = 16;

/// Bits of the head's flags: the first three say which axes are periodic.
pub(crate) const OPEN: u32 = 8;
pub(crate) const TAKES_OUT: u32 = 16;
pub(crate) const DRAINS: u32 = 32;

/// Words of a number.
pub(crate) fn width<R: Real>() -> usize {
    match R::ZERO.to_words().1 {
        Some(_) => 2,
        None => 1,
    }
}

/// Flags of an obstacle, beside its kind.
pub(crate) const KIND: u32 = 0xff;
pub(crate) const CURVED: u32 = 1 << 8;
pub(crate) const FREE: u32 = 1 << 9;
pub(crate) const SPINS: u32 = 1 << 10;
pub(crate) const INTEGRATES: u32 = 12;

/// Where the material begins in the flags of a group and of an obstacle; its bits were zero before there were several.
pub(crate) const GROUP_MATERIAL: u32 = 8;
pub(crate) const MATERIAL: u32 = 16;

/// Words and numbers of an obstacle.
fn obstacle(format: u32) -> (usize, usize) {
    match format {
        PLAIN => PLAIN_OBSTACLE,
        _ => OBSTACLE,
    }
}

/// How many of everything a world has.
#[derive(Clone, Copy, Default)]
pub(crate) struct Counts {
    pub grains: usize,
    pub groups: usize,
    pub obstacles: usize,
    /// Histories of pairs and of obstacle contacts.
    pub pairs: usize,
    pub touches: usize,
    pub facets: usize,
    /// Words of the law in each history.
    pub words: usize,
}

/// Words in so many parts of a world: head, groups, obstacles, grains, histories, triangles.
pub(crate) fn words_of<R: Real>(format: u32, of: Counts, parts: usize) -> usize {
    let (words, numbers) = HISTORY;
    let all = [
        (1, (counts(format), head(format))),
        (of.groups, GROUP),
        (of.obstacles, obstacle(format)),
        (of.grains, GRAIN),
        (
            of.pairs.saturating_add(of.touches),
            (words, numbers + of.words),
        ),
        (of.facets, FACET),
    ];
    let all = all.iter().take(parts);
    all.fold(0usize, |sum, (count, (words, numbers))| {
        let each = words + width::<R>() * numbers;
        sum.saturating_add(count.saturating_mul(each))
    })
}

/// Bytes that a world with these counts takes.
pub(crate) fn size<R: Real>(format: u32, of: Counts) -> usize {
    let words = words_of::<R>(format, of, 6).saturating_add(HASHES);
    words.saturating_mul(4)
}

/// The name of the number type in words.
pub(crate) fn name<R: Real>() -> [u32; 4] {
    let mut bytes = [0u8; 16];
    for (to, from) in bytes.iter_mut().zip(R::NAME.bytes()) {
        *to = from;
    }
    let mut words = [0; 4];
    for (to, from) in words.iter_mut().zip(bytes.as_chunks::<4>().0) {
        *to = u32::from_le_bytes(*from);
    }
    words
}
