//! Which listed bodies overlap too deeply, as the forces found them.

use crate::error::Error;
use crate::math::real::{Real, smaller};
use crate::math::rows::get_or_default;
use crate::math::vec3::{dot, head};
use crate::neighbors::pair_list::PLACE;
use crate::state::obstacle::Obstacle;
use crate::world::World;

/// The next of the listed pairs, by lower grain and partner, from the two ascending parts of the list.
pub(crate) fn next_pair<R: Real>(
    world: &World<'_, R>,
    inner: &mut usize,
    across: &mut usize,
) -> Option<(usize, usize)> {
    let listed = world.clock.listed;
    let entry = |p: usize, end: usize| {
        let pair = (
            get_or_default(world.pairs.lower, p) as usize,
            get_or_default(world.pairs.partner, p) as usize,
        );
        (p < end).then_some(pair)
    };
    let (a, b) = (entry(*inner, listed.inner), entry(*across, listed.pairs));
    let from_across = match (a, b) {
        (Some(a), Some(b)) => b < a,
        (None, _) => true,
        _ => false,
    };
    match from_across {
        true => {
            *across += 1;
            b
        }
        false => {
            *inner += 1;
            a
        }
    }
}

/// Whether two grains overlap by more than half the smaller radius, as the forces found it.
pub(crate) fn is_deep<R: Real>(world: &World<'_, R>, i: usize, j: usize) -> bool {
    let x = get_or_default(world.grains.position, i);
    let y = get_or_default(world.grains.position, j);
    let d = world.domain.separation(head(x), head(y));
    let overlap = (x[3] + y[3]) - dot(d, d).sqrt();
    overlap > smaller(x[3], y[3]) * R::HALF
}

/// The grain and the obstacle of a listed contact, if they overlap too deeply.
pub(crate) fn deep_in_obstacle<R: Real>(
    world: &World<'_, R>,
    entry: usize,
) -> Option<(usize, u32)> {
    let i = get_or_default(world.pairs.obstacle_contact_grain, entry) as usize;
    let k = get_or_default(world.pairs.obstacle_contact_obstacle, entry) & PLACE;
    let body: &Obstacle<R> = world.obstacles.get(k as usize)?;
    let x = get_or_default(world.grains.position, i);
    let overlap = body.meet(world.domain, head(x), x[3]).overlap;
    (overlap > body.depth_allowed(x[3])).then_some((i, k))
}

/// Checks that no listed bodies overlap too deeply.
pub(crate) fn check_depths<R: Real>(world: &World<'_, R>) -> Result<(), Error> {
    let id = |place: usize| get_or_default(world.grains.id, place);
    for entry in 0..world.clock.listed.obstacle_contacts {
        if let Some((i, obstacle)) = deep_in_obstacle(world, entry) {
            return Err(Error::ObstacleTooDeep {
                id: id(i),
                obstacle,
            });
        }
    }
    let (mut inner, mut across) = (0, world.clock.listed.inner);
    while let Some((i, j)) = next_pair(world, &mut inner, &mut across) {
        if is_deep(world, i, j) {
            return Err(Error::OverlapTooDeep { i: id(i), j: id(j) });
        }
    }
    Ok(())
}
