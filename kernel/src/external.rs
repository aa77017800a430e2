//! Forces and torques on grains that do not come from contacts.

use crate::math::real::Real;
use crate::math::rows::plus;
use crate::math::vec3::{Vec3, head};
use crate::world::World;

/// A grain as an external force sees it, in the units of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrainState<R> {
    /// Place among the rows.
    pub place: usize,
    /// Id.
    pub id: u32,
    /// Group.
    pub group: u8,
    /// Centre (length), after the drift of this step, in the box.
    pub position: Vec3<R>,
    /// Radius (length).
    pub radius: R,
    /// Velocity of the half step (length over time).
    pub velocity: Vec3<R>,
    /// Mass.
    pub mass: R,
    /// Angular velocity of the half step (one over time).
    pub spin: Vec3<R>,
}

/// Adds to the rows of each grain what `external` gives for it, by ascending id.
#[inline]
pub(crate) fn add_external<R: Real>(
    world: &mut World<'_, R>,
    mut external: impl FnMut(&GrainState<R>) -> (Vec3<R>, Vec3<R>),
) {
    let g = &mut world.grains;
    let moving = g.position.iter().zip(&*g.velocity).zip(&*g.spin);
    let pushes = g.force.iter_mut().zip(g.torque.iter_mut());
    let names = g.id.iter().zip(g.group).enumerate();
    for ((((x, v), w), (force, torque)), (place, (id, group))) in moving.zip(pushes).zip(names) {
        let grain = GrainState {
            place,
            id: *id,
            group: *group,
            position: head(*x),
            radius: x[3],
            velocity: head(*v),
            mass: v[3],
            spin: head(*w),
        };
        let (push, turn) = external(&grain);
        // The last words are zero and stay so.
        *force = plus(force, &[push[0], push[1], push[2], R::ZERO]);
        *torque = plus(torque, &[turn[0], turn[1], turn[2], R::ZERO]);
    }
}
