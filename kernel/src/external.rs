//! Forces and torques on grains that do not come from contacts.

use crate::math::real::Real;
use crate::math::rows::plus;
use crate::math::vec3::Vec3;
use crate::state::grains::GrainState;
use crate::world::World;

/// Adds to the rows of each grain what `external` gives for it, by ascending id.
#[inline]
pub(crate) fn add_external<R: Real>(
    world: &mut World<'_, R>,
    mut external: impl FnMut(&GrainState<R>) -> (Vec3<R>, Vec3<R>),
) {
    let g = &mut world.grains;
    let moving = g.position.iter().zip(&*g.velocity).zip(&*g.spin);
    let pushes = g.force.iter_mut().zip(g.torque.iter_mut());
    let names = g.id.iter().zip(g.group.iter()).enumerate();
    for ((((x, v), w), (force, torque)), (place, (id, group))) in moving.zip(pushes).zip(names) {
        let grain = GrainState::of(place, *id, *group, [x, v, w]);
        let (push, turn) = external(&grain);
        // The last words stay as they are.
        *force = plus(force, &[push[0], push[1], push[2], R::ZERO]);
        *torque = plus(torque, &[turn[0], turn[1], turn[2], R::ZERO]);
    }
}
