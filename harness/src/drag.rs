//! Dragging: the intruder moves at constant speed through a settled bed, and the force on it is
//! summed at every step.

use bitgrain_kernel::Pushed;

use crate::blocks::{BlockSums, Mean};
use crate::error::{Error, Result};
use crate::histogram::{Angles, Coordination};
use crate::observe::{self, INTRUDER};
use crate::progress::Stage;
use crate::scenario::{History, RunPlan, Scenario};
use crate::series::SeriesRow;
use crate::sim::Sim;

/// Steps between updates of the progress bar; no result depends on it.
const SHOW: u64 = 200;

/// Grains whose centres lie within so many mean diameters of the intruder's surface are its
/// neighbourhood (Kumar 2018, Fig. 7).
pub const NEAR: f64 = 2.0;

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
    /// Contact angle, over all contacts of the samples.
    pub contact_angle: Option<Mean>,
    /// Contacts of a grain near the intruder, over all such grains of the samples.
    pub coordination: Option<Mean>,
    /// Drag over all steps.
    pub drag_uncut: f64,
    /// Steps in the window.
    pub window_steps: u64,
}

/// What a drag leaves behind besides its means, filled as it goes.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// Rows of the force series.
    pub series: Vec<SeriesRow>,
    /// Contact angles of the window's samples.
    pub angles: Angles,
    /// Coordination numbers near the intruder of the window's samples.
    pub coordination: Coordination,
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

/// All that is measured on the way.
#[derive(Default)]
struct Gauges {
    force: [BlockSums; 3],
    contacts: BlockSums,
    angle: BlockSums,
    coordination: BlockSums,
    since_row: Sums,
    all: Sums,
}

/// Drags the intruder of a settled bed as `plan` says. `snapshot` is shown the state and the contacts
/// at the plan's snapshot steps.
///
/// The speed is taken on at once, with the contacts of the settled bed in place, or with empty
/// histories and forces evaluated anew at rest, as the scenario says. On an error `record` holds
/// what was measured before it.
///
/// # Errors
/// [`Error::Run`] where a step goes wrong, [`Error::Interrupted`], and what `snapshot` returns.
pub fn drag(
    sim: &mut Sim,
    scenario: &Scenario,
    plan: &RunPlan,
    stage: &Stage,
    record: &mut Record,
    mut snapshot: impl FnMut(u64, &Sim, &[Pushed<f64>]) -> Result<()>,
) -> Result<Means> {
    let wrong = |n: u64| move |fault| Error::run(&plan.name, n, fault);
    if scenario.drag.history == History::Empty {
        sim.start().map_err(wrong(0))?;
    }
    sim.obstacles[INTRUDER as usize].velocity = [plan.speed, 0.0, 0.0];
    let every = scenario.measure.every;
    let first = plan.first_averaged(sim.dt);
    let mut gauges = Gauges::default();
    let mut seen = Vec::new();
    for n in 1..=plan.steps {
        // They ascend, and there may be thousands.
        if plan.snapshots.binary_search(&n).is_ok() {
            seen.clear();
            sim.step_watched(|contact| seen.push(contact))
                .map_err(wrong(n))?;
            snapshot(n, sim, &seen)?;
        } else {
            sim.steps(1).map_err(wrong(n))?;
        }
        let row = n % every == 0 || n == plan.steps;
        gauges.read(sim, scenario, plan, n, row, n >= first, record);
        if n % SHOW == 0 {
            let drag = crate::report::short(gauges.all.mean()[0]);
            stage.at(n, sim.count(), &format!("drag so far {drag}"))?;
        }
    }
    gauges
        .means(plan.steps + 1 - first)
        .ok_or_else(|| Error::input(&plan.name, "has too few steps to average"))
}

impl Gauges {
    /// Takes the readings of step `n`, which may end a row of the series or lie in the window.
    #[expect(
        clippy::too_many_arguments,
        reason = "one call, beside the loop it is part of"
    )]
    fn read(
        &mut self,
        sim: &mut Sim,
        scenario: &Scenario,
        plan: &RunPlan,
        n: u64,
        row: bool,
        counted: bool,
        record: &mut Record,
    ) {
        let body = &sim.obstacles[INTRUDER as usize];
        // Drag against the motion (a difference, so that no force is +0), lift up, side along y.
        let force = [0.0 - body.force[0], body.force[2], body.force[1]];
        let torque = body.torque;
        self.since_row.add(force);
        self.all.add(force);
        if !row && !counted {
            return;
        }
        let contacts = sim.touch_count(INTRUDER);
        if counted {
            for a in 0..3 {
                self.force[a].add(force[a]);
            }
            self.contacts.add(f64::from(contacts));
        }
        if !row {
            return;
        }
        let (angles, near) = observe::neighbourhood(sim, NEAR * scenario.mean_diameter());
        let (angle, coordination) = (mean(&angles), mean(&near));
        if counted {
            // Every contact and every grain counts alike, in whichever sample.
            angles.iter().for_each(|x| self.angle.add(*x));
            near.iter().for_each(|x| self.coordination.add(*x));
            record.angles.add(&angles);
            record.coordination.add(&near);
        }
        record.series.push(SeriesRow {
            step: n,
            time: n as f64 * sim.dt,
            distance: n as f64 * sim.dt * plan.speed,
            force,
            force_mean: self.since_row.mean(),
            torque,
            contacts,
            angle,
            coordination,
        });
        self.since_row = Sums::default();
    }

    fn means(&self, window_steps: u64) -> Option<Means> {
        Some(Means {
            drag: self.force[0].mean()?,
            lift: self.force[1].mean()?,
            side: self.force[2].mean()?,
            contacts: self.contacts.mean()?,
            contact_angle: self.angle.mean(),
            coordination: self.coordination.mean(),
            drag_uncut: self.all.mean()[0],
            window_steps,
        })
    }
}

/// The mean in the order given; `None` of nothing.
fn mean(values: &[f64]) -> Option<f64> {
    match values.len() {
        0 => None,
        n => Some(values.iter().sum::<f64>() / n as f64),
    }
}
