//! Twenty bounces of a ball: each height is e^2 of the one before.

use bitgrain::case::Case;
use bitgrain::law::{HertzTsujiParameters, LawSpec};
use bitgrain_tests::{ball, floor, open_case};

use crate::bodies::begin;

const RESTITUTION: f64 = 0.9;

/// Heights of twenty bounces of a ball of this stiffness that falls by its own diameter.
fn heights(young: f64) -> Vec<f64> {
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young,
        poisson: 0.3,
        restitution: RESTITUTION,
        mu: 0.5,
        rolling: None,
    });
    // Some two thousand steps a contact.
    let dt = 5e-4 * law.contact_duration(1.0, 0.5, 1.0);
    // As fast as if it had fallen by its diameter.
    let start = ball(1, [0.0, 0.0, 0.5], [0.0, 0.0, -std::f64::consts::SQRT_2]);
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(law, dt, vec![start], vec![floor()])
    };
    let mut sim = begin(&case);
    let mut heights = Vec::new();
    while heights.len() < 20 {
        // In flight the motion is exact: what left the floor comes back to it as fast, and the steps between are left
        // out.
        while !(sim.velocity[0][2] > 0.0 && sim.position[0][2] > 0.5) {
            sim.steps(1).expect("it bounces");
        }
        let (z, v) = (sim.position[0][2] - 0.5, sim.velocity[0][2]);
        heights.push(z + 0.5 * v * v);
        sim.velocity[0][2] = -v;
        sim.start().expect("a sound state");
    }
    heights
}

/// The n-th height is `e^(2 n)` of the first fall for hard balls. Weight acts while a ball touches, over a part of the
/// height that is overlap/height, of order `E^(-2/5)`: between balls 32 times as stiff as each other the twentieth
/// height changes by a quarter each time. For the stiffest here, which goes 1.5e-4 of the fall deep, two thousandths
/// are left; the quarters add up to a rigid ball's height within a ten-thousandth.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn twenty_heights_fall_by_the_square_of_restitution() {
    let heights = [1e7, 3.2e8, 1.024e10].map(heights);
    for (n, height) in (1..).zip(&heights[2]) {
        let expected = RESTITUTION.powi(2 * n);
        assert!(
            (height / expected - 1.0).abs() < 2.5e-3,
            "bounce {n}: {height} {expected}"
        );
    }
    let [soft, hard, harder] = heights.map(|all| all[19] / RESTITUTION.powi(40) - 1.0);
    println!("{soft:.2e} {hard:.2e} {harder:.2e}");
    let ratio = (soft - hard) / (hard - harder);
    assert!((ratio / 4.0 - 1.0).abs() < 0.05, "{ratio}");
}
