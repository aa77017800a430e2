//! Closed forms and conservation laws.

use bitgrain::case::{BoxSpec, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::law::LawSpec;
use bitgrain::sim::{AnyLaw, Sim};
use bitgrain_kernel::{Bond, Shape};
use bitgrain_tests::{floor, open_case};

fn kumar(mu: f64) -> LawSpec {
    LawSpec::HertzHistory {
        kn: 2e8,
        kt: 2.45e8,
        gamma_n: 5e4,
        gamma_t: 5e4,
        mu,
    }
}

fn soft(mu: f64, gamma: f64) -> LawSpec {
    LawSpec::HertzHistory {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: gamma,
        gamma_t: gamma,
        mu,
    }
}

fn ball(id: u32, position: [f64; 3], velocity: [f64; 3]) -> GrainSpec {
    GrainSpec {
        id,
        diameter: 1.0,
        density: 1.0,
        position,
        velocity,
        spin: [0.0; 3],
        motion: MotionSpec::Free,
    }
}

/// Speed after over speed before of a ball of diameter 1 on a flat wall (Kumar 2018, Fig. 2).
fn restitution(speed: f64, dt: f64) -> f64 {
    let start = ball(1, [0.0, 0.0, 0.5 + 1e-7], [0.0, 0.0, -speed]);
    let mut sim = open_case(kumar(0.5), dt, vec![start], vec![floor()])
        .start("wall", |_| {})
        .expect("a sound case");
    for _ in 0..1_000_000 {
        sim.steps(1).expect("a sound case");
        if sim.velocity[0][2] > 0.0 && sim.position[0][2] > 0.5 {
            return sim.velocity[0][2] / speed;
        }
    }
    panic!("the ball stays on the wall");
}

/// The values that a fine step converges to; 2e-4 is what is left at dt = 5e-7.
#[test]
fn restitution_on_a_wall_against_speed() {
    for (speed, expected) in [(0.1, 0.8022), (1.0, 0.7072), (5.0, 0.6221), (20.0, 0.5364)] {
        let e = restitution(speed, 5e-7);
        assert!(
            (e - expected).abs() < 2e-4,
            "v = {speed}: {e} against {expected}"
        );
    }
}

/// The viscoelastic series e = 1 - C1 x + C2 x^2 - C3 x^3 + C4 x^4, x = (m gamma/K)
/// (K sqrt(R)/m)^(2/5) v^(1/5), with the four constants of Ramirez et al., Phys. Rev. E 60, 4465
/// (1999), as Kumar 2018 draws it in Fig. 2. Cut after four terms it is good to 1 % up to v = 5.
#[test]
fn restitution_follows_the_viscoelastic_series() {
    const C: [f64; 4] = [1.15344, 0.79826, 0.48358, 0.28528];
    let mass = std::f64::consts::PI / 6.0;
    let (kn, gamma, radius) = (2e8f64, 5e4, 0.5f64);
    for speed in [0.1f64, 0.2, 0.5, 1.0, 2.0, 5.0] {
        let x = mass * gamma / kn * (kn * radius.sqrt() / mass).powf(0.4) * speed.powf(0.2);
        let series = 1.0 - C[0] * x + C[1] * x * x - C[2] * x.powi(3) + C[3] * x.powi(4);
        let e = restitution(speed, 1e-6);
        assert!(
            (e / series - 1.0).abs() < 0.01,
            "v = {speed}: {e} against {series}"
        );
    }
}

/// Kinetic, gravitational and Hertz energy (2/5 K sqrt(R) delta^(5/2)) of a frictionless world.
fn energy(sim: &mut Sim, gravity: f64) -> f64 {
    let AnyLaw::HertzHistory(law) = sim.law else {
        panic!("this law stores another energy")
    };
    let mut total = sim.kinetic_energy();
    for i in 0..sim.count() {
        total += sim.velocity[i][3] * gravity * sim.position[i][2];
    }
    for bond in sim.bonds() {
        let (radius, overlap) = match bond {
            Bond::Pair { i, j, .. } => {
                let (x, y) = (sim.position[i as usize], sim.position[j as usize]);
                let d = sim
                    .domain
                    .separation([x[0], x[1], x[2]], [y[0], y[1], y[2]]);
                let distance = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                (x[3] * y[3] / (x[3] + y[3]), x[3] + y[3] - distance)
            }
            Bond::Touch { i, obstacle, .. } => {
                let x = sim.position[i as usize];
                let body = &sim.obstacles[obstacle as usize];
                assert!(matches!(body.shape, Shape::Plane { .. }));
                (x[3], x[3] - (x[2] - body.point[2]))
            }
        };
        total += 0.4 * law.kn * radius.sqrt() * overlap.powf(2.5);
    }
    total
}

/// 64 frictionless grains fall on a floor. Damping only takes energy out, so the total falls
/// monotonically; 2e-6 of the energy at the start is the integrator's own error per 25 steps at
/// some 70 steps a contact.
#[test]
fn without_friction_energy_falls_monotonically() {
    let mut grains = Vec::new();
    for k in 0..64u32 {
        let site = [k % 4, k / 4 % 4, k / 16].map(f64::from);
        let wobble = f64::from(k * 37 % 64) / 64.0 - 0.5;
        let position = [
            0.6 + 1.2 * site[0] + 0.15 * wobble,
            0.6 + 1.2 * site[1] - 0.1 * wobble,
            0.8 + 1.2 * site[2],
        ];
        grains.push(ball(k + 1, position, [wobble, -wobble, 0.0]));
    }
    let mut world = open_case(soft(0.0, 792.4465962305567), 1e-4, grains, vec![floor()]);
    world.gravity = [0.0, 0.0, -1.0];
    world.bounds = Some(BoxSpec {
        lo: [0.0, 0.0, -1.0],
        hi: [4.8, 4.8, 20.0],
        periodic: [true, true, false],
    });
    let mut sim = world.start("fall", |_| {}).expect("a sound case");
    let first = energy(&mut sim, 1.0);
    let (mut last, mut risen) = (first, 0.0);
    for _ in 0..2000 {
        sim.steps(25).expect("a sound case");
        let now = energy(&mut sim, 1.0);
        assert!(
            now <= last + 2e-6 * first,
            "energy rose from {last} to {now}"
        );
        if now > last {
            risen += now - last;
        }
        last = now;
    }
    // All rises together stay small against what was dissipated.
    assert!(
        risen < 1e-4 * (first - last),
        "energy rose by {risen} in all"
    );
    assert!(
        last < 0.8 * first,
        "hardly anything was dissipated: {first} to {last}"
    );
}

/// Without damping and friction a collision gives back all energy but the integrator's error: under
/// 1e-4 at 50 steps a contact and more.
#[test]
fn an_elastic_collision_keeps_its_energy() {
    let error = |dt: f64| {
        let grains = vec![
            ball(1, [0.0; 3], [1.0, 0.0, 0.0]),
            ball(2, [1.000_05, 0.0, 0.0], [-1.0, 0.0, 0.0]),
        ];
        let mut sim = open_case(soft(0.0, 0.0), dt, grains, vec![])
            .start("elastic", |_| {})
            .unwrap();
        let before = sim.kinetic_energy();
        sim.steps((0.1 / dt) as u64).unwrap();
        (sim.kinetic_energy() / before - 1.0).abs()
    };
    for dt in [2e-4, 1e-4, 5e-5] {
        assert!(error(dt) < 1e-4, "dt = {dt}: {}", error(dt));
    }
}

/// The force on one is exactly the opposite of the force on the other, so the momentum of a free
/// pair changes only by the rounding of each kick, which partly cancels: 16 ulp of 1 over 400 steps.
#[test]
fn a_free_pair_keeps_its_momentum_to_the_last_bits() {
    let mut spun = ball(1, [0.0; 3], [1.0, 0.4, -0.3]);
    spun.spin = [3.0, -2.0, 5.0];
    let grains = vec![spun, ball(2, [1.000_05, 0.1, 0.0], [-0.5, 0.2, 0.1])];
    let mut sim = open_case(soft(0.5, 792.0), 1e-4, grains, vec![])
        .start("pair", |_| {})
        .unwrap();
    let momentum = |sim: &Sim, a: usize| {
        sim.velocity[0][3] * sim.velocity[0][a] + sim.velocity[1][3] * sim.velocity[1][a]
    };
    let before = [0, 1, 2].map(|a| momentum(&sim, a));
    let steps = 400;
    sim.steps(steps).unwrap();
    assert!(sim.velocity[0][0] < 0.5, "they collided");
    for a in 0..3 {
        let off = (momentum(&sim, a) - before[a]).abs();
        assert!(off < 16.0 * f64::EPSILON, "axis {a}: {off:e}");
    }
}

/// A ball pushed along +x into a resting grain feels a force along -x, that is a positive drag; a
/// grain that rests on it presses it down.
#[test]
fn forces_on_an_obstacle_have_the_stated_sign() {
    let pushed = ObstacleSpec::Sphere {
        center: [0.0; 3],
        diameter: 2.0,
        density: Some(1.0),
        velocity: [1.0, 0.0, 0.0],
    };
    let grains = vec![
        ball(1, [1.499, 0.0, 0.0], [0.0; 3]),
        ball(2, [0.0, 0.0, 1.499], [0.0; 3]),
    ];
    let sim = open_case(soft(0.5, 792.0), 1e-4, grains, vec![pushed])
        .start("push", |_| {})
        .unwrap();
    let force = sim.obstacles[0].force;
    assert!(force[0] < 0.0 && force[2] < 0.0, "{force:?}");
    assert!(sim.force[0][0] > 0.0 && sim.force[1][2] > 0.0);
    // Newton's third law, to the bit here: one grain each way.
    assert_eq!(sim.force[1][2], -force[2]);
}

/// The grain's own radius is the lever: a sliding grain is spun up by the torque r F_t.
#[test]
fn sliding_friction_turns_a_grain_with_its_radius_as_lever() {
    let grains = vec![ball(1, [0.0, 0.0, 0.49], [2.0, 0.0, 0.0])];
    let mut sim = open_case(soft(0.5, 0.0), 1e-5, grains, vec![floor()])
        .start("slide", |_| {})
        .unwrap();
    sim.steps(3).unwrap();
    let (force, torque) = (sim.force[0], sim.torque[0]);
    assert!(force[0] < 0.0, "friction is against the motion: {force:?}");
    assert!(
        (torque[1] + 0.5 * force[0]).abs() < 1e-12 * force[0].abs(),
        "{torque:?} {force:?}"
    );
}
