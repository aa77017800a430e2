//! Touching contacts as the audit sees them: where two bodies meet, how they move over each other, and
//! what their springs store.

use bitgrain_kernel::contact::{Contact, Kept, Law, Materials, Reaction, react};
use bitgrain_kernel::vec3::{Vec3, add, cross, dot, head, scale, sub};
use bitgrain_kernel::{
    ContactForce, ContactHistory, Meeting, Obstacle, Partner, Row, Shape, obstacle_of, surface_of,
};

use crate::law::{Springs, Sprung, WithLaw};
use crate::observe::length;
use crate::simulation::Simulation;

/// Where a grain and its partner meet.
#[derive(Clone, Copy)]
pub(super) struct ElasticContact {
    pub i: usize,
    pub partner: Partner,
    /// Which surface of an obstacle.
    surface: u32,
    /// Where the grain meets that surface.
    met: Option<Meeting<f64>>,
    /// Unit vector from the partner to the grain.
    pub normal: Vec3<f64>,
    pub overlap: f64,
    /// `sqrt(R delta)`, and of that the share of the law's force that counts.
    contact_radius: f64,
    radii: [f64; 2],
    radius_effective: f64,
    /// How much of the law's force counts.
    share: f64,
    /// Levers of the tangential force about the grain and its partner.
    arms: [f64; 2],
    materials: Materials,
    /// What its springs store.
    springs: Springs,
}

/// Velocities and spins of all grains at one time, and the obstacles with theirs.
#[derive(Clone, Copy)]
pub(super) struct Velocities<'a> {
    pub velocity: &'a [Row<f64>],
    pub spin: &'a [Row<f64>],
    pub obstacles: &'a [Obstacle<f64>],
}

impl ElasticContact {
    /// The same order for every list: pairs by their places, then obstacle contacts by theirs.
    pub fn key(&self) -> (bool, usize, u32, u32) {
        match self.partner {
            Partner::Grain(j) => (false, self.i, j, 0),
            Partner::Obstacle(k) => (true, self.i, k, self.surface),
        }
    }

    /// A contact, from where its bodies are now.
    fn new(sim: &Simulation, (i, partner, surface): (u32, Partner, u32)) -> Self {
        let i = i as usize;
        let (place, radius) = (head(sim.position[i]), sim.position[i][3]);
        // Where they meet; the partner's radius as a lever, and as it curves.
        let (normal, overlap, other, curvature, met) = match partner {
            Partner::Grain(j) => {
                let y = sim.position[j as usize];
                let d = sim.domain.separation(place, head(y));
                let distance = length(d);
                let overlap = radius + y[3] - distance;
                (scale(d, 1.0 / distance), overlap, y[3], y[3], None)
            }
            Partner::Obstacle(k) => {
                let body = &sim.obstacles[k as usize];
                let met = body.meet(surface, &sim.facets, &sim.domain, place, radius);
                let lever = match body.shape {
                    Shape::Sphere { radius } => radius,
                    _ => 0.0,
                };
                (met.normal, met.overlap, lever, met.curvature, Some(met))
            }
        };
        let radius_effective = if curvature == 0.0 {
            radius
        } else {
            radius * curvature / (radius + curvature)
        };
        let share = met.map_or(1.0, |met| met.share);
        let materials = sim.materials_of(i, partner);
        let springs = sim.law.springs(materials);
        let arm = |radius: f64| radius - springs.short * overlap;
        Self {
            i,
            partner,
            surface,
            met,
            normal,
            overlap,
            contact_radius: (radius_effective * overlap).sqrt() * share,
            radii: [radius, other],
            radius_effective,
            share,
            arms: [arm(radius), arm(other)],
            materials,
            springs,
        }
    }

    /// A contact as a step showed it, after the step.
    pub fn pushed(sim: &Simulation, p: &ContactForce<f64>) -> Self {
        Self::new(sim, (p.i, p.partner, p.surface))
    }

    /// A contact of the list.
    pub fn listed(sim: &Simulation, history: &ContactHistory<f64>) -> Self {
        let who = match *history {
            ContactHistory::Pair { i, j, .. } => (i, Partner::Grain(j), 0),
            ContactHistory::Obstacle { i, obstacle, .. } => {
                let on = Partner::Obstacle(obstacle_of(obstacle));
                (i, on, surface_of(obstacle))
            }
        };
        Self::new(sim, who)
    }

    /// Normal force of the spring alone: `K_n sqrt(R delta) delta` by either law.
    pub fn normal_force(&self) -> f64 {
        self.springs.kn * self.contact_radius * self.overlap
    }

    /// Its energy: `(2/5) K_n sqrt(R) delta^(5/2)`.
    pub fn normal_energy(&self) -> f64 {
        0.4 * self.springs.kn * self.contact_radius * (self.overlap * self.overlap)
    }

    /// Whether a damper of this contact counts as friction, since it is held to the cap with its spring: a part in
    /// 1e9 allows for the rounding of the capped force.
    pub fn damper_slides(&self, normal: f64, tangential: Vec3<f64>) -> bool {
        self.springs
            .joint_cap
            .is_some_and(|mu| length(tangential) >= mu * normal.abs() * (1.0 - 1e-9))
    }

    /// Stiffness of the tangential spring: `K_t sqrt(R delta)` by either law.
    pub fn stiffness(&self) -> f64 {
        self.springs.kt * self.contact_radius
    }

    /// Velocity and spin with which the partner enters the contact.
    fn of_partner(&self, motion: &Velocities) -> (Vec3<f64>, Vec3<f64>) {
        match (self.partner, &self.met) {
            (Partner::Obstacle(k), Some(met)) => {
                motion.obstacles[k as usize].contact_motion(met, self.radii[0])
            }
            (Partner::Grain(j) | Partner::Obstacle(j), _) => {
                let j = j as usize;
                (head(motion.velocity[j]), head(motion.spin[j]))
            }
        }
    }

    /// Spin of the grain, and of its partner as a whole.
    pub fn turning(&self, motion: &Velocities) -> [Vec3<f64>; 2] {
        let other = match self.partner {
            Partner::Grain(j) => head(motion.spin[j as usize]),
            Partner::Obstacle(k) => motion.obstacles[k as usize].angular_velocity,
        };
        [head(motion.spin[self.i]), other]
    }

    /// Velocity of the grain less that of its partner, and what the spins add to the sliding before it
    /// is crossed with the normal.
    fn relative(&self, motion: &Velocities) -> (Vec3<f64>, Vec3<f64>) {
        let (v, w) = (head(motion.velocity[self.i]), head(motion.spin[self.i]));
        let (u, z) = self.of_partner(motion);
        let turn = add(scale(w, self.arms[0]), scale(z, self.arms[1]));
        (sub(v, u), turn)
    }

    /// Velocity of the surface of its obstacle, on which a force of the obstacle works; none of two grains.
    pub fn surface_velocity(&self, motion: &Velocities) -> Option<Vec3<f64>> {
        self.met?;
        let (u, z) = self.of_partner(motion);
        Some(add(u, cross(scale(z, self.arms[1]), self.normal)))
    }

    /// Speed along the normal, and the velocity of the grain's surface over its partner's.
    pub fn speeds(&self, motion: &Velocities) -> (f64, Vec3<f64>) {
        let (velocity, turn) = self.relative(motion);
        let speed = dot(velocity, self.normal);
        let along = sub(velocity, scale(self.normal, speed));
        (speed, add(along, cross(self.normal, turn)))
    }

    /// The forces of a contact whose spring is known, as they were when the state was made: the law's,
    /// with the spring at rest.
    ///
    /// A spring on the cap is longer than the cap by a rounding or not at all; made longer by a part in
    /// 1e9 it slides, as it did.
    pub fn forces(&self, sim: &Simulation, motion: &Velocities, kept: Kept<f64>) -> Reaction<f64> {
        let inverse_mass = match self.partner {
            Partner::Grain(j) => sim.spin[j as usize][3],
            Partner::Obstacle(k) => sim.obstacles[k as usize].inverse_mass,
        };
        let (velocity, _) = self.relative(motion);
        let contact = Contact {
            normal: self.normal,
            overlap: self.overlap,
            radius_i: self.radii[0],
            radius_j: self.radii[1],
            radius_effective: self.radius_effective,
            mass_effective: 1.0 / (sim.spin[self.i][3] + inverse_mass),
            inverse_masses: [sim.spin[self.i][3], inverse_mass],
            materials: self.materials,
            velocity,
            spin_i: head(sim.spin[self.i]),
            spin_j: self.of_partner(motion).1,
            turning_j: self.turning(motion)[1],
        };
        let kept = Kept {
            spring: scale(kept.spring, 1.0 + 1e-9),
            ..kept
        };
        let mut reaction = sim.law.with(React { contact, kept });
        reaction.normal *= self.share;
        reaction.tangential = scale(reaction.tangential, self.share);
        reaction.torque = scale(reaction.torque, self.share);
        reaction
    }
}

/// The force of one contact.
struct React {
    contact: Contact<f64>,
    kept: Kept<f64>,
}

impl WithLaw for React {
    type Output = Reaction<f64>;

    fn run<L: Law<f64> + Sprung>(self, law: &L) -> Reaction<f64> {
        react(law, &self.contact, self.kept, 0.0)
    }
}
