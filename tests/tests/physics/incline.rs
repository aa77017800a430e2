//! A sphere on an incline rolls if `tan(theta) < 7/2 mu`, and slips above.

use bitgrain::case::Case;
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain_tests::{ball, floor, open_case};

use crate::bodies::begin;

fn laws(mu: f64) -> [LawSpec; 2] {
    [
        LawSpec::HertzHistory(HertzHistoryParameters {
            kn: 2e5,
            kt: 2.45e5,
            gamma_n: 2e3,
            gamma_t: 2e3,
            mu,
            rolling: None,
        }),
        LawSpec::HertzTsuji(HertzTsujiParameters {
            young: 2e5,
            poisson: 0.3,
            restitution: 0.3,
            mu,
            rolling: None,
        }),
    ]
}

/// Acceleration and that of the spin of a ball of diameter 1 once it goes steadily, and the lever of friction.
fn steady(law: LawSpec, theta: f64) -> [f64; 3] {
    let mass = core::f64::consts::PI / 6.0;
    let stiffness = law.normal_stiffness() * 0.5f64.sqrt();
    let overlap = (mass * theta.cos() / stiffness).powf(2.0 / 3.0);
    let case = Case {
        gravity: [theta.sin(), 0.0, -theta.cos()],
        ..open_case(
            law,
            1e-4,
            vec![ball(1, [0.0, 0.0, 0.5 - overlap], [0.0; 3])],
            vec![floor()],
        )
    };
    let mut sim = begin(&case);
    // The spring swings at first; its damping takes a tenth of a unit of time.
    sim.steps(40_000).expect("it goes down");
    let before = [sim.velocity[0][0], sim.spin[0][1]];
    sim.steps(20_000).expect("it goes down");
    let after = [sim.velocity[0][0], sim.spin[0][1]];
    let short = match law {
        LawSpec::HertzHistory(_) => 0.0,
        LawSpec::HertzTsuji(_) => 0.5 * overlap,
    };
    [
        (after[0] - before[0]) / 2.0,
        (after[1] - before[1]) / 2.0,
        0.5 - short,
    ]
}

/// With r the radius and l the lever of the law: rolling `g sin/(1 + 2/5 r^2/l^2)`, which is `5/7 g sin` for l = r, and
/// slipping `g (sin - mu cos)` with the spin growing by `5/2 mu g cos l/r^2`. A hundredth on either side of the limit
/// decides. Once the spring is at rest, all forces are constant: 1e-7 is what is left of its swing.
#[test]
fn a_sphere_rolls_or_slips_by_its_friction() {
    let r = 0.5;
    for mu in [0.1f64, 0.3] {
        for law in laws(mu) {
            for part in [0.3, 0.99, 1.01, 2.0] {
                let theta = (3.5 * mu * part).atan();
                let [speed_up, turn_up, lever] = steady(law, theta);
                let inertia = 0.4 * r * r;
                let (expected, turn) = if part < 1.0 {
                    let rolls = theta.sin() / (1.0 + inertia / (lever * lever));
                    (rolls, rolls / lever)
                } else {
                    let friction = mu * theta.cos();
                    (theta.sin() - friction, friction * lever / inertia)
                };
                let what = format!("{} mu {mu}, {part} of the limit", law.kind());
                let off = [speed_up / expected - 1.0, turn_up / turn - 1.0];
                println!("{what}: {off:?}");
                assert!(off.iter().all(|x| x.abs() < 1e-10), "{what}: {off:?}");
            }
        }
    }
}
