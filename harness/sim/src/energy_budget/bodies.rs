//! Energies of obstacles that move freely, and the power of what moves obstacles.

use bitgrain_kernel::vec3::{add, dot};
use bitgrain_kernel::{Domain, FreeMotion, Motion, Obstacle, to_body};

/// A gravity times an unwrapped place: how far along it a unit of mass lies.
pub(super) fn along(
    gravity: [f64; 3],
    place: [f64; 3],
    image: [i32; 3],
    domain: &Domain<f64>,
) -> f64 {
    let (lo, hi) = (domain.lo(), domain.hi());
    let mut along = 0.0;
    for a in 0..3 {
        let crossed = f64::from(image[a]);
        // Open space has no width to count crossings by.
        let shift = if crossed == 0.0 {
            0.0
        } else {
            crossed * (hi[a] - lo[a])
        };
        along += gravity[a] * (place[a] + shift);
    }
    along
}

/// Kinetic and gravitational energy of a body that moves freely; zero of another.
pub(super) fn energies(body: &Obstacle<f64>, domain: &Domain<f64>) -> (f64, f64) {
    let Motion::Free(free) = body.motion else {
        return (0.0, 0.0);
    };
    let mass = 1.0 / body.inverse_mass;
    let own = to_body(body.orientation, body.angular_velocity);
    let mut kinetic = 0.5 * mass * dot(body.velocity, body.velocity);
    if free.spins {
        kinetic += 0.5
            * (0..3)
                .map(|a| free.inertia[a] * own[a] * own[a])
                .sum::<f64>();
    }
    let along = along(free.gravity, body.point, body.image, domain);
    (kinetic, -mass * along)
}

/// The power that a body which moves freely gets from its host, and from what keeps it from answering a force or
/// torque; besides, what its contacts do to it, which with the power on the grains leaves what is lost between the
/// place where surfaces meet and the end of the grain's lever.
pub(super) fn power(body: &Obstacle<f64>) -> f64 {
    let Motion::Free(free) = body.motion else {
        return 0.0;
    };
    let (v, w) = (body.velocity, body.angular_velocity);
    let mut power = dot(body.force, v) + dot(body.torque, w) + dot(free.force, v);
    power += dot(free.torque, w);
    for a in 0..3 {
        if !free.integrates[a] {
            let weight = free.gravity[a] / body.inverse_mass;
            power -= (body.force[a] + free.force[a] + weight) * v[a];
        }
    }
    power - held_turn(body, &free)
}

/// The power of what holds its angular velocity.
fn held_turn(body: &Obstacle<f64>, free: &FreeMotion<f64>) -> f64 {
    if free.spins {
        return 0.0;
    }
    dot(add(body.torque, free.torque), body.angular_velocity)
}
