//! How the grains of a case move, carried, weightless or as a lid: closed forms,
//! refusals, and the replay of the rig.

use bitgrain::case::{BodyShape, BoxSpec, Case, GrainSpec, MotionSpec};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::simulation::{Simulation, sphere_mass};
use bitgrain_tests::{GLASS, floor, golden, number, numbers, open_case, output, told};
use serde_json::Value;

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

const TSUJI: LawSpec = LawSpec::HertzTsuji(HertzTsujiParameters {
    young: 5e6,
    poisson: 0.45,
    restitution: 0.6,
    mu: 0.5,
    rolling: None,
});

/// Guillard's grains: diameter, density and gravity.
const D: f64 = 1.5e-3;
const DENSITY: f64 = 2500.0;
const GRAVITY: f64 = 9.81;

fn grain(id: u32, density: f64, position: [f64; 3], motion: MotionSpec) -> GrainSpec {
    GrainSpec {
        id,
        diameter: D,
        density,
        position,
        velocity: [0.0; 3],
        spin: [0.0; 3],
        motion,
        material: None,
    }
}

/// A lid's grain on a grain of the bulk on the floor, until all of it is at rest.
fn column(law: LawSpec, bulk: MotionSpec) -> Simulation {
    let grains = vec![
        grain(1, DENSITY, [0.0, 0.0, 0.5 * D], bulk),
        grain(
            2,
            60.0 * DENSITY,
            [0.0, 0.0, 1.5 * D],
            MotionSpec::Lid([0.0; 2]),
        ),
    ];
    let mut case = open_case(law, 1e-5, grains, vec![floor()]);
    case.gravity = [0.0, 0.0, -GRAVITY];
    let mut sim = case.start("column", |_| {}).expect("a sound case");
    sim.steps(300_000).expect("a sound case");
    sim
}

/// The lid presses with its weight, and the weightless bulk adds nothing to it, nor on the
/// floor. A place is known to 4e-19, a rounding of numbers near 0.003, which is 4e-14 of an overlap of
/// 1e-5: so the forces at rest are the weight to 1e-12.
#[test]
fn a_lid_at_rest_presses_with_its_weight() {
    let weight = sphere_mass(D, 60.0 * DENSITY) * GRAVITY;
    let own = sphere_mass(D, DENSITY) * GRAVITY;
    for law in [TSUJI, GLASS] {
        for (bulk, carries) in [
            (MotionSpec::Weightless, weight),
            (MotionSpec::Free, weight + own),
        ] {
            let sim = column(law, bulk);
            let is = |force: f64, want: f64| {
                assert!((force / want - 1.0).abs() < 1e-12, "{force} is not {want}");
            };
            is(sim.force[1][2], weight);
            is(-sim.obstacles[0].force[2], carries);
            // What is above pushes down by the lid's weight, the floor pushes up by all.
            is(sim.force[0][2] + weight, carries);
            // Overlaps by F = K sqrt(R) delta^(3/2), with R = d/4 of two grains and d/2 on a plane.
            let kn = sim.law.springs([0; 2]).kn;
            let overlap = |force: f64, radius: f64| (force / (kn * radius.sqrt())).powf(2.0 / 3.0);
            let (lower, upper) = (sim.position[0][2], sim.position[1][2]);
            is(0.5 * D - lower, overlap(carries, 0.5 * D));
            is(D - (upper - lower), overlap(weight, 0.25 * D));
            // Nothing pushes it aside, and nothing turns it.
            assert_eq!(sim.force[1][..2], [0.0; 2]);
            assert_eq!(sim.spin[1][..3], [0.0; 3]);
        }
    }
}

/// Diameter 1, density 1 and gravity 1, every number a short binary fraction, in a box that is
/// periodic along x and y.
fn fractions(grains: Vec<GrainSpec>) -> Case {
    let law = LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 792.0,
        gamma_t: 792.0,
        mu: 0.5,
        rolling: None,
    });
    Case {
        bounds: Some(BoxSpec {
            lo: [0.0, 0.0, -1.0],
            hi: [8.0, 8.0, 63.0],
            periodic: [true, true, false],
        }),
        gravity: [0.0, 0.0, -1.0],
        ..open_case(law, DT, grains, vec![floor()])
    }
}

const DT: f64 = 1.0 / 8192.0;

fn unit_grain(id: u32, position: [f64; 3], motion: MotionSpec) -> GrainSpec {
    GrainSpec {
        diameter: 1.0,
        ..grain(id, 1.0, position, motion)
    }
}

/// Where a body that was at `from` and goes with this velocity is after n steps, and its crossings of
/// a box from 0 to 8: exact in binary fractions as short as these.
fn carried(from: f64, velocity: f64, n: u64) -> (f64, i32) {
    let gone = from + velocity * DT * n as f64;
    let rounds = (gone / 8.0).floor();
    (gone - 8.0 * rounds, rounds as i32)
}

/// Along x and y a lid's grain is at x0 + U t to the last bit at every step, whatever it runs into and
/// across the box's edges; its velocity keeps its bits. Along z its momentum changes by forces and weight.
#[test]
fn a_lid_is_carried_exactly_and_pushed_along_z() {
    let speed = [0.5, -0.25];
    let mut heavy = unit_grain(9, [5.0, 1.0, 2.25], MotionSpec::Lid(speed));
    heavy.density = 8.0;
    let mut grains = vec![heavy];
    for k in 0..4u32 {
        let k = f64::from(k);
        let place = [5.5 + 0.75 * k, 1.25 - 0.5 * k, 0.5];
        // They stand in its way and overlap a little, side by side, so that they stay.
        grains.push(unit_grain(1 + k as u32, place, MotionSpec::Frozen));
    }
    let mut sim = fractions(grains).start("lid", |_| {}).unwrap();
    let (lid, mass) = (4, sim.velocity[4][3]);
    assert_eq!(sim.id[lid], 9);
    let (mut impulse, mut aside, mut spun) = (0.0, 0.0f64, 0.0f64);
    let mut before = sim.force[lid][2];
    let steps = 65_536;
    for n in 1..=steps {
        sim.steps(1).unwrap();
        let (x, v, f) = (sim.position[lid], sim.velocity[lid], sim.force[lid]);
        for a in 0..2 {
            let there = carried([5.0, 1.0][a], speed[a], n);
            assert_eq!((x[a], sim.image[lid][a]), there, "step {n}");
            assert_eq!(v[a].to_bits(), speed[a].to_bits(), "step {n}");
        }
        impulse += 0.5 * DT * (before + f[2]);
        before = f[2];
        aside = aside.max(f[0].abs());
        spun = spun.max(sim.spin[lid][1].abs());
    }
    assert!(aside > mass, "it ran into something: {aside}");
    assert!(spun > 0.1, "and was turned: {spun}");
    assert_eq!(sim.image[lid][..2], [1, -1]);
    let change = mass * sim.velocity[lid][2];
    let want = impulse - mass * DT * steps as f64;
    // One rounding a step of numbers of order 10.
    assert!((change - want).abs() < 1e-10, "{change} is not {want}");
}

/// Before it meets anything a lid's grain falls as z0 - g t^2/2: velocity Verlet is exact there, and so
/// are binary fractions.
#[test]
fn a_lid_falls_as_anything_falls() {
    let lid = unit_grain(1, [1.0, 1.0, 8.0], MotionSpec::Lid([0.5, 0.0]));
    let mut sim = fractions(vec![lid]).start("lid", |_| {}).unwrap();
    for n in 1..=16_384 {
        sim.steps(1).unwrap();
        let t = n as f64 * DT;
        assert_eq!(sim.position[0][2], 8.0 - 0.5 * t * t, "step {n}");
        assert_eq!(sim.velocity[0][2], -t);
    }
}

/// Without contacts a weightless grain keeps velocity and spin bit for bit, and is at x0 + v t exactly;
/// a free one beside it falls.
#[test]
fn a_weightless_grain_flies_straight() {
    let flying = |id, y, motion| GrainSpec {
        velocity: [-0.75, 0.125, 0.0625],
        spin: [3.0, -0.3, 0.1],
        ..unit_grain(id, [2.0, y, 20.0], motion)
    };
    let grains = vec![
        flying(1, 1.0, MotionSpec::Weightless),
        flying(2, 5.0, MotionSpec::Free),
    ];
    let mut sim = fractions(grains).start("flight", |_| {}).unwrap();
    let (velocity, spin) = (sim.velocity[0], sim.spin[0]);
    for n in 1..=32_768 {
        sim.steps(1).unwrap();
        assert_eq!(
            sim.velocity[0].map(f64::to_bits),
            velocity.map(f64::to_bits)
        );
        assert_eq!(sim.spin[0].map(f64::to_bits), spin.map(f64::to_bits));
        let [x, y, z, _] = sim.position[0];
        assert_eq!((x, sim.image[0][0]), carried(2.0, -0.75, n), "step {n}");
        assert_eq!((y, sim.image[0][1]), carried(1.0, 0.125, n));
        assert_eq!(z, 20.0 + 0.0625 * n as f64 * DT);
    }
    assert_eq!(sim.velocity[1][2], 0.0625 - 4.0, "four units of time on");
}

const CASE: &str = r#"{
  "law": {"kind": "hertz_tsuji", "young": 5e6, "poisson": 0.45, "restitution": 0.6, "mu": 0.5},
  "box": {"lo": [0, 0, 0], "hi": [0.009, 0.0045, 0.02], "periodic": [true, true, false]},
  "gravity": [0, 0, -9.81],
  "dt": 1e-5,
  "obstacles": [{"shape": "cylinder", "center": [0.003, 0, 0.004], "axis": [0, 1, 0], "diameter": 0.002}],
  "grains": [
    {"id": 1, "diameter": 0.0015, "density": 2500, "position": [1e-3, 1e-3, 1e-3], "motion": {"carried": [0.02, 0, 0]}},
    {"id": 2, "diameter": 0.0015, "density": 2500, "position": [0.006, 0.001, 0.004], "motion": "weightless"},
    {"id": 3, "diameter": 0.0015, "density": 150000, "position": [0.006, 0.001, 0.008], "motion": {"lid": [0.02, 0]}}
  ]
}"#;

#[test]
fn wrong_motions_and_bars_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("case.json");
    let (lid, weightless) = ("{\"lid\": [0.02, 0]}", "\"weightless\"");
    let (axis, thick) = ("\"axis\": [0, 1, 0]", "\"diameter\": 0.002}");
    let edits = [
        (lid, "{\"lid\": [0.02, 0, 0]}"),
        (lid, "{\"lid\": [0.02]}"),
        (lid, "{\"lid\": 0.02}"),
        (lid, "{\"lid\": [0.02, NaN]}"),
        (lid, "{\"lid\": [0.02, 1e999]}"),
        (lid, "{\"lids\": [0.02, 0]}"),
        (lid, "\"lid\""),
        (lid, "{\"lid\": [0.02, 0], \"carried\": [0.02, 0, 0]}"),
        (lid, "{\"lid\": [0.02, 0]}, \"velocity\": [0.01, 0, -0.1]"),
        (lid, "{\"lid\": [200, 0]}"),
        (weightless, "\"weightles\""),
        (weightless, "{\"weightless\": [0, 0, 0]}"),
        (weightless, "null"),
        (
            "{\"carried\": [0.02, 0, 0]}",
            "{\"carried\": [0.02, 0, 0]}, \"spin\": [1, 0, 0]",
        ),
        (axis, "\"axis\": [0, 0, 0]"),
        (axis, "\"axis\": [0.1, 1, 0]"),
        (axis, "\"axis\": [0, 1, 0], \"density\": 2500"),
        (thick, "\"diameter\": -0.002}"),
        (thick, "\"diameter\": 0.01}"),
        (thick, "\"diameter\": 0.008}"),
    ];
    let mut text = String::new();
    let replay = ["replay", "case.json", "--steps", "5"];
    for (from, to) in edits {
        assert_eq!(CASE.matches(from).count(), 1, "{from}");
        std::fs::write(&file, CASE.replacen(from, to, 1)).unwrap();
        text.push_str(&format!("# {to}\n"));
        text.push_str(&told(&replay, &output(PROGRAM, folder.path(), &replay)));
    }
    assert_eq!(
        text.matches("[2]\n").count(),
        edits.len(),
        "every one is refused with 2"
    );
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(golden("messages"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.set_description("recipe: `cargo test -p bitgrain-tests --test physics motions::`");
    settings.bind(|| insta::assert_snapshot!("motions", text));
}

fn three(value: &Value) -> [f64; 3] {
    numbers(value).try_into().expect("three numbers")
}

fn plus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// What `bitgrain replay` prints of the rig: the golden digests; base and lid as they are carried; and
/// contacts whose forces, summed in the contract's order, are those on grains and cylinder to the bit.
#[test]
fn the_rig_is_replayed() {
    let case = golden("cases/rig.json");
    let folder = tempfile::tempdir().unwrap();
    let args = ["replay", case.to_str().unwrap(), "--contacts"];
    let args = [&args[..], &["--steps", "3000", "--every", "1000"]].concat();
    let out = output(PROGRAM, folder.path(), &args);
    assert!(out.status.success());
    let digests = std::fs::read_to_string(golden("digests/cases.snap")).unwrap();
    let text = String::from_utf8(out.stdout).unwrap();
    let mut pushed = 0;
    for line in text.lines() {
        let sample: Value = serde_json::from_str(line).unwrap();
        let entry = format!("rig.json {:>5} ", number(&sample["step"]));
        assert!(digests.contains(&(entry + sample["digest"].as_str().unwrap())));
        let mut force = std::collections::BTreeMap::new();
        let mut bar = [0.0; 3];
        for c in sample["contacts"].as_array().unwrap() {
            let push = plus(three(&c["normal_force"]), three(&c["tangential_force"]));
            let mut give = |id: u64, push: [f64; 3]| {
                let sum = force.entry(id).or_insert([0.0; 3]);
                *sum = plus(*sum, push);
            };
            give(c["i"].as_u64().unwrap(), push);
            if let Some(j) = c["j"].as_u64() {
                give(j, push.map(|f| -f));
            }
            if c["obstacle"].as_u64() == Some(0) {
                bar = plus(bar, push.map(|f| -f));
                pushed += 1;
            }
        }
        let grains = sample["grains"].as_array().unwrap();
        assert_eq!(grains.len(), 54);
        for g in grains {
            let id = g["id"].as_u64().unwrap();
            let sum = force.get(&id).copied().unwrap_or_default();
            assert_eq!(three(&g["force"]), sum, "grain {id}");
            let velocity = three(&g["velocity"]);
            match id {
                1..=34 => assert_eq!(velocity, [0.07, 0.0, 0.0]),
                127.. => assert_eq!(velocity[..2], [0.07, 0.0]),
                _ => {}
            }
        }
        assert_eq!(three(&sample["obstacles"][0]["force"]), bar);
    }
    assert_eq!(text.lines().count(), 4);
    assert!(pushed > 2, "the cylinder is pushed: {pushed}");
}

/// The bar of a case is endless, so its place along its axis does not matter.
#[test]
fn a_bar_has_no_place_along_its_axis() {
    let at = |y: f64| {
        let mut case: Case = bitgrain_tests::golden_case("rig.json");
        assert_eq!(case.obstacles[0].shape, BodyShape::Cylinder);
        let center = case.obstacles[0].center.as_mut();
        center.expect("it has one")[1] = y;
        let mut sim = case.start("rig", |_| {}).unwrap();
        sim.steps(3000).unwrap();
        let force = sim.obstacles[0].force.map(f64::to_bits);
        let state = sim.digest().unwrap();
        (state.positions, state.forces, force)
    };
    assert_eq!(at(0.0), at(0.00425));
}
