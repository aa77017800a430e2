//! The fast step against a slow one that follows the written definitions and nothing else: all
//! pairs, one at a time, a map for the springs, every sum in the contract's order. They are equal
//! to the bit.

use std::collections::BTreeMap;

use crate::common::cases::cases;
use crate::common::crowd::{DENSE, PER_GRAIN, Packing, REDUCED, SI, Units, crowd, history, tsuji};
use crate::common::slow_bodies::{drift, kick, meet, out, own_offset};
use crate::common::slow_mesh;
use crate::common::sticky::STICKY;
use bitgrain_kernel::contact::{
    Contact, HertzHistory, HertzTsuji, Kept, Law, MEMORY_MAX, Materials, PairLaws, Rolling,
    RollingResistance, RollingSpring, react,
};
use bitgrain_kernel::vec3::{self, head};
use bitgrain_kernel::{
    ContactHistory, Domain, Facet, Group, KeptContact, Obstacle, Row, Shape, World, obstacle_of,
    start, step, surface_of,
};
use proptest::prelude::*;

type V = [f64; 3];
type Rows = Vec<Row<f64>>;

/// Grains that fly and meet now and then.
const LOOSE: Packing = Packing {
    across: 1.25,
    up: 1.05,
    shake: 0.4,
    lift: 0.1,
};

/// A world that is stepped the obvious way.
struct Slow<L> {
    /// The law of each two materials.
    laws: fn(Materials) -> L,
    domain: Domain<f64>,
    dt: f64,
    group: Vec<Group<f64>>,
    position: Rows,
    velocity: Rows,
    spin: Rows,
    force: Rows,
    torque: Rows,
    image: Vec<[i32; 3]>,
    obstacles: Vec<Obstacle<f64>>,
    facets: Vec<Facet<f64>>,
    pairs: BTreeMap<(usize, usize), Kept<f64>>,
    touches: BTreeMap<(usize, usize, u32), Kept<f64>>,
}

impl<L: Law<f64>> Slow<L> {
    /// What a world holds now, without histories.
    fn of(world: &World<'_, f64>, laws: fn(Materials) -> L) -> Self {
        let g = &world.grains;
        Self {
            laws,
            domain: *world.domain,
            dt: world.dt,
            group: g.group.iter().map(|&k| g.groups[k as usize]).collect(),
            position: g.position.to_vec(),
            velocity: g.velocity.to_vec(),
            spin: g.spin.to_vec(),
            force: g.force.to_vec(),
            torque: g.torque.to_vec(),
            image: g.image.to_vec(),
            obstacles: world.obstacles.to_vec(),
            facets: world.facets.to_vec(),
            pairs: BTreeMap::new(),
            touches: BTreeMap::new(),
        }
    }

    fn heavy(&self, i: usize) -> bool {
        self.group[i].infinite_mass
    }

    fn inverse_mass(&self, i: usize) -> f64 {
        if self.heavy(i) {
            0.0
        } else {
            1.0 / self.velocity[i][3]
        }
    }

    fn forces(&mut self, dt: f64) {
        let n = self.position.len();
        let (mut force, mut torque) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n]);
        for k in 0..self.obstacles.len() {
            self.obstacles[k].force = [0.0; 3];
            self.obstacles[k].torque = [0.0; 3];
        }
        for i in 0..n {
            for k in 0..self.obstacles.len() {
                let body = self.obstacles[k];
                if self.heavy(i) && body.inverse_mass == 0.0 {
                    continue;
                }
                if let Shape::Mesh { .. } = body.shape {
                    self.hand_on(i, k);
                }
                for surface in 0..body.shape.surfaces() {
                    self.touch(i, (k, surface), dt, &mut force[i], &mut torque[i]);
                }
            }
        }
        for i in 0..n {
            for j in i + 1..n {
                if self.heavy(i) && self.heavy(j) {
                    continue;
                }
                let contact = self.of_two(i, j);
                let kept = self.pairs.get(&(i, j)).copied();
                let kept = kept.unwrap_or(Kept::NOTHING);
                let law = (self.laws)([self.group[i].material, self.group[j].material]);
                if !contact.acts(&law, kept.memory) {
                    self.pairs.remove(&(i, j));
                    continue;
                }
                let r = react(&law, &contact, kept, dt);
                self.pairs.insert((i, j), r.kept);
                let push = vec3::add(vec3::scale(contact.normal, r.normal), r.tangential);
                let couple = vec3::cross(contact.normal, r.tangential);
                force[i] = vec3::add(force[i], push);
                force[j] = vec3::sub(force[j], push);
                torque[i] = vec3::sub(torque[i], vec3::scale(couple, r.lever_arm_i));
                torque[j] = vec3::sub(torque[j], vec3::scale(couple, r.lever_arm_j));
                if L::TURNS {
                    torque[i] = vec3::add(torque[i], r.torque);
                    torque[j] = vec3::sub(torque[j], r.torque);
                }
            }
        }
        for i in 0..n {
            self.force[i] = [force[i][0], force[i][1], force[i][2], 0.0];
            self.torque[i] = [torque[i][0], torque[i][1], torque[i][2], 0.0];
        }
    }

    /// Gives contacts on triangles that begin the springs that the grain has on others.
    fn hand_on(&mut self, i: usize, k: usize) {
        let had: Vec<usize> = self
            .touches
            .range((i, k, 0)..(i, k + 1, 0))
            .map(|(key, _)| key.2 as usize)
            .collect();
        let (place, radius) = (head(self.position[i]), self.position[i][3]);
        let (_, own) = own_offset(&self.obstacles[k], &self.domain, place);
        for surface in 0..self.facets.len() {
            let (_, overlap, _) = slow_mesh::meet(&self.facets, surface, own, radius);
            if overlap > 0.0 && !had.contains(&surface) {
                let from = slow_mesh::source(&self.facets, surface, &had, own, radius);
                if let Some(from) = from {
                    let spring = self.touches[&(i, k, from as u32)];
                    self.touches.insert((i, k, surface as u32), spring);
                }
            }
        }
    }

    /// A contact on a surface of an obstacle, and what it adds to the force and torque on the grain.
    fn touch(&mut self, i: usize, at: (usize, u32), dt: f64, force: &mut V, torque: &mut V) {
        let key = (i, at.0, at.1);
        let (contact, offset, share) = self.on_obstacle(i, at.0, at.1);
        let kept = self.touches.get(&key).copied().unwrap_or(Kept::NOTHING);
        let law = (self.laws)([self.group[i].material, self.obstacles[at.0].material]);
        if !contact.acts(&law, kept.memory) {
            self.touches.remove(&key);
            return;
        }
        let mut r = react(&law, &contact, kept, dt);
        r.normal *= share;
        r.tangential = vec3::scale(r.tangential, share);
        r.torque = vec3::scale(r.torque, share);
        self.touches.insert(key, r.kept);
        let push = vec3::add(vec3::scale(contact.normal, r.normal), r.tangential);
        let couple = vec3::cross(contact.normal, r.tangential);
        *force = vec3::add(*force, push);
        *torque = vec3::sub(*torque, vec3::scale(couple, r.lever_arm_i));
        let body = &mut self.obstacles[at.0];
        body.force = vec3::sub(body.force, push);
        let mut moment = match body.shape {
            Shape::Sphere { .. } => vec3::scale(couple, r.lever_arm_j),
            _ => {
                let lever = vec3::sub(offset, vec3::scale(contact.normal, r.lever_arm_i));
                vec3::cross(lever, push)
            }
        };
        if L::TURNS {
            *torque = vec3::add(*torque, r.torque);
            moment = vec3::add(moment, r.torque);
        }
        body.torque = vec3::sub(body.torque, moment);
    }

    fn of_two(&self, i: usize, j: usize) -> Contact<f64> {
        let s = self;
        let d = s
            .domain
            .separation(head(s.position[i]), head(s.position[j]));
        let distance = vec3::dot(d, d).sqrt();
        let (ri, rj) = (s.position[i][3], s.position[j][3]);
        let overlap = (ri + rj) - distance;
        Contact {
            normal: vec3::scale(d, 1.0 / distance),
            overlap,
            radius_i: ri,
            radius_j: rj,
            radius_effective: (ri * rj) / (ri + rj),
            mass_effective: 1.0 / (self.inverse_mass(i) + self.inverse_mass(j)),
            inverse_masses: [self.inverse_mass(i), self.inverse_mass(j)],
            materials: [s.group[i].material, s.group[j].material],
            velocity: vec3::sub(head(s.velocity[i]), head(s.velocity[j])),
            spin_i: head(s.spin[i]),
            spin_j: head(s.spin[j]),
            turning_j: head(s.spin[j]),
        }
    }

    fn on_obstacle(&self, i: usize, k: usize, surface: u32) -> (Contact<f64>, V, f64) {
        let s = self;
        let (body, radius) = (&s.obstacles[k], s.position[i][3]);
        let place = head(s.position[i]);
        let mut share = 1.0;
        let (normal, offset, overlap) = match body.shape {
            Shape::Mesh { .. } => {
                let (offset, own) = own_offset(body, &s.domain, place);
                let met = slow_mesh::meet(&s.facets, surface as usize, own, radius);
                share = met.2;
                (out(body.orientation, met.0), offset, met.1)
            }
            _ => meet(body, surface, &s.domain, place, radius),
        };
        let (curve, spin) = match body.shape {
            Shape::Sphere { radius: own } => (own, body.angular_velocity),
            _ => (0.0, [0.0; 3]),
        };
        let turning = curve == 0.0 && body.angular_velocity != [0.0; 3];
        let surface = if turning {
            let there = vec3::sub(offset, vec3::scale(normal, radius - overlap));
            vec3::add(body.velocity, vec3::cross(body.angular_velocity, there))
        } else {
            body.velocity
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
            inverse_masses: [self.inverse_mass(i), body.inverse_mass],
            materials: [s.group[i].material, body.material],
            velocity: vec3::sub(head(s.velocity[i]), surface),
            spin_i: head(s.spin[i]),
            spin_j: spin,
            turning_j: body.angular_velocity,
        };
        (contact, offset, share)
    }

    fn kick(&mut self) {
        let half = self.dt * 0.5;
        for body in &mut self.obstacles {
            kick(body, self.dt);
        }
        for i in 0..self.position.len() {
            let group = self.group[i];
            let (radius, per_mass) = (self.position[i][3], 1.0 / self.velocity[i][3]);
            let per_inertia = per_mass / ((radius * radius) * 0.4);
            for a in 0..3 {
                if group.integrates[a] {
                    let pull = self.force[i][a] * per_mass + group.gravity[a];
                    self.velocity[i][a] += pull * half;
                }
                if group.spins {
                    self.spin[i][a] += (self.torque[i][a] * per_inertia) * half;
                }
            }
        }
    }

    fn step(&mut self) {
        self.kick();
        let dt = self.dt;
        let domain = self.domain;
        for body in &mut self.obstacles {
            drift(body, &domain, dt);
        }
        for i in 0..self.position.len() {
            let mut to = head(self.position[i]);
            for a in 0..3 {
                to[a] += self.velocity[i][a] * dt;
            }
            domain.wrap(&mut to, &mut self.image[i]);
            self.position[i][..3].copy_from_slice(&to);
        }
        self.forces(dt);
        self.kick();
    }
}

fn bits(v: V) -> [u64; 3] {
    v.map(f64::to_bits)
}

fn same<L>(fast: &World<'_, f64>, slow: &Slow<L>, step: u64) -> Result<(), TestCaseError> {
    let all =
        |rows: &[Row<f64>]| -> Vec<[u64; 3]> { rows.iter().map(|r| bits(head(*r))).collect() };
    let g = &fast.grains;
    let parts = [
        ("position", &*g.position, &slow.position),
        ("velocity", &*g.velocity, &slow.velocity),
        ("spin", &*g.spin, &slow.spin),
        ("force", &*g.force, &slow.force),
        ("torque", &*g.torque, &slow.torque),
    ];
    for (name, a, b) in parts {
        prop_assert_eq!(all(a), all(b), "{} at step {}", name, step);
    }
    prop_assert_eq!(&*g.image, &slow.image, "crossings at step {}", step);
    for (a, b) in fast.obstacles.iter().zip(&slow.obstacles) {
        let words = |o: &Obstacle<f64>| {
            [o.point, o.velocity, o.angular_velocity, o.force, o.torque].map(bits)
        };
        let turned = |o: &Obstacle<f64>| o.orientation.map(f64::to_bits);
        prop_assert_eq!(turned(a), turned(b), "orientations at step {}", step);
        prop_assert_eq!(words(a), words(b), "obstacles at step {}", step);
        prop_assert_eq!(a.image, b.image, "crossings at step {}", step);
    }
    let held: Vec<_> = fast.kept_contacts().map(|one| words_of(&one)).collect();
    let pairs = slow.pairs.iter();
    let pairs = pairs.map(|(&(i, j), kept)| (0, i, (j, 0), all_bits(kept)));
    let touches = slow.touches.iter();
    let touches = touches.map(|(&(i, k, surface), kept)| (1, i, (k, surface), all_bits(kept)));
    let kept: Vec<_> = pairs.chain(touches).collect();
    prop_assert_eq!(held, kept, "histories at step {}", step);
    Ok(())
}

/// Of a spring and the words of a law.
type Words = ([u64; 3], [u64; MEMORY_MAX]);

fn all_bits(kept: &Kept<f64>) -> Words {
    (bits(kept.spring), kept.memory.map(f64::to_bits))
}

/// A pair is of kind 0, a contact on an obstacle of kind 1.
fn words_of(contact: &KeptContact<f64>) -> (u8, usize, (usize, u32), Words) {
    let words = all_bits(&contact.kept());
    match contact.history {
        ContactHistory::Pair { i, j, .. } => (0, i as usize, (j as usize, 0), words),
        ContactHistory::Obstacle { i, obstacle, .. } => {
            let on = (obstacle_of(obstacle) as usize, surface_of(obstacle));
            (1, i as usize, on, words)
        }
    }
}

fn follow<L: Law<f64>>(
    seed: &[f64],
    packing: &Packing,
    (law, laws): (impl Law<f64>, fn(Materials) -> L),
    units: &Units,
    skin: f64,
) -> Result<(), TestCaseError> {
    let mut store = crowd(seed, packing, units, skin);
    let mut fast = store.world();
    // Too deep from the start: not a world to step.
    prop_assume!(start(&mut fast, &law).is_ok());
    let mut slow = Slow::of(&fast, laws);
    slow.forces(0.0);
    same(&fast, &slow, 0)?;
    let mut contacts = [0, 0];
    for n in 1..=400 {
        if step(&mut fast, &law).is_err() {
            // A carried body drove into another: compared up to here.
            prop_assume!(n > 50, "stopped at step {}", n);
            break;
        }
        slow.step();
        same(&fast, &slow, n)?;
        contacts[0] += slow.pairs.len();
        contacts[1] += slow.touches.len();
    }
    let [between, on_obstacles] = contacts;
    prop_assume!(between + on_obstacles > 0, "nothing ever touched");
    if *packing == DENSE {
        prop_assume!(between > 0, "no two grains ever touched");
        prop_assume!(on_obstacles > 0, "no obstacle was ever touched");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn the_step_equals_its_definition_hertz_history(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
        mu in prop::sample::select(vec![0, 1, 2]),
    ) {
        let laws: [fn(Materials) -> _; 3] = [|_| history(0.0), |_| history(0.3), |_| history(0.9)];
        let laws = laws[mu];
        follow(&seed, &packing, (laws([0; 2]), laws), &REDUCED, skin)?;
    }

    #[test]
    fn the_step_equals_its_definition_hertz_tsuji(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 48),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
    ) {
        follow(&seed, &packing, (tsuji(), |_| tsuji()), &SI, skin)?;
    }

    #[test]
    fn the_step_equals_its_definition_of_several_materials(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
        is_history in any::<bool>(),
    ) {
        match is_history {
            true => {
                let laws = table(own_history);
                let table = PairLaws::new(3, &laws).unwrap();
                follow(&seed, &packing, (table, own_history), &REDUCED, skin)?;
            }
            false => {
                let laws = table(own_tsuji);
                let table = PairLaws::new(3, &laws).unwrap();
                follow(&seed, &packing, (table, own_tsuji), &SI, skin)?;
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(16))]

    /// Both models of rolling, for each pair of three materials another one.
    #[test]
    fn the_step_equals_its_definition_of_laws_that_resist_rolling(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
        is_history in any::<bool>(),
    ) {
        match is_history {
            true => {
                let laws = table(rolling_history);
                let table = PairLaws::new(3, &laws).unwrap();
                follow(&seed, &packing, (table, rolling_history), &REDUCED, skin)?;
            }
            false => {
                let laws = table(rolling_tsuji);
                let table = PairLaws::new(3, &laws).unwrap();
                follow(&seed, &packing, (table, rolling_tsuji), &SI, skin)?;
            }
        }
    }

    /// A law that acts at a distance, keeps words, sees masses and materials and twists.
    #[test]
    fn the_step_equals_its_definition_of_a_law_that_acts_at_a_distance(
        seed in prop::collection::vec(0.0..1.0f64, PER_GRAIN * 64),
        packing in prop::sample::select(vec![LOOSE, DENSE]),
        skin in 0.0..0.6f64,
    ) {
        follow(&seed, &packing, (STICKY, |_| STICKY), &REDUCED, skin)?;
    }
}

/// A law of two materials that resists rolling.
fn resisting<L: Law<f64>>([a, b]: Materials, law: L, k: f64) -> Rolling<f64, L> {
    let spring = match a == b {
        true => RollingSpring::Sds,
        false => RollingSpring::Epsd2,
    };
    let sum = f64::from(a + b);
    let resistance = RollingResistance {
        spring,
        k: k * (1.0 + sum),
        gamma: 1e-3 * k,
        mu: 0.05 * sum,
    };
    Rolling { law, resistance }
}

fn rolling_history(pair: Materials) -> Rolling<f64, HertzHistory<f64>> {
    resisting(pair, own_history(pair), 1e3)
}

fn rolling_tsuji(pair: Materials) -> Rolling<f64, HertzTsuji<f64>> {
    resisting(pair, own_tsuji(pair), 20.0)
}

/// The laws of three materials, in the order of a table.
fn table<L: Copy>(law: fn(Materials) -> L) -> Vec<L> {
    PairLaws::<L>::pairs(3).map(law).collect()
}

/// Numbers that tell every two materials from all others, in either order.
fn own_history([a, b]: Materials) -> HertzHistory<f64> {
    let [sum, product] = [a + b, a * b].map(f64::from);
    let law = history(0.2 + 0.1 * sum);
    HertzHistory {
        kn: law.kn * (1.0 + 0.2 * sum + 0.05 * product),
        gamma_t: law.gamma_t / (1.0 + product),
        ..law
    }
}

fn own_tsuji([a, b]: Materials) -> HertzTsuji<f64> {
    let of = |m: u8| [5e6 * (1.0 + 0.5 * f64::from(m)), 0.45 - 0.1 * f64::from(m)];
    HertzTsuji::between(
        [of(a), of(b)],
        0.6 - 0.1 * f64::from(a * b),
        0.2 + 0.1 * f64::from(a + b),
    )
}
