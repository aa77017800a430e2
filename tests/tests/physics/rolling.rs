//! Resistance to rolling as LIGGGHTS (`epsd2`) and LAMMPS (`sds`) have it, and what it does to a ball that rolls.
//! Tolerances as in `peers`.

use bitgrain::case::{Case, MotionSpec, ObstacleSpec};
use bitgrain::energy_budget::Audit;
use bitgrain::law::{HertzTsujiParameters, LawSpec, RollingSpec};
use bitgrain::simulation::Simulation;
use bitgrain_kernel::contact::{
    Law, NormalForce, NormalState, Rolling, RollingResistance, RollingSpring, SpringInPlane,
    TangentialForce, TangentialState, TurningState,
};
use bitgrain_kernel::vec3::{self, Vec3, add, cross, dot, scale, sub};
use bitgrain_kernel::{Domain, Group, Obstacle, Store, start, step};
use bitgrain_tests::{ball, floor, json, largest, number, numbers, open_case, triple};
use serde_json::Value;

use crate::peers::{STEP_0, TRAJECTORY, compare, follow, grain, trajectory};

fn name(c: &Value) -> &str {
    c["name"].as_str().expect("a name")
}

/// The case of LIGGGHTS with the walls that it has.
fn epsd2(c: &Value) -> Case {
    let (params, species) = (&c["params"], &c["params"]["species"][0]);
    let of = |key: &str| number(&params[key]["11"]);
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young: number(&species["E"]),
        poisson: number(&species["nu"]),
        restitution: of("e"),
        mu: of("mu"),
        rolling: Some(RollingSpec::Epsd2 { mu: of("rmu") }),
    });
    let first = &trajectory(c)[0];
    let spheres = first.iter().enumerate().map(|(i, row)| {
        let (diameter, density) = (number(&c["diameter"][i]), number(&c["density"][i]));
        grain(i as u32 + 1, diameter, density, row, MotionSpec::Free)
    });
    let walls = c["walls"].as_array().into_iter().flatten().map(|wall| {
        let [point, normal] = ["point", "normal"].map(|key| triple(&numbers(&wall[key]), 0));
        ObstacleSpec::plane(point, normal)
    });
    Case {
        gravity: triple(&numbers(&c["gravity"]), 0),
        ..open_case(law, number(&c["dt"]), spheres.collect(), walls.collect())
    }
}

#[test]
fn liggghts_epsd2() {
    let file = json("peers/rolling_liggghts.json.gz");
    let cases = file["cases"].as_array().expect("cases").iter();
    let ours: Vec<_> = cases
        .filter(|c| c["params"]["rolling"] == "epsd2")
        .collect();
    assert_eq!(ours.len(), 3);
    for c in ours {
        let (case, mut traj) = (epsd2(c), trajectory(c));
        if c["walls"].is_null() {
            compare(name(c), &case, &traj, &[false; 2]);
            continue;
        }
        // LIGGGHTS turns the ball against its limit at step 0 already, before any way; ours has rolled no way then. So
        // the run goes on from its torque.
        let mut sim = case.start(name(c), |_| {}).expect("the peer ran it");
        let first = traj.remove(0);
        let [lever, whole] = [vec3::head(sim.torque[0]), triple(&first[0], 13)];
        let limit = 0.1 * 0.002 * sim.force[0][2];
        let extra = sub(whole, lever);
        assert!(
            (extra[1] / -limit - 1.0).abs() < STEP_0,
            "{extra:?}, {limit}"
        );
        sim.torque[0][..3].copy_from_slice(&whole);
        let histories = sim.contact_histories();
        sim.resume(&histories).unwrap();
        follow(name(c), (&case, sim), &traj, &[false]);
    }
}

fn sds(of: &Value) -> RollingResistance<f64> {
    let [k, gamma, mu] = numbers(&of["roll"]).try_into().expect("three numbers");
    RollingResistance {
        spring: RollingSpring::Sds,
        k,
        gamma,
        mu,
    }
}

/// LAMMPS' granular wall: stiffnesses as it computes them for a wall, whole radii as levers.
#[derive(Clone, Copy)]
struct Wall {
    /// `E/(2 (1 - nu))` and `E (2 - nu)(1 + nu)/4` (pressure).
    young: f64,
    shear: f64,
    alpha: f64,
    mu: f64,
}

impl Wall {
    fn of(params: &Value) -> Self {
        let [young, poisson, e, mu] = ["E", "nu", "e", "mu"].map(|key| number(&params[key]));
        let powers = [1.2728, -4.2783, 11.087, -22.348, 27.467, -18.022, 4.8218];
        Self {
            young: young / (2.0 * (1.0 - poisson)),
            shear: young * (2.0 - poisson) * (1.0 + poisson) / 4.0,
            alpha: powers.iter().rev().fold(0.0, |sum, c| sum * e + c),
            mu,
        }
    }
}

impl Law<f64> for Wall {
    fn normal_force(&self, c: &NormalState<f64>) -> NormalForce<f64> {
        let contact_radius = (c.radius_effective * c.overlap).sqrt();
        let stiffness = 4.0 / 3.0 * self.young * contact_radius;
        let damping = self.alpha * (c.mass_effective * stiffness).sqrt();
        NormalForce {
            force: stiffness * c.overlap - damping * c.speed,
            contact_radius,
            damping,
            lever_arm_i: c.radius_i,
            lever_arm_j: c.radius_j,
        }
    }

    fn tangential_force(
        &self,
        normal: &NormalForce<f64>,
        state: &TangentialState<f64>,
    ) -> TangentialForce<f64> {
        let stiffness = self.tangential_stiffness(normal);
        let damped = scale(state.velocity, normal.damping);
        let trial = add(scale(state.spring, stiffness), damped);
        let (size, limit) = (dot(trial, trial).sqrt(), self.mu * normal.force.abs());
        if size <= limit {
            return TangentialForce {
                force: scale(trial, -1.0),
                spring: state.spring,
            };
        }
        if state.length2 == 0.0 {
            return TangentialForce {
                force: [0.0; 3],
                spring: state.spring,
            };
        }
        let held = scale(trial, limit / size);
        TangentialForce {
            force: scale(held, -1.0),
            spring: scale(sub(held, damped), 1.0 / stiffness),
        }
    }
}

impl SpringInPlane<f64> for Wall {
    fn tangential_stiffness(&self, normal: &NormalForce<f64>) -> f64 {
        self.shear * normal.contact_radius
    }
}

/// Balls on LAMMPS' wall: one rolls to rest, over 16,000 steps, one begins to turn in contact.
#[test]
fn lammps_sds_on_a_wall() {
    let file = json("peers/rolling_lammps.json.gz");
    let cases = file["cases"].as_array().expect("cases").iter();
    let on_walls: Vec<_> = cases.filter(|c| !c["walls"].is_null()).collect();
    assert_eq!(on_walls.len(), 2);
    for c in on_walls {
        let (traj, of) = (trajectory(c), &c["params"]["pair"]["11"]);
        let law = Rolling {
            law: Wall::of(of),
            resistance: sds(of),
        };
        let (radius, mass) = (0.5 * number(&c["diameter"][0]), number(&c["mass"][0]));
        let gravity = triple(&numbers(&c["gravity"]), 0);
        let mut store = Store::<f64, 1, 4, 2, 1, 3>::new(Domain::open(), number(&c["dt"]), 1e-4);
        store.add_group(Group::free(gravity)).unwrap();
        store
            .add_obstacle(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]))
            .unwrap();
        let first = &traj[0][0];
        store
            .add_grain(1, 0, triple(first, 1), radius, mass)
            .unwrap();
        let mut world = store.world();
        world.grains.velocity[0][..3].copy_from_slice(&triple(first, 4));
        world.grains.spin[0][..3].copy_from_slice(&triple(first, 7));
        start(&mut world, &law).unwrap();
        let all = |at: usize| largest(traj.iter().flatten().flat_map(|row| triple(row, at)));
        let (v, f) = (all(4), all(10));
        let scales = [
            all(1),
            v,
            all(7).max(v / radius),
            f,
            all(13).max(f * radius),
        ];
        for sample in &traj {
            let (row, at) = (&sample[0], sample[0][0] as u64);
            while world.clock.step < at {
                step(&mut world, &law).unwrap();
            }
            let g = &world.grains;
            let ours = [
                g.position[0],
                g.velocity[0],
                g.spin[0],
                g.force[0],
                g.torque[0],
            ];
            for (q, ours) in ours.iter().enumerate() {
                let mut theirs = triple(row, 1 + 3 * q);
                if q == 3 {
                    (0..3).for_each(|a| theirs[a] -= mass * gravity[a]);
                }
                let off = largest((0..3).map(|a| ours[a] - theirs[a]));
                let tolerance = if at == 0 { STEP_0 } else { TRAJECTORY };
                assert!(
                    off <= tolerance * scales[q],
                    "{}: quantity {q} at step {at} is off by {off:e} of {:e}",
                    name(c),
                    scales[q]
                );
            }
        }
    }
}

/// Two spheres as LAMMPS moved them, every step of which is known; its levers differ from those of any law here (see
/// `materials`), so the torque that our resistance gives along its way is compared with what its own torque has beside
/// that of its tangential force.
#[test]
fn lammps_sds_of_two_spheres() {
    let file = json("peers/rolling_lammps.json.gz");
    let cases = file["cases"].as_array().expect("cases").iter();
    let whole: Vec<_> = cases.filter(|c| number(&c["every"]) == 1.0).collect();
    assert_eq!(whole.len(), 1);
    for c in whole {
        let (traj, dt) = (trajectory(c), number(&c["dt"]));
        let (radius, mass) = (0.5 * number(&c["diameter"][0]), number(&c["mass"][0]));
        let inertia = 0.4 * mass * radius * radius;
        let resistance = sds(&c["params"]["pair"]["11"]);
        let law = Rolling {
            law: Wall::of(&c["params"]["pair"]["11"]),
            resistance,
        };
        let most = largest(traj.iter().flatten().flat_map(|row| triple(row, 13)));
        let (mut memory, mut rolled, mut largest_torque) = ([0.0; 8], 0, 0.0f64);
        for (at, sample) in traj.iter().enumerate() {
            let back = if at == 0 { 0.0 } else { -0.5 * dt };
            let half = |i: usize| -> Vec3<f64> {
                add(
                    triple(&sample[i], 7),
                    scale(triple(&sample[i], 13), back / inertia),
                )
            };
            let apart = sub(triple(&sample[0], 1), triple(&sample[1], 1));
            let distance = dot(apart, apart).sqrt();
            let (normal, overlap) = (scale(apart, 1.0 / distance), 2.0 * radius - distance);
            if overlap <= 0.0 {
                memory = [0.0; 8];
                continue;
            }
            let (force, theirs) = (triple(&sample[0], 10), triple(&sample[0], 13));
            let along = dot(force, normal);
            let tangential = sub(force, scale(normal, along));
            let lever = scale(cross(normal, tangential), overlap * 0.5 - radius);
            let state = TurningState {
                contact: NormalState {
                    overlap,
                    speed: 0.0,
                    radius_i: radius,
                    radius_j: radius,
                    radius_effective: 0.5 * radius,
                    mass_effective: 0.5 * mass,
                    inverse_masses: [1.0 / mass; 2],
                    materials: [0; 2],
                    memory,
                },
                normal,
                velocity: [0.0; 3],
                tangential,
                spin_i: half(0),
                spin_j: half(1),
                dt: if at == 0 { 0.0 } else { dt },
            };
            let pressed = NormalForce {
                force: along,
                contact_radius: (0.5 * radius * overlap).sqrt(),
                damping: 0.0,
                lever_arm_i: radius,
                lever_arm_j: radius,
            };
            let ours = law.torque(&pressed, &state);
            memory = ours.memory;
            let off = largest(sub(add(lever, ours.torque), theirs));
            assert!(
                off < TRAJECTORY * most,
                "step {at}: off by {off:e} of {most:e}"
            );
            rolled += 1;
            largest_torque = largest_torque.max(largest(ours.torque));
        }
        assert!(
            rolled > 25 && largest_torque > 0.01 * most,
            "{rolled} {largest_torque:e}"
        );
    }
}

/// A ball of diameter 1 that rolls on the floor under a law with this resistance.
fn rolling_ball(rolling: RollingSpec, speed: f64, dt: f64) -> Simulation {
    let law = LawSpec::HertzTsuji(HertzTsujiParameters {
        young: 1e5,
        poisson: 0.3,
        restitution: 0.5,
        mu: 0.5,
        rolling: Some(rolling),
    });
    let mut one = ball(1, [0.0, 0.0, 0.4997], [speed, 0.0, 0.0]);
    one.spin = [0.0, 2.0 * speed, 0.0];
    let case = Case {
        gravity: [0.0, 0.0, -1.0],
        ..open_case(law, dt, vec![one], vec![floor()])
    };
    case.start("a ball that rolls", |_| {})
        .expect("a sound case")
}

/// Both models, with one limit.
const MODELS: [RollingSpec; 2] = [
    RollingSpec::Epsd2 { mu: 0.05 },
    RollingSpec::Sds {
        k: 2e3,
        gamma: 1.0,
        mu: 0.05,
    },
];

/// A ball that rolls without sliding against the moment `mu r N` is slowed down by `(5/7) mu g` and stops for good; the
/// first tenth is left to the settling of the contact, and a hundredth is for the overlap in the levers.
#[test]
fn a_rolling_ball_is_slowed_down_by_the_moment_of_its_limit() {
    for rolling in MODELS {
        let mut sim = rolling_ball(rolling, 0.5, 1e-4);
        sim.steps(2000).unwrap();
        let (before, at) = (sim.velocity[0][0], sim.step_count());
        sim.steps(60_000).unwrap();
        let time = (sim.step_count() - at) as f64 * sim.dt;
        let slowed = (before - sim.velocity[0][0]) / time;
        let expected = 5.0 / 7.0 * 0.05;
        assert!(
            (slowed / expected - 1.0).abs() < 0.01,
            "{rolling:?}: {slowed} {expected}"
        );
        // It comes to rest, and stays where it is.
        sim.steps(150_000).unwrap();
        let place = sim.position[0][0];
        sim.steps(50_000).unwrap();
        let moved = (sim.position[0][0] - place).abs();
        assert!(moved < 2e-4, "{rolling:?}: it still moves by {moved}");
    }
}

/// Without it a ball rolls on: what slows it down above is nothing else.
#[test]
fn without_resistance_a_ball_rolls_on() {
    let mut sim = rolling_ball(RollingSpec::Epsd2 { mu: 0.0 }, 0.5, 1e-4);
    sim.steps(2000).unwrap();
    let before = sim.velocity[0][0];
    sim.steps(60_000).unwrap();
    assert!((sim.velocity[0][0] / before - 1.0).abs() < 1e-6);
}

/// What resists rolling takes energy, all that is missing of it: the budget closes within a thousandth.
#[test]
fn the_energy_that_rolling_takes_is_accounted_for() {
    for rolling in MODELS {
        let mut sim = rolling_ball(rolling, 0.5, 1e-4);
        sim.steps(2000).unwrap();
        let energy = sim.kinetic_energy();
        let mut audit = Audit::new(&mut sim);
        for _ in 0..40_000 {
            audit.step(&mut sim).unwrap();
        }
        let row = audit.row(sim.step_count());
        let (taken, lost) = (row.rolling.unwrap(), energy - sim.kinetic_energy());
        assert!(row.closure().abs() < 1e-3, "{rolling:?}: {}", row.closure());
        assert!(
            (taken / lost - 1.0).abs() < 0.02,
            "{rolling:?}: {taken} of {lost}"
        );
    }
}
