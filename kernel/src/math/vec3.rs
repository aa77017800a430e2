//! Three-vectors as plain arrays, every sum written out so that its order is part of the contract.

use crate::math::real::{Real, magnitude};

/// A vector with components along x, y and z.
pub type Vec3<R> = [R; 3];

/// `a + b`, component by component.
#[inline(always)]
pub fn add<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`, component by component.
#[inline(always)]
pub fn sub<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a * s`, component by component.
#[inline(always)]
pub fn scale<R: Real>(a: Vec3<R>, s: R) -> Vec3<R> {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// `(a_x b_x + a_y b_y) + a_z b_z`.
#[inline(always)]
pub fn dot<R: Real>(a: Vec3<R>, b: Vec3<R>) -> R {
    (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2]
}

/// `a x b`; each component is the first product minus the second.
#[inline(always)]
pub fn cross<R: Real>(a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The first three words of a row of four.
#[inline(always)]
pub fn head<R: Real>(row: [R; 4]) -> Vec3<R> {
    [row[0], row[1], row[2]]
}

/// `a` if `first` holds, else `b`: three selections, not a branch.
#[inline(always)]
pub fn either<R: Real>(first: bool, a: Vec3<R>, b: Vec3<R>) -> Vec3<R> {
    [
        if first { a[0] } else { b[0] },
        if first { a[1] } else { b[1] },
        if first { a[2] } else { b[2] },
    ]
}

/// Whether a vector is longer than `reach`; not if that cannot be told because squares are too large.
#[inline(always)]
pub(crate) fn is_beyond<R: Real>(d: Vec3<R>, reach: R) -> bool {
    if R::FIXED_POINT {
        // Differences of places are numbers, but their squares need not be.
        let near = |x: R| magnitude(x) <= reach;
        if !(near(d[0]) && near(d[1]) && near(d[2])) {
            return true;
        }
    }
    dot(d, d) > reach * reach
}

/// The length of a vector; in fixed point, where squares of small numbers vanish, a bound of it: the sum of its parts.
#[inline(always)]
pub(crate) fn length_bound<R: Real>(v: Vec3<R>) -> R {
    match R::FIXED_POINT {
        true => (magnitude(v[0]) + magnitude(v[1])) + magnitude(v[2]),
        false => dot(v, v).sqrt(),
    }
}
