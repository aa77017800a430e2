//! The times that a step must resolve: how long waves take through a grain, and how long two bodies collide. All of it
//! is for set-up, or for a look between two steps; nothing here is part of a step.

use core::f64::consts::PI;

use crate::contact::law::Law;
use crate::math::real::{Real, larger, smaller};
use crate::state::grains::material_of;
use crate::state::motion::Motion;
use crate::world::World;

/// Longest time step as a fraction of the Rayleigh time. Beyond a fifth, grains that are hit from
/// several sides at once gain energy from the integrator.
pub const RAYLEIGH_FRACTION_MAX: f64 = 0.2;

/// Longest time step as a fraction of the duration of a collision. At a tenth the coefficient of
/// restitution is off by at most 0.005 under `hertz_history` as Kumar 2018 has it and by 0.022 under
/// `hertz_tsuji` at 0.6, wherever in a step bodies meet, and an elastic collision gains half a percent
/// of its energy; at a sixth these are 0.027, 0.058 and two percent.
pub const CONTACT_FRACTION_MAX: f64 = 0.1;

/// Duration of a Hertz collision times the speed, over the deepest overlap: twice the integral of
/// `1/sqrt(1 - x^(5/2))` from 0 to 1 (Landau and Lifshitz, Theory of Elasticity, section 9).
const HERTZ_DURATION: f64 = 2.943_275;

/// Shear modulus (pressure) and Poisson's ratio of the material whose contacts with itself have these normal and
/// tangential stiffnesses (pressure): Kumar 2018, eq. 3, solved for both. Of stiffnesses that no material has, the
/// stiffer of both counts, and a ratio from 0 to 0.5.
#[must_use]
pub fn moduli(kn: f64, kt: f64) -> (f64, f64) {
    // kt/kn = 3 (1 - nu) / (2 - nu); a ratio above 3/2, which no nu >= 0 gives, counts as nu = 0.
    let ratio = kt / kn;
    let exact = (3.0 - 2.0 * ratio) / (3.0 - ratio);
    let held = larger(smaller(exact, 0.5), 0.0);
    let poisson = if ratio >= 1.5 { 0.0 } else { held };
    let (normal, tangential) = (0.75 * (1.0 - poisson) * kn, 0.25 * (2.0 - poisson) * kt);
    (larger(normal, tangential), poisson)
}

/// Rayleigh time of a grain of this radius (length) and density (mass / length^3): `pi r sqrt(rho / G) / (0.1631 nu +
/// 0.8766)`, with the shear modulus (pressure) and Poisson's ratio of its material.
#[must_use]
pub fn rayleigh_time((shear, poisson): (f64, f64), radius: f64, density: f64) -> f64 {
    let wave = 0.1631 * poisson + 0.8766;
    PI * radius * Real::sqrt(density / shear) / wave
}

/// Deepest overlap (length) and duration of a collision without damping, of two bodies with this effective radius and
/// effective mass that meet at this speed, by the normal stiffness `kn` (pressure): `(5 m v^2 / (4 K_n
/// sqrt(R)))^(2/5)`, and 2.943 times that over the speed (Landau and Lifshitz, Theory of Elasticity, section 9). Two
/// equal grains have half the radius and half the mass of one; a grain on a floor has its own.
#[must_use]
pub fn collision(kn: f64, radius: f64, mass: f64, speed: f64) -> (f64, f64) {
    let stiffness = kn * Real::sqrt(radius);
    let deepest = libm::pow(1.25 * mass * speed * speed / stiffness, 0.4);
    (deepest, HERTZ_DURATION * deepest / speed)
}

/// The shortest times of a world; infinite if it has none of the kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortestTimes {
    /// Rayleigh time of the grain, or the free body, with the shortest one.
    pub rayleigh: f64,
    /// Duration of the collision of the two bodies with the shortest one, at the largest difference of the velocities
    /// of any two bodies.
    pub collision: f64,
}

impl ShortestTimes {
    /// A time step over the Rayleigh time, and over the duration of the collision.
    #[must_use]
    pub fn fractions(&self, dt: f64) -> [f64; 2] {
        [dt / self.rayleigh, dt / self.collision]
    }

    /// Whether a time step is at most [`RAYLEIGH_FRACTION_MAX`] and [`CONTACT_FRACTION_MAX`] of these times.
    #[must_use]
    pub fn are_resolved_by(&self, dt: f64) -> bool {
        let [rayleigh, collision] = self.fractions(dt);
        rayleigh <= RAYLEIGH_FRACTION_MAX && collision <= CONTACT_FRACTION_MAX
    }
}

/// A ball as a collision sees it.
#[derive(Clone, Copy)]
struct Ball {
    radius: f64,
    mass: f64,
}

impl Ball {
    fn density(self) -> f64 {
        self.mass / (4.0 / 3.0 * PI * self.radius * self.radius * self.radius)
    }

    /// What orders balls of one material by how long they collide.
    fn order(self) -> f64 {
        self.mass * self.mass / self.radius
    }
}

/// The smallest ball of a material, and how many there are.
type Smallest = Option<(Ball, u32)>;

/// The shortest times that a step of a world must resolve, with the stiffnesses that the law says
/// ([`Law::stiffness`]): of the smallest grains of each material, of each pair of materials, of grains on obstacles,
/// and of free bodies, which count as balls of their own mass and least thickness. Any world will do, started or not;
/// it takes a few operations for each grain.
///
/// ```
/// use bitgrain_kernel::contact::HertzTsuji;
/// use bitgrain_kernel::time_step::shortest_times;
/// use bitgrain_kernel::{Domain, Group, Obstacle, Store};
///
/// let mut store = Store::<f64, 1, 4, 1, 1>::new(Domain::open(), 5e-4, 0.1);
/// store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
/// store.add_obstacle(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0])).unwrap();
/// store.add_grain(1, 0, [0.0, 0.0, 1.0], 0.5, 0.5236).unwrap();
/// let times = shortest_times(&store.world(), &HertzTsuji::new(2e4, 0.3, 0.6, 0.5));
/// assert!(times.are_resolved_by(5e-4) && !times.are_resolved_by(5e-3));
/// ```
#[must_use]
pub fn shortest_times<R: Real, L: Law<R>>(world: &World<'_, R>, law: &L) -> ShortestTimes {
    let stiffness = |pair| law.stiffness(pair).map(|both| both.map(R::to_f64));
    let mut rayleigh = f64::INFINITY;
    let mut wave = |ball: Ball, material: u8| {
        if let Some([kn, kt]) = stiffness([material; 2]) {
            let time = rayleigh_time(moduli(kn, kt), ball.radius, ball.density());
            rayleigh = smaller(rayleigh, time);
        }
    };
    let g = &world.grains;
    let mut smallest: [Smallest; 256] = [None; 256];
    for (place, (x, v)) in g.position.iter().zip(g.velocity.iter()).enumerate() {
        let ball = Ball {
            radius: x[3].to_f64(),
            mass: v[3].to_f64(),
        };
        let material = match L::KNOWS_MATERIALS {
            true => material_of((g.group, g.groups), place),
            false => 0,
        };
        wave(ball, material);
        if let Some(entry) = smallest.get_mut(usize::from(material)) {
            let (least, count) = entry.unwrap_or((ball, 0));
            let is_less = ball.order() < least.order();
            *entry = Some((if is_less { ball } else { least }, count.saturating_add(1)));
        }
    }
    for body in world.obstacles.iter() {
        let (inverse, radius) = (body.inverse_mass.to_f64(), body.shape.thinnest().to_f64());
        if matches!(body.motion, Motion::Free(_)) && inverse > 0.0 && radius > 0.0 {
            let mass = 1.0 / inverse;
            let material = if L::KNOWS_MATERIALS { body.material } else { 0 };
            wave(Ball { radius, mass }, material);
        }
    }
    let speed = largest_difference(world);
    ShortestTimes {
        rayleigh,
        collision: match shortest_meeting::<R, L>(world, &smallest, stiffness) {
            Some((kn, ball)) if speed > 0.0 => collision(kn, ball.radius, ball.mass, speed).1,
            _ => f64::INFINITY,
        },
    }
}

/// Normal stiffness, effective radius and effective mass of the meeting that lasts shortest at any speed.
fn shortest_meeting<R: Real, L: Law<R>>(
    world: &World<'_, R>,
    smallest: &[Smallest; 256],
    stiffness: impl Fn([u8; 2]) -> Option<[f64; 2]>,
) -> Option<(f64, Ball)> {
    let mut shortest: Option<(f64, Ball)> = None;
    let mut least = f64::INFINITY;
    let mut note = |pair: [u8; 2], ball: Ball| {
        if let Some([kn, _]) = stiffness(pair) {
            let order = ball.mass / (kn * Real::sqrt(ball.radius));
            if order < least {
                (least, shortest) = (order, Some((kn, ball)));
            }
        }
    };
    let balls = |from: u8| {
        let of = smallest.iter().enumerate().skip(usize::from(from));
        of.filter_map(|(material, entry)| entry.map(|(ball, count)| (material as u8, ball, count)))
    };
    for (a, one, count) in balls(0) {
        for (b, other, _) in balls(a) {
            if a != b || count > 1 {
                let half = |x: f64, y: f64| 1.0 / (1.0 / x + 1.0 / y);
                let radius = half(one.radius, other.radius);
                let mass = half(one.mass, other.mass);
                note([a, b], Ball { radius, mass });
            }
        }
        for body in world.obstacles.iter() {
            let b = if L::KNOWS_MATERIALS { body.material } else { 0 };
            let mass = 1.0 / (1.0 / one.mass + body.inverse_mass.to_f64());
            let radius = one.radius;
            note([a, b], Ball { radius, mass });
        }
    }
    shortest
}

/// Bound of the largest difference of the velocities of two bodies: of the box round all velocities.
fn largest_difference<R: Real>(world: &World<'_, R>) -> f64 {
    let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut note = |velocity: [R; 3], more: f64| {
        for a in 0..3 {
            let v = velocity[a].to_f64();
            lo[a] = smaller(lo[a], v - more);
            hi[a] = larger(hi[a], v + more);
        }
    };
    for [x, y, z, _] in world.grains.velocity.iter() {
        note([*x, *y, *z], 0.0);
    }
    for body in world.obstacles.iter() {
        note(body.velocity, body.swing().to_f64());
    }
    let mut square = 0.0;
    for a in 0..3 {
        let difference = larger(0.0, hi[a] - lo[a]);
        square += difference * difference;
    }
    Real::sqrt(square)
}
