//! Closed forms of single contacts, and how fast the scheme comes to them as the time step is halved.

use bitgrain::case::{Case, ObstacleSpec};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::simulation::Simulation;
use bitgrain_tests::{ball, floor, open_case};

use crate::bodies::begin;

fn elastic(kn: f64, mu: f64) -> LawSpec {
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn,
        kt: 1.225 * kn,
        gamma_n: 0.0,
        gamma_t: 0.0,
        mu,
        rolling: None,
    })
}

/// Mass of a grain of diameter 1 and density 1.
const MASS: f64 = core::f64::consts::PI / 6.0;

/// Orders of convergence: logarithms of the ratios of errors at steps that are halved.
fn orders(error: impl Fn(f64) -> f64, coarsest: f64) -> Vec<f64> {
    let errors: Vec<f64> = (0..5)
        .map(|k| error(coarsest / f64::from(1 << k)).abs())
        .collect();
    println!("errors {errors:?}");
    errors
        .windows(2)
        .map(|pair| (pair[0] / pair[1]).log2())
        .collect()
}

/// A ball that meets a wall at speed 1: the overlap at two instants, on the way in and on the way out, is that of
/// Hertz's collision, by quadrature. The force is only once differentiable where the bodies meet, which bends the order
/// by less than a tenth.
#[test]
fn hertz_collision_is_of_second_order() {
    let kn = 2e4;
    let deepest = (1.25 * MASS / (kn * 0.5f64.sqrt())).powf(0.4);
    // With overlap/deepest = 1 - y^2, time from the deepest overlap is the integral of 2 y/sqrt(1 - (1 - y^2)^(5/2)).
    let time_to = |end: f64| {
        let n = 200_000;
        let part = end / f64::from(n);
        let each = (0..n).map(|k| {
            let y = (f64::from(k) + 0.5) * part;
            2.0 * y / (1.0 - (1.0 - y * y).powf(2.5)).sqrt()
        });
        each.sum::<f64>() * part * deepest
    };
    let half = time_to(1.0);
    for (y, side) in [(0.7, -1.0), (0.6, 1.0)] {
        let time = half + side * time_to(y);
        let error = |part: f64| {
            let steps = (1.0 / part).round();
            let start = ball(1, [0.0, 0.0, 0.5], [0.0, 0.0, -1.0]);
            let case = open_case(elastic(kn, 0.0), time / steps, vec![start], vec![floor()]);
            let mut sim = begin(&case);
            sim.steps(steps as u64).expect("a sound case");
            (0.5 - sim.position[0][2]) / deepest - (1.0 - y * y)
        };
        for order in orders(error, 1.0 / 50.0) {
            assert!((order - 2.0).abs() < 0.1, "y = {y}: order {order}");
        }
    }
}

/// A ball pressed on a wall by its weight and pushed along it: under constant load the tangential spring swings at
/// `sqrt(7 k_t/(2 m))`, and the velocity is `v (1 - 2/7 (1 - cos))`.
#[test]
fn tangential_swing_is_of_second_order() {
    let (kn, speed) = (2e4, 1e-3);
    let overlap = (MASS / (kn * 0.5f64.sqrt())).powf(2.0 / 3.0);
    let stiffness = 1.225 * kn * (0.5 * overlap).sqrt();
    let rate = (3.5 * stiffness / MASS).sqrt();
    let time = 2.3 / rate;
    let error = |part: f64| {
        let steps = (1.0 / part).round();
        let start = ball(1, [0.0, 0.0, 0.5 - overlap], [speed, 0.0, 0.0]);
        let case = Case {
            gravity: [0.0, 0.0, -1.0],
            ..open_case(elastic(kn, 10.0), time / steps, vec![start], vec![floor()])
        };
        let mut sim = begin(&case);
        sim.steps(steps as u64).expect("a sound case");
        sim.velocity[0][0] / speed - (1.0 - 2.0 / 7.0 * (1.0 - 2.3f64.cos()))
    };
    for order in orders(error, 1.0 / 20.0) {
        assert!((order - 2.0).abs() < 0.1, "order {order}");
    }
}

/// The velocity that a damper sees is that of half a step before, and a contact ends within a step: restitution is of
/// first order at least (0.9 at e = 0.3, 1.5 at 0.7). Where in a step it ends makes single ratios irregular, so the
/// mean over four halvings is taken.
#[test]
fn damping_is_of_first_order_at_least() {
    for asked in [0.3, 0.7] {
        let law = LawSpec::HertzTsuji(HertzTsujiParameters {
            young: 2e4,
            poisson: 0.3,
            restitution: asked,
            mu: 0.5,
            rolling: None,
        });
        let error = |dt: f64| {
            let start = ball(1, [0.0, 0.0, 0.5], [0.0, 0.0, -1.0]);
            let mut sim = begin(&open_case(law, dt, vec![start], vec![floor()]));
            while sim.position[0][2] < 0.5 || sim.velocity[0][2] < 0.0 {
                sim.steps(1).expect("a sound case");
            }
            sim.velocity[0][2] / asked - 1.0
        };
        let orders = orders(error, 1e-4);
        let mean = orders.iter().sum::<f64>() / orders.len() as f64;
        assert!(mean > 0.8, "e = {asked}: order {mean}");
    }
}

/// A ball falls on a wall and goes on falling while it touches: at the deepest all energy is in the spring,
/// `m g (h + delta) = (2/5) k delta^(5/2)`.
#[test]
fn a_falling_ball_goes_as_deep_as_its_energy() {
    let (kn, height) = (2e4, 0.1);
    let stiffness = kn * 0.5f64.sqrt();
    let mut expected: f64 = 0.02;
    for _ in 0..100 {
        expected = (2.5 * MASS * (height + expected) / stiffness).powf(0.4);
    }
    let start = ball(1, [0.0, 0.0, 0.5 + height], [0.0; 3]);
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(elastic(kn, 0.0), 1e-4, vec![start], vec![floor()])
    };
    let mut sim = begin(&case);
    let mut deepest: f64 = 0.0;
    while sim.velocity[0][2] <= 0.0 {
        sim.steps(1).expect("a sound case");
        deepest = deepest.max(0.5 - sim.position[0][2]);
    }
    // Some 500 steps a contact: the largest sample is within (1/500)^2 of the top.
    assert!(
        (deepest / expected - 1.0).abs() < 1e-5,
        "{deepest} {expected}"
    );
}

/// Two grains of different densities between a floor and a ceiling that are nearer than both are high: at rest each of
/// the three contacts carries what the one above carries and the weight between.
#[test]
fn two_grains_are_pressed_between_walls() {
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 2e3,
        poisson: 0.3,
        restitution: 0.3,
        mu: 0.0,
        rolling: None,
    });
    let mut upper = ball(2, [0.0, 0.0, 1.43], [0.0; 3]);
    upper.density = 3.0;
    let ceiling = ObstacleSpec::plane([0.0, 0.0, 1.9], [0.0, 0.0, -1.0]);
    let grains = vec![ball(1, [0.0, 0.0, 0.47], [0.0; 3]), upper];
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(law, 1e-3, grains, vec![floor(), ceiling])
    };
    let mut sim = begin(&case);
    sim.steps(100_000).expect("it comes to rest");
    // Overlaps by bisection on the force at the ceiling: the lower two follow from the weights.
    let kn = 4.0 / 3.0 * 2e3 / (2.0 * (1.0 - 0.09));
    let overlap = |force: f64, radius: f64| (force / (kn * radius.sqrt())).powf(2.0 / 3.0);
    let squeezed = |top: f64| {
        let (middle, bottom) = (top + 3.0 * MASS, top + 4.0 * MASS);
        overlap(top, 0.5) + overlap(middle, 0.25) + overlap(bottom, 0.5)
    };
    let (mut low, mut high) = (0.0, 100.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if squeezed(middle) < 0.1 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let forces = |sim: &Simulation| [0, 1].map(|k: usize| sim.obstacles[k].force[2]);
    let [below, above] = forces(&sim);
    // Places near 1 are known to 1e-16, which is 1e-14 of an overlap of 0.01.
    assert!((above / low - 1.0).abs() < 1e-10, "{above} {low}");
    assert!((-below / (low + 4.0 * MASS) - 1.0).abs() < 1e-10, "{below}");
}
