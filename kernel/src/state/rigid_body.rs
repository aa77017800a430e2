//! The way of an obstacle through a step: as its host says, or freely, as a rigid body under the forces on it.
//!
//! A free body takes the half kicks and the drift of a grain. Between the kicks nothing pushes it, and its angular
//! momentum stays: it is turned about its own axes x, y, z, y, x in turn, each time by Cayley's rotation at the spin
//! about that axis, for half the step but for z, which takes it whole. Each of the five turns keeps angular momentum
//! and is the exact motion of some energy function of that axis alone, so the scheme is symplectic and of second order
//! (the splitting of Dullweber, Leimkuhler and McLachlan 1997, with rational rotations).

use crate::math::real::Real;
use crate::math::vec3::{Vec3, add, scale};
use crate::state::domain::Domain;
use crate::state::motion::{FreeMotion, Motion};
use crate::state::obstacle::Obstacle;
use crate::state::turning::{Orientation, after, normalized, to_body, to_world, turned};

impl<R: Real> Obstacle<R> {
    /// This body as one that moves freely with this density (mass / length^3) and gravity (length / time^2); its mass
    /// enters its contacts too. `None` if its shape has no volume, or an axis that is not one of its own three: give it
    /// `inverse_mass` and [`FreeMotion`] then.
    #[must_use]
    pub fn free(self, density: R, gravity: Vec3<R>) -> Option<Self> {
        let inverse_mass = R::ONE / (density * self.shape.volume()?);
        let body = Self {
            inverse_mass,
            ..self
        };
        Some(Self {
            motion: Motion::Free(FreeMotion::new(body.own_inertia()?, gravity)),
            ..body
        })
    }

    /// Moments of inertia about its own axes (mass length^2) of its mass spread evenly over its shape; `None` as of
    /// [`Shape::inertia`](crate::Shape::inertia). They are no numbers if it is infinitely heavy.
    #[must_use]
    pub fn own_inertia(&self) -> Option<Vec3<R>> {
        let of_shape = self.shape.inertia()?;
        Some(of_shape.map(|moment| moment / self.inverse_mass))
    }

    /// Half a kick, if it is free: `v += (F/m + g) h`, and in its own axes `w += (T/I) h`, with `h = dt/2`, the sums of
    /// contacts first.
    #[inline(never)]
    pub(crate) fn kick(&mut self, dt: R) {
        let Motion::Free(free) = self.motion else {
            return;
        };
        let half = dt * R::HALF;
        let push = scale(add(self.force, free.force), self.inverse_mass);
        let change = scale(add(push, free.gravity), half);
        for a in 0..3 {
            if free.integrates[a] {
                self.velocity[a] = self.velocity[a] + change[a];
            }
        }
        if free.spins {
            let torque = to_body(self.orientation, add(self.torque, free.torque));
            let mut change = scale(torque, half);
            for a in 0..3 {
                change[a] = change[a] / free.inertia[a];
            }
            let change = to_world(self.orientation, change);
            self.angular_velocity = add(self.angular_velocity, change);
        }
    }

    /// As it is in the drift that comes next, and when the forces after it are evaluated: half a kick on.
    #[must_use]
    pub fn kicked(&self, dt: R) -> Self {
        let mut next = *self;
        next.kick(dt);
        next
    }

    /// Moves and turns it by one step of `dt` and wraps it.
    #[inline(never)]
    pub(crate) fn drift(&mut self, domain: &Domain<R>, dt: R) {
        for a in 0..3 {
            self.point[a] = self.point[a] + self.velocity[a] * dt;
        }
        // An obstacle may leave the box through a closed edge: only grains must stay inside.
        domain.wrap(&mut self.point, &mut self.image);
        match self.motion {
            Motion::Free(free) if free.spins => {
                let own = to_body(self.orientation, self.angular_velocity);
                let (orientation, own) = turned_freely(self.orientation, own, free.inertia, dt);
                self.orientation = orientation;
                self.angular_velocity = to_world(orientation, own);
            }
            _ if self.angular_velocity != [R::ZERO; 3] => {
                let half = dt * R::HALF;
                self.orientation = turned(self.orientation, self.angular_velocity, half);
            }
            _ => {}
        }
    }
}

/// The orientation, and the spin in its own axes, of a body that nothing pushes after a step.
fn turned_freely<R: Real>(
    orientation: Orientation<R>,
    spin: Vec3<R>,
    inertia: Vec3<R>,
    dt: R,
) -> (Orientation<R>, Vec3<R>) {
    let (half, quarter) = (dt * R::HALF, (dt * R::HALF) * R::HALF);
    let state = turned_about::<R, 0, 1, 2>((orientation, spin), inertia, quarter);
    let state = turned_about::<R, 1, 2, 0>(state, inertia, quarter);
    let state = turned_about::<R, 2, 0, 1>(state, inertia, half);
    let state = turned_about::<R, 1, 2, 0>(state, inertia, quarter);
    let (q, w) = turned_about::<R, 0, 1, 2>(state, inertia, quarter);
    (normalized(q), w)
}

/// The same after a turn about the own axis A; B and C are the axes that follow it.
fn turned_about<R: Real, const A: usize, const B: usize, const C: usize>(
    (q, mut w): (Orientation<R>, Vec3<R>),
    inertia: Vec3<R>,
    half: R,
) -> (Orientation<R>, Vec3<R>) {
    // Of half the angle: its tangent, and by that cosine and sine of the whole.
    let t = w[A] * half;
    let square = t * t;
    let cosine = (R::ONE - square) / (R::ONE + square);
    let sine = (t + t) / (R::ONE + square);
    // Angular momentum turns back in the axes that turn on.
    let (lb, lc) = (inertia[B] * w[B], inertia[C] * w[C]);
    w[B] = (lb * cosine + lc * sine) / inertia[B];
    w[C] = (lc * cosine - lb * sine) / inertia[C];
    let mut axis = [R::ZERO; 3];
    axis[A] = t;
    (after(q, [R::ONE, axis[0], axis[1], axis[2]]), w)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3::{cross, dot, sub};
    use std::vec::Vec;

    const INERTIA: Vec3<f64> = [1.0, 2.0, 2.5];

    fn momentum(body: &Obstacle<f64>) -> Vec3<f64> {
        let own = to_body(body.orientation, body.angular_velocity);
        let [x, y, z] = [0, 1, 2].map(|a| own[a] * INERTIA[a]);
        to_world(body.orientation, [x, y, z])
    }

    fn energy(body: &Obstacle<f64>) -> f64 {
        0.5 * dot(momentum(body), body.angular_velocity)
    }

    fn spinning() -> Obstacle<f64> {
        Obstacle {
            inverse_mass: 1.0,
            // Mostly about the middle axis, about which it tumbles.
            angular_velocity: [0.1, 1.0, 0.2],
            motion: Motion::Free(FreeMotion::new(INERTIA, [0.0; 3])),
            ..Obstacle::cuboid([0.0; 3], [0.5; 3])
        }
    }

    fn after_time(time: f64, steps: u32) -> Obstacle<f64> {
        let mut body = spinning();
        for _ in 0..steps {
            let dt = time / f64::from(steps);
            body.kick(dt);
            body.drift(&Domain::open(), dt);
            body.kick(dt);
        }
        body
    }

    /// Euler's equations with the orientation, by the classical Runge-Kutta scheme.
    fn reference(time: f64, steps: u32) -> (Vec<f64>, Vec<f64>) {
        let rate = |s: [f64; 7]| {
            let w = [s[0], s[1], s[2]];
            let l = [0, 1, 2].map(|a| INERTIA[a] * w[a]);
            let turn = cross(l, w);
            let q = after([s[3], s[4], s[5], s[6]], [0.0, w[0], w[1], w[2]]);
            [
                turn[0] / INERTIA[0],
                turn[1] / INERTIA[1],
                turn[2] / INERTIA[2],
                0.5 * q[0],
                0.5 * q[1],
                0.5 * q[2],
                0.5 * q[3],
            ]
        };
        let start = spinning();
        let w = start.angular_velocity;
        let mut s = [w[0], w[1], w[2], 1.0, 0.0, 0.0, 0.0];
        let h = time / f64::from(steps);
        let plus = |s: [f64; 7], k: [f64; 7], h: f64| {
            let mut sum = s;
            (0..7).for_each(|a| sum[a] += k[a] * h);
            sum
        };
        for _ in 0..steps {
            let k1 = rate(s);
            let k2 = rate(plus(s, k1, h / 2.0));
            let k3 = rate(plus(s, k2, h / 2.0));
            let k4 = rate(plus(s, k3, h));
            (0..7).for_each(|a| s[a] += h / 6.0 * (k1[a] + 2.0 * (k2[a] + k3[a]) + k4[a]));
        }
        (s[..3].to_vec(), s[3..].to_vec())
    }

    /// The distance from the reference is a quarter at half the step.
    #[test]
    fn free_spin_is_of_second_order() {
        let time = 10.0;
        let (spin, orientation) = reference(time, 20_000);
        let error = |steps: u32| {
            let body = after_time(time, steps);
            let own = to_body(body.orientation, body.angular_velocity);
            let spins = own.iter().zip(&spin).map(|(a, b)| (a - b).abs());
            let turns = body.orientation.iter().zip(&orientation);
            spins
                .chain(turns.map(|(a, b)| (a - b).abs()))
                .fold(0.0, f64::max)
        };
        let errors = [1000, 2000, 4000].map(error);
        for pair in errors.windows(2) {
            let ratio = pair[0] / pair[1];
            // Orders of 1.9 to 2.1.
            assert!((3.7..4.3).contains(&ratio), "{errors:?}");
        }
        assert!(errors[2] < 1e-4, "{errors:?}");
    }

    /// Momentum stays to rounding; energy swings about its value and does not drift.
    #[test]
    fn a_hundred_turns_keep_energy_and_momentum() {
        let turn = core::f64::consts::TAU;
        let (steps, turns) = (2000, 100);
        let begin = spinning();
        let mut body = begin;
        let (mut worst, mut tumbles) = (0.0f64, false);
        for _ in 0..steps * turns {
            let dt = turn / f64::from(steps);
            body.kick(dt);
            body.drift(&Domain::open(), dt);
            body.kick(dt);
            worst = worst.max((energy(&body) / energy(&begin) - 1.0).abs());
            tumbles |= to_body(body.orientation, body.angular_velocity)[1] < 0.0;
        }
        let lost = sub(momentum(&body), momentum(&begin));
        let lost = (dot(lost, lost) / dot(momentum(&begin), momentum(&begin))).sqrt();
        assert!(lost < 1e-11, "{lost:e}");
        assert!(worst < 1e-6, "{worst:e}");
        assert!(tumbles);
    }

    /// A constant torque about an axis, and a force: half kicks give the parabola exactly but for rounding.
    #[test]
    fn forces_and_torques_of_the_host_push() {
        let mut body = Obstacle {
            inverse_mass: 0.5,
            motion: Motion::Free(FreeMotion {
                force: [3.0, 0.0, 0.0],
                torque: [0.0, 0.0, 0.01],
                integrates: [true, true, false],
                ..FreeMotion::new(INERTIA, [0.0, 0.0, -1.0])
            }),
            ..Obstacle::cuboid([0.0; 3], [0.5; 3])
        };
        let (dt, steps) = (1e-3, 1000);
        for _ in 0..steps {
            body.kick(dt);
            body.drift(&Domain::open(), dt);
            body.kick(dt);
        }
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(near(body.velocity[0], 1.5) && near(body.point[0], 0.75));
        assert!(body.velocity[2] == 0.0 && body.point[2] == 0.0);
        assert!(near(body.angular_velocity[2], 0.01 / 2.5));
        let angle = 2.0 * libm::atan2(body.orientation[3], body.orientation[0]);
        assert!(near(angle, 0.002), "{angle}");
    }
}
