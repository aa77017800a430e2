//! Walls as LAMMPS and LIGGGHTS have them: the same contacts on drums, boxes and bars. Tolerances as in `peers`.

use bitgrain::case::{BodyShape, Case, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain_kernel::{Domain, Obstacle, vec3};
use bitgrain_tests::{json, largest, number, numbers, open_case, triple};
use serde_json::Value;

use crate::peers::{PeerRow, compare, grain, trajectory};

/// A law where any will do.
const TSUJI: LawSpec = LawSpec::HertzTsuji(HertzTsujiParameters {
    young: 5e6,
    poisson: 0.45,
    restitution: 0.6,
    mu: 0.4,
    rolling: None,
});

/// The wall of a case of either file as an obstacle.
fn wall(wall: &Value) -> ObstacleSpec {
    let lo_hi = |key: &str| triple(&numbers(&wall[key]), 0);
    match wall["kind"].as_str() {
        Some("cyl_in") => ObstacleSpec {
            shape: BodyShape::Drum,
            // Longer than the sphere gets.
            length: Some(0.08),
            velocity: [0.0, 0.0, wall["v_axial"].as_f64().unwrap_or(0.0)],
            angular_velocity: Some(vec3::scale(lo_hi("axis"), number(&wall["spin"]))),
            curved: wall["rwall"].is_number(),
            ..ObstacleSpec::cylinder(lo_hi("point"), lo_hi("axis"), 2.0 * number(&wall["radius"]))
        },
        Some("cyl_out") => {
            let mut axis = [0.0; 3];
            axis[number(&wall["axis"]) as usize] = 1.0;
            let (lo, hi) = (number(&wall["lo"]), number(&wall["hi"]));
            let middle = vec3::scale(axis, 0.5 * (lo + hi));
            ObstacleSpec {
                length: Some(hi - lo),
                curved: true,
                ..ObstacleSpec::cylinder(middle, axis, 2.0 * number(&wall["radius"]))
            }
        }
        Some("box_out") => {
            let (lo, hi) = (lo_hi("lo"), lo_hi("hi"));
            ObstacleSpec {
                shape: BodyShape::Box,
                half: Some(vec3::scale(vec3::sub(hi, lo), 0.5)),
                diameter: None,
                ..ObstacleSpec::sphere(vec3::scale(vec3::add(lo, hi), 0.5), 1.0)
            }
        }
        other => panic!("unknown wall {other:?}"),
    }
}

fn sphere(case: &Value, traj: &[Vec<PeerRow>]) -> GrainSpec {
    let (diameter, density) = (number(&case["diameter"][0]), number(&case["density"][0]));
    grain(1, diameter, density, &traj[0][0], MotionSpec::Free)
}

/// Compares a case under its law.
fn check(c: &Value, law: LawSpec) {
    let traj = trajectory(c);
    let case = Case {
        gravity: triple(&numbers(&c["gravity"]), 0),
        ..open_case(
            law,
            number(&c["dt"]),
            vec![sphere(c, &traj)],
            vec![wall(&c["walls"][0])],
        )
    };
    let name = c["name"].as_str().expect("a name");
    compare(name, &case, &traj, &[false]);
}

/// LAMMPS under the law that is one of ours: effective radius `r c / (r + c)` with `c = -2 R` inside a cylinder and
/// none on a box; the normal points from the nearest place.
#[test]
fn lammps_walls_with_hertz_history() {
    let file = json("peers/walls_lammps.json.gz");
    let mut count = 0;
    for c in file["cases"].as_array().expect("cases") {
        let params = &c["params"]["pair"]["11"];
        if params["normal"] != "hertz/history" {
            continue;
        }
        let get = |key: &str| number(&params[key]);
        let law = LawSpec::HertzHistory(HertzHistoryParameters {
            kn: get("Kn"),
            kt: get("Kt"),
            gamma_n: get("gn"),
            gamma_t: get("gt"),
            mu: get("mu"),
            rolling: None,
        });
        check(c, law);
        count += 1;
    }
    assert_eq!(count, 2);
}

/// Where LAMMPS' sphere meets a wall, whatever the law: the nearest place of a face, an edge, a corner, a side, an end,
/// a rim. It notes the last of two contacts.
#[test]
fn lammps_places_of_contact() {
    let file = json("peers/walls_lammps.json.gz");
    let (mut cases, mut contacts) = (0, 0);
    for c in file["cases"].as_array().expect("cases") {
        let traj = trajectory(c);
        let spec = wall(&c["walls"][0]);
        let case = open_case(TSUJI, number(&c["dt"]), vec![sphere(c, &traj)], vec![spec]);
        let body = case
            .start("wall", |_| {})
            .expect("the peers ran it")
            .obstacles[0];
        let infos = c["contact_info"].as_array().expect("contacts");
        let radius = 0.5 * number(&c["diameter"][0]);
        for (sample, info) in traj.iter().zip(infos.iter().map(numbers)) {
            if info[0] == 0.0 {
                continue;
            }
            let ours = (0..body.shape.surfaces()).filter_map(|surface| {
                let place = triple(&sample[0], 1);
                let met = body.meet(surface, &[], &Domain::open(), place, radius);
                let depth = radius - met.overlap;
                let nearest = vec3::sub(place, vec3::scale(met.normal, depth));
                (met.overlap > 0.0).then_some(nearest)
            });
            let theirs = triple(&info, 4);
            let off = |ours: [f64; 3]| largest((0..3).map(|a| ours[a] - theirs[a]));
            let best = ours.map(off).fold(f64::INFINITY, f64::min);
            // Roundings of coordinates up to ten radii.
            assert!(best < 1e-14 * radius.max(1.0), "{}: {best:e}", c["name"]);
            contacts += 1;
        }
        cases += 1;
    }
    assert!(cases >= 9 && contacts > 300, "{cases} {contacts}");
}

/// LIGGGHTS' primitive cylinder from inside, which it takes for flat. Where it turns, its wall has the velocity at the
/// radius of the sphere's centre, and ours that of the surface: those cases are not compared.
#[test]
fn liggghts_cylinder_from_inside() {
    let file = json("peers/walls_liggghts.json.gz");
    let mut count = 0;
    for c in file["cases"].as_array().expect("cases") {
        let turns = |wall: &Value| number(&wall["spin"]) != 0.0;
        if c["walls"].is_null() || turns(&c["walls"][0]) {
            continue;
        }
        let species = &c["params"]["species"][0];
        let law = LawSpec::HertzTsuji(HertzTsujiParameters {
            young: number(&species["E"]),
            poisson: number(&species["nu"]),
            restitution: number(&c["params"]["e"]["11"]),
            mu: number(&c["params"]["mu"]["11"]),
            rolling: None,
        });
        check(c, law);
        count += 1;
    }
    assert_eq!(count, 2);
}

/// A surface that turns has the velocity of its nearest place: a drum that turns is, to a grain that touches it, a
/// plane that moves.
#[test]
fn a_turning_surface_moves_as_its_nearest_place() {
    let (radius, spin) = (0.25, 3.0);
    let start = |body: ObstacleSpec| {
        let row = [0.0, 0.0, 0.0, -0.248_01, 0.1, -0.2, -0.3, 1.0, 2.0, 3.0];
        let case = open_case(
            TSUJI,
            1e-6,
            vec![grain(1, 0.004, 2500.0, &row, MotionSpec::Free)],
            vec![body],
        );
        let sim = case.start("wall", |_| {}).expect("a sound case");
        (sim.force[0], sim.torque[0])
    };
    let drum = ObstacleSpec {
        shape: BodyShape::Drum,
        length: Some(1.0),
        angular_velocity: Some([0.0, spin, 0.0]),
        ..ObstacleSpec::cylinder([0.0; 3], [0.0, 1.0, 0.0], 2.0 * radius)
    };
    let floor = ObstacleSpec {
        velocity: [-spin * radius, 0.0, 0.0],
        ..ObstacleSpec::plane([0.0, 0.0, -radius], [0.0, 0.0, 1.0])
    };
    let ((f, t), (g, u)) = (start(drum), start(floor));
    assert!(f[0] != 0.0 && t[1] != 0.0);
    for a in 0..3 {
        assert!((f[a] - g[a]).abs() < 1e-12 * g[2].abs(), "{f:?} {g:?}");
        assert!((t[a] - u[a]).abs() < 1e-12 * u[1].abs(), "{t:?} {u:?}");
    }
}

/// The stated convention: flat unless `curved`; then `1/r + 1/(2 R)` on a bar, `1/r - 1/(2 R)` in a drum.
#[test]
fn curvature_counts_if_it_is_asked_for() {
    let meet = |body: Obstacle<f64>, curved: bool, place: [f64; 3]| {
        let body = Obstacle { curved, ..body };
        body.meet(0, &[], &Domain::open(), place, 0.5).curvature
    };
    let axis = [0.0, 1.0, 0.0];
    let bars = [
        (Obstacle::cylinder([0.0; 3], axis, 2.0), 4.0),
        (Obstacle::finite_cylinder([0.0; 3], axis, 2.0, 3.0), 4.0),
        (Obstacle::capsule([0.0; 3], axis, 2.0, 3.0), 4.0),
        (Obstacle::cuboid([0.0; 3], [2.0; 3]), 0.0),
    ];
    for (body, curvature) in bars {
        assert_eq!(meet(body, false, [0.0, 0.0, 2.4]), 0.0);
        assert_eq!(meet(body, true, [0.0, 0.0, 2.4]), curvature);
    }
    let capsule = Obstacle::capsule([0.0; 3], axis, 2.0, 3.0);
    assert_eq!(meet(capsule, true, [0.0, 5.0, 0.1]), 2.0);
    let drum = Obstacle::drum([0.0; 3], axis, 2.0, 3.0);
    assert_eq!(meet(drum, true, [0.0, 0.0, 1.6]), -4.0);
    assert_eq!(meet(drum, false, [0.0, 0.0, 1.6]), 0.0);
    let ball = Obstacle::sphere([0.0; 3], 2.0);
    assert_eq!(meet(ball, false, [0.0, 0.0, 2.4]), 2.0);
}
