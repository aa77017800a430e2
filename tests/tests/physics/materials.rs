//! Two materials and more, each pair with its own numbers, as LAMMPS and LIGGGHTS have them. Tolerances as in `peers`.

use std::collections::BTreeMap;

use bitgrain::case::{GrainSpec, MotionSpec};
use bitgrain::law::{
    AnyLaw, Elasticity, HertzHistoryPair, HertzHistoryTable, HertzTsujiPair, HertzTsujiTable,
    LawTable,
};
use bitgrain_kernel::contact::{Contact, Kept, react};
use bitgrain_kernel::vec3::{add, cross, dot, scale as scaled, sub};
use bitgrain_tests::{json, largest, number, open_case, triple};
use serde_json::Value;

use crate::peers::{compare, grain, trajectory};

/// The two names in a key such as `12`.
fn between(key: &str) -> [String; 2] {
    let mut names = key.chars().map(|of| of.to_string());
    [(); 2].map(|()| names.next().expect("two numbers"))
}

/// What a key of a file says of each pair.
fn pairs<T>(of: &Value, pair: impl Fn([String; 2], &Value) -> T) -> Vec<T> {
    let pairs = of.as_object().expect("pairs").iter();
    pairs
        .map(|(key, value)| pair(between(key), value))
        .collect()
}

/// LIGGGHTS' law of a case.
fn liggghts(params: &Value) -> LawTable {
    let species = params["species"].as_array().expect("species").iter();
    let elasticity = |of: &Value| Elasticity {
        young: number(&of["E"]),
        poisson: number(&of["nu"]),
    };
    let materials: BTreeMap<_, _> = (1..)
        .zip(species)
        .map(|(k, of)| (k.to_string(), elasticity(of)))
        .collect();
    let pair = |between: [String; 2], restitution: &Value| HertzTsujiPair {
        mu: number(&params["mu"][between.concat()]),
        restitution: number(restitution),
        between,
        rolling: None,
    };
    LawTable::HertzTsuji(HertzTsujiTable {
        materials,
        pairs: pairs(&params["e"], pair),
    })
}

/// LAMMPS' `hertz` with viscoelastic damping, a force of our first law.
fn lammps(params: &Value) -> LawTable {
    let pair = |between, of: &Value| HertzHistoryPair {
        between,
        kn: number(&of["k"]),
        kt: number(&of["kt"]),
        gamma_n: number(&of["eta"]),
        gamma_t: number(&of["xt"]) * number(&of["eta"]),
        mu: number(&of["mu"]),
        rolling: None,
    };
    LawTable::HertzHistory(HertzHistoryTable {
        materials: None,
        pairs: pairs(&params["pair"], pair),
    })
}

/// Compares a case under its law.
fn check(c: &Value, law: LawTable) {
    let traj = trajectory(c);
    let roles: Vec<_> = c["role"].as_array().expect("roles").iter().collect();
    let grains = roles.iter().enumerate().map(|(i, role)| {
        let motion = match role.as_str() {
            Some("frozen") => MotionSpec::Frozen,
            _ => MotionSpec::Free,
        };
        let (diameter, density) = (number(&c["diameter"][i]), number(&c["density"][i]));
        let sphere = grain(i as u32 + 1, diameter, density, &traj[0][i], motion);
        GrainSpec {
            material: Some(number(&c["type"][i]).to_string()),
            ..sphere
        }
    });
    let case = open_case(law, number(&c["dt"]), grains.collect(), vec![]);
    let frozen: Vec<bool> = roles.iter().map(|role| *role == "frozen").collect();
    compare(c["name"].as_str().expect("a name"), &case, &traj, &frozen);
}

#[test]
fn liggghts_species() {
    let file = json("peers/materials_liggghts.json.gz");
    let cases = file["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 14);
    cases.iter().for_each(|c| check(c, liggghts(&c["params"])));
}

/// LAMMPS' `pair granular` lets the tangential force turn a sphere by the radius less half the overlap and takes the
/// whole radius for the sliding; ours, as its `gran/hertz/history`, takes the whole radius for both. So spins part, and
/// what is compared is the force that our law gives along LAMMPS' own way, step by step.
#[test]
fn lammps_pair_coefficients() {
    let file = json("peers/materials_lammps.json.gz");
    let cases = file["cases"].as_array().expect("cases").iter();
    // Of every step.
    let whole: Vec<_> = cases.filter(|c| number(&c["every"]) == 1.0).collect();
    assert_eq!(whole.len(), 1);
    for c in whole {
        let (traj, dt) = (trajectory(c), number(&c["dt"]));
        let numbers = |key: &str| [0, 1].map(|i| number(&c[key][i]));
        let (diameter, mass) = (numbers("diameter"), numbers("mass"));
        let AnyLaw::HertzHistoryPairs(laws) = lammps(&c["params"]).build().expect("a law") else {
            panic!("a table of this law");
        };
        let materials = numbers("type").map(|of| of as u8 - 1);
        let all = |at: usize| largest(traj.iter().flatten().flat_map(|row| triple(row, at)));
        let (scale, mut spring, mut touching) = (all(10), [0.0f64; 3], 0);
        for (step, sample) in traj.iter().enumerate() {
            // The forces of a step are those of its half-step velocities; at step 0 of the full ones.
            let back = if step == 0 { 0.0 } else { -0.5 * dt };
            let half = |i: usize| {
                let inertia = 0.1 * mass[i] * diameter[i] * diameter[i];
                let (row, push, turn) =
                    (&sample[i], triple(&sample[i], 10), triple(&sample[i], 13));
                let velocity = add(triple(row, 4), scaled(push, back / mass[i]));
                (velocity, add(triple(row, 7), scaled(turn, back / inertia)))
            };
            let ([v, w], [u, z]) = (half(0).into(), half(1).into());
            let apart = sub(triple(&sample[0], 1), triple(&sample[1], 1));
            let distance = dot(apart, apart).sqrt();
            let [a, b] = diameter.map(|d| 0.5 * d);
            let contact = Contact {
                normal: scaled(apart, 1.0 / distance),
                overlap: a + b - distance,
                radius_i: a,
                radius_j: b,
                radius_effective: a * b / (a + b),
                mass_effective: mass[0] * mass[1] / (mass[0] + mass[1]),
                inverse_masses: mass.map(|m| 1.0 / m),
                materials,
                velocity: sub(v, u),
                spin_i: w,
                spin_j: z,
                turning_j: z,
            };
            let (theirs, turn) = (triple(&sample[0], 10), triple(&sample[0], 13));
            if contact.overlap <= 0.0 {
                spring = [0.0; 3];
                assert_eq!(theirs, [0.0; 3], "step {step}");
                continue;
            }
            // As its plane turns, a spring keeps its length there, and here only what lies in the new plane.
            let (n, long) = (contact.normal, dot(spring, spring).sqrt());
            let plane = sub(spring, scaled(n, dot(spring, n)));
            let left = dot(plane, plane).sqrt();
            if left > 0.0 {
                spring = scaled(plane, long / left);
            }
            let advance = if step == 0 { 0.0 } else { dt };
            let kept = Kept {
                spring,
                ..Kept::NOTHING
            };
            let ours = react(&laws.lend(), &contact, kept, advance);
            spring = ours.kept.spring;
            touching += 1;
            let force = add(scaled(contact.normal, ours.normal), ours.tangential);
            let off = largest(sub(force, theirs));
            assert!(
                off < 1e-9 * scale,
                "step {step}: force off by {off:e} of {scale:e}"
            );
            let lever = a - 0.5 * contact.overlap;
            let torque = scaled(cross(contact.normal, ours.tangential), -lever);
            let off = largest(sub(torque, turn));
            assert!(off < 1e-9 * scale * a, "step {step}: torque off by {off:e}");
        }
        assert!(touching > 25, "{touching}");
    }
}
