//! Grains as rows of four words, and the groups that say how they move.

use crate::math::real::Real;
use crate::math::rows::{Row, get_or_default, set, shorten};
use crate::math::vec3::{Vec3, head};

/// How the grains of a group move and what weighs on them. A motion that is not integrated keeps
/// the velocity that the grain's row holds: zero for frozen grains, the carrying velocity for others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Group<R> {
    /// Along which axes the grains answer forces and gravity.
    pub integrates: [bool; 3],
    /// Whether they answer torques.
    pub spins: bool,
    /// Whether they count as infinitely heavy in a contact. Two such grains never push each other.
    #[cfg_attr(feature = "serde", serde(rename = "heavy"))]
    pub infinite_mass: bool,
    /// Acceleration of gravity on these grains (length / time^2).
    pub gravity: [R; 3],
    /// Number of their material, for a law that tells materials apart.
    pub material: u8,
}

/// The material of the grain at a place: that of its group, by number and among these groups.
#[inline(always)]
pub(crate) fn material_of<R: Real>((group, groups): (&[u8], &[Group<R>]), place: usize) -> u8 {
    let group = groups.get(usize::from(get_or_default(group, place)));
    group.map_or(0, |group| group.material)
}

impl<R: Real> Group<R> {
    /// Free grains under this gravity.
    pub fn free(gravity: [R; 3]) -> Self {
        Self {
            integrates: [true; 3],
            spins: true,
            infinite_mass: false,
            gravity,
            material: 0,
        }
    }

    /// The same group of another material.
    #[must_use]
    pub fn of_material(self, material: u8) -> Self {
        Self { material, ..self }
    }

    /// Grains that never move and are infinitely heavy in a contact.
    pub fn frozen() -> Self {
        Self {
            integrates: [false; 3],
            spins: false,
            infinite_mass: true,
            gravity: [R::ZERO; 3],
            material: 0,
        }
    }

    /// Grains carried at the velocity in their rows, without spin, with their own mass in a contact.
    pub fn prescribed_velocity() -> Self {
        Self {
            infinite_mass: false,
            ..Self::frozen()
        }
    }

    /// Grains carried along x and y but free along z, and free to spin: Guillard's heavy lid.
    pub fn free_along_z(gravity: [R; 3]) -> Self {
        Self {
            integrates: [false, false, true],
            spins: true,
            infinite_mass: false,
            gravity,
            material: 0,
        }
    }
}

/// A grain that comes into a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NewGrain<R> {
    /// Its name, which no other grain has.
    pub id: u32,
    /// Number of its group.
    pub group: u8,
    /// Centre (length), inside the box.
    pub position: Vec3<R>,
    /// Radius (length), positive.
    pub radius: R,
    /// Mass, positive.
    pub mass: R,
    /// Velocity (length / time).
    pub velocity: Vec3<R>,
    /// Angular velocity (radians / time).
    pub spin: Vec3<R>,
}

/// What is known of a grain within a step or at its end, in the units of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GrainState<R> {
    /// Place among the rows.
    pub place: usize,
    /// Id.
    pub id: u32,
    /// Group.
    pub group: u8,
    /// Centre (length), in the box unless it has left.
    pub position: Vec3<R>,
    /// Radius (length).
    pub radius: R,
    /// Velocity (length over time).
    pub velocity: Vec3<R>,
    /// Mass.
    pub mass: R,
    /// Angular velocity (one over time).
    pub spin: Vec3<R>,
}

impl<R: Real> GrainState<R> {
    /// From the rows of position, velocity and spin.
    #[inline(always)]
    pub(crate) fn of(place: usize, id: u32, group: u8, [x, v, w]: [&Row<R>; 3]) -> Self {
        Self {
            place,
            id,
            group,
            position: head(*x),
            radius: x[3],
            velocity: head(*v),
            mass: v[3],
            spin: head(*w),
        }
    }
}

/// All grains of a world, borrowed: one entry a grain in each slice, by ascending id.
pub struct Grains<'a, R> {
    /// Names; they strictly ascend, and need not be consecutive.
    pub id: &'a mut [u32],
    /// Place of each grain's group in `groups`.
    pub group: &'a mut [u8],
    /// The groups.
    pub groups: &'a [Group<R>],
    /// Position x, y, z (length, inside the box) and radius.
    pub position: &'a mut [Row<R>],
    /// Velocity (length / time) and mass.
    pub velocity: &'a mut [Row<R>],
    /// Spin (radians / time) and 1 / mass as it enters contacts, 0 for infinitely heavy; the last
    /// word is written when the world starts.
    pub spin: &'a mut [Row<R>],
    /// Contact force of the last evaluation, without weight; the last word is unused.
    pub force: &'a mut [Row<R>],
    /// Its torque about the grain's centre, and 1 / moment of inertia; the last word is written when the world
    /// starts.
    pub torque: &'a mut [Row<R>],
    /// Crossings of each periodic axis so far.
    pub image: &'a mut [[i32; 3]],
}

impl<R: Real> Grains<'_, R> {
    /// How many grains there are.
    pub fn count(&self) -> usize {
        self.position.len()
    }

    /// What is known of the grain at a place.
    pub(crate) fn state(&self, place: usize) -> GrainState<R> {
        let rows = [&*self.position, &*self.velocity, &*self.spin];
        let [x, v, w] = &rows.map(|rows| get_or_default(rows, place));
        let (id, group) = (
            get_or_default(self.id, place),
            get_or_default(self.group, place),
        );
        GrainState::of(place, id, group, [x, v, w])
    }

    /// Marks a grain that is to go: an inverse mass is zero or more.
    pub(crate) fn mark(&mut self, place: usize) {
        if let Some(row) = self.spin.get_mut(place) {
            row[3] = -R::ONE;
        }
    }

    /// Whether a grain is marked.
    pub(crate) fn is_marked(&self, place: usize) -> bool {
        get_or_default(self.spin, place)[3] < R::ZERO
    }

    /// Copies all that is known of a grain to another row.
    pub(crate) fn copy_row(&mut self, from: usize, to: usize) {
        set(self.id, to, get_or_default(self.id, from));
        set(self.group, to, get_or_default(self.group, from));
        set(self.position, to, get_or_default(self.position, from));
        set(self.velocity, to, get_or_default(self.velocity, from));
        set(self.spin, to, get_or_default(self.spin, from));
        set(self.force, to, get_or_default(self.force, from));
        set(self.torque, to, get_or_default(self.torque, from));
        set(self.image, to, get_or_default(self.image, from));
    }

    /// Writes a new grain to a row.
    pub(crate) fn put(&mut self, place: usize, grain: &NewGrain<R>) {
        let ([x, y, z], [u, v, w], [p, q, r]) = (grain.position, grain.velocity, grain.spin);
        set(self.id, place, grain.id);
        set(self.group, place, grain.group);
        set(self.position, place, [x, y, z, grain.radius]);
        set(self.velocity, place, [u, v, w, grain.mass]);
        set(self.spin, place, [p, q, r, R::ZERO]);
        set(self.force, place, [R::ZERO; 4]);
        set(self.torque, place, [R::ZERO; 4]);
        set(self.image, place, [0; 3]);
    }

    /// Shortens every slice to its first `count` grains.
    pub(crate) fn shrink(&mut self, count: usize) {
        shorten(&mut self.id, count);
        shorten(&mut self.group, count);
        shorten(&mut self.position, count);
        shorten(&mut self.velocity, count);
        shorten(&mut self.spin, count);
        shorten(&mut self.force, count);
        shorten(&mut self.torque, count);
        shorten(&mut self.image, count);
    }

    /// Whether every slice has one entry a grain.
    pub(crate) fn is_whole(&self) -> bool {
        let n = self.position.len();
        self.id.len() == n
            && self.group.len() == n
            && self.velocity.len() == n
            && self.spin.len() == n
            && self.force.len() == n
            && self.torque.len() == n
            && self.image.len() == n
    }
}
