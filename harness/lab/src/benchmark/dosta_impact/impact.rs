//! The impact itself: the world, the way of the ball, and what is told of it.

use bitgrain_kernel::{Group, Obstacle};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::format::short;
use bitgrain_sim::simulation::{Simulation, hex};
use bitgrain_sim::table::{Cell, Table, column};

use super::setup::{
    ABOVE, BALL, DT, FLOOR, HALF, M1_NUMBER, STEEL, STEEL_NUMBER, STEPS, VELOCITY, bounds, grains,
    law, ordered, walls,
};
use crate::benchmark::request::Request;
use crate::benchmark::result::{Chart, Check, Curve, Source, Test};
use crate::performance::{StagePerformance, timed};

/// Time between two rows, and between two looks whether the ball is near a wall (s).
const ROW: f64 = 1e-3;
const GLANCE: f64 = 1e-4;

/// Number of the ball among the obstacles.
const BALL_NUMBER: usize = 5;

/// The ball at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Row {
    time: f64,
    height: f64,
    speed: f64,
    place: [f64; 2],
    velocity: [f64; 2],
    force: f64,
}

const ROWS: Table<Row> = Table(&[
    column("time", |r| Cell::Real(&mut r.time)),
    column("z", |r| Cell::Real(&mut r.height)),
    column("vz", |r| Cell::Real(&mut r.speed)),
    column("x", |r| Cell::Real(&mut r.place[0])),
    column("y", |r| Cell::Real(&mut r.place[1])),
    column("vx", |r| Cell::Real(&mut r.velocity[0])),
    column("vy", |r| Cell::Real(&mut r.velocity[1])),
    column("fz", |r| Cell::Real(&mut r.force)),
]);

const UNITS: &str =
    "centre of the ball; time s; x, y, z m; velocities m/s; force of the grains fz N";

/// The way of the ball.
pub(super) struct Course {
    gravity: f64,
    grains: usize,
    rows: Vec<Row>,
    /// The first row at which the ball touches a grain.
    met: usize,
    /// Digest of the last state.
    digest: String,
    pub performance: StagePerformance,
}

/// Grains at rest, and the ball on its way.
fn world(places: &[[f64; 3]], gravity: f64) -> Result<Simulation> {
    let down = [0.0, 0.0, -gravity];
    let ball = Obstacle::sphere(ABOVE, 0.5 * BALL).free(STEEL, down);
    let ball = Obstacle {
        velocity: VELOCITY,
        material: STEEL_NUMBER,
        ..ball.expect("a ball has a volume")
    };
    let mut obstacles = walls();
    debug_assert_eq!(obstacles.len(), BALL_NUMBER);
    obstacles.push(ball);
    let group = Group::free(down).of_material(M1_NUMBER);
    let grains = grains(&ordered(places));
    let law = law(1.0, None)?;
    Ok(Simulation::new(
        law,
        bounds(),
        DT,
        vec![group],
        &grains,
        obstacles,
    ))
}

impl Course {
    /// Follows the ball.
    pub fn follow(
        places: &[[f64; 3]],
        gravity: f64,
        until: f64,
        request: &Request,
    ) -> Result<Self> {
        let name = format!("g = {gravity}");
        let mut sim = world(places, gravity)?;
        sim.start().map_err(|fault| Error::run(&name, 0, fault))?;
        let steps = |time: f64| (time * STEPS).round() as u64;
        let (row, glance, last) = (steps(ROW), steps(GLANCE), steps(until));
        let stage = request.progress.stage(&name, last);
        let (mut rows, mut met) = (vec![Row::of(&sim)], None);
        while sim.step_count() < last {
            let step = sim.step_count();
            sim.steps(glance.min(last - step))
                .map_err(|fault| Error::run(&name, sim.step_count() + 1, fault))?;
            if gap(&sim.obstacles[BALL_NUMBER]) <= 0.0 {
                let problem = "the ball came to the floor or to a wall, and bodies do not push each other: take a \
                               deeper bed (--grains) or a shorter time (--until)";
                return Err(Error::input(&name, problem));
            }
            if met.is_none() && sim.touch_count(BALL_NUMBER as u32) > 0 {
                met = Some(rows.len());
            }
            let step = sim.step_count();
            if step.is_multiple_of(row) || step == last {
                rows.push(Row::of(&sim));
                let message = format!(
                    "the ball at z = {:.4} m",
                    sim.obstacles[BALL_NUMBER].point[2]
                );
                stage.at(step, sim.count(), &message)?;
            }
        }
        let digest = sim
            .digest()
            .map_err(|fault| Error::run(&name, last, fault))?;
        let performance = timed(stage, "followed", &sim, last);
        Ok(Self {
            gravity,
            grains: sim.count(),
            met: met.unwrap_or(rows.len()),
            rows,
            digest: hex(&digest.whole),
            performance,
        })
    }

    /// What is told of it.
    pub fn test(&self, number: u32, from: &str) -> Test {
        let g = self.gravity;
        let setup = format!(
            "A steel ball of 20 mm falls at 5 m/s on {} grains of 2 mm, {from}, that rest in a steel box of 98 by 60 \
             mm; g = {g} m/s^2, dt = {} µs.",
            self.grains,
            short(1e6 * DT)
        );
        let title = "A steel ball hits a bed";
        let mut test = Test::new(number, title, &setup);
        let lowest = self
            .rows
            .iter()
            .min_by(|a, b| a.height.total_cmp(&b.height));
        let (lowest, last) = (
            lowest.copied().unwrap_or_default(),
            self.rows[self.rows.len() - 1],
        );
        test.outcome = format!(
            "g = {g}: lowest at z = {} m after {} ms, {} mm over the floor; at {} ms z = {} m and v = {} m/s; \
             digest {}",
            short(lowest.height),
            short(1e3 * lowest.time),
            short(1e3 * (lowest.height - 0.5 * BALL - FLOOR)),
            short(1e3 * last.time),
            short(last.height),
            short(last.speed),
            &self.digest[..16],
        );
        test.table = ROWS.text(UNITS, &self.rows);
        let fall = |t: f64| ABOVE[2] + VELOCITY[2] * t - 0.5 * g * t * t;
        let speed = |t: f64| VELOCITY[2] - g * t;
        let chart = |what: &str, of: fn(&Row) -> f64, theory: &dyn Fn(f64) -> f64| {
            let computed = self.rows.iter().map(|r| (1e3 * r.time, of(r)));
            let falling = self
                .rows
                .iter()
                .take(self.met)
                .map(|r| (1e3 * r.time, theory(r.time)));
            Chart {
                title: format!("g = {g} m/s^2"),
                labels: ["time (ms)".into(), what.into()],
                curves: vec![
                    Curve {
                        source: Source::Computed,
                        points: computed.collect(),
                    },
                    Curve {
                        source: Source::Theory,
                        points: falling.collect(),
                    },
                ],
            }
        };
        let charts = [
            chart("height of the ball (m)", |r| r.height, &fall),
            chart("its speed upwards (m/s)", |r| r.speed, &speed),
            chart("force of the grains on it (N)", |r| r.force, &|_| 0.0),
        ];
        let falling = || self.rows.iter().take(self.met).skip(1);
        let steel = format!("steel, g = {g}");
        // Rounding of 40,000 steps, over a height that passes through zero.
        let checks = [
            Check::worst(
                &*steel,
                "height in free fall",
                1e-9,
                falling().map(|r| (fall(r.time), r.height)),
            ),
            Check::worst(
                &*steel,
                "speed in free fall",
                1e-9,
                falling().map(|r| (speed(r.time), r.speed)),
            ),
        ];
        test.add(charts.map(|chart| (chart, Vec::new())), checks);
        test
    }
}

impl Row {
    fn of(sim: &Simulation) -> Self {
        let ball = &sim.obstacles[BALL_NUMBER];
        let ([x, y, z], [u, v, w]) = (ball.point, ball.velocity);
        Self {
            time: sim.step_count() as f64 / STEPS,
            height: z,
            speed: w,
            place: [x, y],
            velocity: [u, v],
            force: ball.force[2],
        }
    }
}

/// The least distance of the ball's surface from floor and walls.
fn gap(ball: &Obstacle<f64>) -> f64 {
    let [x, y, z] = ball.point;
    let gaps = [z - FLOOR, HALF[0] - x.abs(), HALF[1] - y.abs()];
    gaps.into_iter().fold(f64::INFINITY, f64::min) - 0.5 * BALL
}
