//! One impact of a sphere on a flat wall or on another sphere, in the plane of x (along the surface) and y (normal).

use bitgrain_kernel::ContactForce;
use bitgrain_kernel::vec3::dot;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::simulation::Simulation;
use bitgrain_sim::simulation::sphere_mass;

use super::material::Material;
use super::theory::Hertz;
use crate::case::{Case, GrainSpec, MotionSpec, ObstacleSpec};

/// Steps in the duration of the elastic impact: its integration is good to 1e-6 then.
const STEPS: f64 = 2000.0;

/// An impact: the sphere comes down along y on its partner, which it touches as time begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Collision {
    /// Material of the sphere.
    pub material: &'static Material,
    /// Young's modulus of the partner over the sphere's; Poisson's ratio is the same.
    pub stiffness_ratio: f64,
    /// Radius of the sphere, m.
    pub radius: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Friction coefficient.
    pub mu: f64,
    /// Speed at which the sphere comes down, m/s.
    pub approach: f64,
    /// Its speed along x, m/s.
    pub tangential: f64,
    /// Its spin about z, rad/s.
    pub spin: f64,
    /// The sphere that it meets; a wall without one.
    pub partner: Option<Partner>,
}

/// The sphere that is met, which comes up along y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Partner {
    /// Radius, m.
    pub radius: f64,
    /// Density, kg/m^3.
    pub density: f64,
    /// Its speed, m/s.
    pub approach: f64,
    /// Its spin about z, rad/s.
    pub spin: f64,
}

/// Motion of the sphere relative to its partner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    /// Along y, m/s.
    pub normal: f64,
    /// Of the centres along x, m/s.
    pub tangential: f64,
    /// Of the surfaces that meet along x, m/s, with the full radii as levers.
    pub surface: f64,
    /// Spin of the sphere itself about z, rad/s.
    pub spin: f64,
}

/// The contact at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    /// Since the bodies met, s.
    pub time: f64,
    /// Overlap, m.
    pub overlap: f64,
    /// Normal force, N; negative if it pulls.
    pub force: f64,
    /// Size of the tangential force, N.
    pub friction: f64,
}

/// What became of an impact.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    /// As they met.
    pub before: Motion,
    /// As they parted.
    pub after: Motion,
    /// Every step of the contact.
    pub samples: Vec<Sample>,
    /// How long they touched, s.
    pub duration: f64,
}

impl Collision {
    /// What meets: effective radius and mass, relative normal speed, stiffness `(4/3) E* sqrt(R)` with
    /// `1/E* = (1 - nu^2) (1/E_1 + 1/E_2)`.
    pub fn hertz(&self) -> Hertz {
        let own = sphere_mass(2.0 * self.radius, self.material.density);
        let (radius, mass, speed) = match self.partner {
            None => (self.radius, own, self.approach),
            Some(p) => {
                let other = sphere_mass(2.0 * p.radius, p.density);
                let radius = self.radius * p.radius / (self.radius + p.radius);
                (
                    radius,
                    own * other / (own + other),
                    self.approach + p.approach,
                )
            }
        };
        let Material { young, poisson, .. } = *self.material;
        let softness = (1.0 - poisson * poisson) / young * (1.0 + 1.0 / self.stiffness_ratio);
        Hertz {
            stiffness: 4.0 / 3.0 / softness * libm::sqrt(radius),
            mass,
            speed,
        }
    }

    /// The two bodies as they meet; the point where they do is the origin.
    fn case(&self, dt: f64) -> Case {
        let sphere = |id, radius: f64, density, side: f64, velocity, spin| GrainSpec {
            id,
            diameter: 2.0 * radius,
            density,
            position: [0.0, side * radius, 0.0],
            velocity,
            spin: [0.0, 0.0, spin],
            motion: MotionSpec::Free,
            material: None,
        };
        let down = [self.tangential, -self.approach, 0.0];
        let density = self.material.density;
        let mut grains = vec![sphere(1, self.radius, density, 1.0, down, self.spin)];
        let mut obstacles = Vec::new();
        match self.partner {
            None => obstacles.push(ObstacleSpec::plane([0.0; 3], [0.0, 1.0, 0.0])),
            Some(p) => {
                let up = [0.0, p.approach, 0.0];
                grains.push(sphere(2, p.radius, p.density, -1.0, up, p.spin));
            }
        }
        Case {
            law: self
                .material
                .law(self.stiffness_ratio, self.restitution, self.mu)
                .into(),
            bounds: None,
            gravity: [0.0; 3],
            dt,
            obstacles,
            grains,
        }
    }

    fn motion(&self, sim: &Simulation) -> Motion {
        let (v, spin) = (sim.velocity[0], sim.spin[0][2]);
        let (u, turn) = match self.partner {
            None => ([0.0; 4], 0.0),
            Some(p) => (sim.velocity[1], p.radius * sim.spin[1][2]),
        };
        Motion {
            normal: v[1] - u[1],
            tangential: v[0] - u[0],
            surface: (v[0] + self.radius * spin) - (u[0] - turn),
            spin,
        }
    }

    /// Less than nothing once the bodies are apart.
    fn overlap(&self, sim: &Simulation) -> f64 {
        let x = sim.position[0];
        match self.partner {
            None => x[3] - x[1],
            Some(_) => {
                let y = sim.position[1];
                let d = [x[0] - y[0], x[1] - y[1]];
                x[3] + y[3] - libm::sqrt(d[0] * d[0] + d[1] * d[1])
            }
        }
    }

    /// Runs the impact until the bodies part.
    ///
    /// # Errors
    /// [`Error::Run`] if a step fails, [`Error::Input`] if they do not part in ten times the elastic duration.
    pub fn run(&self) -> Result<Outcome> {
        let name = format!("an impact of {}", self.material.name);
        let dt = self.hertz().course().duration() / STEPS;
        let mut sim = self.case(dt).start(&name, |_| {})?;
        let before = self.motion(&sim);
        let mut samples: Vec<Sample> = Vec::new();
        loop {
            let mut seen: Option<ContactForce<f64>> = None;
            let step = sim.step_count() + 1;
            sim.step_watched(|contact| seen = Some(contact))
                .map_err(|fault| Error::run(&name, step, fault))?;
            let Some(contact) = seen else { break };
            let friction = contact.tangential_force;
            samples.push(Sample {
                time: step as f64 * dt,
                overlap: contact.overlap,
                force: contact.normal_force,
                friction: libm::sqrt(dot(friction, friction)),
            });
            if step as f64 > 10.0 * STEPS {
                return Err(Error::input(
                    name,
                    "does not end: the bodies stay in contact",
                ));
            }
        }
        // They parted between the last two steps.
        let (last, gap) = (samples.last().copied(), self.overlap(&sim));
        let duration = last.map_or(0.0, |s| s.time + dt * s.overlap / (s.overlap - gap));
        let after = self.motion(&sim);
        Ok(Outcome {
            before,
            after,
            samples,
            duration,
        })
    }
}

impl Outcome {
    /// The largest of this number over the contact.
    pub fn largest(&self, of: fn(&Sample) -> f64) -> f64 {
        let numbers = self.samples.iter().map(of);
        numbers.fold(0.0, |a, b| if b > a { b } else { a })
    }

    /// Whether friction is at its limit at every step, to rounding, or beyond it: the law holds the spring to the
    /// limit, and adds a damper while the spring is below it.
    pub fn slides(&self, mu: f64) -> bool {
        let limit = |s: &Sample| mu * s.force.abs();
        mu > 0.0
            && self
                .samples
                .iter()
                .all(|s| s.friction.abs() >= limit(s) * (1.0 - 1e-9))
    }
}
