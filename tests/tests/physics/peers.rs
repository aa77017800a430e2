//! LAMMPS and LIGGGHTS measured the same contacts; these tests compare our numbers with theirs.
//!
//! Forces at step 0 agree to 1e-12 of the largest in the case: the same formula in another order of
//! evaluation. Trajectories agree to 1e-9: a few hundred steps of a collision amplify that rounding.

use bitgrain::case::{BoxSpec, Case, GrainSpec, MotionSpec, ObstacleSpec};
use bitgrain::law::{HertzHistoryParameters, HertzTsujiParameters, LawSpec};
use bitgrain::simulation::Simulation;
use bitgrain_kernel::{Partner, vec3};
use bitgrain_tests::{floor, golden, json, largest, number, numbers, open_case, triple};
use serde_json::Value;

pub(crate) const STEP_0: f64 = 1e-12;
pub(crate) const TRAJECTORY: f64 = 1e-9;

/// One row of a reference code's trajectory: step, position, velocity, spin, force, torque.
pub(crate) type PeerRow = Vec<f64>;

pub(crate) fn grain(
    id: u32,
    diameter: f64,
    density: f64,
    row: &[f64],
    motion: MotionSpec,
) -> GrainSpec {
    let rests = motion != MotionSpec::Free;
    GrainSpec {
        id,
        diameter,
        density,
        position: triple(row, 1),
        velocity: if rests { [0.0; 3] } else { triple(row, 4) },
        spin: if rests { [0.0; 3] } else { triple(row, 7) },
        motion,
        material: None,
    }
}

fn history_law(params: &Value) -> LawSpec {
    let get = |key: &str| number(&params[key]);
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn: get("Kn"),
        kt: get("Kt"),
        gamma_n: get("gamma_n"),
        gamma_t: get("gamma_t"),
        mu: get("mu"),
        rolling: None,
    })
}

/// Largest deviation of five quantities over a trajectory, each relative to its largest value in
/// the case (spins at least to speed over radius, torques to force times radius).
pub(crate) fn compare(name: &str, case: &Case, traj: &[Vec<PeerRow>], skip_force: &[bool]) {
    let sim = case.start(name, |_| {}).expect("the peers ran it");
    follow(name, (case, sim), traj, skip_force);
}

/// The same of a simulation that has begun.
pub(crate) fn follow(
    name: &str,
    (case, mut sim): (&Case, Simulation),
    traj: &[Vec<PeerRow>],
    skip_force: &[bool],
) {
    let all = |at: usize| largest(traj.iter().flatten().flat_map(|row| triple(row, at)));
    let radius = 0.5 * largest(case.grains.iter().map(|g| g.diameter));
    let (x, v, f) = (all(1), all(4), all(10));
    let scales = [x, v, all(7).max(v / radius), f, all(13).max(f * radius)];
    let names = ["position", "velocity", "spin", "force", "torque"];
    for sample in traj {
        let step = sample[0][0] as u64;
        sim.steps(step - sim.step_count())
            .expect("the peers ran it");
        let tolerance = if step == 0 { STEP_0 } else { TRAJECTORY };
        for (i, row) in sample.iter().enumerate() {
            let ours = [
                sim.position[i],
                sim.velocity[i],
                sim.spin[i],
                sim.force[i],
                sim.torque[i],
            ];
            for (q, ours) in ours.iter().enumerate() {
                // The reference codes blank the force on spheres that they freeze.
                if q >= 3 && skip_force[i] {
                    continue;
                }
                let mut theirs = triple(row, 1 + 3 * q);
                if q == 3 {
                    // Their force holds the weight.
                    let mass = sim.velocity[i][3];
                    (0..3).for_each(|a| theirs[a] -= mass * case.gravity[a]);
                }
                let off = largest((0..3).map(|a| ours[a] - theirs[a]));
                assert!(
                    off <= tolerance * scales[q],
                    "{name}: {} of sphere {i} at step {step} is off by {off:e} of {:e}",
                    names[q],
                    scales[q]
                );
            }
        }
    }
}

pub(crate) fn trajectory(case: &Value) -> Vec<Vec<PeerRow>> {
    let samples = case["traj"].as_array().expect("samples");
    samples
        .iter()
        .map(|s| match s[0].is_array() {
            true => s.as_array().expect("rows").iter().map(numbers).collect(),
            false => vec![numbers(s)],
        })
        .collect()
}

fn flags(value: &Value, count: usize) -> Vec<bool> {
    (0..count)
        .map(|k| value[k].as_bool().unwrap_or(false))
        .collect()
}

#[test]
fn lammps_pair_collisions() {
    let file = json("peers/lammps_pairs.json.gz");
    let cases = file["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 12);
    for c in cases {
        let traj = trajectory(c);
        let (frozen, moved) = (flags(&c["frozen"], 2), flags(&c["moved"], 2));
        let grains = (0..2).map(|i| {
            let row = &traj[0][i];
            let motion = match (frozen[i], moved[i]) {
                (true, _) => MotionSpec::Frozen,
                (_, true) => MotionSpec::Carried(triple(row, 4)),
                _ => MotionSpec::Free,
            };
            grain(i as u32 + 1, number(&c["diameter"][i]), 1.0, row, motion)
        });
        let case = open_case(
            history_law(&c["params"]),
            number(&c["dt"]),
            grains.collect(),
            vec![],
        );
        compare(c["name"].as_str().expect("a name"), &case, &traj, &frozen);
    }
}

/// The driven sphere of the same data as an obstacle: its own mass enters the contact, and the force
/// on it has the stated sign.
#[test]
fn lammps_driven_sphere_as_obstacle() {
    let file = json("peers/lammps_pairs.json.gz");
    let cases = file["cases"].as_array().expect("cases");
    let c = cases
        .iter()
        .find(|c| c["name"] == "moved_partner_soft")
        .expect("the case");
    let traj = trajectory(c);
    let body = &traj[0][1];
    let sphere = ObstacleSpec {
        density: Some(1.0),
        velocity: triple(body, 4),
        ..ObstacleSpec::sphere(triple(body, 1), number(&c["diameter"][1]))
    };
    let free = grain(
        1,
        number(&c["diameter"][0]),
        1.0,
        &traj[0][0],
        MotionSpec::Free,
    );
    let law = history_law(&c["params"]);
    let case = open_case(law, number(&c["dt"]), vec![free], vec![sphere]);
    let only: Vec<Vec<PeerRow>> = traj.iter().map(|s| vec![s[0].clone()]).collect();
    compare("moved_partner_soft", &case, &only, &[false]);

    let mut sim = case
        .start("moved_partner_soft", |_| {})
        .expect("the peers ran it");
    let scale = largest(traj.iter().flat_map(|s| triple(&s[1], 10)));
    let torques = largest(traj.iter().flat_map(|s| triple(&s[1], 13)));
    for sample in &traj {
        sim.steps(sample[1][0] as u64 - sim.step_count())
            .expect("the peers ran it");
        let theirs = triple(&sample[1], 10);
        let off = largest((0..3).map(|a| sim.obstacles[0].force[a] - theirs[a]));
        assert!(
            off <= TRAJECTORY * scale,
            "force on the sphere is off by {off:e}"
        );
        let theirs = triple(&sample[1], 13);
        let off = largest((0..3).map(|a| sim.obstacles[0].torque[a] - theirs[a]));
        assert!(
            off <= TRAJECTORY * torques,
            "torque on the sphere is off by {off:e}"
        );
    }
}

#[test]
fn liggghts_pair_and_wall_collisions() {
    let file = json("peers/liggghts_pairs.json.gz");
    let cases = file["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 20);
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 5e6,
        poisson: 0.45,
        restitution: 0.6,
        mu: 0.5,
        rolling: None,
    });
    for c in cases {
        let traj = trajectory(c);
        let count = traj[0].len();
        let frozen = flags(&c["frozen"], count);
        let grains = (0..count).map(|i| {
            let motion = if frozen[i] {
                MotionSpec::Frozen
            } else {
                MotionSpec::Free
            };
            grain(
                i as u32 + 1,
                number(&c["diameter"][i]),
                2500.0,
                &traj[0][i],
                motion,
            )
        });
        let obstacles = match c["wall"].as_str() {
            None => vec![],
            Some("zplane 0.0") => vec![floor()],
            Some("ycylinder 0.0025 0.0 0.0") => {
                vec![ObstacleSpec::cylinder([0.0; 3], [0.0, 1.0, 0.0], 0.005)]
            }
            Some(other) => panic!("unknown wall {other}"),
        };
        let case = open_case(law, number(&c["dt"]), grains.collect(), obstacles);
        let name = format!("{} dt {}", c["name"], c["dt"]);
        compare(&name, &case, &traj, &frozen);
    }
}

#[test]
fn lammps_oblique_wall_collisions() {
    let file = json("peers/lammps_wall_oblique.json");
    let cases = file["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 2);
    for c in cases {
        let traj = trajectory(c);
        let ball = grain(
            1,
            number(&c["diameter"]),
            1.0,
            &traj[0][0],
            MotionSpec::Free,
        );
        let case = open_case(history_law(c), number(&c["dt"]), vec![ball], vec![floor()]);
        compare(c["name"].as_str().expect("a name"), &case, &traj, &[false]);
    }
}

#[test]
fn lammps_wall_restitution() {
    let text =
        std::fs::read_to_string(golden("peers/lammps_wall_restitution.csv")).expect("a file");
    let rows: Vec<Vec<f64>> = text
        .lines()
        .filter(|l| l.starts_with(|c: char| c.is_ascii_digit()))
        .map(|l| l.split(',').map(|w| w.parse().expect("a number")).collect())
        .collect();
    assert_eq!(rows.len(), 24);
    for row in rows {
        let [kn, gamma, dt, v, e] = row[..5] else {
            panic!("five columns")
        };
        let law = LawSpec::HertzHistory(HertzHistoryParameters {
            kn,
            kt: 1.225 * kn,
            gamma_n: gamma,
            gamma_t: gamma,
            mu: 0.5,
            rolling: None,
        });
        let start = [0.0, 0.0, 0.0, row[7], 0.0, 0.0, -v, 0.0, 0.0, 0.0];
        let ball = grain(1, 1.0, 1.0, &start, MotionSpec::Free);
        let case = open_case(law, dt, vec![ball], vec![floor()]);
        let mut sim = case.start("wall", |_| {}).expect("the peers ran it");
        sim.steps(row[8] as u64).expect("the peers ran it");
        let ours = sim.velocity[0][2] / v;
        assert!(
            (ours - e).abs() <= 1e-9,
            "kn {kn} v {v} dt {dt}: {ours} against {e}"
        );
    }
}

/// The 200-grain bed, with the contacts at step 0 one by one.
#[test]
fn lammps_bed_of_200() {
    let file = json("peers/bed200.json.gz");
    let frozen: Vec<u32> = numbers(&file["frozen_ids"])
        .iter()
        .map(|&k| k as u32)
        .collect();
    let state = |step: u64| -> Vec<Vec<f64>> {
        let rows = file["states"][step.to_string()]
            .as_array()
            .expect("a state");
        let mut rows: Vec<Vec<f64>> = rows.iter().map(numbers).collect();
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        rows
    };
    let grains = state(0).into_iter().map(|row| {
        let id = row[0] as u32;
        let motion = if frozen.contains(&id) {
            MotionSpec::Frozen
        } else {
            MotionSpec::Free
        };
        grain(id, row[1], 1.0, &row[2..], motion)
    });
    let case = Case {
        law: history_law(&file["params"]).into(),
        bounds: Some(BoxSpec {
            lo: [0.0, 0.0, -0.5],
            hi: [5.5, 5.5, 30.0],
            periodic: [true, true, false],
        }),
        gravity: [0.0, 0.0, -1.0],
        dt: number(&file["dt"]),
        obstacles: vec![],
        grains: grains.collect(),
    };
    let mut seen = Vec::new();
    let mut sim = case
        .start("bed200", |p| seen.push(p))
        .expect("the peers ran it");
    check_contacts(&sim, &seen, &file["contacts"]["0"]);
    for step in [0, 1, 10, 100] {
        sim.steps(step - sim.step_count())
            .expect("the peers ran it");
        check_bed(
            &sim,
            &state(step),
            &frozen,
            if step == 0 { STEP_0 } else { TRAJECTORY },
        );
    }
}

fn check_bed(sim: &Simulation, rows: &[Vec<f64>], frozen: &[u32], tolerance: f64) {
    let scale = |at: usize| largest(rows.iter().flat_map(|row| triple(row, at)));
    let scales = [5.5, scale(6), scale(9), scale(12), scale(15)];
    for (i, row) in rows.iter().enumerate() {
        let mass = sim.velocity[i][3];
        let ours = [
            sim.position[i],
            sim.velocity[i],
            sim.spin[i],
            sim.force[i],
            sim.torque[i],
        ];
        for q in 0..5 {
            if q >= 3 && frozen.contains(&sim.id[i]) {
                continue;
            }
            let mut theirs = triple(row, 3 + 3 * q);
            if q == 3 {
                // Their force holds the weight.
                theirs[2] += mass;
            }
            for a in 0..3 {
                let mut off = ours[q][a] - theirs[a];
                if q == 0 && a < 2 {
                    // They wrap now and then only.
                    off -= 5.5 * (off / 5.5).round();
                }
                let (id, limit) = (sim.id[i], tolerance * scales[q]);
                assert!(
                    off.abs() <= limit,
                    "grain {id} quantity {q} is off by {off:e}"
                );
            }
        }
    }
}

fn check_contacts(sim: &Simulation, seen: &[bitgrain_kernel::ContactForce<f64>], theirs: &Value) {
    let theirs: Vec<Vec<f64>> = theirs
        .as_array()
        .expect("contacts")
        .iter()
        .map(numbers)
        .collect();
    assert_eq!(seen.len(), theirs.len(), "number of contacts");
    let scale = largest(theirs.iter().map(|c| c[3]));
    for c in seen {
        let Partner::Grain(j) = c.partner else {
            panic!("no obstacle here")
        };
        let (i, j) = (
            f64::from(sim.id[c.i as usize]),
            f64::from(sim.id[j as usize]),
        );
        let same = |t: &&Vec<f64>| (t[0] == i && t[1] == j) || (t[0] == j && t[1] == i);
        let t = theirs.iter().find(same).expect("the same pairs touch");
        let sign = if t[0] == i { 1.0 } else { -1.0 };
        let normal = vec3::scale(c.normal, c.normal_force);
        for a in 0..3 {
            let off = largest([
                normal[a] - sign * t[4 + a],
                c.tangential_force[a] - sign * t[7 + a],
            ]);
            assert!(off <= STEP_0 * scale, "contact {i} {j} is off by {off:e}");
        }
    }
}

/// The tail of chi-square by which drags are judged.
#[test]
fn tails_are_those_of_tables() {
    for (chi_square, degrees, p) in [(32.0, 16, 0.01), (23.542, 16, 0.1), (9.210, 2, 0.01)] {
        assert!((bitgrain_tests::drags::tail(chi_square, degrees) / p - 1.0).abs() < 1e-3);
    }
}
