//! Restitution on a flat wall by the law, against the series for viscoelastic spheres
//! (Kumar 2018, Fig. 2).

use bitgrain_kernel::contact::{HertzHistory, Kept, Law, NormalState};

use super::number::{Found, Number};
use crate::analysis::Value;

/// K_n and gamma_n of the paper.
const KN: f64 = 2e8;
const GAMMA_N: f64 = 5e4;
/// Speeds v/sqrt(g d) of the figure.
const SPEEDS: [f64; 8] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0];
/// Steps of the shortest collision.
const STEPS: f64 = 2000.0;
/// First four numbers of the series (Ramirez et al., Phys. Rev. E 60, 4465, 1999).
const SERIES: [f64; 4] = [-1.15344, 0.79826, -0.48358, 0.28528];

/// The series at a speed: a ball of diameter 1 and density 1 on a wall.
///
/// `e = 1 + sum of SERIES[k] beta^(k + 1) v^((k + 1)/5)`, `beta = (3/2) A (rho/m)^(2/5)`, with the elastic
/// force `rho delta^(3/2)` and the dissipative one `(3/2) A rho sqrt(delta) v`.
fn series(speed: f64) -> f64 {
    let (m, r) = (std::f64::consts::PI / 6.0, 0.5f64);
    let beta = m * GAMMA_N / KN * libm::pow(KN * r.sqrt() / m, 0.4);
    let x = beta * libm::pow(speed, 0.2);
    let (mut e, mut power) = (1.0, 1.0);
    for number in SERIES {
        power *= x;
        e += number * power;
    }
    e
}

/// Restitution of one ball that meets the wall at a speed, under the kernel's law.
fn collided(speed: f64) -> f64 {
    let (m, r) = (std::f64::consts::PI / 6.0, 0.5);
    let law = HertzHistory {
        kn: KN,
        kt: 0.0,
        gamma_n: GAMMA_N,
        gamma_t: 0.0,
        mu: 0.0,
    };
    // Duration of an elastic Hertz collision: 3.2145 (m^2/(rho^2 v))^(1/5), rho = K_n sqrt(R).
    let rho = KN * libm::sqrt(r);
    let dt = 3.2145 * libm::pow(m * m / (rho * rho * speed), 0.2) / STEPS;
    let (mut x, mut v, mut f) = (0.0, -speed, 0.0);
    loop {
        v += 0.5 * dt * f / m;
        x += dt * v;
        if x >= 0.0 {
            return v / speed;
        }
        let squeeze = NormalState {
            overlap: -x,
            speed: v,
            radius_i: r,
            radius_j: 0.0,
            radius_effective: r,
            mass_effective: m,
            inverse_masses: [1.0 / m, 0.0],
            materials: [0; 2],
            memory: Kept::NOTHING.memory,
        };
        f = law.normal_force(&squeeze).force;
        v += 0.5 * dt * f / m;
    }
}

/// The largest difference of the two over the speeds of the figure.
pub fn measure() -> Found {
    let mut most = (0.0, 0.0);
    for speed in SPEEDS {
        let off = (collided(speed) - series(speed)).abs();
        if off > most.0 {
            most = (off, speed);
        }
    }
    let note = format!("at v* = {}", most.1);
    Ok(Number::one(Value::new(most.0, 0.0), note))
}
