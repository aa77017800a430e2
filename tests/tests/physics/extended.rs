//! The same scheme in 32 digits, written a second time: what is left is rounding.
//!
//! Some 300 steps of single contacts agree to 1e-12 of the largest value of their kind. Places near 1 are rounded to
//! 1e-16, which is 1e-14 of an overlap of 0.01; the contact hands that on to forces and velocities.

use bitgrain::case::{Case, GrainSpec, ObstacleSpec};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::simulation::Simulation;
use bitgrain_kernel::Shape;
use bitgrain_tests::extended::{Extended, ZERO};
use bitgrain_tests::reference_scheme::{Pair, Partner, Sphere, Vector, World, vector};
use bitgrain_tests::{ball, floor, largest, open_case};

const TOLERANCE: f64 = 1e-12;
const STEPS: u64 = 300;

fn laws(mu: f64) -> [LawSpec; 2] {
    let history = HertzHistoryParameters {
        kn: 2e4,
        kt: 2.45e4,
        gamma_n: 60.0,
        gamma_t: 60.0,
        mu,
        rolling: None,
    };
    let tsuji = HertzTsujiParameters {
        young: 2e4,
        poisson: 0.3,
        restitution: 0.7,
        mu,
        rolling: None,
    };
    [LawSpec::HertzHistory(history), LawSpec::HertzTsuji(tsuji)]
}

/// The same world in 32 digits: its grains, then its obstacles, which are walls or balls.
fn reference(case: &Case, sim: &Simulation) -> World {
    let mut spheres: Vec<Sphere> = (0..sim.count())
        .map(|i| {
            let [x, v, w] = [sim.position[i], sim.velocity[i], sim.spin[i]];
            Sphere {
                position: vector([x[0], x[1], x[2]]),
                velocity: vector([v[0], v[1], v[2]]),
                spin: vector([w[0], w[1], w[2]]),
                radius: x[3].into(),
                mass: Some(v[3].into()),
                moves: true,
            }
        })
        .collect();
    let grains = spheres.len();
    let mut partners: Vec<Partner> = Vec::new();
    for (body, spec) in sim.obstacles.iter().zip(&case.obstacles) {
        match (spec.diameter, body.shape) {
            (Some(diameter), _) => {
                partners.push(Partner::Sphere(spheres.len()));
                let mass = Extended::from(1.0) / body.inverse_mass.into();
                spheres.push(Sphere {
                    position: vector(body.point),
                    velocity: vector(body.velocity),
                    spin: vector(body.angular_velocity),
                    radius: (0.5 * diameter).into(),
                    mass: (body.inverse_mass > 0.0).then_some(mass),
                    moves: false,
                });
            }
            (None, Shape::Plane { normal }) => {
                partners.push(Partner::Wall(vector(body.point), vector(normal)));
            }
            _ => panic!("a wall or a ball"),
        }
    }
    let mut pairs = Vec::new();
    for sphere in 0..grains {
        let others = (sphere + 1..grains).map(Partner::Sphere);
        pairs.extend(partners.iter().copied().chain(others).map(|partner| Pair {
            sphere,
            partner,
            spring: [ZERO; 3],
        }));
    }
    World {
        loads: vec![([ZERO; 3], [ZERO; 3]); spheres.len()],
        spheres,
        pairs,
        law: sim.law.clone(),
        gravity: vector(case.gravity),
        dt: case.dt.into(),
    }
}

/// All numbers of the grains of both worlds, kind by kind: places, velocities, spins, forces, torques.
fn numbers(sim: &Simulation, world: &World) -> [Vec<(f64, Vector, usize)>; 5] {
    let rows = |of: fn(&Simulation, usize) -> [f64; 4], theirs: &dyn Fn(usize) -> Vector| {
        let all = (0..sim.count()).flat_map(|i| {
            let (ours, theirs) = (of(sim, i), theirs(i));
            (0..3).map(move |a| (ours[a], theirs, a))
        });
        all.collect()
    };
    [
        rows(|s, i| s.position[i], &|i| world.spheres[i].position),
        rows(|s, i| s.velocity[i], &|i| world.spheres[i].velocity),
        rows(|s, i| s.spin[i], &|i| world.spheres[i].spin),
        rows(|s, i| s.force[i], &|i| world.loads[i].0),
        rows(|s, i| s.torque[i], &|i| world.loads[i].1),
    ]
}

/// Runs a case both ways. Returns the largest deviation over the largest value of its kind, spins at least speed over
/// radius and torques force times radius; and in how many steps something touched.
fn followed(case: &Case) -> (f64, usize) {
    let mut sim = case.start("extended", |_| {}).expect("a sound case");
    let mut world = reference(case, &sim);
    world.start();
    let (mut sizes, mut off, mut touching) = ([0.0; 5], [0.0; 5], 0);
    for _ in 0..=STEPS {
        for (k, kind) in numbers(&sim, &world).into_iter().enumerate() {
            sizes[k] = largest(kind.iter().map(|n| n.0).chain([sizes[k]]));
            let apart = |n: &(f64, Vector, usize)| (Extended::from(n.0) - n.1[n.2]).to_f64();
            off[k] = largest(kind.iter().map(apart).chain([off[k]]));
        }
        touching += usize::from(!sim.contact_histories().is_empty());
        sim.steps(1).expect("a sound case");
        world.step();
    }
    let radius = sim.position[0][3];
    sizes[2] = largest([sizes[2], sizes[1] / radius]);
    sizes[4] = largest([sizes[4], sizes[3] * radius]);
    (largest((0..5).map(|k| off[k] / sizes[k])), touching)
}

fn check(what: &str, mu: f64, grains: &[GrainSpec], obstacles: &[ObstacleSpec], gravity: [f64; 3]) {
    for law in laws(mu) {
        let case = Case {
            gravity,
            ..open_case(law, 1e-3, grains.to_vec(), obstacles.to_vec())
        };
        let (off, touching) = followed(&case);
        println!(
            "{what}, {}: {off:.1e} in {touching} steps of contact",
            law.kind()
        );
        assert!(off <= TOLERANCE, "{what}, {}: {off:e}", law.kind());
        // A contact lasts some 45 to 300 steps.
        assert!(touching > 40, "{what}, {}: {touching} steps", law.kind());
    }
}

#[test]
fn a_normal_impact() {
    let grains = [
        ball(1, [0.0; 3], [0.5, 0.0, 0.0]),
        ball(2, [1.0007, 0.0, 0.0], [-0.5, 0.0, 0.0]),
    ];
    check("normal impact", 0.5, &grains, &[], [0.0; 3]);
}

/// At friction 0.9 the contact sticks at first, at 0.1 it slides throughout.
#[test]
fn oblique_impacts_of_spinning_grains() {
    let mut one = ball(1, [0.0; 3], [0.5, 0.2, -0.1]);
    one.spin = [0.3, -0.8, 0.9];
    let mut two = ball(2, [0.98, 0.2, 0.07], [-0.5, 0.0, 0.1]);
    two.diameter = 0.9;
    two.density = 1.7;
    let apart = two.position.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(apart > 0.95, "they do not touch at first");
    for mu in [0.1, 0.9] {
        check(
            "oblique impact",
            mu,
            &[one.clone(), two.clone()],
            &[],
            [0.0; 3],
        );
    }
}

#[test]
fn a_ball_on_a_plane() {
    let mut grain = ball(1, [0.0, 0.0, 0.5005], [0.6, -0.3, -0.4]);
    grain.spin = [0.5, 0.0, 2.0];
    for mu in [0.1, 0.9] {
        check(
            "ball on a plane",
            mu,
            &[grain.clone()],
            &[floor()],
            [0.1, 0.0, -1.0],
        );
    }
    let askew = ObstacleSpec::plane([0.0, 0.0, -0.1], [0.6, 0.0, 0.8]);
    let grain = ball(1, [0.3, 0.0, 0.3023], [0.2, 0.5, -0.4]);
    check("ball on a plane askew", 0.3, &[grain], &[askew], [0.0; 3]);
}

#[test]
fn a_ball_against_a_ball_that_moves_as_prescribed() {
    let grain = ball(1, [1.3, 0.3, 0.75], [-0.2, 0.1, 0.0]);
    for density in [None, Some(1.0)] {
        let intruder = ObstacleSpec {
            density,
            velocity: [0.4, 0.0, 0.1],
            angular_velocity: Some([0.0, 0.7, 0.2]),
            ..ObstacleSpec::sphere([0.0; 3], 2.05)
        };
        let grains = [grain.clone()];
        check("ball against a ball", 0.4, &grains, &[intruder], [0.0; 3]);
    }
}

/// Three grains on a wall: each has several contacts at once.
#[test]
fn grains_with_several_contacts() {
    let grains = [
        ball(1, [0.0, 0.0, 0.495], [0.1, 0.0, 0.0]),
        ball(2, [0.995, 0.05, 0.498], [-0.1, 0.2, 0.0]),
        ball(3, [0.5, 0.1, 1.36], [0.0, 0.0, -0.2]),
    ];
    check("three grains", 0.3, &grains, &[floor()], [0.0, 0.0, -1.0]);
}

/// The numbers themselves: 1/3 and the root of 2 to 30 digits, and what cancels.
#[test]
fn extended_numbers_have_thirty_digits() {
    let [one, two, three] = [1.0, 2.0, 3.0].map(Extended::from);
    let third = (one / three * three - one).abs();
    let root = (two.sqrt() * two.sqrt() - two).abs();
    let tiny = Extended::from(1e-25);
    assert!(third.to_f64() < 1e-31 && root.to_f64() < 1e-31);
    assert!(((one + tiny) - one - tiny).abs().to_f64() < 1e-31);
    assert!(((one + tiny) * (one - tiny) - one).abs().to_f64() < 1e-31);
}
