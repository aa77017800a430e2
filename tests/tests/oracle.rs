//! The fast step against a slow one that follows the written definitions and nothing else: all
//! pairs, one at a time, a map for the springs, every sum in the contract's order. Equal to the bit.

use std::collections::BTreeMap;

use bitgrain::sim::{AnyLaw, Grain, Sim, sphere_mass};
use bitgrain_kernel::law::{Contact, HertzHistory, HertzTsuji, Law, Reaction};
use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{Domain, Group, Obstacle, Shape, vec3};
use proptest::prelude::*;

type V = [f64; 3];

/// A world that is stepped the obvious way.
struct Slow {
    sim: Sim,
    pairs: BTreeMap<(usize, usize), V>,
    touches: BTreeMap<(usize, usize), V>,
}

fn react(law: &AnyLaw, contact: &Contact<f64>, spring: V, dt: f64) -> Reaction<f64> {
    match law {
        AnyLaw::HertzHistory(law) => law.react(contact, spring, dt),
        AnyLaw::HertzTsuji(law) => law.react(contact, spring, dt),
    }
}

impl Slow {
    fn heavy(&self, i: usize) -> bool {
        self.sim.groups[self.sim.group[i] as usize].heavy
    }

    fn inverse_mass(&self, i: usize) -> f64 {
        if self.heavy(i) {
            0.0
        } else {
            1.0 / self.sim.velocity[i][3]
        }
    }

    fn forces(&mut self, dt: f64) {
        let n = self.sim.count();
        let (mut force, mut torque) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
        for k in 0..self.sim.obstacles.len() {
            self.sim.obstacles[k].force = [0.0; 3];
            self.sim.obstacles[k].torque = [0.0; 3];
        }
        for i in 0..n {
            for k in 0..self.sim.obstacles.len() {
                let body = self.sim.obstacles[k];
                if self.heavy(i) && body.inverse_mass == 0.0 {
                    continue;
                }
                let Some((contact, offset)) = self.on_obstacle(i, k) else {
                    self.touches.remove(&(i, k));
                    continue;
                };
                let spring = self.touches.get(&(i, k)).copied().unwrap_or([0.0; 3]);
                let r = react(&self.sim.law, &contact, spring, dt);
                self.touches.insert((i, k), r.spring);
                let push = vec3::add(vec3::scale(contact.normal, r.normal), r.tangential);
                let couple = vec3::cross(contact.normal, r.tangential);
                force[i] = vec3::add(force[i], push);
                torque[i] = vec3::sub(torque[i], vec3::scale(couple, r.arm_i));
                let body = &mut self.sim.obstacles[k];
                body.force = vec3::sub(body.force, push);
                let moment = match body.shape {
                    Shape::Sphere { .. } => vec3::scale(couple, r.arm_j),
                    _ => {
                        let lever = vec3::sub(offset, vec3::scale(contact.normal, r.arm_i));
                        vec3::cross(lever, push)
                    }
                };
                body.torque = vec3::sub(body.torque, moment);
            }
        }
        for i in 0..n {
            for j in i + 1..n {
                if self.heavy(i) && self.heavy(j) {
                    continue;
                }
                let Some(contact) = self.of_two(i, j) else {
                    self.pairs.remove(&(i, j));
                    continue;
                };
                let spring = self.pairs.get(&(i, j)).copied().unwrap_or([0.0; 3]);
                let r = react(&self.sim.law, &contact, spring, dt);
                self.pairs.insert((i, j), r.spring);
                let push = vec3::add(vec3::scale(contact.normal, r.normal), r.tangential);
                let couple = vec3::cross(contact.normal, r.tangential);
                force[i] = vec3::add(force[i], push);
                force[j] = vec3::sub(force[j], push);
                torque[i] = vec3::sub(torque[i], vec3::scale(couple, r.arm_i));
                torque[j] = vec3::sub(torque[j], vec3::scale(couple, r.arm_j));
            }
        }
        for i in 0..n {
            self.sim.force[i] = [force[i][0], force[i][1], force[i][2], 0.0];
            self.sim.torque[i] = [torque[i][0], torque[i][1], torque[i][2], 0.0];
        }
    }

    fn of_two(&self, i: usize, j: usize) -> Option<Contact<f64>> {
        let s = &self.sim;
        let d = s
            .domain
            .separation(head(s.position[i]), head(s.position[j]));
        let distance = vec3::dot(d, d).sqrt();
        let (ri, rj) = (s.position[i][3], s.position[j][3]);
        let overlap = (ri + rj) - distance;
        (overlap > 0.0).then(|| Contact {
            normal: vec3::scale(d, 1.0 / distance),
            overlap,
            radius_i: ri,
            radius_j: rj,
            radius_effective: (ri * rj) / (ri + rj),
            mass_effective: 1.0 / (self.inverse_mass(i) + self.inverse_mass(j)),
            velocity: vec3::sub(head(s.velocity[i]), head(s.velocity[j])),
            spin_i: head(s.spin[i]),
            spin_j: head(s.spin[j]),
        })
    }

    fn on_obstacle(&self, i: usize, k: usize) -> Option<(Contact<f64>, V)> {
        let s = &self.sim;
        let (body, radius) = (&s.obstacles[k], s.position[i][3]);
        let (normal, offset, overlap, curve) = match body.shape {
            Shape::Plane { normal } => {
                let offset = vec3::sub(head(s.position[i]), body.point);
                (normal, offset, radius - vec3::dot(offset, normal), 0.0)
            }
            Shape::Sphere { radius: own } => {
                let d = s.domain.separation(head(s.position[i]), body.point);
                let distance = vec3::dot(d, d).sqrt();
                (d.map(|x| x / distance), d, (radius + own) - distance, own)
            }
            Shape::Cylinder { axis, radius: own } => {
                let d = s.domain.separation(head(s.position[i]), body.point);
                let across = vec3::sub(d, vec3::scale(axis, vec3::dot(d, axis)));
                let distance = vec3::dot(across, across).sqrt();
                (
                    across.map(|x| x / distance),
                    d,
                    (radius + own) - distance,
                    0.0,
                )
            }
        };
        let contact = Contact {
            normal,
            overlap,
            radius_i: radius,
            radius_j: curve,
            radius_effective: if curve > 0.0 {
                (radius * curve) / (radius + curve)
            } else {
                radius
            },
            mass_effective: 1.0 / (self.inverse_mass(i) + body.inverse_mass),
            velocity: vec3::sub(head(s.velocity[i]), body.velocity),
            spin_i: head(s.spin[i]),
            spin_j: [0.0; 3],
        };
        (overlap > 0.0).then_some((contact, offset))
    }

    fn kick(&mut self) {
        let half = self.sim.dt * 0.5;
        for i in 0..self.sim.count() {
            let group = self.sim.groups[self.sim.group[i] as usize];
            let (radius, per_mass) = (self.sim.position[i][3], 1.0 / self.sim.velocity[i][3]);
            let per_inertia = per_mass / ((radius * radius) * 0.4);
            for a in 0..3 {
                if group.integrates[a] {
                    let pull = self.sim.force[i][a] * per_mass + group.gravity[a];
                    self.sim.velocity[i][a] += pull * half;
                }
                if group.spins {
                    self.sim.spin[i][a] += (self.sim.torque[i][a] * per_inertia) * half;
                }
            }
        }
    }

    fn step(&mut self) {
        self.kick();
        let dt = self.sim.dt;
        let domain = self.sim.domain;
        for body in &mut self.sim.obstacles {
            for a in 0..3 {
                body.point[a] += body.velocity[a] * dt;
            }
            domain.wrap(&mut body.point, &mut body.image);
        }
        for i in 0..self.sim.count() {
            let mut to = head(self.sim.position[i]);
            for a in 0..3 {
                to[a] += self.sim.velocity[i][a] * dt;
            }
            domain.wrap(&mut to, &mut self.sim.image[i]);
            self.sim.position[i][..3].copy_from_slice(&to);
        }
        self.forces(dt);
        self.kick();
    }
}

/// A crowd in a small periodic box over a floor, with a driven ball, a bar and every kind of group.
fn crowd(seed: &[f64], law: AnyLaw, tsuji: bool) -> Sim {
    let scale: f64 = if tsuji { 1.5e-3 } else { 1.0 };
    let density = if tsuji { 2500.0 } else { 1.0 };
    let dt = if tsuji { 1e-5 } else { 1e-4 };
    let side = 5.0 * scale;
    let domain = Domain::new(
        [0.0, 0.0, -scale],
        [side, side, 40.0 * scale],
        [true, true, false],
    )
    .unwrap();
    let mut grains = Vec::new();
    for (k, u) in seed.as_chunks::<5>().0.iter().enumerate() {
        let site = [k % 4, k / 4 % 4, k / 16].map(|c| c as f64);
        let group = [0, 0, 1, 0, 2, 0, 0, 3][k % 8];
        let speed = 2.0 * scale.sqrt();
        let velocity = match group {
            1 => [0.0; 3],
            2 => [0.3 * scale, 0.0, 0.0],
            _ => [u[0] - 0.5, u[1] - 0.5, u[2] - 1.0].map(|v| v * speed),
        };
        let spin = if group == 0 {
            [u[3], u[4], u[0]].map(|w| 4.0 * w)
        } else {
            [0.0; 3]
        };
        grains.push(Grain {
            // Ids ascend but are not consecutive.
            id: 3 * k as u32 + 2,
            group,
            diameter: (0.9 + 0.2 * u[3]) * scale,
            density,
            position: [
                (1.25 * site[0] + 0.4 * u[0] + 0.2) * scale,
                (1.25 * site[1] + 0.4 * u[1] + 0.2) * scale,
                (1.05 * site[2] + 0.1 * u[2] + 0.55) * scale,
            ],
            velocity,
            spin,
        });
    }
    let g: f64 = if tsuji { 9.81 } else { 1.0 };
    let down = [0.0, 0.0, -g];
    let groups = vec![
        Group::free(down),
        Group::frozen(),
        Group::carried(),
        Group::lid([0.0, 0.0, -2.0 * g]),
    ];
    let top = 1.05 * (seed.len() / 80) as f64 * scale + 2.2 * scale;
    let obstacles = vec![
        Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]),
        Obstacle {
            velocity: [0.5 * scale.sqrt(), 0.0, -1.5 * scale.sqrt()],
            inverse_mass: 1.0 / sphere_mass(scale, density),
            ..Obstacle::sphere([2.5 * scale, 2.5 * scale, top], 0.6 * scale)
        },
        Obstacle {
            velocity: [0.0, 0.0, -scale.sqrt()],
            ..Obstacle::cylinder([0.5 * scale, 0.0, top], [0.0, 2.0, 0.0], 0.4 * scale)
        },
    ];
    let mut sim = Sim::new(law, domain, dt, groups, &grains, obstacles);
    sim.skin = 0.0;
    sim
}

fn same(fast: &Sim, slow: &Slow, step: u64) -> Result<(), TestCaseError> {
    let bits = |rows: &[[f64; 4]]| -> Vec<[u64; 3]> {
        rows.iter().map(|r| head(*r).map(f64::to_bits)).collect()
    };
    let s = &slow.sim;
    let parts = [
        ("position", &fast.position, &s.position),
        ("velocity", &fast.velocity, &s.velocity),
        ("spin", &fast.spin, &s.spin),
        ("force", &fast.force, &s.force),
        ("torque", &fast.torque, &s.torque),
    ];
    for (name, a, b) in parts {
        prop_assert_eq!(bits(a), bits(b), "{} at step {}", name, step);
    }
    prop_assert_eq!(&fast.image, &s.image, "crossings at step {}", step);
    for (a, b) in fast.obstacles.iter().zip(&s.obstacles) {
        let words = |o: &Obstacle<f64>| [o.point, o.force, o.torque].map(|v| v.map(f64::to_bits));
        prop_assert_eq!(words(a), words(b), "step {}", step);
    }
    Ok(())
}

fn follow(seed: &[f64], law: AnyLaw, tsuji: bool, skin: f64) -> Result<(), TestCaseError> {
    let mut fast = crowd(seed, law, tsuji);
    fast.skin = skin * if tsuji { 1.5e-3 } else { 1.0 };
    let mut slow = Slow {
        sim: fast.clone(),
        pairs: BTreeMap::new(),
        touches: BTreeMap::new(),
    };
    if fast.start().is_err() {
        // Too deep from the start: not a world to step.
        return Ok(());
    }
    slow.forces(0.0);
    same(&fast, &slow, 0)?;
    let mut contacts = 0;
    for step in 1..=400 {
        if fast.steps(1).is_err() {
            // A carried body drove into another: compared up to here.
            prop_assert!(step > 50, "stopped at step {}", step);
            break;
        }
        slow.step();
        same(&fast, &slow, step)?;
        contacts += fast.bonds().len();
    }
    prop_assert!(contacts > 0, "nothing ever touched");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 24,
        max_shrink_iters: 100,
        failure_persistence: None,
        ..Default::default()
    })]

    #[test]
    fn the_step_equals_its_definition_hertz_history(
        seed in prop::collection::vec(0.0..1.0f64, 5 * 64),
        skin in 0.0..0.6f64,
        mu in prop::sample::select(vec![0.0, 0.3, 0.9]),
    ) {
        let law = HertzHistory { kn: 2e5, kt: 2.45e5, gamma_n: 792.0, gamma_t: 792.0, mu };
        follow(&seed, AnyLaw::HertzHistory(law), false, skin)?;
    }

    #[test]
    fn the_step_equals_its_definition_hertz_tsuji(
        seed in prop::collection::vec(0.0..1.0f64, 5 * 48),
        skin in 0.0..0.6f64,
    ) {
        let law = HertzTsuji::new(5e6, 0.45, 0.6, 0.5);
        follow(&seed, AnyLaw::HertzTsuji(law), true, skin)?;
    }
}
