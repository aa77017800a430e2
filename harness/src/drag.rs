//! Dragging: the intruder moves at constant speed through a settled bed, and the force on it is
//! summed at every step.

use crate::error::{Error, Result};
use crate::observe::{BlockSums, INTRUDER};
use crate::progress::Stage;
use crate::scenario::RunPlan;
use crate::series::SeriesRow;
use crate::sim::Sim;
use crate::summary::Mean;

/// Steps between updates of the progress bar; no result depends on it.
const SHOW: u64 = 200;

/// Means over the averaging window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Means {
    /// Force against the motion.
    pub drag: Mean,
    /// Upward force.
    pub lift: Mean,
    /// Force along y.
    pub side: Mean,
    /// Grains that touch the intruder.
    pub contacts: Mean,
    /// Drag over all steps.
    pub drag_uncut: f64,
    /// Steps in the window.
    pub window_steps: u64,
}

/// Sums of one window of steps.
#[derive(Clone, Copy, Default)]
struct Sums {
    force: [f64; 3],
    steps: u64,
}

impl Sums {
    fn add(&mut self, force: [f64; 3]) {
        for a in 0..3 {
            self.force[a] += force[a];
        }
        self.steps += 1;
    }

    fn mean(&self) -> [f64; 3] {
        self.force.map(|f| f / self.steps as f64)
    }
}

/// Drags the intruder of a settled bed as `plan` says; a row of the series every `every` steps.
///
/// The speed is taken on at once, with the contacts of the settled bed in place. On an error `series`
/// holds the rows measured before it.
///
/// # Errors
/// [`Error::Run`] where a step goes wrong.
pub fn drag(
    sim: &mut Sim,
    plan: &RunPlan,
    every: u64,
    stage: &Stage,
    series: &mut Vec<SeriesRow>,
) -> Result<Means> {
    sim.obstacles[INTRUDER as usize].velocity = [plan.speed, 0.0, 0.0];
    let dt = sim.dt;
    let travel = |n: u64| n as f64 * dt * plan.speed;
    let first = plan.first_averaged(dt);
    let window = plan.steps + 1 - first;
    let mut sums: [BlockSums; 4] = std::array::from_fn(|_| BlockSums::new(window));
    let (mut since_row, mut all) = (Sums::default(), Sums::default());
    for n in 1..=plan.steps {
        sim.steps(1)
            .map_err(|fault| Error::run(&plan.name, n, fault))?;
        let body = &sim.obstacles[INTRUDER as usize];
        // Drag against the motion (a difference, so that no force is +0), lift up, side along y.
        let force = [0.0 - body.force[0], body.force[2], body.force[1]];
        let torque = body.torque;
        since_row.add(force);
        all.add(force);
        let row = n % every == 0 || n == plan.steps;
        let counted = n >= first;
        let contacts = if row || counted {
            sim.touch_count(INTRUDER)
        } else {
            0
        };
        if counted {
            for a in 0..3 {
                sums[a].add(force[a]);
            }
            sums[3].add(f64::from(contacts));
        }
        if row {
            series.push(SeriesRow {
                step: n,
                time: n as f64 * dt,
                distance: travel(n),
                force,
                force_mean: since_row.mean(),
                torque,
                contacts,
            });
            since_row = Sums::default();
        }
        if n % SHOW == 0 {
            stage.at(
                n,
                format!("drag so far {}", crate::report::short(all.mean()[0])),
            );
        }
    }
    Ok(Means {
        drag: sums[0].mean(),
        lift: sums[1].mean(),
        side: sums[2].mean(),
        contacts: sums[3].mean(),
        drag_uncut: all.mean()[0],
        window_steps: window,
    })
}
