//! The neighbour search: who may come near before the next search.
//!
//! Grains are sorted into cells at least as wide as the largest listed distance, by counting, so
//! that each cell holds its grains in ascending order; a grain then looks at its own cell and the
//! ones around it. What it finds are candidates, kept for many steps; the pairs that a step
//! evaluates are picked from them, more often, in `prune.rs`.

use crate::contact::kept::Kept;
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::rows::{copy, front_mut, get_or_default, prefix, set, sort_by};
use crate::math::vec3::{head, is_beyond};
use crate::neighbors::extent::Extent;
use crate::neighbors::grid::Grid;
use crate::neighbors::outer_list::OuterList;
use crate::neighbors::pair_list::{PairList, obstacle_of, surface_of, surface_word};
use crate::state::domain::Domain;
use crate::state::facet::Facet;
use crate::state::grains::Grains;
use crate::state::obstacle::Obstacle;
use crate::state::owned::Owned;
use crate::state::shape::Shape;

/// Storage of the cells, borrowed.
pub struct CellList<'a> {
    /// Where each cell's grains begin; its length less one bounds the number of cells, 2 at least.
    pub start: &'a mut [u32],
    /// The grains, cell by cell.
    pub grain: &'a mut [u32],
}

/// What a search found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Found<R> {
    pub obstacle_contacts: usize,
    /// How far beyond touching every pair is a candidate, less rounding.
    pub far: R,
    /// Margin for the rounding of coordinates and distances.
    pub slack: R,
    /// What one step's rounding may add to a travel.
    pub rounding: R,
}

/// What a search reads.
pub(crate) struct Scene<'a, R> {
    pub domain: &'a Domain<R>,
    pub grains: &'a Grains<'a, R>,
    pub obstacles: &'a [Obstacle<R>],
    pub facets: &'a [Facet<R>],
    pub owned: Owned<'a>,
    /// How large numbers and grains are.
    pub extent: Extent<R>,
    /// How far beyond touching a pair is a candidate.
    pub far: R,
}

/// Finds every pair and every obstacle contact closer than touching by up to `scene.far`. The obstacle
/// contacts are left in the spare list, with the springs that the old list of `old_obstacle_contacts` of them holds.
///
/// Margins: coordinates, separations and travels are each rounded by at most a few units in the
/// last place of the largest coordinate, and 64 such units are added.
pub(crate) fn search<R: Real>(
    scene: &Scene<'_, R>,
    candidates: &mut OuterList<'_>,
    pairs: &PairList<'_, R>,
    spare: &mut PairList<'_, R>,
    cells: &mut CellList<'_>,
    old_obstacle_contacts: usize,
) -> Result<Found<R>, Error> {
    let (domain, grains) = (scene.domain, scene.grains);
    let position = &*grains.position;
    let (radius, least) = (scene.extent.radius, scene.extent.least);
    let widest = scene.extent.reach;
    // Coordinates may grow by half of it before the next search.
    let extent = scene.extent.largest + scene.far;
    let size = match R::FIXED_POINT {
        // Rounding is the same for all numbers, and more of a distance the shorter it is.
        true => (extent + widest) + (R::ONE + R::ONE / least),
        false => extent + widest,
    };
    let slack = size * (R::EPSILON * R::from_f64(64.0));
    // However far: a pair is listed by its nearest image, and no other image comes first.
    let far = scene.far + slack;

    let width = (radius + radius) + far + slack;
    let room = cells.start.len().saturating_sub(1);
    let grid = Grid::new(domain, position, width, room);
    sort_into_cells(&grid, position, cells);

    let obstacle_contacts = list_obstacle_contacts(scene, spare, far)?;
    list_candidates(scene, &grid, cells, candidates, far)?;
    take_obstacle_contacts(pairs, old_obstacle_contacts, spare, obstacle_contacts);
    Ok(Found {
        obstacle_contacts,
        far: scene.far,
        slack,
        rounding: match R::FIXED_POINT {
            true => R::EPSILON * R::from_f64(4.0),
            false => extent * (R::EPSILON + R::EPSILON),
        },
    })
}

/// Puts the obstacle contacts of a search in the place of the old ones.
pub(crate) fn keep_obstacle_contacts<R: Real>(
    pairs: &mut PairList<'_, R>,
    spare: &PairList<'_, R>,
    touches: usize,
) {
    copy(
        front_mut(pairs.obstacle_contact_grain, touches),
        prefix(spare.obstacle_contact_grain, touches),
    );
    copy(
        front_mut(pairs.obstacle_contact_obstacle, touches),
        prefix(spare.obstacle_contact_obstacle, touches),
    );
    copy(
        front_mut(pairs.obstacle_contact_spring, touches),
        prefix(spare.obstacle_contact_spring, touches),
    );
    let memory = pairs.obstacle_contact_memory.iter_mut();
    for (word, new) in memory.zip(&spare.obstacle_contact_memory) {
        copy(front_mut(word, touches), prefix(new, touches));
    }
}

fn sort_into_cells<R: Real>(grid: &Grid<R>, position: &[Row<R>], cells: &mut CellList<'_>) {
    let count = grid.count[0] * grid.count[1] * grid.count[2];
    let start = front_mut(cells.start, count + 1);
    start.fill(0);
    for x in position {
        let c = grid.number(grid.place(x)) + 1;
        set(start, c, get_or_default(start, c) + 1);
    }
    let mut before = 0;
    for end in start.iter_mut() {
        before += *end;
        *end = before;
    }
    // Filling from the last grain down moves each cell's end to its beginning and keeps order.
    for (i, x) in position.iter().enumerate().rev() {
        let c = grid.number(grid.place(x)) + 1;
        let slot = get_or_default(start, c).saturating_sub(1);
        set(start, c, slot);
        set(cells.grain, slot as usize, i as u32);
    }
    // Now start[c + 1] is where cell c begins; shift down and close the last cell.
    let mut next = position.len() as u32;
    for begin in start.iter_mut().rev() {
        core::mem::swap(begin, &mut next);
    }
}

/// Fills the rows of the candidates, partners ascending.
fn list_candidates<R: Real>(
    scene: &Scene<'_, R>,
    grid: &Grid<R>,
    cells: &CellList<'_>,
    candidates: &mut OuterList<'_>,
    far: R,
) -> Result<(), Error> {
    let (domain, grains) = (scene.domain, scene.grains);
    let position = &*grains.position;
    let n = position.len();
    let capacity = candidates.partner.len();
    let mut listed = 0usize;
    for (i, x) in position.iter().enumerate() {
        set(candidates.row, i, listed.min(capacity) as u32);
        let begin = listed;
        let heavy = has_infinite_mass(grains, i);
        let is_own = scene.owned.has(i);
        let cell = grid.place(x);
        let (zs, zn) = grid.around(2, cell[2]);
        let (ys, yn) = grid.around(1, cell[1]);
        let (xs, xn) = grid.around(0, cell[0]);
        for &cz in zs.iter().take(zn) {
            for &cy in ys.iter().take(yn) {
                for &cx in xs.iter().take(xn) {
                    let c = grid.number([cx, cy, cz]);
                    let from = get_or_default(cells.start, c) as usize;
                    let members = prefix(cells.grain, get_or_default(cells.start, c + 1) as usize);
                    for &j in members.get(from..).unwrap_or_default() {
                        let k = j as usize;
                        if k <= i || (heavy && has_infinite_mass(grains, k)) {
                            continue;
                        }
                        // Two ghosts are a pair of other parts.
                        if !is_own && !scene.owned.has(k) {
                            continue;
                        }
                        let y = get_or_default(position, k);
                        let d = domain.separation(head(*x), head(y));
                        let reach = (x[3] + y[3]) + far;
                        if !is_beyond(d, reach) {
                            set(candidates.partner, listed, j);
                            listed += 1;
                        }
                    }
                }
            }
        }
        if let Some(row) = candidates.partner.get_mut(begin..listed) {
            sort(row);
        }
    }
    if listed > capacity {
        return Err(Error::OuterListFull { needed: listed });
    }
    set(candidates.row, n, listed as u32);
    Ok(())
}

fn has_infinite_mass<R: Real>(grains: &Grains<'_, R>, i: usize) -> bool {
    let group = grains
        .groups
        .get(usize::from(get_or_default(grains.group, i)));
    group.is_some_and(|group| group.infinite_mass)
}

/// Ciura's gaps: rows are short.
const GAPS: [usize; 8] = [701, 301, 132, 57, 23, 10, 4, 1];

fn sort(words: &mut [u32]) {
    sort_by(words, &GAPS, |a, b| a < b);
}

fn list_obstacle_contacts<R: Real>(
    scene: &Scene<'_, R>,
    spare: &mut PairList<'_, R>,
    skin: R,
) -> Result<usize, Error> {
    let (domain, grains) = (scene.domain, scene.grains);
    let capacity = spare.obstacle_contact_grain.len();
    let mut touches = 0;
    for (i, x) in grains.position.iter().enumerate() {
        let heavy = has_infinite_mass(grains, i);
        if !scene.owned.has(i) {
            continue;
        }
        for (k, body) in scene.obstacles.iter().enumerate() {
            if heavy && body.inverse_mass == R::ZERO {
                continue;
            }
            if let Shape::Mesh { .. } = body.shape {
                let offset = domain.separation(head(*x), body.point);
                if let Some((mesh, own)) = body.in_mesh(scene.facets, offset) {
                    mesh.near(own, x[3] + skin, &mut |surface| {
                        let word = surface_word(k as u32, surface);
                        set(spare.obstacle_contact_grain, touches, i as u32);
                        set(spare.obstacle_contact_obstacle, touches, word);
                        touches += 1;
                        true
                    });
                }
                continue;
            }
            for surface in 0..body.shape.surfaces() {
                let meeting = body.meet(surface, &[], domain, head(*x), x[3]);
                // A distance whose square is too large for a number may be any.
                let is_number = meeting.overlap.is_finite();
                let is_far = match R::FIXED_POINT {
                    // A distance whose square overflows is beyond all contacts.
                    true => !is_number || meeting.overlap < -skin,
                    false => is_number && meeting.overlap < -skin,
                };
                if !is_far {
                    let word = surface_word(k as u32, surface);
                    set(spare.obstacle_contact_grain, touches, i as u32);
                    set(spare.obstacle_contact_obstacle, touches, word);
                    touches += 1;
                }
            }
        }
    }
    if touches > capacity {
        return Err(Error::ObstacleContactsFull { needed: touches });
    }
    Ok(touches)
}

fn take_obstacle_contacts<R: Real>(
    old: &PairList<'_, R>,
    old_obstacle_contacts: usize,
    new: &mut PairList<'_, R>,
    touches: usize,
) {
    let mut from = 0;
    for t in 0..touches {
        // By grain, obstacle and surface.
        let key = |list: &PairList<'_, R>, t: usize| {
            let word = get_or_default(list.obstacle_contact_obstacle, t);
            let grain = get_or_default(list.obstacle_contact_grain, t);
            (grain, obstacle_of(word), surface_of(word))
        };
        let old_key = |f: usize| key(old, f);
        let key = key(new, t);
        while from < old_obstacle_contacts && old_key(from) < key {
            from += 1;
        }
        let same = from < old_obstacle_contacts && old_key(from) == key;
        if same {
            set(
                new.obstacle_contact_obstacle,
                t,
                get_or_default(old.obstacle_contact_obstacle, from),
            );
        }
        let kept = if same {
            old.kept_on_obstacle(from)
        } else {
            Kept::NOTHING
        };
        new.keep_on_obstacle(t, kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    proptest! {
        #[test]
        fn rows_are_sorted(words in prop::collection::vec(0..5000u32, 0..1500)) {
            let mut ours: Vec<u32> = words;
            let mut theirs = ours.clone();
            sort(&mut ours);
            theirs.sort_unstable();
            prop_assert_eq!(ours, theirs);
        }
    }
}
