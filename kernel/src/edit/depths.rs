//! Which listed bodies overlap too deeply, as the forces found them.

use crate::error::Error;
use crate::math::real::{Real, smaller};
use crate::math::rows::get_or_default;
use crate::math::vec3::{dot, head};
use crate::neighbors::pair_list::{obstacle_of, surface_of};
use crate::state::domain::Domain;
use crate::state::grains::Grains;
use crate::state::obstacle::Obstacle;
use crate::world::World;

/// Whether two grains overlap by more than half the smaller radius, as the forces found it.
pub(crate) fn is_deep<R: Real>(domain: &Domain<R>, grains: &Grains<'_, R>, i: u32, j: u32) -> bool {
    let x = get_or_default(grains.position, i as usize);
    let y = get_or_default(grains.position, j as usize);
    let d = domain.separation(head(x), head(y));
    let overlap = (x[3] + y[3]) - dot(d, d).sqrt();
    overlap > smaller(x[3], y[3]) * R::HALF
}

/// The grain and the obstacle of a listed contact, if they overlap too deeply.
pub(crate) fn deep_in_obstacle<R: Real>(
    world: &World<'_, R>,
    entry: usize,
) -> Option<(usize, u32)> {
    let i = get_or_default(world.pairs.obstacle_contact_grain, entry) as usize;
    let word = get_or_default(world.pairs.obstacle_contact_obstacle, entry);
    let k = obstacle_of(word);
    let body: &Obstacle<R> = world.obstacles.get(k as usize)?;
    let x = get_or_default(world.grains.position, i);
    let met = body.meet(surface_of(word), world.facets, world.domain, head(x), x[3]);
    let overlap = met.overlap;
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
    for (i, j, _) in world.pairs.in_order(&world.stretches, world.clock.listed) {
        if is_deep(world.domain, &world.grains, i, j) {
            return Err(Error::OverlapTooDeep {
                i: id(i as usize),
                j: id(j as usize),
            });
        }
    }
    Ok(())
}
