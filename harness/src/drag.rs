//! Dragging: the intruder moves at constant speed through a settled bed, or the bed past it, and the
//! force on it is summed at every step.

use bitgrain_kernel::{Fault, Pushed};

use crate::blocks::{BlockSums, Mean};
use crate::error::{Error, Result};
use crate::flow::{FlowGauge, FlowMeans};
use crate::histogram::{Angles, Coordination};
use crate::observe::{self, INTRUDER};
use crate::progress::Stage;
use crate::scenario::{History, Moves, RunPlan, Scenario};
use crate::series::SeriesRow;
use crate::sim::{Role, Sim};

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
    /// How a bed flowed that has a lid, a cylinder in it, or moves.
    pub flow: Option<FlowMeans>,
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
    /// What was measured of a bed that flows.
    pub flow: Option<FlowGauge>,
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
    let surface = observe::surface_height(sim, scenario.mean_diameter());
    set_off(sim, scenario.drag.moves, plan.speed).map_err(wrong(0))?;
    record.flow = scenario
        .flows()
        .then(|| FlowGauge::new(sim, scenario, plan, surface));
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
        let force = force_on_intruder(sim, scenario.drag.moves);
        if let Some(flow) = &mut record.flow {
            flow.read(sim, n, force);
        }
        gauges.read(sim, scenario, plan, n, force, row, n >= first, record);
        if n % SHOW == 0 {
            let drag = crate::report::short(gauges.all.mean()[0]);
            stage.at(n, sim.count(), &format!("drag so far {drag}"))?;
        }
    }
    let short = || Error::input(&plan.name, "has too few steps to average");
    let mut means = gauges.means(plan.steps + 1 - first).ok_or_else(short)?;
    means.flow = record.flow.as_ref().and_then(|flow| flow.means(sim.dt));
    Ok(means)
}

/// Sets the intruder in motion, or base, lid and planes; all at once.
fn set_off(sim: &mut Sim, moves: Moves, speed: f64) -> std::result::Result<(), Fault> {
    let bonds = sim.bonds();
    if moves == Moves::Intruder {
        sim.obstacles[INTRUDER as usize].velocity = [speed, 0.0, 0.0];
    } else {
        for i in 0..sim.count() {
            if sim.role(i) != Role::Free {
                sim.velocity[i][0] = speed;
            }
        }
        for body in &mut sim.obstacles[INTRUDER as usize + 1..] {
            body.velocity = [speed, 0.0, 0.0];
        }
    }
    // Taken up anew, so that the list of pairs reckons with the motion, and a speed that cannot be
    // resolved is refused.
    sim.resume(&bonds)
}

/// Drag, along the motion of the bed past the intruder, lift up, and side force along y.
fn force_on_intruder(sim: &Sim, moves: Moves) -> [f64; 3] {
    let [x, y, z] = sim.obstacles[INTRUDER as usize].force;
    match moves {
        // A difference, so that no force is +0.
        Moves::Intruder => [0.0 - x, z, y],
        Moves::Bed => [x, z, y],
    }
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
        force: [f64; 3],
        row: bool,
        counted: bool,
        record: &mut Record,
    ) {
        let torque = sim.obstacles[INTRUDER as usize].torque;
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
        let ahead = scenario.drag.moves.forward();
        let (angles, near) = observe::neighbourhood(sim, NEAR * scenario.mean_diameter(), ahead);
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
            flow: None,
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
