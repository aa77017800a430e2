//! The pairs near enough to touch soon, picked from the candidates of the last search.
//!
//! A search looks far, so that it is rare; the list that every step evaluates looks a short way, so that almost every
//! pair in it touches, and each stretch of grains renews its own part of it as often as needed. New pairs are written
//! to the spare storage, take over the springs of the old ones and are copied back, so that a full list leaves the
//! old one whole.

use core::ops::Range;

use crate::contact::block::BLOCK;
use crate::contact::kept::Kept;
use crate::error::Error;
use crate::math::real::{Real, larger};
use crate::math::rows::Row;
use crate::math::rows::{copy, get_or_default, less, min, part, part_mut, prefix, set, split_at};
use crate::math::vec3::{dot, head, is_beyond};
use crate::neighbors::outer_list::OuterList;
use crate::neighbors::pair_list::{Listed, PairList};
use crate::neighbors::stretch::StretchList;
use crate::state::domain::Domain;

/// Entries of room that a stretch gets beyond its pairs at most, so that they can grow in number in their place.
const ROOM: usize = 24;

/// What picking reads.
pub(crate) struct Pruning<'a, R> {
    pub domain: &'a Domain<R>,
    pub position: &'a [Row<R>],
    pub candidates: &'a OuterList<'a>,
    /// Margin for the rounding of coordinates and distances.
    pub slack: R,
}

impl<R: Real> Pruning<'_, R> {
    /// The candidates of a grain.
    fn row(&self, grain: usize) -> &[u32] {
        let rows = &*self.candidates.row;
        let from = get_or_default(rows, grain) as usize;
        part(
            self.candidates.partner,
            from,
            get_or_default(rows, grain + 1) as usize,
        )
    }
}

/// Candidates whose distances are computed together.
const CHUNK: usize = BLOCK;

/// Some candidates of a stretch, in columns: each loop over them is short enough for wide registers.
struct Chunk<R> {
    count: usize,
    lower: [u32; CHUNK],
    partner: [u32; CHUNK],
    apart: [Row<R>; CHUNK],
    /// Sum of the radii.
    touch: [R; CHUNK],
    is_near: [bool; CHUNK],
    touches: [bool; CHUNK],
}

impl<R: Real> Chunk<R> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            count: 0,
            lower: [0; CHUNK],
            partner: [0; CHUNK],
            apart: [[R::ZERO; 4]; CHUNK],
            touch: [R::ZERO; CHUNK],
            is_near: [false; CHUNK],
            touches: [false; CHUNK],
        }
    }

    /// Takes up candidates of a grain; returns those that there is no room for.
    #[inline(always)]
    fn fill<'c>(&mut self, position: &[Row<R>], i: usize, row: &'c [u32]) -> &'c [u32] {
        let x = get_or_default(position, i);
        let begin = min(self.count, CHUNK);
        let (now, later) = split_at(row, min(CHUNK - begin, row.len()));
        for (k, j) in (begin..).zip(now) {
            if k >= CHUNK {
                break;
            }
            let y = get_or_default(position, *j as usize);
            self.lower[k] = i as u32;
            self.partner[k] = *j;
            self.apart[k] = less(&x, &y);
            self.touch[k] = x[3] + y[3];
        }
        self.count = begin + now.len();
        later
    }

    /// Finds which are nearer than touching by up to `near`.
    #[inline(always)]
    fn measure(&mut self, domain: &Domain<R>, near: R) {
        for k in 0..CHUNK {
            let d = domain.nearest(head(self.apart[k]));
            self.is_near[k] = !is_beyond(d, self.touch[k] + near);
            self.touches[k] = dot(d, d) < self.touch[k] * self.touch[k];
        }
    }

    /// Writes those that are near to a list from `to` on, as far as there is room; returns where they end, and how
    /// many candidates touch.
    #[inline(always)]
    fn keep(&mut self, list: &mut PairList<'_, R>, mut to: usize) -> (usize, usize) {
        let mut touching = 0;
        let lower = prefix(&self.lower, self.count).iter();
        let found = self.is_near.iter().zip(&self.touches);
        for ((i, j), (is_near, touches)) in lower.zip(&self.partner).zip(found) {
            // Written in any case, kept only if near: no branch to mispredict.
            set(list.lower, to, *i);
            set(list.partner, to, *j);
            to += usize::from(*is_near);
            touching += usize::from(*touches);
        }
        self.count = 0;
        (to, touching)
    }
}

/// Picks the pairs of these grains into the spare list from `begin` on; returns where they end and
/// how many touch. What there is no room for is only counted. For small machines there is one copy of it.
#[cfg_attr(any(target_arch = "arm", target_arch = "riscv32"), inline(never))]
#[cfg_attr(not(any(target_arch = "arm", target_arch = "riscv32")), inline(always))]
fn pick<R: Real>(
    picking: &Pruning<'_, R>,
    grains: Range<usize>,
    near: R,
    spare: &mut PairList<'_, R>,
    begin: usize,
) -> (usize, usize) {
    let mut chunk = Chunk::new();
    let (mut to, mut touching) = (begin, 0usize);
    let mut empty = |chunk: &mut Chunk<R>| {
        chunk.measure(picking.domain, near);
        let kept = chunk.keep(spare, to);
        to = kept.0;
        touching += kept.1;
    };
    for i in grains {
        let mut row = picking.row(i);
        while !row.is_empty() {
            row = chunk.fill(picking.position, i, row);
            if chunk.count == CHUNK {
                empty(&mut chunk);
            }
        }
    }
    empty(&mut chunk);
    (to, touching)
}

/// Gives the entries `new` of the spare list what the entries `old` of the list have kept of the same pairs.
#[cfg_attr(any(target_arch = "arm", target_arch = "riscv32"), inline(never))]
#[cfg_attr(not(any(target_arch = "arm", target_arch = "riscv32")), inline(always))]
fn take_kept<R: Real>(
    pairs: &PairList<'_, R>,
    old: Range<usize>,
    spare: &mut PairList<'_, R>,
    new: Range<usize>,
) {
    let had = |p: usize| {
        (
            get_or_default(pairs.lower, p),
            get_or_default(pairs.partner, p),
        )
    };
    // Of a full list, those that were written.
    let end = min(new.end, spare.lower.len());
    let old_end = min(old.end, pairs.lower.len());
    let (mut from, mut to) = (old.start, new.start);
    while to < end {
        // Most pairs stay: as long as they do, springs are copied together.
        let lower = part(pairs.lower, from, old_end)
            .iter()
            .zip(part(spare.lower, to, end));
        let higher = part(pairs.partner, from, old_end)
            .iter()
            .zip(part(spare.partner, to, end));
        let same = lower
            .zip(higher)
            .take_while(|((a, b), (c, d))| a == b && c == d);
        let count = same.count();
        for (new, old) in columns_mut(spare).zip(columns(pairs)) {
            copy(part_mut(new, to, to + count), part(old, from, from + count));
        }
        from += count;
        to += count;
        if to >= end {
            return;
        }
        let pair = (
            get_or_default(spare.lower, to),
            get_or_default(spare.partner, to),
        );
        while from < old_end && had(from) < pair {
            from += 1;
        }
        if from >= old_end || had(from) != pair {
            spare.keep(to, Kept::NOTHING);
            to += 1;
        }
    }
}

/// The columns of springs and words; words end with the first column that is empty.
fn columns<'l, R>(list: &'l PairList<'_, R>) -> impl Iterator<Item = &'l [R]> {
    let words = list.memory.iter().take_while(|word| !word.is_empty());
    list.spring.iter().chain(words).map(|column| &**column)
}

/// [`columns`], to write to.
fn columns_mut<'l, R>(list: &'l mut PairList<'_, R>) -> impl Iterator<Item = &'l mut [R]> {
    let words = list.memory.iter_mut().take_while(|word| !word.is_empty());
    list.spring
        .iter_mut()
        .chain(words)
        .map(|column| &mut **column)
}

/// Copies pairs of the spare list to another place of the list.
fn keep<R: Real>(
    pairs: &mut PairList<'_, R>,
    to: usize,
    spare: &PairList<'_, R>,
    from: Range<usize>,
) {
    let end = to.saturating_add(from.len());
    copy(
        part_mut(pairs.lower, to, end),
        part(spare.lower, from.start, from.end),
    );
    copy(
        part_mut(pairs.partner, to, end),
        part(spare.partner, from.start, from.end),
    );
    for (new, kept) in columns_mut(pairs).zip(columns(spare)) {
        copy(part_mut(new, to, end), part(kept, from.start, from.end));
    }
}

/// Picks the pairs of one stretch nearer than touching by up to `skin`. `false`, and nothing is changed, if there is no
/// room for them in its place.
#[cfg_attr(any(target_arch = "arm", target_arch = "riscv32"), inline(never))]
#[cfg_attr(not(any(target_arch = "arm", target_arch = "riscv32")), inline(always))]
pub(crate) fn prune_stretch<R: Real>(
    picking: &Pruning<'_, R>,
    (stretches, s): (&mut StretchList<'_, R>, usize),
    skin: R,
    pairs: &mut PairList<'_, R>,
    spare: &mut PairList<'_, R>,
    listed: &mut Listed,
) -> bool {
    let old = stretches.entries(s);
    let near = skin + picking.slack;
    let (count, touching) = pick(picking, stretches.grains(s), near, spare, 0);
    if count > min(stretches.room(s), spare.lower.len()) {
        return false;
    }
    take_kept(pairs, old.clone(), spare, 0..count);
    keep(pairs, old.start, spare, 0..count);
    let before = get_or_default(stretches.touching, s) as usize;
    listed.pairs = listed.pairs.saturating_sub(old.len()) + count;
    listed.touching = listed.touching.saturating_sub(before) + touching;
    set(stretches.pairs, s, count as u32);
    set(stretches.touching, s, touching as u32);
    set(stretches.budget, s, skin);
    true
}

/// Picks all pairs, of each stretch for `skin` or what it needs in the next step, and makes room between stretches.
///
/// # Errors
/// A full list, before anything is changed.
#[cfg_attr(any(target_arch = "arm", target_arch = "riscv32"), inline(never))]
#[cfg_attr(not(any(target_arch = "arm", target_arch = "riscv32")), inline(always))]
pub(crate) fn prune_all<R: Real>(
    picking: &Pruning<'_, R>,
    stretches: &mut StretchList<'_, R>,
    (skin, ahead): (R, bool),
    pairs: &mut PairList<'_, R>,
    spare: &mut PairList<'_, R>,
    old: Listed,
) -> Result<Listed, Error> {
    let (mut all, mut touching) = (0, 0);
    for s in 0..old.stretches {
        let near = larger(skin, stretches.need(s, ahead)) + picking.slack;
        let (end, touches) = pick(picking, stretches.grains(s), near, spare, all);
        take_kept(pairs, stretches.entries(s), spare, all..end);
        set(stretches.touching, s, touches as u32);
        touching += touches;
        all = end;
    }
    let capacity = spare.lower.len();
    if all > capacity {
        return Err(Error::PairListFull { needed: all });
    }
    let room = (capacity - all)
        .checked_div(old.stretches)
        .unwrap_or_default();
    let room = min(room, ROOM);
    let (mut from, mut to) = (0, 0);
    for s in 0..old.stretches {
        let end = stretches.grains(s).end;
        let own = part(spare.lower, from, all);
        let count = own.partition_point(|i| (*i as usize) < end);
        keep(pairs, to, spare, from..from + count);
        set(stretches.begin, s, to as u32);
        set(stretches.pairs, s, count as u32);
        set(stretches.budget, s, larger(skin, stretches.need(s, ahead)));
        from += count;
        to += count + room;
    }
    set(stretches.begin, old.stretches, to as u32);
    Ok(Listed {
        end: to,
        pairs: all,
        touching,
        ..old
    })
}

/// Moves all pairs together, without room between stretches, and cuts so many grains into stretches anew.
pub(crate) fn flatten<R: Real>(
    stretches: &mut StretchList<'_, R>,
    pairs: &mut PairList<'_, R>,
    spare: &mut PairList<'_, R>,
    old: Listed,
    grains: usize,
) -> Listed {
    let mut all = 0;
    for (i, j, p) in pairs.in_order(stretches, old) {
        set(spare.lower, all, i);
        set(spare.partner, all, j);
        spare.keep(all, pairs.kept(p));
        all += 1;
    }
    keep(pairs, 0, spare, 0..all);
    let least = stretches.least_budget(old.stretches);
    let count = stretches.divide(prefix(pairs.lower, all), least, grains);
    Listed {
        stretches: count,
        end: all,
        pairs: all,
        ..old
    }
}
