//! Dragging: the intruder moves at constant speed through a settled bed, or the bed past it, and the
//! force on it is summed at every step.

use bitgrain_kernel::{Error as KernelError, check_arithmetic};
use serde::{Deserialize, Serialize};

use crate::flow::{FlowGauge, FlowMeans};
use crate::near_field::{NearField, NearFieldMeans, WithinMeans};
use crate::progress::Stage;
use crate::scenario::{DragPlan, History};
use crate::series::SeriesRow;
use bitgrain_sim::block_averaging::{BlockSums, Mean};
use bitgrain_sim::chain::Chain;
use bitgrain_sim::checkpoint::StageState;
use bitgrain_sim::coarse_graining::CoarseGraining;
use bitgrain_sim::energy_budget::{Audit, EnergyRow};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::histogram::{Angles, Coordination};
use bitgrain_sim::memory::room;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::observe::{self, INTRUDER};
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::{Role, Simulation};

/// Steps between updates of the progress bar; no result depends on it.
const SHOW: u64 = 200;

/// Bytes that a point of the fields takes, in memory and twice as a checkpoint is made.
const FIELDS: f64 = 3.0 * 13.0 * 8.0;

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
    /// The grains round it.
    pub around: NearFieldMeans,
    /// Drag over all steps.
    pub drag_uncut: f64,
    /// Steps in the window.
    pub window_steps: u64,
    /// How a bed flowed that has a lid, a cylinder in it, or moves.
    pub flow: Option<FlowMeans>,
}

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
    /// The energy budget, if it was asked for.
    pub energy: Vec<EnergyRow>,
    /// Deepest overlap of grains with each other and with the intruder at any row (length).
    pub deepest: f64,
}

/// Sums of one window of steps.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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

/// All that is measured of the intruder during the drag.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Gauges {
    force: [BlockSums; 3],
    contacts: BlockSums,
    since_row: Sums,
    all: Sums,
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
    audit: Option<Audit>,
    /// Sums of the fields, if they were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fields: Option<CoarseGraining>,
    /// Frames of the checkpoint that it was read from, which no file holds yet.
    #[serde(skip)]
    pub frames: String,
}

impl Dragging {
    /// Sets the intruder of a settled bed in motion, or the bed, as `plan` says; `link` is the last one of
    /// the bed's chain.
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
        set_off(sim, plan.motion.moves, plan.motion.speed).map_err(wrong)?;
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
                ..DragSeries::default()
            },
            gauges: Gauges::default(),
            around: NearField::new(&plan.reaches),
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
        // Each step is looked at, and none is written to.
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
        let first = plan.motion.window[0];
        let mut seen = Vec::new();
        while self.step < plan.steps() && self.step < observer.last_step() {
            let n = self.step + 1;
            let wrong = |fault| Error::run(&plan.name, n, fault);
            let looks = observer.wants_step(n);
            let sampled = self.fields.as_ref().is_some_and(|f| f.is_due(n));
            seen.clear();
            match &mut self.audit {
                Some(audit) => audit.step_watched(sim, |contact| seen.push(contact)),
                None if looks || sampled => sim.step_watched(|contact| seen.push(contact)),
                None => sim.steps(1),
            }
            .map_err(wrong)?;
            self.measure(sim, n, n >= first, plan);
            if let Some(fields) = self.fields.as_mut().filter(|_| sampled) {
                fields.add(sim, &seen, n);
            }
            self.step = n;
            if self.chain.is_due(n) || n == plan.steps() {
                let link = self.chain.add(n, &sim.digest().map_err(wrong)?);
                link.map_or(Ok(()), |link| observer.on_digest(link))?;
            }
            if looks {
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

    /// Takes the readings of step `n`.
    fn measure(&mut self, sim: &mut Simulation, n: u64, counted: bool, plan: &DragPlan) {
        let row = n.is_multiple_of(plan.every) || n == plan.steps();
        let force = force_on_intruder(sim, plan.motion.moves);
        if let Some(flow) = &mut self.record.flow {
            flow.read(sim, n, force);
        }
        let (record, moves) = (&mut self.record, plan.motion.moves);
        let angles = &mut record.angles;
        self.around.touched(sim, moves, counted, angles);
        self.gauges.read(sim, force, counted);
        if !row {
            return;
        }
        record.energy.extend(self.audit.map(|audit| audit.row(n)));
        let deepest = observe::deepest_overlap(sim);
        if deepest > record.deepest {
            record.deepest = deepest;
        }
        let sums = counted.then_some((angles, &mut record.coordination));
        let sample = self
            .around
            .sample(sim, moves, plan.motion.grain_diameter, sums);
        record.series.push(SeriesRow {
            step: n,
            time: n as f64 * sim.dt,
            distance: plan.motion.travel(n),
            force,
            force_mean: std::mem::take(&mut self.gauges.since_row).mean(),
            torque: sim.obstacles[INTRUDER as usize].torque,
            contacts: sim.touch_count(INTRUDER),
            angle: sample.angle,
            coordination: sample.coordination,
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
        if read.chain.end() == note.link && read.record.angles.is_whole() {
            Ok(read)
        } else {
            Err("does not hold the drag that its chain of digests is of".into())
        }
    }

    /// Means over the window of the grains within other distances of the intruder.
    pub fn within(&self) -> Vec<WithinMeans> {
        self.around.within()
    }

    /// Means over the window of a finished drag.
    ///
    /// # Errors
    /// [`Error::Input`] if the window is too short for any.
    pub fn means(&self, plan: &DragPlan, dt: f64) -> Result<Means> {
        let short = || Error::input(&plan.name, "has too few steps to average");
        let steps = self.step + 1 - plan.motion.window[0];
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

/// Sets the intruder in motion, or base, lid and planes; all at once.
fn set_off(sim: &mut Simulation, moves: Moves, speed: f64) -> std::result::Result<(), KernelError> {
    let histories = sim.contact_histories();
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
    // Resumed, so that the list of pairs takes the motion into account, and a speed that cannot be
    // resolved is refused.
    sim.resume(&histories)
}

/// Drag, along the motion of the bed past the intruder, lift up, and side force along y.
fn force_on_intruder(sim: &Simulation, moves: Moves) -> [f64; 3] {
    let [x, y, z] = sim.obstacles[INTRUDER as usize].force;
    match moves {
        // A difference, so that no force is +0.
        Moves::Intruder => [0.0 - x, z, y],
        Moves::Bed => [x, z, y],
    }
}

impl Gauges {
    /// Sums the force of a step, and if it is `counted` the quantities of the means.
    fn read(&mut self, sim: &Simulation, force: [f64; 3], counted: bool) {
        self.since_row.add(force);
        self.all.add(force);
        if counted {
            for a in 0..3 {
                self.force[a].add(force[a]);
            }
            self.contacts.add(f64::from(sim.touch_count(INTRUDER)));
        }
    }

    fn means(&self, window_steps: u64) -> Option<Means> {
        Some(Means {
            drag: self.force[0].mean()?,
            lift: self.force[1].mean()?,
            side: self.force[2].mean()?,
            contacts: self.contacts.mean()?,
            around: NearFieldMeans::default(),
            drag_uncut: self.all.mean()[0],
            window_steps,
            flow: None,
        })
    }
}
