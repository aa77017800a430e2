//! Turning without sines: orientations as unit quaternions, turned by rational rotations.
//!
//! With `h`, half a spin times a time, the quaternion `(c, h) / |(c, h)|` is a rotation about `h` by `2 atan (|h| /
//! c)`, of `+ - * /` and a square root alone. It is an exact rotation whatever `c` and `h` are, so a body keeps its
//! shape. A free body turns with `c = 1` (Cayley), by `2 |h|` to second order, as its scheme is. A body that is turned
//! as its host says turns by `2 |h|`, which is the spin times the time, since its `c` is `|h| / tan |h|`.

use crate::math::real::Real;
use crate::math::vec3::{Vec3, add, cross, dot, scale};

/// A unit quaternion `(w, x, y, z)` that takes a vector from a body's own axes to those of the world.
pub type Orientation<R> = [R; 4];

/// The orientation of a body whose axes are those of the world.
pub(crate) const fn upright<R: Real>() -> Orientation<R> {
    [R::ONE, R::ZERO, R::ZERO, R::ZERO]
}

/// Whether a body with this orientation has the world's axes.
#[inline(always)]
pub(crate) fn is_upright<R: Real>([w, x, y, z]: Orientation<R>) -> bool {
    w == R::ONE && x == R::ZERO && y == R::ZERO && z == R::ZERO
}

/// A vector of a body's own axes as one of the world: `v + w t + u x t` with `t = 2 (u x v)`.
pub fn to_world<R: Real>([w, x, y, z]: Orientation<R>, v: Vec3<R>) -> Vec3<R> {
    rotated(w, [x, y, z], v)
}

/// A vector of the world as one of a body's own axes.
pub fn to_body<R: Real>([w, x, y, z]: Orientation<R>, v: Vec3<R>) -> Vec3<R> {
    rotated(w, [-x, -y, -z], v)
}

/// One copy of it, for small machines; so below.
#[inline(never)]
fn rotated<R: Real>(w: R, u: Vec3<R>, v: Vec3<R>) -> Vec3<R> {
    let once = cross(u, v);
    let t = add(once, once);
    add(add(v, scale(t, w)), cross(u, t))
}

/// The orientation `p` followed by `q`, both seen from the world.
#[inline(never)]
pub(crate) fn after<R: Real>(q: Orientation<R>, p: Orientation<R>) -> Orientation<R> {
    let ([a, x, y, z], [b, s, t, u]) = (q, p);
    let (q, p) = ([x, y, z], [s, t, u]);
    let across = add(add(scale(p, a), scale(q, b)), cross(q, p));
    [a * b - dot(q, p), across[0], across[1], across[2]]
}

/// The square of a quaternion's length.
pub(crate) fn length2<R: Real>(q: Orientation<R>) -> R {
    ((q[0] * q[0] + q[1] * q[1]) + q[2] * q[2]) + q[3] * q[3]
}

/// The quaternion divided by its length.
pub(crate) fn normalized<R: Real>(q: Orientation<R>) -> Orientation<R> {
    let length = length2(q).sqrt();
    q.map(|x| x / length)
}

/// One over the product of two odd numbers in a row, for each level of [`over_tangent`]; the last one counts most.
const LEVELS: [f64; 8] = [
    1.0 / 255.0,
    1.0 / 195.0,
    1.0 / 143.0,
    1.0 / 99.0,
    1.0 / 63.0,
    1.0 / 35.0,
    1.0 / 15.0,
    1.0 / 3.0,
];

/// `a / tan a` by the square of `a`: Lambert's continued fraction `1 - a^2/(3 - a^2/(5 - ...))`, each level divided by
/// its odd number, so that all are about 1 in any number type. Eight levels give it to the last digit up to `a = 1`.
fn over_tangent<R: Real>(square: R) -> R {
    let deeper = |level: R, part: &f64| R::ONE - (square * R::from_f64(*part)) / level;
    LEVELS.iter().fold(R::ONE, deeper)
}

/// The orientation after a turn at the spin `w` of the world for a time of which `half` is the half: by the spin times
/// the time, to rounding up to two radians.
pub(crate) fn turned<R: Real>(q: Orientation<R>, w: Vec3<R>, half: R) -> Orientation<R> {
    let h = scale(w, half);
    normalized(after([over_tangent(dot(h, h)), h[0], h[1], h[2]], q))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3::sub;
    use proptest::prelude::*;

    fn orientation() -> impl Strategy<Value = Orientation<f64>> {
        let any = prop::array::uniform4(-1.0..1.0f64);
        let any = any.prop_filter("a direction", |q| {
            q.iter().map(|x| x * x).sum::<f64>() > 1e-2
        });
        any.prop_map(normalized)
    }

    fn vector() -> impl Strategy<Value = Vec3<f64>> {
        prop::array::uniform3(-3.0..3.0f64)
    }

    fn near(a: Vec3<f64>, b: Vec3<f64>) -> bool {
        // Some ten roundings of products up to thirty.
        sub(a, b).iter().all(|x| x.abs() < 1e-13)
    }

    proptest! {
        /// Lengths and angles stay, the way back leads back, and two turns are one.
        #[test]
        fn a_turn_is_a_rotation(q in orientation(), p in orientation(), v in vector(), u in vector()) {
            let (w, z) = (to_world(q, v), to_world(q, u));
            prop_assert!((dot(w, z) - dot(v, u)).abs() < 3e-13);
            prop_assert!(near(cross(w, z), to_world(q, cross(v, u))));
            prop_assert!(near(to_body(q, w), v));
            prop_assert!(near(to_world(after(q, p), v), to_world(q, to_world(p, v))));
            prop_assert!(near(to_world(upright(), v), v));
        }
    }

    /// Turned at a constant spin about an axis, by the spin times the time: after n steps by n times as much.
    #[test]
    fn a_spin_turns_by_itself_times_the_time() {
        let steps = 2000;
        for dt in [1e-9, 1e-3, 0.03, 0.5, 1.0, 2.0] {
            let (mut q, spin) = (upright(), 1.0);
            for _ in 0..steps {
                q = turned(q, [0.0, 0.0, spin], dt * 0.5);
            }
            let angle = f64::from(steps) * spin * dt;
            let (v, expected) = (
                to_world(q, [1.0, 0.0, 0.0]),
                [libm::cos(angle), libm::sin(angle), 0.0],
            );
            // Two thousand roundings of an ulp.
            let off = sub(v, expected).map(f64::abs);
            assert!(off.iter().all(|x| *x < 2e-12), "{dt} {off:?}");
        }
    }

    /// The levels leave no more than the last digits of a tangent.
    #[test]
    fn the_fraction_is_a_tangent() {
        for k in 0..=1000 {
            let a = f64::from(k) * 1e-3;
            let angle = libm::atan2(a, over_tangent(a * a));
            assert!((angle - a).abs() <= 3e-16 * a, "{a}: {angle}");
        }
    }
}
