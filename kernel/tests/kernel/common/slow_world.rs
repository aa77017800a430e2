//! A world that follows the written definitions and nothing else: all pairs, one at a time, a map for what laws keep,
//! every sum in the contract's order.

use std::collections::BTreeMap;

use bitgrain_kernel::contact::{Contact, Kept, Law, Materials, react};
use bitgrain_kernel::vec3::{self, head};
use bitgrain_kernel::{Domain, Facet, Group, Obstacle, Row, Shape, World};

use super::slow_bodies::{drift, kick, meet, out, own_offset};
use super::slow_mesh;

type V = [f64; 3];
type Rows = Vec<Row<f64>>;

/// A world that is stepped the obvious way.
pub struct Slow<L> {
    /// The law of each two materials.
    pub laws: fn(Materials) -> L,
    pub domain: Domain<f64>,
    pub dt: f64,
    pub group: Vec<Group<f64>>,
    pub position: Rows,
    pub velocity: Rows,
    pub spin: Rows,
    pub force: Rows,
    pub torque: Rows,
    pub image: Vec<[i32; 3]>,
    pub obstacles: Vec<Obstacle<f64>>,
    pub facets: Vec<Facet<f64>>,
    pub pairs: BTreeMap<(usize, usize), Kept<f64>>,
    pub touches: BTreeMap<(usize, usize, u32), Kept<f64>>,
}

impl<L: Law<f64>> Slow<L> {
    /// What a world holds now, without histories.
    pub fn of(world: &World<'_, f64>, laws: fn(Materials) -> L) -> Self {
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

    pub fn forces(&mut self, dt: f64) {
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

    pub fn step(&mut self) {
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
