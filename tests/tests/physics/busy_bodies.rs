//! Bodies of every kind of motion among grains: the same bits whatever way they are stepped, in files too; their
//! energy; what cannot be is refused.

use bitgrain::case::{BodyMotion, BoxSpec, Case, ObstacleSpec};
use bitgrain::checkpoint;
use bitgrain::energy_budget::Audit;
use bitgrain::mesh::Triangle;
use bitgrain::parts::Cutting;
use bitgrain::simulation::{Simulation, hex};
use bitgrain::threads::on_threads;
use bitgrain_tests::{ball, open_case};

use crate::bodies::{begin, capsule, cuboid, free, tsuji};

/// Four blades that meet in an axis, each a square of two triangles.
fn paddles() -> Vec<Triangle> {
    let blade = |[x, y]: [f64; 2]| {
        let [a, b] = [-0.5, 0.5].map(|z| [0.0, 0.0, z]);
        let [c, d] = [0.5, -0.5].map(|z| [x, y, z]);
        [[a, b, c], [a, c, d]]
    };
    [[0.8, 0.0], [0.0, 0.8], [-0.8, 0.0], [0.0, -0.8]]
        .into_iter()
        .flat_map(blade)
        .collect()
}

/// Many grains in a box that is periodic along x and y, and bodies of every kind of motion among them.
fn busy() -> Case {
    let grain = |k: u32| {
        let site = [k % 8, k / 8 % 8, k / 64].map(|c| f64::from(c) + 0.5);
        let place = [site[0], site[1], site[2] + 0.05 * f64::from(k % 3)];
        ball(k + 1, place, [0.3, 0.1 * f64::from(k % 5), -1.0])
    };
    let above = |x: f64, y: f64| [x, y, 4.9];
    let bodies = vec![
        ObstacleSpec::plane([0.0; 3], [0.0, 0.0, 1.0]),
        ObstacleSpec {
            velocity: [0.0, 0.0, -2.0],
            ..free(cuboid(above(1.5, 1.5), [0.7, 0.6, 0.4]), 2.0)
        },
        ObstacleSpec {
            velocity: [0.0, 0.0, -2.0],
            angular_velocity: Some([0.0, 3.0, 0.0]),
            ..free(capsule(above(4.0, 6.0), [1.0, 0.0, 0.0], 0.8, 0.6), 4.0)
        },
        ObstacleSpec {
            velocity: [1.0, 0.0, -2.0],
            motion: Some(BodyMotion::Partly {
                along: [false, false, true],
                turns: false,
            }),
            ..free(ObstacleSpec::sphere(above(6.0, 2.5), 1.5), 3.0)
        },
        ObstacleSpec {
            velocity: [0.0, 0.0, -1.5],
            angular_velocity: Some([2.0, 1.0, -1.0]),
            ..cuboid(above(3.5, 3.5), [0.5, 0.4, 0.6])
        },
        ObstacleSpec {
            center: Some(above(6.0, 6.0)),
            velocity: [0.0, 0.0, -1.5],
            angular_velocity: Some([1.0, 0.0, 2.0]),
            mass: Some(6.0),
            inertia: Some([0.9, 0.9, 1.2]),
            motion: Some(BodyMotion::Free),
            ..ObstacleSpec::mesh(paddles())
        },
    ];
    Case {
        bounds: Some(BoxSpec {
            lo: [0.0, 0.0, -1.0],
            hi: [8.0, 8.0, 30.0],
            periodic: [true, true, false],
        }),
        gravity: [0.0, 0.0, -1.0],
        ..open_case(tsuji(0.5), 1e-4, (0..256).map(grain).collect(), bodies)
    }
}

fn digest(sim: &mut Simulation) -> String {
    hex(&sim.digest().expect("at rest").whole)
}

/// Whoever steps it: one thread or several, and whatever grain is where. All parts need the whole force on a free body.
#[test]
fn any_threads_step_free_bodies_alike() {
    let steps = if cfg!(debug_assertions) { 200 } else { 5000 };
    let run = |threads: usize, cutting: Cutting, skin: f64| {
        let mut sim = begin(&busy());
        sim.stepping.divide_always();
        sim.stepping.cutting = cutting;
        sim.stepping.tunes = false;
        sim.skin = skin;
        on_threads(threads, || sim.steps(steps).expect("a sound case")).expect("threads");
        let touched = (1..6).map(|k| sim.touching(k).len()).collect::<Vec<_>>();
        (digest(&mut sim), touched)
    };
    let one = run(1, Cutting::Planes, 0.1);
    assert!(one.1.iter().sum::<usize>() > 3 || steps < 5000, "{one:?}");
    assert_eq!(run(1, Cutting::Planes, 0.0), one);
    assert_eq!(run(2, Cutting::Planes, 0.2), one);
    assert_eq!(run(3, Cutting::Scattered(1), 0.1), one);
    assert_eq!(run(5, Cutting::Planes, 0.05), one);
}

/// A file keeps all of a body, and of a world without such bodies it is the file that it was.
#[test]
fn files_keep_bodies() {
    let mut sim = begin(&busy());
    sim.steps(500).expect("a sound case");
    let (saved, bytes) = (
        sim.save().expect("at rest"),
        checkpoint::bytes(&mut sim, "").expect("at rest"),
    );
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("\\\"format\\\":4"));
    sim.steps(1000).expect("a sound case");
    let end = digest(&mut sim);
    let mut loaded = Simulation::load(&saved).expect("as saved");
    loaded.steps(1000).expect("a sound case");
    assert_eq!(digest(&mut loaded), end);
    let mut read = checkpoint::parse(&bytes, "bodies", None).expect("as written");
    read.steps(1000).expect("a sound case");
    assert_eq!(digest(&mut read), end);

    let mut plain = busy();
    plain.obstacles.truncate(1);
    let bytes = checkpoint::bytes(&mut begin(&plain), "").expect("at rest");
    let text = String::from_utf8_lossy(&bytes);
    assert!(text.contains("\\\"format\\\":3") && !text.contains("orientation"));
}

/// With bodies that move freely, in part and as prescribed, and turn.
#[test]
#[cfg_attr(debug_assertions, ignore = "seconds in release")]
fn the_energy_account_closes_with_bodies() {
    let mut sim = begin(&busy());
    let mut audit = Audit::new(&mut sim);
    let mut worst = 0.0f64;
    for _ in 0..10_000 {
        audit.step(&mut sim).expect("a sound case");
        worst = worst.max(audit.row(0).closure().abs());
    }
    assert!(audit.row(0).work > 100.0);
    // As the accounts of beds: the error of velocity Verlet.
    assert!(worst < 1e-3, "{worst:e}");
}

/// A sphere that is dragged and free along z: its speed along x stays, and the grains below lift it.
#[test]
fn a_body_may_be_free_along_one_axis() {
    let mut sim = begin(&busy());
    sim.steps(5000).expect("a sound case");
    let body = &sim.obstacles[3];
    assert_eq!((body.velocity[0], body.velocity[1]), (1.0, 0.0));
    assert_eq!(body.angular_velocity, [0.0; 3]);
    // It would fall at 2.5.
    assert!(body.velocity[2] > -2.4, "{body:?}");
}

/// Bodies that cannot be are refused with the key.
#[test]
fn wrong_bodies_are_refused_by_key() {
    let with = |body: ObstacleSpec| {
        let case = open_case(
            tsuji(0.5),
            1e-4,
            vec![ball(1, [9.0; 3], [0.0; 3])],
            vec![body],
        );
        let text = serde_json::to_string(&case).expect("a case");
        bitgrain::case::parse(&text, "it")
            .expect_err("a wrong case")
            .to_string()
    };
    let sphere = ObstacleSpec::sphere([0.0; 3], 1.0);
    let endless = ObstacleSpec::cylinder([0.0; 3], [0.0, 1.0, 0.0], 1.0);
    let askew = capsule([0.0; 3], [0.0, 1.0, 1.0], 1.0, 1.0);
    let cases = [
        (
            ObstacleSpec {
                half: Some([1.0; 3]),
                ..sphere.clone()
            },
            "obstacles[0].half",
        ),
        (
            ObstacleSpec {
                diameter: None,
                ..sphere.clone()
            },
            "obstacles[0].diameter",
        ),
        (
            ObstacleSpec {
                motion: Some(BodyMotion::Free),
                ..sphere.clone()
            },
            "obstacles[0].motion",
        ),
        (
            ObstacleSpec {
                mass: Some(1.0),
                ..free(sphere.clone(), 1.0)
            },
            "obstacles[0].mass",
        ),
        (
            ObstacleSpec {
                orientation: Some([1.0, 1.0, 0.0, 0.0]),
                ..sphere.clone()
            },
            "obstacles[0].orientation",
        ),
        (
            ObstacleSpec {
                applied_force: Some([1.0; 3]),
                ..sphere.clone()
            },
            "obstacles[0].applied_force",
        ),
        (free(endless, 1.0), "obstacles[0].density"),
        (free(askew, 1.0), "obstacles[0].inertia"),
        (cuboid([0.0; 3], [1.0, 0.0, 1.0]), "obstacles[0].half"),
    ];
    for (body, key) in cases {
        let told = with(body);
        assert!(told.contains(key), "{told}");
    }
}
