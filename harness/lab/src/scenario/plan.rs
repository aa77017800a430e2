//! What follows from a scenario: units, numbers of grains, beds to pour and drags to run.

use serde::{Deserialize, Serialize};

use super::keys::values;
use super::limits::STEADY;
use super::{Gradient, History, IntruderShape, Release, Scenario, UnitSystem};
use bitgrain_sim::coarse_graining::Sampling;
use bitgrain_sim::motion::{Motion, Moves};
use bitgrain_sim::units::Units;

/// Most steps of one drag: a guard against typing errors, a year on one core.
pub(super) const STEPS_MAX: u64 = 1_000_000_000_000;

/// Packing fraction that plans assume before a bed has been poured.
pub const PACKING_GUESS: f64 = 0.6;

/// A bed to make: its intruder, its lid, its seed and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct BedPlan {
    /// Name of the bed and its files.
    pub name: String,
    /// Centre of the intruder.
    pub center: [f64; 3],
    /// Its diameter.
    pub diameter: f64,
    /// Seed of every random number.
    pub seed: u64,
    /// What is put on top of the poured bed.
    pub lid: Option<LidPlan>,
}

impl BedPlan {
    /// The bed below the lid of this one.
    #[must_use]
    pub fn bare(&self) -> Self {
        Self {
            name: format!("{}-bare", self.name),
            lid: None,
            ..self.clone()
        }
    }
}

/// A lid to put on a bed. One of the two numbers is given.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LidPlan {
    /// Effective depth that the lid is to give the intruder's centre.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_depth: Option<f64>,
    /// Mass density of its grains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Whether the bed below it keeps its weight.
    pub pressure_gradient: bool,
}

/// One drag to run in a bed: all that is needed to do it.
#[derive(Clone, Debug, PartialEq)]
pub struct DragPlan {
    /// Name of the drag and its folder.
    pub name: String,
    /// Digest of everything that shapes it: [`Scenario::key`].
    pub key: String,
    /// Place of its bed among the bed plans.
    pub bed: usize,
    /// How its intruder is set going.
    pub release: Release,
    /// Acceleration of gravity, along -z.
    pub gravity: f64,
    /// How intruder and bed move past each other, and over which steps means are taken. Of a drop or a pull the speed
    /// is a scale only: that of a fall from its height, or sqrt(g d).
    pub motion: Motion,
    /// Froude number of the speed.
    pub froude: f64,
    /// Travel; of a drop or a pull what the speed would give.
    pub distance: f64,
    /// Travel at which averaging begins.
    pub discard: f64,
    /// Travel at which it ends: the distance, but for a bar half a turn at most.
    pub window_end: f64,
    /// Tangential springs of the settled bed as it begins.
    pub history: History,
    /// Steps between rows of the force series.
    pub every: u64,
    /// Steps between links of its chain of digests.
    pub digest_every: u64,
    /// Whether its energy is accounted for.
    pub energy: bool,
    /// Whether the flow of its bed is measured too.
    pub flows: bool,
    /// Travel of the ends of a bar in half a turn; none of other intruders.
    pub half_turn: Option<f64>,
    /// Distances from the intruder's surface within which the coordination number is measured too.
    pub reaches: Vec<f64>,
    /// Fields that are averaged during the drag.
    pub fields: Option<Sampling>,
    /// Steps after which a snapshot is taken, ascending.
    pub snapshots: Vec<u64>,
    /// Steps after which a checkpoint is kept, ascending; the last is the last step.
    pub checkpoints: Vec<u64>,
    /// Steps of its frames, ascending: of a moving picture, or the panel's alone.
    pub frames: Vec<u64>,
    /// Step of the frame at the travel at which all drags of the scenario are compared.
    pub panel: u64,
}

impl DragPlan {
    /// Steps of the whole drag.
    pub fn steps(&self) -> u64 {
        self.motion.steps()
    }

    /// Steps that are averaged.
    pub fn averaged(&self) -> u64 {
        let [first, last] = self.motion.window;
        (last + 1).saturating_sub(first)
    }
}

/// Frames of a drag, and the most travel from one to the next in mean diameters: a larger one looks like a jump.
const FRAMES: u64 = 60;
const FRAME: f64 = 0.25;

/// The last of `steps` steps and others before it, so many in all, evenly spaced.
fn evenly(steps: u64, count: u64) -> Vec<u64> {
    let share = |k: u64| (u128::from(steps) * u128::from(k)).div_ceil(count.into());
    let mut chosen: Vec<u64> = (1..=count).map(|k| share(k) as u64).collect();
    chosen.dedup();
    chosen.retain(|step| *step > 0);
    chosen
}

/// The key of a run of these inputs.
fn key_of(run: &str, inputs: &str) -> String {
    let text = format!("{run}\n{inputs}");
    bitgrain_sim::simulation::hex(blake3::hash(text.as_bytes()).as_bytes())
}

impl Scenario {
    /// Digest of everything that shapes a run of this scenario, wherever the file of its bed lies.
    pub fn key(&self, run: &str) -> String {
        key_of(run, &self.key_inputs())
    }

    /// The inputs that a key is made of, as text.
    fn key_inputs(&self) -> String {
        let mut inputs = self.clone();
        // Its content has a digest among the inputs.
        inputs.bed.file = inputs.bed.file.map(|_| String::new());
        inputs.to_toml()
    }

    /// The resolved scenario as TOML, every default written out.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a scenario has only string keys and finite numbers")
    }

    /// Mean grain diameter.
    pub fn mean_diameter(&self) -> f64 {
        0.5 * (self.bed.diameters[0] + self.bed.diameters[1])
    }

    /// What one unit of each kind of number stands for.
    pub fn units(&self) -> Units {
        match self.units {
            UnitSystem::Reduced => Units::reduced(),
            UnitSystem::Si => Units::si(),
        }
    }

    /// Mean volume of a grain: the mean of pi/6 diameter^3 over the uniform distribution.
    fn mean_volume(&self) -> f64 {
        let [a, b] = self.bed.diameters;
        std::f64::consts::PI / 6.0 * 0.25 * (a + b) * (a * a + b * b)
    }

    /// Whether the bed's flow is measured too: round a cylinder, under a lid, and if it moves.
    pub fn flows(&self) -> bool {
        let cylinder = self.intruder.shape == IntruderShape::Cylinder;
        cylinder || self.lid.is_some() || self.drag.moves == Moves::Bed
    }

    /// Volume that an intruder of this diameter takes from the bed.
    fn buried_volume(&self, diameter: f64) -> f64 {
        match self.is_dropped() {
            true => 0.0,
            false => self.intruder_volume(diameter),
        }
    }

    /// Number of grains round an intruder of this diameter, given or from the fill height.
    pub fn grain_count(&self, diameter: f64) -> usize {
        match (self.bed.grains, self.bed.fill_height) {
            (Some(n), _) => n,
            (None, Some(height)) => self.filling(height, self.buried_volume(diameter)),
            (None, None) => 0,
        }
    }

    /// How many grains fill the box to this height at the packing fraction that plans assume, but for
    /// the volume of an obstacle.
    pub(crate) fn filling(&self, height: f64, obstacle: f64) -> usize {
        ((self.bed_area() * height - obstacle) * PACKING_GUESS / self.mean_volume()) as usize
    }

    /// Height of the free surface expected at a packing fraction of 0.6.
    pub fn expected_surface(&self, diameter: f64) -> f64 {
        let grains = self.grain_count(diameter) as f64;
        let ball = self.buried_volume(diameter);
        (grains * self.mean_volume() / PACKING_GUESS + ball) / self.bed_area()
    }

    /// Effective depth that a lid of this density adds: `(pi d/6)(rho_lid/rho)` (Guillard 2014,
    /// section III A); `bulk_density` is `rho = phi rho_g`.
    pub fn lid_depth(&self, lid_density: f64, bulk_density: f64) -> f64 {
        std::f64::consts::PI * self.mean_diameter() / 6.0 * (lid_density / bulk_density)
    }

    /// Grains of the lid's square lattice along x and y.
    pub fn lid_sites(&self) -> [usize; 2] {
        let d = self.mean_diameter();
        [self.bed.size[0], self.bed.size[1]].map(|length| (length / d).round() as usize)
    }

    /// Froude number of a speed: 2 V sqrt(2 D/g)/(D + d) (Kumar 2018, eq. 4).
    pub fn froude(&self, speed: f64, diameter: f64) -> f64 {
        2.0 * speed * self.fall_time(diameter) / (diameter + self.mean_diameter())
    }

    fn fall_time(&self, diameter: f64) -> f64 {
        (2.0 * diameter / self.gravity).sqrt()
    }

    /// Heights of the centre of an intruder of this diameter.
    pub(super) fn heights(&self, diameter: f64) -> Vec<f64> {
        if self.is_dropped() {
            // Beside the box that the bed fills, until it is put over the settled bed.
            return vec![self.bed.size[2] + 0.5 * diameter];
        }
        match (&self.intruder.height, &self.intruder.depth) {
            (Some(heights), _) => heights.values(),
            (None, Some(depths)) => {
                let surface = self.expected_surface(diameter);
                depths.values().iter().map(|h| surface - h).collect()
            }
            (None, None) => vec![],
        }
    }

    /// Speeds with their Froude numbers, whichever of the two was given kept as it is.
    pub(super) fn speeds(&self, diameter: f64) -> Vec<(f64, f64)> {
        match (&self.intruder.speed, &self.intruder.froude) {
            (Some(speeds), _) => speeds
                .values()
                .iter()
                .map(|&v| (v, self.froude(v, diameter)))
                .collect(),
            (None, Some(numbers)) => {
                let width = diameter + self.mean_diameter();
                let per_froude = width / (2.0 * self.fall_time(diameter));
                numbers
                    .values()
                    .iter()
                    .map(|&fr| (fr * per_froude, fr))
                    .collect()
            }
            (None, None) => vec![],
        }
    }

    /// The seeds, one or several.
    pub fn all_seeds(&self) -> Vec<u64> {
        if self.seeds.is_empty() {
            vec![self.seed]
        } else {
            self.seeds.clone()
        }
    }

    /// What is put on top of a bed whose intruder is this deep, by effective depth and then with the
    /// pressure gradient first.
    pub(super) fn lids(&self, depth: f64) -> Vec<Option<LidPlan>> {
        let Some(lid) = &self.lid else {
            return vec![None];
        };
        let deep = values(&lid.effective_depth);
        let dense = values(&lid.density);
        let asked = deep.iter().map(|&h| (Some(h), None));
        let asked = asked.chain(dense.iter().map(|&rho| (None, Some(rho))));
        let gradients: &[bool] = match lid.pressure_gradient {
            Gradient::With => &[true],
            Gradient::Without => &[false],
            Gradient::Both => &[true, false],
        };
        let mut lids = Vec::new();
        for (effective_depth, density) in asked {
            for &pressure_gradient in gradients {
                // At the bed's own depth its own weight suffices.
                let bare = pressure_gradient
                    && effective_depth
                        .is_some_and(|h| (h - depth).abs() <= 0.5 * self.mean_diameter());
                lids.push((!bare).then_some(LidPlan {
                    effective_depth,
                    density,
                    pressure_gradient,
                }));
            }
        }
        lids
    }

    /// The beds to make, by diameter, height, lid and seed.
    pub(super) fn plan_beds(&self) -> Vec<BedPlan> {
        let [x, y, _] = self.bed.size;
        let mut beds = Vec::new();
        for diameter in self.intruder.diameter.values() {
            for z in self.heights(diameter) {
                for lid in self.lids(self.expected_surface(diameter) - z) {
                    for seed in self.all_seeds() {
                        beds.push(BedPlan {
                            name: format!("bed-{}", beds.len() + 1),
                            center: [0.5 * x, 0.5 * y, z],
                            diameter,
                            seed,
                            lid,
                        });
                    }
                }
            }
        }
        if let [one] = &mut beds[..] {
            one.name = "bed".into();
        }
        beds
    }

    /// The beds to pour, each once: those without a lid, and what lies below the lids of the others. A
    /// bed that only lies below lids is named after them.
    pub(super) fn plan_bare_beds(&self) -> Vec<BedPlan> {
        let (mut bare, covered): (Vec<BedPlan>, Vec<BedPlan>) = self
            .plan_beds()
            .into_iter()
            .partition(|plan| plan.lid.is_none());
        for plan in covered {
            let below = plan.bare();
            let same = |other: &BedPlan| {
                let named = BedPlan {
                    name: below.name.clone(),
                    ..other.clone()
                };
                named == below
            };
            if !bare.iter().any(same) {
                bare.push(below);
            }
        }
        bare
    }

    /// The drags to run, by bed and then speed, force or height.
    pub(super) fn plan_drags(&self) -> Vec<DragPlan> {
        let (beds, inputs) = (self.plan_beds(), self.key_inputs());
        let mut runs = Vec::new();
        for (bed, plan) in beds.iter().enumerate() {
            for (k, passage) in self.passages(plan.diameter).into_iter().enumerate() {
                let run = format!("run-{}", k + 1);
                let name = if beds.len() == 1 {
                    run
                } else {
                    format!("{}-{run}", plan.name)
                };
                let (motion, release) = (passage.motion, passage.release);
                let steps = motion.steps();
                runs.push(DragPlan {
                    key: key_of(&name, &inputs),
                    name,
                    bed,
                    release,
                    gravity: self.gravity,
                    motion,
                    froude: passage.froude,
                    distance: passage.distance,
                    discard: passage.discard,
                    window_end: passage.window_end,
                    history: self.drag.history,
                    every: self.measure.every,
                    digest_every: self.measure.digest_every,
                    energy: self.measure.energy,
                    flows: self.flows(),
                    half_turn: self.half_turn(),
                    reaches: self.measure.reaches.clone(),
                    fields: self.fields_sampling(motion.speed),
                    snapshots: evenly(steps, self.measure.snapshots),
                    checkpoints: evenly(steps, self.measure.checkpoints),
                    frames: Vec::new(),
                    panel: 0,
                });
            }
        }
        self.plan_frames(&mut runs);
        runs
    }

    /// Where frames are taken: of each drag at one travel, and of the first, the middle and the last, which
    /// show the range, many of a travel that a moving picture can show.
    fn plan_frames(&self, runs: &mut [DragPlan]) {
        let most = FRAMES as f64 * FRAME * self.mean_diameter();
        let common = runs.iter().map(|run| 0.5 * run.distance);
        let common = common.fold(most, f64::min);
        let last = runs.len().saturating_sub(1);
        for (k, run) in runs.iter_mut().enumerate() {
            // A plane that stands cuts a bar that turns elsewhere at each step, and one that is free to rise has the
            // floor elsewhere.
            if run.half_turn.is_some() || run.release.is_free() {
                continue;
            }
            let (steps, distance) = (run.steps() as f64, run.distance);
            let step = |travel: f64| (steps * (travel / distance).min(1.0)) as u64;
            run.panel = step(common).max(1);
            if [0, last / 2, last].contains(&k) {
                run.frames = evenly(step(most), FRAMES);
            }
            if let Err(place) = run.frames.binary_search(&run.panel) {
                run.frames.insert(place, run.panel);
            }
        }
    }

    /// Travel left out of the averages unless the scenario gives it: the larger of D and a tenth
    /// of the distance; for a cylinder 2 D (Guillard 2014, section III A), which the middle of each half of a bar
    /// has gone when its ends have gone 4 D.
    pub(super) fn default_discard(&self, diameter: f64, distance: f64) -> f64 {
        match self.intruder.shape {
            IntruderShape::Cylinder => STEADY * diameter,
            IntruderShape::Bar => 2.0 * STEADY * diameter,
            IntruderShape::Sphere if 0.1 * distance > diameter => 0.1 * distance,
            IntruderShape::Sphere => diameter,
        }
    }
}
