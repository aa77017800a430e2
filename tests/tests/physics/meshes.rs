//! Meshes of triangles: beside LIGGGHTS, over creases, and against planes.

use std::fmt::Write;

use bitgrain::case::{Case, MotionSpec, ObstacleSpec};
use bitgrain::energy_budget::Audit;
use bitgrain::law::{HertzTsujiParameters, LawSpec};
use bitgrain::mesh::Triangle;
use bitgrain_kernel::vec3;
use bitgrain_tests::{ball, golden, json, number, numbers, open_case, triple};
use serde_json::Value;

use crate::bodies::{begin, tsuji};
use crate::peers::{compare, grain, trajectory};

/// Where LIGGGHTS counts the overlap at an edge twice, or lets the sphere fall into a face: what happens there is shown
/// beside ours, not matched.
const CREASES: [&str; 5] = [
    "slide_convex_30deg",
    "slide_convex_0.5deg",
    "slide_convex_0.2deg",
    "slide_concave_5deg",
    "slide_concave_0.2deg",
];

fn law(c: &Value) -> LawSpec {
    let species = &c["params"]["species"][0];
    LawSpec::HertzTsuji(HertzTsujiParameters {
        young: number(&species["E"]),
        poisson: number(&species["nu"]),
        restitution: number(&c["params"]["e"]["11"]),
        mu: number(&c["params"]["mu"]["11"]),
        rolling: None,
    })
}

fn triangles(mesh: &Value) -> Vec<Triangle> {
    let all = mesh["tris"].as_array().expect("triangles");
    let corners = |t: &Value| [0, 1, 2].map(|k| triple(&numbers(&t[k]), 0));
    all.iter().map(corners).collect()
}

/// A case of the peer with its mesh as an obstacle.
fn case(c: &Value) -> Case {
    let (diameter, density) = (number(&c["diameter"][0]), number(&c["density"][0]));
    let first = &trajectory(c)[0][0];
    let sphere = grain(1, diameter, density, first, MotionSpec::Free);
    let mesh = ObstacleSpec::mesh(triangles(&c["mesh"]));
    Case {
        gravity: triple(&numbers(&c["gravity"]), 0),
        ..open_case(law(c), number(&c["dt"]), vec![sphere], vec![mesh])
    }
}

fn name(c: &Value) -> &str {
    c["name"].as_str().expect("a name")
}

fn cases(file: &str) -> Vec<Value> {
    let file = json(file);
    let all = file["cases"].as_array().expect("cases");
    let has_mesh = |c: &&Value| !c["mesh"].is_null();
    all.iter().filter(has_mesh).cloned().collect()
}

/// Faces, edges, a ridge, sliding over and along the edge of coplanar triangles, a hollow crease whose edge is not in
/// the sphere, and a drum of 24 faces.
#[test]
fn liggghts_meshes() {
    let mut count = 0;
    for file in [
        "peers/mesh_liggghts.json.gz",
        "peers/walls_liggghts.json.gz",
    ] {
        for c in cases(file) {
            if CREASES.contains(&name(&c)) {
                continue;
            }
            compare(name(&c), &case(&c), &trajectory(&c), &[false]);
            count += 1;
        }
    }
    assert_eq!(count, 9);
}

/// The largest force on a sphere while it slides over the very crease, in weights, ours and the peer's. On a
/// nearly flat convex crease ours stays that of a plane; a hollow one is met at the speed that the turn of the path
/// asks for.
#[test]
fn creases_beside_liggghts() {
    let mut text = String::from("crease, largest force in weights: ours, LIGGGHTS\n");
    for c in cases("peers/mesh_liggghts.json.gz") {
        if !CREASES.contains(&name(&c)) {
            continue;
        }
        let case = case(&c);
        let weight = number(&c["mass"][0]) * 9.81;
        let size = |v: [f64; 3]| vec3::dot(v, v).sqrt() / weight;
        let mut sim = begin(&case);
        let mut most = [0.0f64; 2];
        for sample in trajectory(&c) {
            let step = sample[0][0] as u64;
            let ahead = step - sim.step_count();
            sim.steps(ahead).expect("the peer ran it");
            // The crease reaches into the sphere.
            if sample[0][1].abs() < 1e-4 {
                let mass = number(&c["mass"][0]);
                let own = vec3::scale(case.gravity, mass);
                let theirs = vec3::sub(triple(&sample[0], 10), own);
                let forces = [vec3::head(sim.force[0]), theirs];
                most = [0, 1].map(|k| most[k].max(size(forces[k])));
            }
        }
        let [ours, theirs] = most;
        writeln!(text, "{}: {ours:.3}, {theirs:.3}", name(&c)).expect("a string");
        assert!(
            !name(&c).contains("convex_0.") || ours < 1.01,
            "{}: {ours}",
            name(&c)
        );
    }
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("peers"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("creases", text));
}

/// A disc of triangles round its middle, at height 0.
fn fan(count: usize) -> Vec<Triangle> {
    let rim = |k: usize| {
        let turn = std::f64::consts::TAU * (k % count) as f64 / count as f64 + 0.3;
        [6.0 * turn.cos(), 6.0 * turn.sin(), 0.0]
    };
    (0..count).map(|k| [[0.0; 3], rim(k), rim(k + 1)]).collect()
}

/// Rolling and bouncing over the edges of flat triangles, and over the corner where all of them meet, is rolling and
/// bouncing on a plane: springs go along, and nothing counts twice.
#[test]
fn flat_triangles_roll_as_a_plane() {
    let path = |floor: ObstacleSpec, y: f64| {
        let mut rolls = ball(1, [-3.0, y, 0.499], [2.0, 0.0, 0.0]);
        rolls.spin = [1.0, 0.5, 3.0];
        let case = Case {
            gravity: [0.0, 0.0, -1.0],
            ..open_case(tsuji(0.5), 1e-4, vec![rolls], vec![floor])
        };
        let mut sim = begin(&case);
        let mut all = Vec::new();
        for _ in 0..40 {
            sim.steps(1000).expect("it rolls");
            all.push([sim.position[0], sim.velocity[0], sim.spin[0], sim.force[0]]);
        }
        all
    };
    for (count, y) in [(3, 0.2), (6, 0.0), (7, -0.4), (24, 0.01)] {
        let plane = path(ObstacleSpec::plane([0.0; 3], [0.0, 0.0, 1.0]), y);
        let mesh = path(ObstacleSpec::mesh(fan(count)), y);
        assert!(plane[39][0][0] > 2.0, "it rolls over the middle");
        for (one, other) in plane.iter().flatten().zip(mesh.iter().flatten()) {
            for a in 0..3 {
                // Roundings of a step over 40,000 of them, in a motion that forgets its past.
                let off = (one[a] - other[a]).abs();
                assert!(off < 1e-11, "{count} triangles: {off:e}");
            }
        }
    }
}

/// A bowl of flat faces, in which a sphere rolls over ridges and hollow creases: no energy comes or goes but by
/// friction and damping.
#[test]
fn energy_closes_over_creases() {
    let corner = |x: i32, y: i32| {
        let (x, y) = (f64::from(x), f64::from(y));
        [x, y, 0.3 * (x * x + y * y)]
    };
    let squares = (-5..5).flat_map(|x| (-5..5).map(move |y| (x, y)));
    let bowl = squares.flat_map(|(x, y)| {
        let [a, b] = [corner(x, y), corner(x + 1, y)];
        let [c, d] = [corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(
            tsuji(0.3),
            1e-4,
            vec![ball(1, [-2.0, 0.4, 2.0], [0.0, 0.5, 0.0])],
            vec![ObstacleSpec::mesh(bowl.collect())],
        )
    };
    let mut sim = begin(&case);
    let mut audit = Audit::new(&mut sim);
    let (mut worst, mut crossed) = (0.0f64, 0);
    let mut side = false;
    for _ in 0..100_000 {
        audit.step(&mut sim).expect("it rolls");
        worst = worst.max(audit.row(0).closure().abs());
        let now = sim.position[0][0] > 0.0;
        crossed += u32::from(now != side);
        side = now;
    }
    assert!(crossed > 1, "it rolls to and fro: {crossed}");
    assert!(worst < 1e-3, "{worst:e}");
}

/// A fine mesh costs what a grain touches of it: as many contacts are listed near a sphere on 20,000 triangles as its
/// own size says.
#[test]
fn a_fine_mesh_is_searched_where_grains_are() {
    let corner = |x: i32, y: i32| [0.25 * f64::from(x), 0.25 * f64::from(y), 0.0];
    let squares = (-50..50).flat_map(|x| (-50..50).map(move |y| (x, y)));
    let floor = squares.flat_map(|(x, y)| {
        let [a, b] = [corner(x, y), corner(x + 1, y)];
        let [c, d] = [corner(x + 1, y + 1), corner(x, y + 1)];
        [[a, b, c], [a, c, d]]
    });
    let grains = (0..20).map(|k| ball(k + 1, [f64::from(k) - 9.7, 0.3, 0.499], [0.0; 3]));
    let case = open_case(
        tsuji(0.3),
        1e-4,
        grains.collect(),
        vec![ObstacleSpec::mesh(floor.collect())],
    );
    let mut sim = begin(&case);
    sim.steps(10).expect("they rest");
    let (_, _, contacts) = sim.list_counts();
    // A square of 1.2 has 5 x 5 smaller squares or 6 x 6, of two triangles each.
    assert!((20 * 32..20 * 100).contains(&contacts), "{contacts}");
    assert_eq!(sim.touching(0).len(), 20);
}
