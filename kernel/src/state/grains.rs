//! Grains as rows of four words, and the groups that say how they move.

use crate::Row;
use crate::math::real::Real;

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
}

impl<R: Real> Group<R> {
    /// Free grains under this gravity.
    pub fn free(gravity: [R; 3]) -> Self {
        Self {
            integrates: [true; 3],
            spins: true,
            infinite_mass: false,
            gravity,
        }
    }

    /// Grains that never move and are infinitely heavy in a contact.
    pub fn frozen() -> Self {
        Self {
            integrates: [false; 3],
            spins: false,
            infinite_mass: true,
            gravity: [R::ZERO; 3],
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
        }
    }
}

/// All grains of a world, borrowed: one entry a grain in each slice, by ascending id.
pub struct Grains<'a, R> {
    /// Names; they strictly ascend, and need not be consecutive.
    pub id: &'a [u32],
    /// Place of each grain's group in `groups`.
    pub group: &'a [u8],
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
    /// Its torque about the grain's centre; the last word is unused.
    pub torque: &'a mut [Row<R>],
    /// Crossings of each periodic axis so far.
    pub image: &'a mut [[i32; 3]],
}

impl<R: Real> Grains<'_, R> {
    /// How many grains there are.
    pub fn count(&self) -> usize {
        self.position.len()
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
