//! Columns of a block of contacts: as many numbers side by side as there are contacts in it.

use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::vec3::Vec3;
use crate::state::grains::Group;

/// Pairs of a block: enough that filling and emptying it costs little, few enough for the nearest
/// cache; fewer if the stack is small. A multiple of [`STRIDE`].
pub(crate) const BLOCK: usize = if cfg!(any(target_arch = "arm", target_arch = "riscv32")) {
    1
} else {
    64
};

/// A block is evaluated in whole strides, so that no register is left partly filled: what fills up the
/// last one is not read.
pub(crate) const STRIDE: usize = if BLOCK < 8 { BLOCK } else { 8 };

pub(crate) type Column<R> = [R; BLOCK];
pub(crate) type Columns<R> = [Column<R>; 3];
pub(crate) type Rows<R> = [Row<R>; BLOCK];

/// Rows of grains.
#[derive(Clone, Copy)]
pub(crate) struct Bodies<'a, R> {
    /// Positions and radii.
    pub position: &'a [Row<R>],
    /// Velocities and masses.
    pub velocity: &'a [Row<R>],
    /// Spins and inverse contact masses.
    pub spin: &'a [Row<R>],
    /// Groups of the grains, and all groups.
    pub group: (&'a [u8], &'a [Group<R>]),
}

/// [`NormalForce`](crate::contact::NormalForce) in columns.
pub(crate) struct NormalForces<R> {
    pub force: Column<R>,
    pub contact_radius: Column<R>,
    pub damping: Column<R>,
    pub lever_arm_i: Column<R>,
    pub lever_arm_j: Column<R>,
}

#[inline(always)]
pub(crate) fn taken<R: Real>(columns: &Columns<R>, k: usize) -> Vec3<R> {
    [columns[0][k], columns[1][k], columns[2][k]]
}

#[inline(always)]
pub(crate) fn put<R: Real>(columns: &mut Columns<R>, k: usize, v: Vec3<R>) {
    columns[0][k] = v[0];
    columns[1][k] = v[1];
    columns[2][k] = v[2];
}
