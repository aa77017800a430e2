//! How an intruder is set going, and what is measured of one that forces move.

use bitgrain_kernel::{Error as KernelError, FreeMotion, Motion as Body, Obstacle, Shape};

use crate::scenario::{DragPlan, Release};
use crate::series::BodyRow;
use crate::summary::Released;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::observe::INTRUDER;
use bitgrain_sim::simulation::{Role, Simulation};

/// Gap between a sphere that is dropped and the first grain it will touch, in mean diameters: a step's way at any
/// speed that the time step allows.
const GAP: f64 = 0.1;

/// Kinetic energy over weight times the mean diameter below which an intruder counts as at rest: a speed of 0.014
/// sqrt(g d), that of a fall through a ten-thousandth of d.
const REST: f64 = 1e-4;

/// Sets the intruder in motion, or base, lid and planes, all at once; `surface` is the height of the free surface.
///
/// # Errors
/// What the kernel refuses: a speed that cannot be resolved.
pub(super) fn set_off(
    sim: &mut Simulation,
    plan: &DragPlan,
    surface: f64,
) -> Result<(), KernelError> {
    let histories = sim.contact_histories();
    let intruder = sim.obstacles[INTRUDER as usize];
    let along_x = [plan.motion.speed, 0.0, 0.0];
    match plan.release {
        Release::Dragged => carry(sim, plan.motion.moves, along_x),
        Release::Floating { .. } => {
            sim.obstacles[INTRUDER as usize] = Obstacle {
                velocity: along_x,
                ..freed(intruder, plan, [false, false, true])
            };
        }
        Release::Pulled { force, rises, .. } => {
            let mut body = freed(intruder, plan, [true, false, rises]);
            if let Body::Free(free) = &mut body.motion {
                free.force = [force, 0.0, 0.0];
            }
            sim.obstacles[INTRUDER as usize] = body;
        }
        Release::Dropped { height } => {
            let radius = intruder.reach();
            let d = plan.motion.grain_diameter;
            let z = first_contact(sim, &intruder, surface) + GAP * d;
            let fallen = height - (z - radius - surface);
            let fallen = if fallen > 0.0 { fallen } else { 0.0 };
            let [x, y, _] = intruder.point;
            sim.obstacles[INTRUDER as usize] = Obstacle {
                point: [x, y, z],
                velocity: [0.0, 0.0, -(2.0 * plan.gravity * fallen).sqrt()],
                ..freed(intruder, plan, [true; 3])
            };
        }
    }
    // Resumed, so that the list of pairs takes the motion into account, and a speed that cannot be
    // resolved is refused.
    sim.resume(&histories)
}

/// Sets the intruder in motion, or what carries the bed. A bar turns, its ends at this speed.
fn carry(sim: &mut Simulation, moves: Moves, velocity: [f64; 3]) {
    if moves == Moves::Intruder {
        let body = &mut sim.obstacles[INTRUDER as usize];
        match body.shape {
            Shape::FiniteCylinder { half_length, .. } => {
                body.angular_velocity = [0.0, 0.0, velocity[0] / half_length];
            }
            _ => body.velocity = velocity,
        }
        return;
    }
    for i in 0..sim.count() {
        if sim.role(i) != Role::Free {
            sim.velocity[i][0] = velocity[0];
        }
    }
    for body in &mut sim.obstacles[INTRUDER as usize + 1..] {
        body.velocity = velocity;
    }
}

/// The intruder as a body that answers forces along these axes, and torques if the plan says so.
fn freed(body: Obstacle<f64>, plan: &DragPlan, integrates: [bool; 3]) -> Obstacle<f64> {
    // A ball has moments of inertia.
    let inertia = body.own_inertia().unwrap_or([1.0; 3]);
    Obstacle {
        motion: Body::Free(FreeMotion {
            integrates,
            spins: plan.release.spins(),
            ..FreeMotion::new(inertia, [0.0, 0.0, -plan.gravity])
        }),
        ..body
    }
}

/// Height of the centre of a ball that comes straight down as it first touches a grain; at the surface, if it touches
/// none.
fn first_contact(sim: &Simulation, ball: &Obstacle<f64>, surface: f64) -> f64 {
    let mut first = surface + ball.reach();
    let mut touches = false;
    for x in &sim.position {
        let off = sim.domain.separation([x[0], x[1], x[2]], ball.point);
        let (reach, across) = (ball.reach() + x[3], off[0] * off[0] + off[1] * off[1]);
        if across >= reach * reach {
            continue;
        }
        let z = x[2] + (reach * reach - across).sqrt();
        if !touches || z > first {
            (first, touches) = (z, true);
        }
    }
    first
}

/// The centre of the intruder; the periods of the box that it crossed count.
fn place(sim: &Simulation, body: &Obstacle<f64>) -> [f64; 3] {
    let (lo, hi, periodic) = (sim.domain.lo(), sim.domain.hi(), sim.domain.periodic());
    let along = |a: usize| match periodic[a] {
        true => body.point[a] + f64::from(body.image[a]) * (hi[a] - lo[a]),
        false => body.point[a],
    };
    [along(0), along(1), along(2)]
}

/// What is known of an intruder that was just set going; `None` if no force moves it.
pub(super) fn begin(sim: &Simulation, plan: &DragPlan, surface: f64) -> Option<Released> {
    let body = &sim.obstacles[INTRUDER as usize];
    let begin = place(sim, body);
    plan.release.is_free().then(|| Released {
        mass: 1.0 / body.inverse_mass,
        surface,
        begin,
        begin_velocity: body.velocity,
        window_begin: begin,
        end: begin,
        end_velocity: body.velocity,
        lowest: begin[2],
        highest: begin[2],
        rest: None,
    })
}

/// At a row of the series, in the order of the steps: adds to what is known of it, and returns what the row says, and
/// its travel.
pub(super) fn follow(
    known: &mut Released,
    sim: &Simulation,
    plan: &DragPlan,
    step: u64,
) -> (BodyRow, f64) {
    let body = &sim.obstacles[INTRUDER as usize];
    let place = place(sim, body);
    if step < plan.motion.window[0] {
        known.window_begin = place;
    }
    (known.end, known.end_velocity) = (place, body.velocity);
    if place[2] < known.lowest {
        known.lowest = place[2];
    }
    if place[2] > known.highest {
        known.highest = place[2];
    }
    let square: f64 = body.velocity.iter().map(|v| v * v).sum();
    let rests = 0.5 * square < REST * plan.gravity * plan.motion.grain_diameter;
    let time = step as f64 * sim.dt;
    known.rest = rests.then(|| known.rest.unwrap_or(time));
    let travel = match plan.release {
        Release::Dropped { .. } => known.begin[2] - place[2],
        _ => place[0] - known.begin[0],
    };
    let row = BodyRow {
        place,
        velocity: body.velocity,
        spin: body.angular_velocity,
    };
    (row, travel)
}
