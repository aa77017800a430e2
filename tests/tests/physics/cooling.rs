//! Haff's law: a gas of inelastic grains cools as `T_0/(1 + t/t_c)^2` (Haff, J. Fluid Mech. 134, 401 (1983)).

use bitgrain::case::{BoxSpec, Case};
use bitgrain::law::{HertzTsujiParameters, LawSpec};
use bitgrain::random::{Purpose, uniforms};
use bitgrain::simulation::Simulation;
use bitgrain_tests::{ball, open_case};

use crate::bodies::begin;

/// Grains of a cube of sites.
const SIDE: u32 = 13;
const FRACTION: f64 = 0.05;

/// Temperature per mass: a third of the mean square velocity.
fn temperature(sim: &Simulation) -> f64 {
    let squares = sim
        .velocity
        .iter()
        .map(|v| v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    squares.sum::<f64>() / (3.0 * sim.count() as f64)
}

/// Frictionless grains of diameter 1 in a periodic box, at the temperature 1 and without momentum.
fn gas(restitution: f64, seed: u64) -> (Case, f64) {
    let count = SIDE * SIDE * SIDE;
    let edge = (f64::from(count) * core::f64::consts::FRAC_PI_6 / FRACTION).cbrt();
    let velocity = |k: u32| {
        let [a, b, c, d] = uniforms::<4>(seed, Purpose::Velocity, k);
        let size = |u: f64| (-2.0 * (1.0 - u).ln()).sqrt();
        let turn = |u: f64| core::f64::consts::TAU * u;
        [
            size(a) * turn(b).cos(),
            size(a) * turn(b).sin(),
            size(c) * turn(d).cos(),
        ]
    };
    let mut velocities: Vec<[f64; 3]> = (0..count).map(velocity).collect();
    let mean = [0, 1, 2].map(|a| velocities.iter().map(|v| v[a]).sum::<f64>() / f64::from(count));
    velocities
        .iter_mut()
        .for_each(|v| (0..3).for_each(|a| v[a] -= mean[a]));
    let squares = velocities.iter().flatten().map(|v| v * v).sum::<f64>();
    let scale = (3.0 * f64::from(count) / squares).sqrt();
    let grains = (0..count).map(|k| {
        let site = [k % SIDE, k / SIDE % SIDE, k / SIDE / SIDE];
        let place = site.map(|s| (f64::from(s) + 0.5) * edge / f64::from(SIDE));
        ball(k + 1, place, velocities[k as usize].map(|v| v * scale))
    });
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 1e6,
        poisson: 0.3,
        restitution,
        mu: 0.0,
        rolling: None,
    });
    let dt = law.contact_duration(2.0, 0.5, 1.0) / 30.0;
    let case = Case {
        bounds: Some(BoxSpec {
            lo: [0.0; 3],
            hi: [edge; 3],
            periodic: [true; 3],
        }),
        ..open_case(law, dt, grains.collect(), Vec::new())
    };
    (case, dt)
}

/// Collisions of a grain per time at temperature 1 (Enskog): `4 sqrt(pi) n d^2 chi`, with the contact value of Carnahan
/// and Starling.
fn collision_rate() -> f64 {
    let density = FRACTION / core::f64::consts::FRAC_PI_6;
    let chi = (1.0 - 0.5 * FRACTION) / (1.0 - FRACTION).powi(3);
    4.0 * core::f64::consts::PI.sqrt() * density * chi
}

/// Each collision takes `(1 - e^2) T` on the mean, so `sqrt(T_0/T) = 1 + t/t_c` with `1/t_c = (1 - e^2) w/6` and w the
/// rate of collisions at the start. Measured from when each grain has met five others, over four times until the
/// temperature is a ninth.
///
/// The rate found is 1.9 % below that, with a standard error of 0.4 % from four seeds; the tolerance is 3 %. Known are
/// 0.2 % from the velocities' deviation from Maxwell's (van Noije and Ernst, Granular Matter 1, 57 (1998)) and 0.6 %
/// from contacts that last 0.8 % of the time between them at first. At this time step head-on impacts have a
/// restitution of 0.7996, which is worth 0.2 % the other way. The other 1.3 % are not explained: grains a hundred times
/// as stiff are 1.7 to 3.0 % below (two seeds), those with e = 0.95 by 1.8 to 2.5 %.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn a_gas_cools_as_haff_says() {
    let restitution = 0.8;
    let times = [0.5, 1.0, 1.5, 2.0];
    let mut found = [0.0; 4];
    for seed in [1, 2] {
        let (case, dt) = gas(restitution, seed);
        let mut sim = begin(&case);
        let go = |sim: &mut Simulation, time: f64| sim.steps((time / dt) as u64).expect("a gas");
        go(&mut sim, 5.0 / collision_rate());
        let (first, began) = (temperature(&sim), sim.step_count());
        let rate = (1.0 - restitution * restitution) * collision_rate() * first.sqrt() / 6.0;
        for (k, part) in times.iter().enumerate() {
            let to = part / rate - (sim.step_count() - began) as f64 * dt;
            go(&mut sim, to);
            let time = (sim.step_count() - began) as f64 * dt;
            let measured = ((first / temperature(&sim)).sqrt() - 1.0) / time;
            found[k] += 0.5 * measured / rate;
        }
    }
    println!("rates over theory at {times:?} t_c: {found:.4?}");
    for rate in found {
        assert!((rate - 1.0).abs() < 0.03, "{found:?}");
    }
}
