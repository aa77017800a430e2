//! Dragging: the intruder moves at constant speed through a settled bed, or the bed past it, or it is set free; the
//! force on it is summed at every step.
//!
//! A drag goes in stretches of steps, from one that something is due after to the next: a stretch leaves notes of its
//! steps, which are read, and its last state, which is looked at.

mod gauges;
mod release;

use bitgrain_kernel::{ContactForce, Domain, Obstacle, check_arithmetic};
use serde::{Deserialize, Serialize};

use crate::flow::FlowGauge;
use crate::near_field::{NearField, WithinMeans};
use crate::progress::Stage;
use crate::scenario::{DragPlan, History};
use crate::series::SeriesRow;
use crate::summary::Released;
use crate::tank::{TankGauge, force_on_bar};
use bitgrain_sim::chain::Chain;
use bitgrain_sim::checkpoint::StageState;
use bitgrain_sim::coarse_graining::CoarseGraining;
use bitgrain_sim::energy_budget::{Audit, EnergyRow};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::histogram::{Angles, Coordination};
use bitgrain_sim::memory::room;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::notes::{Note, Watch};
use bitgrain_sim::observe::{self, INTRUDER};
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;

use gauges::Gauges;
pub use gauges::Means;
use release::set_off;

/// Steps between updates of the progress bar; no result depends on it.
const SHOW: u64 = 200;

/// Bytes that a point of the fields takes, in memory and twice as a checkpoint is made.
const FIELDS: f64 = 3.0 * 13.0 * 8.0;

/// The results of a drag besides its means, filled as it goes.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DragSeries {
    /// Rows of the force series.
    pub series: Vec<SeriesRow>,
    /// Contact angles of the window's samples.
    pub angles: Angles,
    /// Coordination numbers near the intruder of the window's samples.
    pub coordination: Coordination,
    /// What was measured of a bed that flows.
    pub flow: Option<FlowGauge>,
    /// What was measured of a bar in a tank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tank: Option<TankGauge>,
    /// The energy budget, if it was asked for.
    pub energy: Vec<EnergyRow>,
    /// Deepest overlap of grains with each other and with the intruder at any row (length).
    pub deepest: f64,
}

/// An unfinished drag: all that one step hands to the next besides the state itself.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dragging {
    /// Which run of which scenario this is: `Scenario::key`.
    pub key: String,
    /// Steps done.
    pub step: u64,
    /// Digests of its states.
    pub chain: Chain,
    /// What was measured so far.
    pub record: DragSeries,
    gauges: Gauges,
    around: NearField,
    /// What is known of an intruder that forces move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    released: Option<Released>,
    audit: Option<Audit>,
    /// Sums of the fields, if they were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fields: Option<CoarseGraining>,
    /// Frames of the checkpoint that it was read from, which no file holds yet.
    #[serde(skip)]
    pub frames: String,
}

impl Dragging {
    /// Sets the intruder of a settled bed in motion, or free, or the bed in motion, as `plan` says; `link` is the last
    /// one of the bed's chain.
    ///
    /// The speed is taken on at once, with the contacts of the settled bed in place, or with empty
    /// histories and forces recomputed at rest, as the scenario says.
    ///
    /// # Errors
    /// [`Error::Run`] if the kernel refuses the motion.
    pub fn begin(sim: &mut Simulation, plan: &DragPlan, link: &str) -> Result<Self> {
        let points = plan.fields.map_or(0, |fields| fields.grid.points());
        room(
            FIELDS * points as f64,
            &format!("the fields of {}", plan.name),
        )?;
        let wrong = |fault| Error::run(&plan.name, 0, fault);
        if plan.history == History::Empty {
            sim.start().map_err(wrong)?;
        }
        let surface = observe::surface_height(sim, plan.motion.grain_diameter);
        set_off(sim, plan, surface).map_err(wrong)?;
        let flow = plan
            .flows
            .then(|| FlowGauge::new(sim, &plan.motion, surface));
        let mut chain = Chain::new(link.to_string(), plan.digest_every);
        chain.add(0, &sim.digest().map_err(wrong)?);
        Ok(Self {
            key: plan.key.clone(),
            step: 0,
            chain,
            record: DragSeries {
                flow,
                tank: plan
                    .half_turn
                    .map(|half| TankGauge::new(&plan.motion, half, plan.every)),
                ..DragSeries::default()
            },
            gauges: Gauges::default(),
            around: NearField::new(&plan.reaches),
            released: release::begin(sim, plan, surface),
            audit: plan.energy.then(|| Audit::new(sim)),
            fields: plan
                .fields
                .map(|fields| CoarseGraining::new(&fields, &plan.motion)),
            frames: String::new(),
        })
    }

    /// Goes on to the end of the drag, or as far as `observer` wants to see.
    ///
    /// On an error this holds what was measured before it; after [`Error::Interrupted`] it belongs to the
    /// state, and the drag can go on from both.
    ///
    /// # Errors
    /// [`Error::Run`] if a step fails, [`Error::Interrupted`], and what `observer` returns.
    pub fn go_on(
        &mut self,
        sim: &mut Simulation,
        plan: &DragPlan,
        stage: &Stage,
        observer: &mut impl Observer,
    ) -> Result<()> {
        observer.on_start(self.step, sim)?;
        let at = self.step;
        let wrong = |fault| Error::run(&plan.name, at, fault);
        // Many stretches of few steps, and nothing is written to in between.
        sim.hold().map_err(wrong)?;
        let went = self.steps(sim, plan, stage, observer);
        if matches!(went, Ok(()) | Err(Error::Interrupted { .. })) {
            sim.release().map_err(wrong)?;
        }
        went
    }

    /// The steps of [`Dragging::go_on`].
    fn steps(
        &mut self,
        sim: &mut Simulation,
        plan: &DragPlan,
        stage: &Stage,
        observer: &mut impl Observer,
    ) -> Result<()> {
        let watch = match &self.record.flow {
            Some(flow) => flow.watch(sim.obstacles.len()),
            None => Watch {
                obstacles: vec![INTRUDER],
                ..Watch::default()
            },
        };
        let mut seen = Vec::new();
        while self.step < plan.steps() && self.step < observer.last_step() {
            let n = self.next_stop(plan, observer);
            seen.clear();
            self.step_to(n, sim, plan, observer, &watch, &mut seen)?;
            self.look(sim, plan);
            let wrong = |fault| Error::run(&plan.name, n, fault);
            if let Some(fields) = self.fields.as_mut().filter(|fields| fields.is_due(n)) {
                fields.add(sim, &seen, n);
            }
            let tank = self.record.tank.as_mut();
            if let Some(tank) = tank.filter(|tank| tank.is_due(n)) {
                tank.sample(sim, &seen, n);
            }
            if self.chain.is_due(n) || n == plan.steps() {
                let link = self.chain.add(n, &sim.digest().map_err(wrong)?);
                link.map_or(Ok(()), |link| observer.on_digest(link))?;
            }
            if observer.wants_step(n) {
                // What is shown is stored.
                check_arithmetic::<f64>().map_err(wrong)?;
                observer.on_step(n, sim, &seen)?;
            }
            observer.on_checkpoint(n, sim, &|| self.note())?;
            if n.is_multiple_of(SHOW) {
                let drag = bitgrain_sim::format::short(self.gauges.all.mean()[0]);
                stage.at(n, sim.count(), &format!("drag so far {drag}"))?;
            }
        }
        Ok(())
    }

    /// Whether the contacts of step `n` must be seen.
    fn shows(&self, n: u64, observer: &impl Observer) -> bool {
        let sampled = self.fields.as_ref().is_some_and(|f| f.is_due(n));
        let sampled = sampled || self.record.tank.as_ref().is_some_and(|t| t.is_due(n));
        self.audit.is_some() || sampled || observer.wants_contacts(n)
    }

    /// The next step after which there is something to do besides reading its note, or whose contacts must be seen; at
    /// the latest the one before such a step.
    fn next_stop(&self, plan: &DragPlan, observer: &impl Observer) -> u64 {
        let ends_flow = |n| self.record.flow.as_ref().is_some_and(|f| f.is_due(n));
        let mut n = self.step + 1;
        while !(is_row(plan, n)
            || ends_flow(n)
            || self.chain.is_due(n)
            || n.is_multiple_of(SHOW)
            || n >= observer.last_step()
            || observer.wants_step(n)
            || observer.wants_checkpoint(n)
            || self.shows(n, observer)
            || self.shows(n + 1, observer))
        {
            n += 1;
        }
        n
    }

    /// Steps up to `n`, and takes the readings of each of them; contacts that must be seen are added to `seen`.
    fn step_to(
        &mut self,
        n: u64,
        sim: &mut Simulation,
        plan: &DragPlan,
        observer: &impl Observer,
        watch: &Watch,
        seen: &mut Vec<ContactForce<f64>>,
    ) -> Result<()> {
        let domain = sim.domain;
        let done = if self.shows(n, observer) {
            let watched = match &mut self.audit {
                Some(audit) => audit.step_seen(sim, seen),
                None => sim.step_seen(seen),
            };
            if watched.is_ok() {
                self.read(&sim.note(watch), plan, &domain);
            }
            watched
        } else {
            sim.steps_noted(n - self.step, watch, |note| self.read(note, plan, &domain))
        };
        done.map_err(|fault| Error::run(&plan.name, self.step + 1, fault))
    }

    /// Takes the readings of the next step.
    fn read(&mut self, note: &Note, plan: &DragPlan, domain: &Domain<f64>) {
        self.step += 1;
        let counted = self.is_counted(plan);
        let intruder = &note.obstacles[INTRUDER as usize];
        let force = force_on_intruder(&intruder.body, plan.motion.moves);
        let record = &mut self.record;
        if let Some(flow) = &mut record.flow {
            flow.read(note, force);
        }
        if let Some(tank) = &mut record.tank {
            tank.read(self.step, force);
        }
        let (moves, angles) = (plan.motion.moves, &mut record.angles);
        self.around
            .touched(domain, intruder, moves, counted, angles);
        self.gauges.read(intruder, force, counted);
    }

    /// Whether the present step is in the averaging window.
    fn is_counted(&self, plan: &DragPlan) -> bool {
        let [first, last] = plan.motion.window;
        (first..=last).contains(&self.step)
    }

    /// Adds to the series what is due after the present step.
    fn look(&mut self, sim: &mut Simulation, plan: &DragPlan) {
        let n = self.step;
        if let Some(flow) = self.record.flow.as_mut().filter(|flow| flow.is_due(n)) {
            flow.end_row(sim, n);
        }
        if !is_row(plan, n) {
            return;
        }
        let (counted, moves) = (self.is_counted(plan), plan.motion.moves);
        let record = &mut self.record;
        record.energy.extend(self.audit.map(|audit| audit.row(n)));
        let contacts = sim.count_contacts();
        let deepest = observe::deepest_overlap(sim, &contacts);
        if deepest > record.deepest {
            record.deepest = deepest;
        }
        let sums = counted.then_some((&mut record.angles, &mut record.coordination));
        let sample = self
            .around
            .sample(sim, &contacts, moves, plan.motion.grain_diameter, sums);
        let body = sim.obstacles[INTRUDER as usize];
        let (moved, distance) = match &mut self.released {
            Some(known) => {
                let (row, travel) = release::follow(known, sim, plan, n);
                (Some(row), travel)
            }
            None => (None, plan.motion.travel(n)),
        };
        record.series.push(SeriesRow {
            step: n,
            time: n as f64 * sim.dt,
            distance,
            force: force_on_intruder(&body, moves),
            force_mean: std::mem::take(&mut self.gauges.since_row).mean(),
            torque: body.torque,
            contacts: sim.touch_count(INTRUDER),
            angle: sample.angle,
            coordination: sample.coordination,
            body: moved,
        });
    }

    /// What a checkpoint holds of it.
    pub fn note(&self) -> StageState {
        StageState {
            recipe: String::new(),
            link: self.chain.end().to_string(),
            course: serde_json::to_string(self).expect("what is measured is finite"),
            fields: self
                .fields
                .as_ref()
                .map_or(Vec::new(), CoarseGraining::array),
            frames: String::new(),
        }
    }

    /// Restores it from a checkpoint's note.
    ///
    /// # Errors
    /// What is wrong with the note.
    pub fn of(note: &StageState) -> std::result::Result<Self, String> {
        let mut read: Self = serde_json::from_str(&note.course)
            .map_err(|e| format!("holds no drag under way: {e}"))?;
        if let Some(fields) = read.fields.take() {
            let whole = fields.with_array(&note.fields);
            read.fields = Some(whole.ok_or("holds other sums of fields than its grid has")?);
        }
        read.frames.clone_from(&note.frames);
        let whole = read.chain.is_whole_at(read.step) && read.record.angles.is_whole();
        if read.chain.end() == note.link && whole {
            Ok(read)
        } else {
            Err("does not hold the drag that its chain of digests is of".into())
        }
    }

    /// Means over the window of the grains within other distances of the intruder.
    pub fn within(&self) -> Vec<WithinMeans> {
        self.around.within()
    }

    /// The way of an intruder that forces moved.
    pub fn released(&self) -> Option<Released> {
        self.released
    }

    /// Means over the window of a finished drag.
    ///
    /// # Errors
    /// [`Error::Input`] if the window is too short for any.
    pub fn means(&self, plan: &DragPlan, dt: f64) -> Result<Means> {
        let short = || Error::input(&plan.name, "has too few steps to average");
        let [first, last] = plan.motion.window;
        let steps = self.step.min(last) + 1 - first;
        let mut means = self.gauges.means(steps).ok_or_else(short)?;
        means.around = self.around.means();
        means.flow = self.record.flow.as_ref().and_then(|flow| flow.means(dt));
        Ok(means)
    }
}

/// Drags the intruder of a settled bed from beginning to end: [`Dragging::begin`], [`Dragging::go_on`]
/// and [`Dragging::means`].
///
/// # Errors
/// As those.
pub fn drag(
    sim: &mut Simulation,
    plan: &DragPlan,
    observer: &mut impl Observer,
) -> Result<(Means, DragSeries)> {
    let mut dragging = Dragging::begin(sim, plan, "")?;
    dragging.go_on(sim, plan, &Stage::silent(), observer)?;
    Ok((dragging.means(plan, sim.dt)?, dragging.record))
}

/// Whether the force series has a row for step `n`.
fn is_row(plan: &DragPlan, n: u64) -> bool {
    n.is_multiple_of(plan.every) || n == plan.steps()
}

/// Drag, along the motion of the bed past the intruder, lift up, and side force along y; of a bar [`force_on_bar`].
fn force_on_intruder(intruder: &Obstacle<f64>, moves: Moves) -> [f64; 3] {
    if let Some(force) = force_on_bar(intruder) {
        return force;
    }
    let [x, y, z] = intruder.force;
    match moves {
        // A difference, so that no force is +0.
        Moves::Intruder => [0.0 - x, z, y],
        Moves::Bed => [x, z, y],
    }
}
