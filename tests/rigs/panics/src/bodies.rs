//! Rigid bodies.

use bitgrain_kernel::vec3::Vec3;
use bitgrain_kernel::{
    Domain, Error as KernelError, Facet, FreeMotion, Meeting, Obstacle, Orientation, Real, Shape,
    arrange, obstacle_of, surface_of, to_body, to_world,
};

/// Functions of obstacles, their shapes and their motion.
pub struct Bodies<R: Real> {
    new: fn(Shape<R>, Vec3<R>) -> Obstacle<R>,
    sphere: fn(Vec3<R>, R) -> Obstacle<R>,
    cylinder: fn(Vec3<R>, Vec3<R>, R) -> Obstacle<R>,
    plane: fn(Vec3<R>, Vec3<R>) -> Obstacle<R>,
    cuboid: fn(Vec3<R>, Vec3<R>) -> Obstacle<R>,
    long: fn(Vec3<R>, Vec3<R>, R, R) -> [Obstacle<R>; 3],
    free: fn(Obstacle<R>, R, Vec3<R>) -> Option<Obstacle<R>>,
    free_motion: fn(Vec3<R>, Vec3<R>) -> FreeMotion<R>,
    kicked: fn(&Obstacle<R>, R) -> Obstacle<R>,
    drive_to: fn(&mut Obstacle<R>, Vec3<R>, Orientation<R>, u32, R),
    check: fn(&Obstacle<R>, &Domain<R>, u32) -> Result<(), KernelError>,
    check_turn: fn(&Obstacle<R>, u32) -> Result<(), KernelError>,
    look: fn(&Obstacle<R>) -> (R, Vec3<R>),
    contact_motion: fn(&Obstacle<R>, &Meeting<R>, R) -> (Vec3<R>, Vec3<R>),
    own: fn(&Obstacle<R>) -> (Option<Vec3<R>>, bool),
    meet: fn(&Obstacle<R>, u32, &[Facet<R>], &Domain<R>, Vec3<R>, R) -> Meeting<R>,
    mesh: fn(Vec3<R>, &[Facet<R>], u32) -> Obstacle<R>,
    facet: fn([Vec3<R>; 3]) -> (Facet<R>, [Vec3<R>; 3]),
    arrange: fn(&mut [Facet<R>]),
    shape: fn(&Shape<R>) -> (u32, R, Option<R>, Option<Vec3<R>>),
    turns: fn(Orientation<R>, Vec3<R>) -> [Vec3<R>; 2],
    words: fn(u32) -> [u32; 2],
}

impl<R: Real> Bodies<R> {
    pub const ALL: Self = Self {
        new: Obstacle::new,
        sphere: Obstacle::sphere,
        cylinder: Obstacle::cylinder,
        plane: Obstacle::plane,
        cuboid: Obstacle::cuboid,
        long: |center, axis, radius, half| {
            [
                Obstacle::finite_cylinder(center, axis, radius, half),
                Obstacle::capsule(center, axis, radius, half),
                Obstacle::drum(center, axis, radius, half),
            ]
        },
        free: Obstacle::free,
        free_motion: FreeMotion::new,
        kicked: Obstacle::kicked,
        drive_to: Obstacle::drive_to,
        check: Obstacle::check,
        check_turn: Obstacle::check_turn,
        look: |body| (body.reach(), body.direction()),
        contact_motion: Obstacle::contact_motion,
        own: |body| (body.own_inertia(), body.is_plain()),
        meet: Obstacle::meet,
        mesh: Obstacle::mesh,
        facet: |corners| {
            let facet = Facet::new(corners);
            (facet, facet.corners())
        },
        arrange,
        shape: |shape| {
            (
                shape.surfaces(),
                shape.reach(),
                shape.volume(),
                shape.inertia(),
            )
        },
        turns: |orientation, v| [to_world(orientation, v), to_body(orientation, v)],
        words: |word| [obstacle_of(word), surface_of(word)],
    };
}
