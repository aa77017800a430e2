//! The scheme of a step and both contact laws written a second time, in 32 digits and from the papers: velocity Verlet
//! with spin for spheres, walls and balls that move as prescribed. Nothing of the kernel is called.
//!
//! Kumar 2018, eqs. 1 and 2, with the slip rule of LAMMPS; Guillard 2014, eq. A1, with that of LIGGGHTS.

use bitgrain::simulation::AnyLaw;

use crate::extended::{Extended, ZERO};

/// A vector.
pub type Vector = [Extended; 3];

/// A vector of numbers that `f64` holds.
pub fn vector(v: [f64; 3]) -> Vector {
    v.map(Extended::from)
}

fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn times(a: Vector, s: Extended) -> Vector {
    a.map(|x| x * s)
}

fn minus(a: Vector, b: Vector) -> Vector {
    plus(a, b.map(|x| -x))
}

fn inner(a: Vector, b: Vector) -> Extended {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn outer(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A sphere.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    /// Centre.
    pub position: Vector,
    /// Velocity.
    pub velocity: Vector,
    /// Spin.
    pub spin: Vector,
    /// Radius.
    pub radius: Extended,
    /// Mass; `None` if it is infinitely heavy.
    pub mass: Option<Extended>,
    /// Whether forces move it; otherwise it keeps its velocity and spin.
    pub moves: bool,
}

/// What a sphere meets.
#[derive(Clone, Copy, Debug)]
pub enum Partner {
    /// Another of the spheres.
    Sphere(usize),
    /// A resting wall through a point with a unit normal.
    Wall(Vector, Vector),
}

/// Two bodies that may touch, and their tangential spring.
#[derive(Clone, Copy, Debug)]
pub struct Pair {
    /// The sphere.
    pub sphere: usize,
    /// What it meets.
    pub partner: Partner,
    /// The spring.
    pub spring: Vector,
}

/// A world of few bodies.
#[derive(Clone, Debug)]
pub struct World {
    /// Its spheres.
    pub spheres: Vec<Sphere>,
    /// All pairs that may meet.
    pub pairs: Vec<Pair>,
    /// The law.
    pub law: AnyLaw,
    /// Acceleration of gravity.
    pub gravity: Vector,
    /// Time step.
    pub dt: Extended,
    /// Force and torque on each sphere.
    pub loads: Vec<(Vector, Vector)>,
}

/// What both laws are told of a contact.
struct Touch {
    overlap: Extended,
    speed: Extended,
    radius: Extended,
    mass: Extended,
}

impl World {
    /// Forces of a start: springs stay empty.
    pub fn start(&mut self) {
        self.evaluate(ZERO);
    }

    /// A step: half a kick and a drift, forces at the new places with the velocities of the half step, half a kick.
    pub fn step(&mut self) {
        let dt = self.dt;
        self.kick();
        for sphere in &mut self.spheres {
            sphere.position = plus(sphere.position, times(sphere.velocity, dt));
        }
        self.evaluate(dt);
        self.kick();
    }

    fn kick(&mut self) {
        let half = self.dt * 0.5.into();
        for (sphere, (force, torque)) in self.spheres.iter_mut().zip(&self.loads) {
            let (true, Some(mass)) = (sphere.moves, sphere.mass) else {
                continue;
            };
            let pull = plus(times(*force, Extended::from(1.0) / mass), self.gravity);
            // A solid sphere has the moment of inertia 2/5 m r^2; 0.4 is the number that the kernel has for it.
            let inertia = mass * sphere.radius * sphere.radius * 0.4.into();
            sphere.velocity = plus(sphere.velocity, times(pull, half));
            sphere.spin = plus(sphere.spin, times(*torque, half / inertia));
        }
    }

    fn evaluate(&mut self, dt: Extended) {
        self.loads = vec![([ZERO; 3], [ZERO; 3]); self.spheres.len()];
        for k in 0..self.pairs.len() {
            let pair = self.pairs[k];
            let own = self.spheres[pair.sphere];
            let (normal, overlap, other) = match pair.partner {
                Partner::Sphere(j) => {
                    let other = self.spheres[j];
                    let apart = minus(own.position, other.position);
                    let distance = inner(apart, apart).sqrt();
                    let normal = apart.map(|x| x / distance);
                    (normal, own.radius + other.radius - distance, Some(other))
                }
                Partner::Wall(point, normal) => {
                    let height = inner(minus(own.position, point), normal);
                    (normal, own.radius - height, None)
                }
            };
            self.pairs[k].spring = if overlap > ZERO {
                self.push(pair, (normal, overlap), other, dt)
            } else {
                [ZERO; 3]
            };
        }
    }

    /// Adds the loads of a contact, and returns its spring.
    fn push(
        &mut self,
        pair: Pair,
        (normal, overlap): (Vector, Extended),
        other: Option<Sphere>,
        dt: Extended,
    ) -> Vector {
        let own = self.spheres[pair.sphere];
        let one = Extended::from(1.0);
        let inverse = |sphere: &Sphere| sphere.mass.map_or(ZERO, |mass| one / mass);
        let relative = other.map_or(own.velocity, |other| minus(own.velocity, other.velocity));
        let touch = Touch {
            overlap,
            speed: inner(relative, normal),
            radius: other.map_or(own.radius, |j| {
                own.radius * j.radius / (own.radius + j.radius)
            }),
            mass: one / (inverse(&own) + other.as_ref().map_or(ZERO, inverse)),
        };
        // Levers: the radii, less half the overlap under hertz_tsuji.
        let short = match self.law {
            AnyLaw::HertzHistory(_) => ZERO,
            AnyLaw::HertzTsuji(_) => overlap * 0.5.into(),
            _ => panic!("the reference is of one material"),
        };
        let surface = |sphere: &Sphere, side: Extended| {
            let arm = times(normal, side * (sphere.radius - short));
            plus(sphere.velocity, outer(sphere.spin, arm))
        };
        let theirs = other.map_or([ZERO; 3], |other| surface(&other, one));
        let sliding = minus(surface(&own, -one), theirs);
        let sliding = minus(sliding, times(normal, inner(sliding, normal)));
        let grown = plus(pair.spring, times(sliding, dt));
        let spring = minus(grown, times(normal, inner(grown, normal)));
        let is_new = inner(grown, grown) == ZERO;
        let (force, friction, spring) = match self.law {
            AnyLaw::HertzHistory(_) => self.history(&touch, sliding, spring, is_new),
            AnyLaw::HertzTsuji(_) => self.tsuji(&touch, sliding, spring),
            _ => panic!("the reference is of one material"),
        };
        let whole = plus(times(normal, force), friction);
        let turn = outer(normal, friction);
        let load = &mut self.loads[pair.sphere];
        load.0 = plus(load.0, whole);
        load.1 = minus(load.1, times(turn, own.radius - short));
        if let (Partner::Sphere(j), Some(other)) = (pair.partner, other) {
            let load = &mut self.loads[j];
            load.0 = minus(load.0, whole);
            load.1 = minus(load.1, times(turn, other.radius - short));
        }
        spring
    }

    /// Kumar 2018, eqs. 1 and 2: normal force, tangential force and spring.
    fn history(
        &self,
        touch: &Touch,
        sliding: Vector,
        spring: Vector,
        is_new: bool,
    ) -> (Extended, Vector, Vector) {
        let AnyLaw::HertzHistory(law) = self.law else {
            panic!("it is this law");
        };
        let [kn, kt, gamma_n, gamma_t, mu] =
            [law.kn, law.kt, law.gamma_n, law.gamma_t, law.mu].map(Extended::from);
        let root = (touch.radius * touch.overlap).sqrt();
        let force = root * (kn * touch.overlap - touch.mass * gamma_n * touch.speed);
        let damper = times(sliding, touch.mass * gamma_t);
        let both = plus(times(spring, kt), damper);
        let size = root * inner(both, both).sqrt();
        let limit = mu * force.abs();
        if size <= limit {
            return (force, times(both, -root), spring);
        }
        // Spring and damper together are held to the limit; the spring is what then belongs to the damper.
        if is_new {
            return (force, [ZERO; 3], spring);
        }
        let held = times(both, limit / size);
        let left = minus(held, damper).map(|x| x / kt);
        (force, times(held, -root), left)
    }

    /// Guillard 2014, eq. A1: normal force, tangential force and spring.
    fn tsuji(&self, touch: &Touch, sliding: Vector, spring: Vector) -> (Extended, Vector, Vector) {
        let AnyLaw::HertzTsuji(law) = self.law else {
            panic!("it is this law");
        };
        let [kn, kt, cn, ct, mu] = [law.kn, law.kt, law.cn, law.ct, law.mu].map(Extended::from);
        let root = (touch.radius * touch.overlap).sqrt();
        let damp = (touch.mass * root).sqrt();
        let force = kn * root * touch.overlap - cn * damp * touch.speed;
        let stiffness = kt * root;
        let size = stiffness * inner(spring, spring).sqrt();
        let limit = mu * force.abs();
        if size <= limit {
            let both = plus(times(spring, stiffness), times(sliding, ct * damp));
            return (force, both.map(|x| -x), spring);
        }
        // The spring alone is held to the limit, and a contact that slides has no damper.
        let left = times(spring, limit / size);
        (force, times(left, -stiffness), left)
    }
}
