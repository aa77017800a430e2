//! Rigid bodies: closed forms and conservation.

use bitgrain::case::{BodyMotion, BodyShape, Case, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::simulation::Simulation;
use bitgrain_kernel::vec3::{add, cross, dot, scale, sub};
use bitgrain_kernel::{Motion, Obstacle, to_body, to_world};
use bitgrain_tests::{ball, largest, open_case};

type V = [f64; 3];

pub(crate) fn tsuji(mu: f64) -> LawSpec {
    LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 2e5,
        poisson: 0.3,
        restitution: 0.5,
        mu,
        rolling: None,
    })
}

fn history(mu: f64) -> LawSpec {
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 792.0,
        gamma_t: 792.0,
        mu,
        rolling: None,
    })
}

pub(crate) fn cuboid(center: V, half: V) -> ObstacleSpec {
    ObstacleSpec {
        shape: BodyShape::Box,
        half: Some(half),
        diameter: None,
        ..ObstacleSpec::sphere(center, 1.0)
    }
}

pub(crate) fn capsule(center: V, axis: V, diameter: f64, half_length: f64) -> ObstacleSpec {
    ObstacleSpec {
        shape: BodyShape::Capsule,
        half_length: Some(half_length),
        ..ObstacleSpec::cylinder(center, axis, diameter)
    }
}

fn drum(axis: V, diameter: f64, length: f64) -> ObstacleSpec {
    ObstacleSpec {
        shape: BodyShape::Drum,
        length: Some(length),
        ..ObstacleSpec::cylinder([0.0; 3], axis, diameter)
    }
}

pub(crate) fn free(body: ObstacleSpec, density: f64) -> ObstacleSpec {
    ObstacleSpec {
        density: Some(density),
        motion: Some(BodyMotion::Free),
        ..body
    }
}

pub(crate) fn begin(case: &Case) -> Simulation {
    case.start("bodies", |_| {}).expect("a sound case")
}

/// What slides without spin rolls at 5/7 of its speed in the end, whatever friction and path.
#[test]
fn sliding_becomes_rolling() {
    let top = cuboid([20.0, 0.0, -1.0], [30.0, 2.0, 1.0]);
    for (law, mu) in [(tsuji(0.3), 0.3), (history(0.3), 0.3)] {
        let slides = ball(1, [0.0, 0.0, 0.4999], [1.0, 0.0, 0.0]);
        let case = Case {
            gravity: [0.0, 0.0, -1.0],
            ..open_case(law, 1e-4, vec![slides], vec![top.clone()])
        };
        let mut sim = begin(&case);
        // It slides for 2 v / (7 mu g), about one unit of time.
        sim.steps((2.0 / 7.0 / mu * 3e4) as u64).expect("it rolls");
        let (v, w) = (sim.velocity[0][0], sim.spin[0][1]);
        // The grain sinks in by 2e-4 of its radius, and bounces a little at first.
        assert!((v / (5.0 / 7.0) - 1.0).abs() < 1e-3, "{v}");
        assert!((0.5 * w / v - 1.0).abs() < 1e-3, "{w} {v}");
    }
}

/// A grain that rolls to and fro at the bottom of a drum has the period `2 pi sqrt(7 (R - r) / (5 g))`.
#[test]
fn a_grain_rolls_in_a_drum() {
    let (inner, r, angle) = (5.0f64, 0.5, 0.05f64);
    // The overlap under its weight, so that it does not bounce.
    let bowl = inner - r + 1.5e-4;
    let place = [bowl * angle.sin(), 0.0, -bowl * angle.cos()];
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(
            tsuji(0.9),
            1e-4,
            vec![ball(1, place, [0.0; 3])],
            vec![drum([0.0, 1.0, 0.0], 2.0 * inner, 4.0)],
        )
    };
    let mut sim = begin(&case);
    let mut crossings = Vec::new();
    let mut before = sim.position[0][0];
    while crossings.len() < 5 {
        sim.steps(1).expect("it rolls");
        let x = sim.position[0][0];
        if before * x < 0.0 {
            crossings.push((sim.step_count() as f64 - x / (x - before)) * 1e-4);
        }
        before = x;
    }
    let period = (crossings[4] - crossings[0]) / 2.0;
    let expected = core::f64::consts::TAU * (1.4 * (inner - r)).sqrt();
    // The amplitude lengthens it by angle^2 / 16, the spring of the contact by a little more.
    assert!(
        (period / expected - 1.0).abs() < 2e-3,
        "{period} {expected}"
    );
}

/// A carpet of grains that do not move, and a box with an orientation above it.
fn on_a_carpet(orientation: [f64; 4], height: f64) -> Simulation {
    let grain = |k: u32| GrainSpec {
        motion: MotionSpec::Frozen,
        ..ball(
            k + 1,
            [f64::from(k % 14) - 6.5, f64::from(k / 14) - 6.5, -0.5],
            [0.0; 3],
        )
    };
    let body = ObstacleSpec {
        orientation: Some(orientation),
        ..free(cuboid([0.03, 0.02, height], [2.2, 1.7, 1.5]), 0.8)
    };
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(tsuji(0.5), 2e-4, (0..196).map(grain).collect(), vec![body])
    };
    begin(&case)
}

fn weight(body: &Obstacle<f64>) -> f64 {
    1.0 / body.inverse_mass
}

/// It rests on its face, and what it rests on carries its weight.
fn rests(sim: &Simulation, along_z: usize, half: f64) {
    let body = &sim.obstacles[0];
    let speed = largest(body.velocity.into_iter().chain(body.angular_velocity));
    assert!(speed < 1e-3, "{body:?}");
    let own = to_body(body.orientation, [0.0, 0.0, 1.0]);
    // The tops of the carpet are the same height; contacts give by 1e-3 of a diameter.
    assert!(own[along_z].abs() > 1.0 - 1e-5, "{own:?}");
    assert!((body.point[2] - half).abs() < 2e-3, "{:?}", body.point);
    assert!((body.force[2] / weight(body) - 1.0).abs() < 1e-3);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_box_lands_flat() {
    let mut sim = on_a_carpet([1.0, 0.0, 0.0, 0.0], 1.7);
    sim.steps(60_000).expect("it lands");
    rests(&sim, 2, 1.5);
    let turned = sim.obstacles[0].orientation;
    assert!(largest(turned[1..].iter().copied()) < 1e-3, "{turned:?}");
}

/// Dropped on an edge, it falls over on the face that its middle is above: back if it is tilted by less than
/// `atan(2.2 / 1.5)`, 55.7 degrees.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn a_box_lands_on_an_edge() {
    for (degrees, face, half) in [(40.0f64, 2, 1.5), (75.0, 0, 2.2)] {
        let angle = degrees.to_radians();
        let tilted = [(0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0];
        // Half of its height so, and a little.
        let height = 2.2 * angle.sin() + 1.5 * angle.cos() + 0.05;
        let mut sim = on_a_carpet(tilted, height);
        sim.steps(150_000).expect("it lands");
        rests(&sim, face, half);
    }
}

/// Grains thrown at bodies of all shapes in open space without gravity.
fn thrown(law: LawSpec, balls_too: bool) -> Case {
    let grain = |k: u32| {
        let site = [k % 4, k / 4 % 4, k / 16].map(|c| 1.2 * f64::from(c) - 1.8);
        // Inwards, askew.
        let inwards = [-site[0] + 0.3 * site[1], -site[1], -site[2] + 0.2 * site[0]];
        GrainSpec {
            spin: [0.5, f64::from(k % 3) - 1.0, 0.2],
            ..ball(k + 1, scale(site, 2.4), scale(inwards, 4.0))
        }
    };
    let mut bodies = vec![
        free(cuboid([0.5, 0.4, 0.2], [0.6, 0.5, 0.3]), 2.0),
        ObstacleSpec {
            angular_velocity: Some([0.3, 1.0, -0.4]),
            ..free(capsule([-1.2, 0.0, 0.3], [0.0, 0.0, 1.0], 0.8, 0.7), 1.5)
        },
        ObstacleSpec {
            orientation: Some([0.8, 0.0, 0.6, 0.0]),
            length: Some(0.8),
            ..free(
                ObstacleSpec::cylinder([1.0, -1.3, -0.9], [0.0, 0.0, 1.0], 1.2),
                1.0,
            )
        },
    ];
    if balls_too {
        bodies.push(free(ObstacleSpec::sphere([-0.8, 1.5, -1.0], 1.4), 3.0));
    }
    // Not where the bodies are.
    let outside = |grain: &GrainSpec| largest(grain.position) > 3.0;
    let grains = (0..64).map(grain).filter(outside);
    open_case(law, 1e-4, grains.collect(), bodies)
}

/// Momentum and angular momentum about the origin of grains and bodies.
fn momenta(sim: &Simulation) -> [V; 2] {
    let (mut p, mut l) = ([0.0; 3], [0.0; 3]);
    for i in 0..sim.count() {
        let [vx, vy, vz, mass] = sim.velocity[i];
        let [x, y, z, radius] = sim.position[i];
        let push = scale([vx, vy, vz], mass);
        let [wx, wy, wz, _] = sim.spin[i];
        let turn = scale([wx, wy, wz], 0.4 * mass * radius * radius);
        p = add(p, push);
        l = add(l, add(cross([x, y, z], push), turn));
    }
    for body in &sim.obstacles {
        let Motion::Free(free) = body.motion else {
            panic!("all bodies are free here");
        };
        let push = scale(body.velocity, 1.0 / body.inverse_mass);
        let own = to_body(body.orientation, body.angular_velocity);
        let own = [0, 1, 2].map(|a| own[a] * free.inertia[a]);
        p = add(p, push);
        l = add(
            l,
            add(cross(body.point, push), to_world(body.orientation, own)),
        );
    }
    [p, l]
}

/// How much changed by 8000 steps, over the sum of what there is without signs; and the contacts on bodies.
fn changes(case: &Case) -> ([f64; 2], usize) {
    let mut sim = begin(case);
    let before = momenta(&sim);
    let speed = |v: V| dot(v, v).sqrt();
    let all: f64 = sim
        .velocity
        .iter()
        .map(|&[x, y, z, m]| m * speed([x, y, z]))
        .sum();
    let mut touches = 0;
    for _ in 0..80 {
        sim.steps(100).expect("a sound case");
        touches += (0..sim.obstacles.len() as u32)
            .map(|k| sim.touching(k).len())
            .sum::<usize>();
    }
    let after = momenta(&sim);
    let changed = [0, 1].map(|k| speed(sub(after[k], before[k])) / all);
    (changed, touches)
}

/// Grains and free bodies together keep momentum to rounding under both laws, and angular momentum under shortened
/// arms; under full arms a contact of two balls turns both by the overlap times the tangential force.
#[test]
fn momentum_of_grains_and_bodies_stays() {
    for balls_too in [false, true] {
        let ([p, l], touches) = changes(&thrown(tsuji(0.5), balls_too));
        assert!(touches > 30, "{touches}");
        // 8000 steps of rounding.
        assert!(p < 1e-12 && l < 1e-12, "{p:e} {l:e}");
        let ([p, l], touches) = changes(&thrown(history(0.5), balls_too));
        assert!(touches > 30, "{touches}");
        assert!(p < 1e-12, "{p:e}");
        assert!(l > 1e-9 && l < 1e-2, "{l:e}");
    }
}

/// A free ball is a grain by another name: its way differs by rounding alone.
#[test]
fn a_free_ball_moves_as_a_grain() {
    for law in [tsuji(0.4), history(0.4)] {
        let others = |k: u32| {
            let place = [1.02 * f64::from(k % 3), 1.02 * f64::from(k / 3), 0.97];
            ball(k + 2, place, [0.0, 0.1 * f64::from(k), -1.0])
        };
        let mine = GrainSpec {
            spin: [1.0, -2.0, 0.5],
            ..ball(1, [0.9, 0.8, 0.0], [0.0, 0.0, 0.5])
        };
        let body = ObstacleSpec {
            velocity: mine.velocity,
            angular_velocity: Some(mine.spin),
            ..free(ObstacleSpec::sphere(mine.position, 1.0), 1.0)
        };
        let crowd: Vec<GrainSpec> = (0..9).map(others).collect();
        let with_grain = [vec![mine], crowd.clone()].concat();
        let mut a = begin(&open_case(law, 1e-4, with_grain, vec![]));
        let mut b = begin(&open_case(law, 1e-4, crowd, vec![body]));
        a.steps(1500).expect("a sound case");
        b.steps(1500).expect("a sound case");
        let body = &b.obstacles[0];
        let near = |grain: [f64; 4], own: V| {
            let [x, y, z, _] = grain;
            let off = largest(sub([x, y, z], own));
            assert!(off < 1e-9, "{off:e}");
        };
        near(a.position[0], body.point);
        near(a.velocity[0], body.velocity);
        near(a.spin[0], body.angular_velocity);
        near(a.force[0], body.force);
        near(a.torque[0], body.torque);
        assert!(
            largest(a.spin[0]) > 0.1 && a.velocity[0][2] < 0.4,
            "they met"
        );
    }
}

/// The world turned by a right angle about z gives the same forces, turned.
#[test]
fn a_turned_world_is_the_same_world() {
    let turn = |v: V| [-v[1], v[0], v[2]];
    let root = 0.5f64.sqrt();
    let mut case = thrown(tsuji(0.5), false);
    let mut turned = case.clone();
    for g in &mut turned.grains {
        (g.position, g.velocity, g.spin) = (turn(g.position), turn(g.velocity), turn(g.spin));
    }
    for (from, to) in case.obstacles.iter_mut().zip(&mut turned.obstacles) {
        to.center = from.center.map(turn);
        to.angular_velocity = from.angular_velocity.map(turn);
        let [w, x, y, z] = from.orientation.unwrap_or([1.0, 0.0, 0.0, 0.0]);
        // The turn about z after the own one.
        let q = [w - z, x - y, x + y, w + z].map(|c| c * root);
        to.orientation = Some(q);
    }
    let (mut a, mut b) = (begin(&case), begin(&turned));
    a.steps(5000).expect("a sound case");
    b.steps(5000).expect("a sound case");
    assert!(
        largest(a.obstacles[0].angular_velocity) > 1e-3,
        "it was hit"
    );
    for (from, to) in a.obstacles.iter().zip(&b.obstacles) {
        for (u, v) in [
            (from.point, to.point),
            (from.velocity, to.velocity),
            (from.angular_velocity, to.angular_velocity),
        ] {
            // Rounding, grown by 5000 steps of collisions.
            assert!(largest(sub(turn(u), v)) < 1e-8, "{u:?} {v:?}");
        }
    }
}
