//! A contact law of one's own that pulls: Johnson, Kendall and Roberts (1971), with the rules of LAMMPS' `jkr`.
//!
//! It uses all that a law can have: it acts on grains that have touched until the neck between them breaks, so it acts
//! at a distance and keeps a word of each contact. A chain of three grains hangs from a frozen one and is pulled harder
//! and harder; the program prints what it bore before the uppermost contact broke.
//!
//! ```sh
//! cargo run --release -p bitgrain-kernel --example cohesion
//! ```

use bitgrain_kernel::contact::{
    Law, NormalForce, NormalState, TangentialForce, TangentialState, Torque, TurningState,
};
use bitgrain_kernel::vec3::{add, dot, scale, sub};
use bitgrain_kernel::{Domain, Error, Group, Store, start, step_with};

const PI: f64 = core::f64::consts::PI;

/// Steps of Newton's method: from the bounds below they end within rounding.
const NEWTON: usize = 12;

/// `F = (4/3) E a^3/R - 2 pi a^2 sqrt(4 w E/(pi a)) - eta v` with the neck of radius `a` in
/// `delta = a^2/R - 2 sqrt(pi w a/E)`. Contacts begin as the surfaces touch, and end where the force is least,
/// `-3 pi w R`.
#[derive(Clone, Copy, Debug)]
pub struct Jkr {
    /// Effective Young's modulus of the pair, `E/(2 (1 - nu^2))` (pressure).
    young: f64,
    /// `8 G` with the effective shear modulus (pressure).
    shear: f64,
    /// Half the work of adhesion (energy / area).
    energy: f64,
    /// `eta = alpha sqrt(m k)` with `k = (4/3) E a`.
    alpha: f64,
    /// Tangential damping over the normal one.
    tangential: f64,
    /// Friction coefficient.
    mu: f64,
    /// Largest effective radius (length).
    largest: f64,
    /// `sqrt(pi w/E)`, and a bound of the roots that are searched for, made at set-up.
    c: f64,
    bound: f64,
}

impl Jkr {
    /// Of grains with Young's modulus `young` (pressure, positive) and Poisson's ratio `poisson`, half the work of
    /// adhesion `energy` (energy / area, positive), damping `alpha`, tangential over normal damping, friction `mu`, and
    /// grains of radius `radius` (length) at most.
    pub fn new(
        [young, poisson]: [f64; 2],
        energy: f64,
        damping: [f64; 2],
        mu: f64,
        radius: f64,
    ) -> Self {
        let young_effective = young / (2.0 * (1.0 - poisson * poisson));
        let c = (PI * energy / young_effective).sqrt();
        // Of a grain on a wall.
        let largest = radius;
        Self {
            young: young_effective,
            shear: 8.0 * young / (4.0 * (2.0 - poisson) * (1.0 + poisson)),
            energy,
            alpha: damping[0],
            tangential: damping[1],
            mu,
            largest,
            c,
            // From far away each of Newton's steps takes a third.
            bound: cube_root(2.0 * c * largest, 1.0 + 2.0 * c * largest, 200),
        }
    }

    /// The root of the neck at which a contact of this effective radius ends: `x^3 = 1.5 c R`.
    fn last_root(&self, radius: f64) -> f64 {
        cube_root(1.5 * self.c * radius, self.bound, NEWTON)
    }

    /// The overlap at which it ends (length), below zero.
    fn last_overlap(&self, radius: f64) -> f64 {
        let x = self.last_root(radius);
        (x * x) * (x * x) / radius - 2.0 * self.c * x
    }

    /// The neck's radius: the larger root of `x^4/R - 2 c x = delta`, squared. Newton's method comes
    /// down to it from a larger one.
    fn neck(&self, radius: f64, overlap: f64) -> f64 {
        let pressed = if overlap > 0.0 { overlap } else { 0.0 };
        let mut x = (radius * pressed).sqrt().sqrt() + self.bound;
        for _ in 0..NEWTON {
            let square = x * x;
            let value = square * square / radius - 2.0 * self.c * x - overlap;
            x = x - value / (4.0 * (square * x) / radius - 2.0 * self.c);
        }
        x * x
    }

    /// Elastic force between two bodies with this neck.
    fn elastic(&self, radius: f64, neck: f64) -> f64 {
        let square = neck * neck;
        let pull = 2.0 * PI * square * (4.0 * self.energy * self.young / (PI * neck)).sqrt();
        4.0 / 3.0 * self.young * (square * neck) / radius - pull
    }
}

/// The cube root of a positive number by so many of Newton's steps, down from a larger one than the root: with the
/// operations of the bit contract only.
fn cube_root(cube: f64, bound: f64, steps: usize) -> f64 {
    let mut x = bound;
    for _ in 0..steps {
        x = x - (x * x * x - cube) / (3.0 * (x * x));
    }
    x
}

impl Law<f64> for Jkr {
    const MEMORY: usize = 1;
    const ACTS_APART: bool = true;

    fn reach(&self) -> f64 {
        -self.last_overlap(self.largest)
    }

    fn acts(&self, c: &NormalState<f64>) -> bool {
        // The word says that they have touched.
        let holds = c.memory[0] > 0.0 && c.overlap > self.last_overlap(c.radius_effective);
        c.overlap > 0.0 || holds
    }

    fn normal_force(&self, c: &NormalState<f64>) -> NormalForce<f64> {
        let neck = self.neck(c.radius_effective, c.overlap);
        let stiffness = 4.0 / 3.0 * self.young * neck;
        let damping = self.alpha * (c.mass_effective * stiffness).sqrt();
        let short = c.overlap * 0.5;
        NormalForce {
            force: self.elastic(c.radius_effective, neck) - damping * c.speed,
            contact_radius: neck,
            damping: self.tangential * damping,
            lever_arm_i: c.radius_i - short,
            lever_arm_j: c.radius_j - short,
        }
    }

    fn tangential_force(
        &self,
        normal: &NormalForce<f64>,
        state: &TangentialState<f64>,
    ) -> TangentialForce<f64> {
        let (radius, neck) = (state.contact.radius_effective, normal.contact_radius);
        // Friction holds against what presses and twice what pulls at most.
        let load = self.elastic(radius, neck) + 6.0 * PI * self.energy * radius;
        let limit = self.mu * if load < 0.0 { -load } else { load };
        let stiffness = self.shear * neck;
        let damped = scale(state.velocity, normal.damping);
        let trial = add(scale(state.spring, stiffness), damped);
        let size = dot(trial, trial).sqrt();
        let share = if size > limit { limit / size } else { 1.0 };
        let held = scale(trial, share);
        let slid = scale(sub(held, damped), 1.0 / stiffness);
        TangentialForce {
            force: scale(held, -1.0),
            spring: if size > limit { slid } else { state.spring },
        }
    }

    fn torque(&self, _: &NormalForce<f64>, state: &TurningState<f64>) -> Torque<f64> {
        let mut memory = state.contact.memory;
        memory[0] = 1.0;
        Torque {
            torque: [0.0; 3],
            memory,
        }
    }
}

/// Hangs a chain and pulls each of its grains harder until it breaks: the pull on the uppermost contact then, over the
/// most that it can bear, and whether the other contacts hold.
///
/// # Errors
/// What the kernel refuses.
pub fn hang() -> Result<(f64, bool), Error> {
    const RADIUS: f64 = 0.5e-3;
    let law = Jkr::new([5e6, 0.3], 0.05, [0.5, 1.0], 0.5, RADIUS);
    // Room for one word of each contact.
    let mut store = Store::<f64, 4, 16, 4, 2, 1>::new(Domain::open(), 2e-7, 1e-5);
    let hanging = store
        .add_group(Group::free([0.0, 0.0, 0.0]))
        .expect("room for a group");
    let held = store.add_group(Group::frozen()).expect("room for a group");
    let mass = 2500.0 * 4.0 / 3.0 * PI * (RADIUS * RADIUS * RADIUS);
    for k in 0..4u32 {
        let group = if k == 0 { held } else { hanging };
        // Barely in touch.
        let place = [0.0, 0.0, -1.9999 * RADIUS * f64::from(k)];
        store.add_grain(k + 1, group, place, RADIUS, mass)?;
    }
    start(&mut store.world(), &law)?;
    let bears = 3.0 * PI * 0.05 * (RADIUS / 2.0);
    let mut pull = 0.0;
    // A force on each grain besides those of its contacts, which grows slowly.
    for _ in 0..400_000 {
        pull += 2e-6 * bears;
        let weight = [0.0, 0.0, -pull];
        step_with(&mut store.world(), &law, |_| (weight, [0.0; 3]))?;
        let world = store.world();
        let fallen = world.grains.position[1][2];
        if fallen < -2.1 * RADIUS {
            return Ok((3.0 * pull / bears, world.kept_contacts().count() == 2));
        }
    }
    Ok((f64::INFINITY, false))
}

/// # Errors
/// What the kernel refuses.
pub fn main() -> Result<(), Error> {
    let (load, holds) = hang()?;
    println!("the uppermost contact broke at {load:.3} of 3 pi w R; the others hold: {holds}");
    Ok(())
}
