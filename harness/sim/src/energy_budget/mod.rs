//! Where the energy of a simulation goes, step by step.
//!
//! Both laws keep the tangential spring as a displacement (Kumar 2018, eq. 2; Guillard 2014, eq. A1). So
//! a contact that is squeezed at fixed spring stores more energy and one that opens loses some, a spring
//! is cut to the tangent plane as the plane turns, and what a spring holds at separation is lost. These
//! are not losses by friction; an energy budget must count each of them separately.
//!
//! The sums follow velocity Verlet. Kicks lie symmetrically round a full step, so a force evaluated at
//! step n does the work `dt F_n . v_n` with the velocity of the full step: the trapezoidal rule, whose
//! only error in the kinetic energy is `m (a dt)^2/8` at either end. For the tangential spring s of
//! stiffness k, advanced by g over half-step velocities, cut by p as its plane turns and by u as it
//! slides, `s_n = s_(n-1) + g_n - p_n - u_n`, the work against it is an identity at every step,
//!
//! ```text
//! (f_n + f_(n-1))/2 . g_n  =  k_n s_n^2/2 - k_(n-1) s_(n-1)^2/2            stored
//!                            - (k_n - k_(n-1)) s_n . s_(n-1)/2             stiffened
//!                            + (f_n + f_(n-1))/2 . p_n                     turned
//!                            + (f_n + f_(n-1))/2 . u_n                     slid
//! ```
//!
//! with `f = k s`. Sliding is not what the spring's energy falls by, which at v dt comparable with the
//! spring would be wrong in the first order of dt. Under `hertz_history` spring and damper are held to the
//! cap together, and what the damper dissipates then counts as sliding too; if the damper alone is
//! beyond the cap, the law bends the spring against it. A contact that parts has half a step of its spring's
//! force left, `-f . g/2`, and the rest of its stored energy is erased.
//!
//! No term is computed as the remainder: the residual is measured, and is the integrator's error.

mod bodies;
mod contacts;
mod table;

use bitgrain_kernel::vec3::{add, dot, head, scale, sub};
use bitgrain_kernel::{ContactForce, Error as KernelError, KeptContact, Partner, Row};
use serde::{Deserialize, Serialize};

use crate::simulation::Simulation;
use contacts::{ElasticContact, Velocities};
pub use table::{ENERGY, EnergyRow, energy_text};

/// Energies of a state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Energies {
    /// Of all grains and of the bodies that move freely, by velocity and by spin.
    pub kinetic: f64,
    /// Stored in the normal direction of contacts: sum of `(2/5) K_n sqrt(R) delta^(5/2)`.
    pub normal: f64,
    /// Stored in their tangential springs: sum of `K_t sqrt(R delta) s^2/2`.
    pub tangential: f64,
    /// Of all grains in the gravity of their groups, and of free bodies in theirs, from unwrapped positions: zero if
    /// all lie in the origin.
    pub gravitational: f64,
}

impl Energies {
    fn total(&self) -> f64 {
        self.kinetic + self.normal + self.tangential + self.gravitational
    }
}

/// Work done and energy dissipated: as powers at a step, or summed over steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Flows {
    obstacles: f64,
    carriers: f64,
    normal_damping: f64,
    tangential_damping: f64,
    /// By the dampers of contacts that slide, if those are a part of friction.
    sliding: f64,
    /// By the torques of a law that has any; what their springs store is not told apart.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rolling: Option<f64>,
}

/// The energy budget of a simulation: it follows step by step and changes no bit.
///
/// It holds a few numbers only, whatever the size of the bed, and goes on from a saved copy of
/// itself and of the state with the same bits as without saving. Between its steps the simulation may be
/// saved and resumed, but not otherwise changed: no other steps, no other velocities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Audit {
    steps: u64,
    start: Energies,
    now: Energies,
    /// Powers at the present step, whose second half is still to come.
    powers: Flows,
    done: Flows,
    /// By the springs of contacts that slide.
    sliding: f64,
    stiffening: f64,
    projection: f64,
    erased: f64,
    gross: f64,
}

/// A contact before a step.
struct Held {
    at: ElasticContact,
    spring: [f64; 3],
    stiffness: f64,
    /// What its spring will advance by if its plane does not turn.
    advance: [f64; 3],
}

impl Audit {
    /// A budget that begins at this state, started or resumed, between two steps.
    ///
    /// The contact forces of the state are computed from the law with the velocities of the full step, which
    /// is first order in dt for the damping in the first half step alone.
    pub fn new(sim: &mut Simulation) -> Self {
        let histories = sim.contact_histories();
        let mut audit = Self {
            steps: 0,
            start: Energies::default(),
            now: Energies::default(),
            powers: Flows::default(),
            done: Flows::default(),
            sliding: 0.0,
            stiffening: 0.0,
            projection: 0.0,
            erased: 0.0,
            gross: 0.0,
        };
        let motion = full_step(sim);
        let mut energies = of_grains(sim);
        let mut powers = carried(sim);
        for history in histories.iter() {
            let at = ElasticContact::listed(sim, &history.history);
            let spring = history.kept().spring;
            let r = at.forces(sim, &motion, history.kept());
            powers.add_contact(sim, &at, (r.normal, r.tangential, r.torque), spring);
            energies.add_contact(&at, spring);
        }
        (audit.start, audit.now, audit.powers) = (energies, energies, powers);
        audit.gross = energies.kinetic + energies.normal + energies.tangential;
        audit
    }

    /// Advances the simulation by one step and accounts for it.
    ///
    /// # Errors
    /// As [`Simulation::steps`]; a fault is not accounted for.
    pub fn step(&mut self, sim: &mut Simulation) -> Result<(), KernelError> {
        self.step_seen(sim, &mut Vec::new())
    }

    /// [`Audit::step`], adding every touching contact to `seen` as [`Simulation::step_seen`] does.
    ///
    /// # Errors
    /// As [`Audit::step`].
    pub fn step_seen(
        &mut self,
        sim: &mut Simulation,
        seen: &mut Vec<ContactForce<f64>>,
    ) -> Result<(), KernelError> {
        let (velocity, spin) = half_step(sim);
        let obstacles: Vec<_> = sim
            .obstacles
            .iter()
            .map(|body| body.kicked(sim.dt))
            .collect();
        let half = Velocities {
            velocity: &velocity,
            spin: &spin,
            obstacles: &obstacles,
        };
        let held = held(sim, &half);
        // A step shows obstacle contacts before pairs, the list holds pairs before obstacle contacts.
        let first = seen.len();
        sim.step_seen(seen)?;
        let is_touch = |p: &ContactForce<f64>| matches!(p.partner, Partner::Obstacle(_));
        let touches = seen[first..].partition_point(is_touch);
        let (touches, pairs) = seen[first..].split_at(touches);
        let histories = sim.contact_histories();
        debug_assert_eq!(histories.len(), pairs.len() + touches.len());

        let mut now = of_grains(sim);
        let mut powers = carried(sim);
        let mut held = held.iter().peekable();
        for (p, history) in pairs.iter().chain(touches).zip(histories.iter()) {
            let at = ElasticContact::pushed(sim, p);
            let spring = history.kept().spring;
            while let Some(gone) = held.next_if(|h| h.at.key() < at.key()) {
                self.part(gone);
            }
            let before = held.next_if(|h| h.at.key() == at.key());
            let (_, sliding) = at.speeds(&half);
            let advance = scale(sliding, sim.dt);
            self.hold_on(before, &at, (at.stiffness(), spring), advance);
            let forces = (p.normal_force, p.tangential_force, p.torque);
            powers.add_contact(sim, &at, forces, spring);
            now.add_contact(&at, spring);
        }
        held.for_each(|gone| self.part(gone));
        self.book(now, powers, sim.dt);
        Ok(())
    }

    /// Accounts for the spring of a contact that touches after a step; `before` is what it was, if it
    /// touched then too.
    fn hold_on(
        &mut self,
        before: Option<&Held>,
        at: &ElasticContact,
        (stiffness, spring): (f64, [f64; 3]),
        advance: [f64; 3],
    ) {
        let force = scale(spring, stiffness);
        let (mut old, mut old_force) = ([0.0; 3], [0.0; 3]);
        if let Some(held) = before {
            old = held.spring;
            old_force = scale(old, held.stiffness);
            self.stiffening += 0.5 * (stiffness - held.stiffness) * dot(spring, old);
            // The spring's force acted along the old plane, and the law advances the spring along
            // the new one.
            self.projection += 0.5 * dot(old_force, sub(held.advance, advance));
        }
        let mean = scale(add(force, old_force), 0.5);
        let grown = add(old, advance);
        let cut = scale(at.normal, dot(grown, at.normal));
        let slid = sub(sub(grown, cut), spring);
        self.projection += dot(mean, cut);
        self.sliding += dot(mean, slid);
    }

    /// Accounts for the spring of a contact that no longer touches.
    fn part(&mut self, gone: &Held) {
        let force = scale(gone.spring, gone.stiffness);
        self.erased += 0.5 * dot(force, gone.spring) + 0.5 * dot(force, gone.advance);
    }

    /// Accounts for the two half steps between the previous powers and the present ones.
    fn book(&mut self, now: Energies, powers: Flows, dt: f64) {
        let half = 0.5 * dt;
        let over = |a: f64, b: f64| half * a + half * b;
        let (old, done) = (self.powers, &mut self.done);
        let obstacles = over(old.obstacles, powers.obstacles);
        let carriers = over(old.carriers, powers.carriers);
        done.obstacles += obstacles;
        done.carriers += carriers;
        done.normal_damping += over(old.normal_damping, powers.normal_damping);
        done.tangential_damping += over(old.tangential_damping, powers.tangential_damping);
        done.sliding += over(old.sliding, powers.sliding);
        if let Some(power) = powers.rolling {
            let taken = over(old.rolling.unwrap_or_default(), power);
            done.rolling = Some(done.rolling.unwrap_or_default() + taken);
        }
        let fallen = now.gravitational - self.now.gravitational;
        self.gross += obstacles.abs() + carriers.abs() + fallen.abs();
        (self.now, self.powers) = (now, powers);
        self.steps += 1;
    }

    /// Energies of the present state, the gravitational one as it is.
    pub fn energies(&self) -> Energies {
        self.now
    }

    /// The budget at the present step; `step` is the one that its row names.
    pub fn row(&self, step: u64) -> EnergyRow {
        let (now, done) = (&self.now, &self.done);
        let given = done.obstacles + done.carriers + self.stiffening;
        let sliding = self.sliding + done.sliding;
        let mut taken =
            done.normal_damping + done.tangential_damping + sliding + self.projection + self.erased;
        taken += done.rolling.unwrap_or_default();
        EnergyRow {
            step,
            kinetic: now.kinetic,
            normal: now.normal,
            tangential: now.tangential,
            gravitational: now.gravitational - self.start.gravitational,
            obstacles: done.obstacles,
            carriers: done.carriers,
            normal_damping: done.normal_damping,
            tangential_damping: done.tangential_damping,
            sliding,
            stiffening: self.stiffening,
            projection: self.projection,
            erased: self.erased,
            rolling: done.rolling,
            work: self.gross,
            residual: (now.total() - self.start.total()) - (given - taken),
        }
    }

    /// Whether every number is finite; one read from a file may not be.
    pub fn is_finite(&self) -> bool {
        let states = [self.start, self.now].map(|e| e.total());
        let flows = [self.powers, self.done].map(|f| {
            let dampers = f.normal_damping + f.tangential_damping + f.sliding;
            f.obstacles + f.carriers + dampers + f.rolling.unwrap_or_default()
        });
        let others = self.sliding + self.stiffening + self.projection + self.erased + self.gross;
        states.iter().chain(&flows).all(|x| x.is_finite()) && others.is_finite()
    }
}

impl Flows {
    /// Adds the powers of a contact: `N v_n + T . v_s` on both its bodies, of which springs store a part,
    /// and `F . V` of an obstacle on its grain.
    fn add_contact(
        &mut self,
        sim: &Simulation,
        at: &ElasticContact,
        (normal, tangential, torque): (f64, [f64; 3], [f64; 3]),
        spring: [f64; 3],
    ) {
        let motion = full_step(sim);
        if let Some(rolling) = &mut self.rolling {
            let [own, other] = at.turning(&motion);
            *rolling -= dot(torque, sub(own, other));
            if let Partner::Obstacle(_) = at.partner {
                self.obstacles += dot(torque, other);
            }
        }
        let (speed, sliding) = at.speeds(&motion);
        self.normal_damping -= (normal - at.normal_force()) * speed;
        let damped = add(tangential, scale(spring, at.stiffness()));
        if at.damper_slides(normal, tangential) {
            self.sliding -= dot(damped, sliding);
        } else {
            self.tangential_damping -= dot(damped, sliding);
        }
        if let Some(velocity) = at.surface_velocity(&motion) {
            let force = add(scale(at.normal, normal), tangential);
            self.obstacles += dot(force, velocity);
        }
    }
}

impl Energies {
    fn add_contact(&mut self, at: &ElasticContact, spring: [f64; 3]) {
        self.normal += at.normal_energy();
        self.tangential += 0.5 * at.stiffness() * dot(spring, spring);
    }
}

/// The present velocities.
fn full_step(sim: &Simulation) -> Velocities<'_> {
    Velocities {
        velocity: &sim.velocity,
        spin: &sim.spin,
        obstacles: &sim.obstacles,
    }
}

/// Velocities and spins half a step on: those of the coming drift and of the forces after it.
fn half_step(sim: &Simulation) -> (Vec<Row<f64>>, Vec<Row<f64>>) {
    let half = 0.5 * sim.dt;
    let (mut velocity, mut spin) = (sim.velocity.clone(), sim.spin.clone());
    for (i, (v, w)) in velocity.iter_mut().zip(&mut spin).enumerate() {
        let group = &sim.groups[usize::from(sim.group[i])];
        let (mass, radius) = (v[3], sim.position[i][3]);
        let inertia = 0.4 * mass * (radius * radius);
        for a in 0..3 {
            if group.integrates[a] {
                v[a] += (sim.force[i][a] / mass + group.gravity[a]) * half;
            }
            if group.spins {
                w[a] += sim.torque[i][a] / inertia * half;
            }
        }
    }
    (velocity, spin)
}

/// The touching contacts with what their springs hold.
fn held(sim: &mut Simulation, motion: &Velocities) -> Vec<Held> {
    let histories = sim.contact_histories();
    let hold = |history: KeptContact<f64>| {
        let at = ElasticContact::listed(sim, &history.history);
        let (_, sliding) = at.speeds(motion);
        Held {
            spring: history.kept().spring,
            stiffness: at.stiffness(),
            advance: scale(sliding, sim.dt),
            at,
        }
    };
    histories.iter().map(hold).collect()
}

/// Kinetic and gravitational energy.
fn of_grains(sim: &Simulation) -> Energies {
    let mut gravitational = 0.0;
    for (i, x) in sim.position.iter().enumerate() {
        let gravity = sim.groups[usize::from(sim.group[i])].gravity;
        let along = bodies::along(gravity, head(*x), sim.image[i], &sim.domain);
        gravitational -= sim.velocity[i][3] * along;
    }
    let mut kinetic = sim.kinetic_energy();
    for body in &sim.obstacles {
        let (moving, lying) = bodies::energies(body, &sim.domain);
        kinetic += moving;
        gravitational += lying;
    }
    Energies {
        kinetic,
        gravitational,
        ..Energies::default()
    }
}

/// Power of what keeps grains from answering to forces: along every axis that a group does not
/// integrate it takes up contact forces and weight.
fn carried(sim: &Simulation) -> Flows {
    let mut carriers = 0.0;
    for (i, v) in sim.velocity.iter().enumerate() {
        let group = &sim.groups[usize::from(sim.group[i])];
        for a in 0..3 {
            if !group.integrates[a] {
                carriers -= (sim.force[i][a] + v[3] * group.gravity[a]) * v[a];
            }
        }
        if !group.spins {
            carriers -= dot(head(sim.torque[i]), head(sim.spin[i]));
        }
    }
    Flows {
        carriers,
        obstacles: sim.obstacles.iter().map(bodies::power).sum(),
        rolling: (sim.law.words() > 0).then_some(0.0),
        ..Flows::default()
    }
}
