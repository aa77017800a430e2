//! Closed forms and conservation laws.

use bitgrain::case::{BoxSpec, ObstacleSpec};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::simulation::{AnyLaw, Simulation};
use bitgrain_kernel::{ContactHistory, Shape};
use bitgrain_tests::{ball, floor, open_case};

/// Guillard 2014's law, for grains of diameter 1.
const TSUJI: LawSpec = LawSpec::HertzTsuji(HertzTsujiParameters {
    young: 2e5,
    poisson: 0.45,
    restitution: 0.6,
    mu: 0.5,
    rolling: None,
});

fn kumar(mu: f64) -> LawSpec {
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e8,
        kt: 2.45e8,
        gamma_n: 5e4,
        gamma_t: 5e4,
        mu,
        rolling: None,
    })
}

fn soft(mu: f64, gamma: f64) -> LawSpec {
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: gamma,
        gamma_t: gamma,
        mu,
        rolling: None,
    })
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
fn energy(sim: &mut Simulation, gravity: f64) -> f64 {
    let AnyLaw::HertzHistory(law) = sim.law else {
        panic!("this law stores another energy")
    };
    let mut total = sim.kinetic_energy();
    for i in 0..sim.count() {
        total += sim.velocity[i][3] * gravity * sim.position[i][2];
    }
    for bond in sim.contact_histories().contacts() {
        let (radius, overlap) = match *bond {
            ContactHistory::Pair { i, j, .. } => {
                let (x, y) = (sim.position[i as usize], sim.position[j as usize]);
                let d = sim
                    .domain
                    .separation([x[0], x[1], x[2]], [y[0], y[1], y[2]]);
                let distance = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
                (x[3] * y[3] / (x[3] + y[3]), x[3] + y[3] - distance)
            }
            ContactHistory::Obstacle { i, obstacle, .. } => {
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
    let momentum = |sim: &Simulation, a: usize| {
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
    let pushed = ObstacleSpec {
        density: Some(1.0),
        velocity: [1.0, 0.0, 0.0],
        ..ObstacleSpec::sphere([0.0; 3], 2.0)
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

/// A bar along y.
fn bar(center: [f64; 3], diameter: f64) -> ObstacleSpec {
    ObstacleSpec::cylinder(center, [0.0, 1.0, 0.0], diameter)
}

/// A spinning grain that comes down on an obstacle whose highest point is at z = 2, with this overlap.
fn comes_down(law: LawSpec, below: ObstacleSpec, overlap: f64) -> Simulation {
    let mut grain = ball(1, [0.0, 0.25, 2.5 - overlap], [0.5, 0.25, -0.125]);
    grain.spin = [2.0, -3.0, 1.0];
    open_case(law, 1e-4, vec![grain], vec![below])
        .start("contact", |_| {})
        .expect("a sound case")
}

/// Guillard 2014, appendix A: to a grain a cylinder is a plane, however thick it is. Places are short
/// binary fractions, so overlaps and with them forces and torques agree to the bit; to a ball they do
/// not, whose force is less by the root of its part in the effective radius.
#[test]
fn a_cylinder_pushes_a_grain_as_a_plane_does() {
    for law in [TSUJI, soft(0.5, 792.0)] {
        for overlap in [1.0 / 4096.0, 1.0 / 512.0, 3.0 / 64.0] {
            let plane = ObstacleSpec::plane([0.0, 0.0, 2.0], [0.0, 0.0, 1.0]);
            let flat = comes_down(law, plane, overlap);
            for diameter in [0.5, 1.0, 3.25, 16.0] {
                let axis = 2.0 - 0.5 * diameter;
                let round = comes_down(law, bar([0.0, 0.0, axis], diameter), overlap);
                assert_eq!(round.force[0], flat.force[0], "{diameter} {overlap}");
                assert_eq!(round.torque[0], flat.torque[0], "{diameter} {overlap}");
                let ball = ObstacleSpec::sphere([0.0, 0.25, axis], diameter);
                let ball = comes_down(law, ball, overlap);
                assert!(ball.force[0][2] < flat.force[0][2], "{diameter}");
            }
        }
    }
}

/// Without velocity and spin the force on a cylinder is (4/3) Y sqrt(r) delta^(3/2), with r the grain's
/// radius and Y = E/(2(1 - nu^2)): a product of six roundings.
#[test]
fn a_cylinder_presses_as_hertz_on_a_plane() {
    let LawSpec::HertzTsuji(HertzTsujiParameters { young, poisson, .. }) = TSUJI else {
        panic!("it is this law");
    };
    for overlap in [1.0 / 4096.0, 1.0 / 512.0, 3.0 / 64.0] {
        let grain = ball(1, [2.0 - overlap, 0.0, 0.0], [0.0; 3]);
        let sim = open_case(TSUJI, 1e-4, vec![grain], vec![bar([0.0; 3], 3.0)]);
        let sim = sim.start("press", |_| {}).expect("a sound case");
        let modulus = young / (2.0 * (1.0 - poisson * poisson));
        let hertz = 4.0 / 3.0 * modulus * 0.5f64.sqrt() * overlap.powf(1.5);
        let force = sim.force[0][0];
        assert!((force / hertz - 1.0).abs() < 8.0 * f64::EPSILON, "{force}");
        assert_eq!(sim.obstacles[0].force, [-force, 0.0, 0.0]);
    }
}

/// A grain at a bar along y in a box of 8 by 8, shifted by this much; it overlaps by 0.03.
fn at_bar(law: LawSpec, shift: [f64; 2]) -> Simulation {
    // Places in 1024ths, so that the separation is the same to the bit wherever both are.
    let place = [-1280.0, 512.0, 1559.0].map(|k| k / 1024.0);
    let place = [place[0] + shift[0], place[1] + shift[1], place[2]];
    let mut grain = ball(1, place, [1.0, 0.25, -2.0]);
    grain.spin = [2.0, -3.0, 1.0];
    let mut case = open_case(law, 1e-4, vec![grain], vec![bar([shift[0], 0.0, 0.0], 3.0)]);
    case.bounds = Some(BoxSpec {
        lo: [0.0, 0.0, -8.0],
        hi: [8.0, 8.0, 8.0],
        periodic: [true, true, false],
    });
    case.start("bar", |_| {}).expect("a sound case")
}

/// A cylinder pushes a grain alike wherever the box is cut: across the edge along x, along its axis and
/// across the edge along y. The first forces are the same to the bit. Then places are rounded as their
/// size asks, by up to 2^-50 near 8: at a stiffness of 4e4 and a mass of a half that makes at most 3e-12
/// of velocity in the 400 steps of a bounce, and a few times as much of spin.
#[test]
fn a_cylinder_pushes_alike_across_the_edges_of_the_box() {
    for law in [TSUJI, soft(0.5, 792.0)] {
        let mut inside = at_bar(law, [4.0, 0.0]);
        let first = (inside.force[0], inside.torque[0], inside.obstacles[0].force);
        inside.steps(400).unwrap();
        assert_eq!(inside.force[0], [0.0; 4], "it bounced off");
        // On the edge along x, short of it, beyond it, and passing the edge along y.
        let edge = 7.5 - 1.0 / 128.0;
        for shift in [[0.0, 0.0], [1.0, 0.0], [7.5, 3.5], [4.0, edge]] {
            let mut sim = at_bar(law, shift);
            let there = (sim.force[0], sim.torque[0], sim.obstacles[0].force);
            assert_eq!(there, first, "{shift:?}");
            sim.steps(400).unwrap();
            for a in 0..3 {
                let off = (sim.velocity[0][a] - inside.velocity[0][a]).abs();
                let spun = (sim.spin[0][a] - inside.spin[0][a]).abs();
                assert!(off < 1e-11 && spun < 1e-11, "{shift:?}: {off:e} {spun:e}");
            }
        }
    }
}

/// The force on a cylinder is the negative of those on its grains, summed by their names, to the bit at
/// every step; so what the grains lose the cylinder takes, up to the rounding of some thousand kicks.
#[test]
fn what_grains_lose_a_cylinder_takes() {
    for law in [TSUJI, soft(0.5, 792.0)] {
        // Far enough from each other to touch the cylinder only.
        let grains = vec![
            ball(3, [-2.1, 0.0, 0.0], [1.5, 0.25, 0.1]),
            ball(5, [1.5, 2.0, 1.5], [-1.0, 0.1, -1.25]),
            ball(8, [0.0, 4.0, -2.05], [0.125, 0.0, 1.0]),
        ];
        let mut sim = open_case(law, 1e-4, grains, vec![bar([0.0; 3], 3.0)])
            .start("bar", |_| {})
            .expect("a sound case");
        let momentum =
            |sim: &Simulation, a: usize| -> f64 { sim.velocity.iter().map(|v| v[3] * v[a]).sum() };
        let before = [0, 1, 2].map(|a| momentum(&sim, a));
        let (mut impulse, mut together) = ([0.0; 3], 0);
        for _ in 0..3000 {
            sim.steps(1).unwrap();
            let force = sim.obstacles[0].force;
            for a in 0..3 {
                let sum = sim.force.iter().fold(0.0, |sum, f| sum - f[a]);
                assert_eq!(force[a].to_bits(), sum.to_bits());
                impulse[a] += 1e-4 * force[a];
            }
            let touching = sim.force.iter().filter(|f| f[0] != 0.0);
            together += usize::from(touching.count() > 1);
        }
        assert!(together > 10, "they touch at the same time: {together}");
        assert_eq!(sim.obstacles[0].force, [0.0; 3], "and are gone");
        for a in 0..3 {
            let lost = before[a] - momentum(&sim, a);
            assert!((lost - impulse[a]).abs() < 1e-12, "{lost} {impulse:?}");
        }
        let pushed = impulse.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(pushed > 0.2, "{pushed}");
    }
}
