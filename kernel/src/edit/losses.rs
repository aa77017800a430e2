//! Grains that a world loses: they leave the box, fall through a plane or overlap too deeply.

use super::depths::{deep_in_obstacle, is_deep};
use super::remove::drop_marked;
use super::settle::open;
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::{Row, get_or_default};
use crate::state::domain::Domain;
use crate::state::grains::Grains;
use crate::state::losses::{Cause, Departure};
use crate::world::World;

/// Takes out the grains that the world lost in its last step, and shows each to `departed`: first those beyond an
/// edge and behind the drain, by ascending id, then those too deep in an obstacle, by id and obstacle, then those too
/// deep in another grain, by the two ids. A grain goes once, for the first of these causes; a pair of which one goes is
/// no cause for the other. Returns how many went; none if the world is not losing any. Rows and histories are as after
/// [`remove`](crate::remove).
///
/// # Errors
/// Before anything is changed: [`Error::NotStarted`] if the world is not between two stretches of steps,
/// [`Error::Edited`]; [`Error::Escaped`] of a grain that crossed a periodic edge more often than can be counted.
pub fn take_out<R: Real>(
    world: &mut World<'_, R>,
    mut departed: impl FnMut(Departure<R>),
) -> Result<usize, Error> {
    if !world.clock.losing {
        return match world.clock.rests() {
            true => Ok(0),
            false => Err(Error::NotStarted),
        };
    }
    world.clock.losing = false;
    if let Err(fault) = open(world) {
        world.clock.losing = true;
        return Err(fault);
    }
    let mut gone = 0;
    let mut goes = |grains: &mut Grains<'_, R>, place: usize, cause: Cause| {
        if !grains.is_marked(place) {
            departed(Departure {
                grain: grains.state(place),
                cause,
            });
            grains.mark(place);
            gone += 1;
        }
    };
    let policy = world.policy;
    for place in 0..world.clock.count {
        let x = get_or_default(world.grains.position, place);
        if policy.takes_out && !is_inside(world.domain, &x) {
            goes(&mut world.grains, place, Cause::Escaped);
        } else if policy.drain.is_some_and(|drain| drain.has(&x)) {
            goes(&mut world.grains, place, Cause::Drained);
        }
    }
    if policy.takes_out {
        for entry in 0..world.clock.listed.obstacle_contacts {
            if let Some((i, obstacle)) = deep_in_obstacle(world, entry) {
                goes(&mut world.grains, i, Cause::ObstacleTooDeep { obstacle });
            }
        }
        let grains = &mut world.grains;
        for (i, j, _) in world.pairs.in_order(&world.stretches, world.clock.listed) {
            let whole = !grains.is_marked(i as usize) && !grains.is_marked(j as usize);
            if whole && is_deep(world.domain, grains, i, j) {
                let with = get_or_default(grains.id, i as usize);
                goes(grains, j as usize, Cause::OverlapTooDeep { with });
            }
        }
    }
    if gone == 0 {
        // The only loss that leaves no trace in a position: a count of crossings that cannot grow.
        let last = |image: &[i32; 3]| image.iter().any(|k| *k == i32::MAX || *k == i32::MIN);
        let found = world.grains.image.iter().position(last).unwrap_or_default();
        world.clock.stop();
        return Err(Error::Escaped {
            id: get_or_default(world.grains.id, found),
        });
    }
    drop_marked(world)?;
    Ok(gone)
}

/// Whether a grain at this place is within the box; not if it is no number.
fn is_inside<R: Real>(domain: &Domain<R>, position: &Row<R>) -> bool {
    let (lo, hi) = (domain.lo(), domain.hi());
    (0..3).all(|a| position[a] >= lo[a] && position[a] <= hi[a])
}
