//! The pairs near enough to touch soon, picked from the candidates of the last search.
//!
//! A search looks far, so that it is rare; the list that every step evaluates looks a short way, so
//! that almost every pair in it touches, and is renewed as often as needed. The new list is
//! made in the spare storage, takes over the springs of the old one and is copied back, so that a
//! full list leaves the old one whole.

use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::rows::{copy, front_mut, get_or_default, prefix, set};
use crate::math::vec3::{dot, head, is_beyond};
use crate::neighbors::cell_list::OuterList;
use crate::neighbors::pair_list::{Listed, PairList};
use crate::state::domain::Domain;

/// What picking reads.
pub(crate) struct Pruning<'a, R> {
    pub domain: &'a Domain<R>,
    pub position: &'a [Row<R>],
    pub candidates: &'a OuterList<'a>,
    /// How far beyond touching a pair is listed.
    pub near: R,
    /// Where ranges of grains end, but for the last.
    pub range_bounds: &'a [u32],
}

/// Lists every candidate closer than touching by up to `near`, with the springs of the old list.
pub(crate) fn prune<R: Real>(
    picking: &Pruning<'_, R>,
    pairs: &mut PairList<'_, R>,
    spare: &mut PairList<'_, R>,
    old: Listed,
) -> Result<Listed, Error> {
    let new = list(picking, spare, old)?;
    take_springs(pairs, old, spare, new);
    copy(
        front_mut(pairs.lower, new.pairs),
        prefix(spare.lower, new.pairs),
    );
    copy(
        front_mut(pairs.partner, new.pairs),
        prefix(spare.partner, new.pairs),
    );
    for (to, from) in pairs.spring.iter_mut().zip(&spare.spring) {
        copy(front_mut(to, new.pairs), prefix(from, new.pairs));
    }
    Ok(new)
}

/// Pairs within one range from the front, those of two ranges from the back, which are then turned
/// round and moved up.
fn list<R: Real>(
    picking: &Pruning<'_, R>,
    spare: &mut PairList<'_, R>,
    old: Listed,
) -> Result<Listed, Error> {
    let capacity = spare.partner.len();
    let rows = &*picking.candidates.row;
    let mut range_bounds = picking.range_bounds.iter().copied();
    let mut end = range_bounds.next().unwrap_or(u32::MAX);
    let (mut inner, mut across, mut touching) = (0usize, 0usize, 0usize);
    // Where the pairs of two ranges begin.
    let mut room = capacity;
    for (i, x) in picking.position.iter().enumerate() {
        while i as u32 >= end {
            end = range_bounds.next().unwrap_or(u32::MAX);
        }
        let row = prefix(
            picking.candidates.partner,
            get_or_default(rows, i + 1) as usize,
        );
        for &j in row
            .get(get_or_default(rows, i) as usize..)
            .unwrap_or_default()
        {
            let y = get_or_default(picking.position, j as usize);
            let d = picking.domain.separation(head(*x), head(y));
            let touch = x[3] + y[3];
            let reach = touch + picking.near;
            let distance2 = dot(d, d);
            let is_far = is_beyond(d, reach);
            touching += usize::from(distance2 < touch * touch);
            if j < end {
                // Written while there is room, kept only when near: no branch to mispredict.
                if inner < room {
                    set(spare.lower, inner, i as u32);
                    set(spare.partner, inner, j);
                }
                inner += usize::from(!is_far);
            } else if !is_far {
                across += 1;
                room = capacity.saturating_sub(across);
                if inner <= room {
                    set(spare.lower, room, i as u32);
                    set(spare.partner, room, j);
                }
            }
        }
    }
    let pairs = inner + across;
    if pairs > capacity {
        return Err(Error::PairListFull { needed: pairs });
    }
    for column in [&mut *spare.lower, &mut *spare.partner] {
        turn_round(column, capacity - across);
        for k in 0..across {
            let word = get_or_default(column, capacity - across + k);
            set(column, inner + k, word);
        }
    }
    Ok(Listed {
        inner,
        pairs,
        touching,
        ..old
    })
}

/// Reverses the words from a place on; the standard library's way can panic.
fn turn_round(words: &mut [u32], from: usize) {
    let end = words.len();
    for k in 0..end.saturating_sub(from) / 2 {
        let (a, b) = (
            get_or_default(words, from + k),
            get_or_default(words, end - 1 - k),
        );
        set(words, from + k, b);
        set(words, end - 1 - k, a);
    }
}

/// Both lists ascend, so one walk along each finds the pairs that stay.
fn take_springs<R: Real>(
    old: &PairList<'_, R>,
    had: Listed,
    new: &mut PairList<'_, R>,
    has: Listed,
) {
    for stretch in [0..has.inner, has.inner..has.pairs] {
        let mut kept = old.in_order(had);
        let mut at_hand = kept.next();
        for p in stretch {
            let pair = (get_or_default(new.lower, p), get_or_default(new.partner, p));
            while at_hand.is_some_and(|(i, j, _)| (i, j) < pair) {
                at_hand = kept.next();
            }
            let same = at_hand.filter(|&(i, j, _)| (i, j) == pair);
            let spring = same.map_or([R::ZERO; 3], |(_, _, from)| old.spring_of(from));
            new.set_spring(p, spring);
        }
    }
}
