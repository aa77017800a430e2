//! What a scenario would take, before it runs: sizes, dimensionless groups, and the time, from the
//! speed of this machine on a small settled bed.

mod ranks;
mod space;
mod work;

use std::fmt::Write;
use std::time::Instant;

pub(crate) use space::space;
use space::{SUMS, points};
pub(crate) use work::side_by_side;
use work::{Work, range};

use crate::bed;
use crate::bed::library::BedCache;
use crate::folder::Folder;
use crate::pace::StageKind;
use crate::progress::Stage;
use crate::scenario::{self, BedPlan, CheckedScenario, DragPlan, PACKING_GUESS, UnitSystem};
use bitgrain_sim::coefficients::table_text;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::format::{bytes, short};
use bitgrain_sim::law::{CONTACT_FRACTION_MAX, RAYLEIGH_FRACTION_MAX};
use bitgrain_sim::memory::{PER_GRAIN, PER_GRAIN_ON_THREADS};

/// Least duration of the trial, in seconds.
const TRIAL: f64 = 0.5;

/// The forecast of a scenario as text: `threads` jobs run side by side, beds come from `library`. `words` name
/// the scenario on a command line. If it was begun in `folder`, the forecast is of the rest, at the speed so far.
///
/// # Errors
/// A fault of the trial run.
pub fn forecast(
    scenario: &CheckedScenario,
    words: &str,
    library: &BedCache,
    folder: Folder<'_>,
    threads: usize,
) -> Result<String> {
    let speed = trial(scenario)?;
    let work = Work::of(scenario, library, Some(folder))?;
    let mut out = Lines::default();
    let needs = cost(scenario, &work, threads, speed, &mut out);
    if let Some(advice) = ranks::advice(&needs, bitgrain_sim::memory::of_machine()) {
        let command = format!(
            "mpirun -n {} bitgrain run {words} --threads {threads}",
            advice.ranks
        );
        out.add("one machine is not enough", advice.why);
        if advice.ranks > 1 {
            out.add("on several (built with MPI)", command);
        }
    }
    let si = scenario.units == UnitSystem::Si;
    let (d, density) = (scenario.mean_diameter(), scenario.bed.density);
    if let Some(table) = table_text(&scenario.law, d, density, si) {
        out.gap();
        out.text.push_str(&table);
    }
    groups(scenario, speed, &mut out);
    Ok(out.text)
}

/// A shipped scenario: its sizes, and its time in words.
#[derive(Clone, Debug)]
pub struct Size {
    /// Its name.
    pub name: &'static str,
    /// Grains of its largest bed.
    pub grains: usize,
    /// Beds.
    pub beds: usize,
    /// Drags.
    pub drags: usize,
    /// From the least that it takes on this machine to the most.
    pub time: String,
}

/// The shipped scenarios on this many threads, with no bed at hand.
///
/// # Errors
/// A fault of the trial run.
pub fn shipped(threads: usize) -> Result<Vec<Size>> {
    let none = BedCache::new("");
    let mut sizes = Vec::new();
    let mut speed = None;
    for (name, _) in scenario::SHIPPED {
        let scenario = scenario::load(name, &[])?;
        let speed = match speed {
            Some(speed) => speed,
            None => *speed.insert(trial(&scenario)?),
        };
        let (beds, runs) = (scenario.beds(), scenario.drags());
        let grains = largest(&scenario, beds);
        let steps = Work::of(&scenario, &none, None)?
            .longest(threads)
            .iter()
            .sum();
        sizes.push(Size {
            name,
            grains,
            beds: beds.len(),
            drags: runs.len(),
            time: range(steps, grains, speed),
        });
    }
    Ok(sizes)
}

/// Grains of the largest bed.
fn largest(scenario: &CheckedScenario, beds: &[BedPlan]) -> usize {
    let sizes = beds.iter().map(|plan| scenario.grain_count(plan.diameter));
    sizes.max().unwrap_or(0)
}

/// Lines of a name and a value.
#[derive(Default)]
struct Lines {
    text: String,
}

impl Lines {
    fn add(&mut self, name: &str, value: impl std::fmt::Display) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.text, "{name:<34}{value}");
    }

    fn gap(&mut self) {
        self.text.push('\n');
    }
}

/// Grains, steps, memory, disk and time.
fn cost(
    scenario: &CheckedScenario,
    work: &Work,
    threads: usize,
    speed: f64,
    out: &mut Lines,
) -> ranks::Needs {
    let (beds, runs) = (scenario.beds(), scenario.drags());
    let grains = largest(scenario, beds);
    let drags: u64 = work.dragged.iter().sum();
    let beds_steps: u64 = work.poured.iter().chain(&work.covered).sum();
    let steps = beds_steps + drags;

    out.add(
        "scenario",
        format!("{} ({})", scenario.name, system(scenario)),
    );
    out.add(
        "grains",
        format!("{grains} in each of {} bed(s)", beds.len()),
    );
    let pour = match (&work.poured[..], work.covered.len()) {
        _ if scenario.source.is_some() => "none: the bed comes from a file".to_string(),
        _ if work.missing.is_empty() => "none: every bed is at hand".to_string(),
        ([], lids) => format!("none; {lids} to put a lid on"),
        ([first, ..], lids) => {
            let lids = match lids {
                0 => String::new(),
                n => format!("; {n} lid(s), about {} steps each", work.covered[0]),
            };
            let names = match &work.missing[..] {
                [first, .., last] if work.missing.len() > 4 => format!("{first} to {last}"),
                few => few.join(", "),
            };
            format!(
                "{} ({names}), about {first} steps each{lids}",
                work.poured.len()
            )
        }
    };
    out.add("beds to pour", pour);
    out.add("steps in all", format!("{steps} (drags {drags})"));
    if work.done > 0 {
        out.add("drags that are done", work.done);
    }
    let at_once = threads.min(runs.len());
    // Sums of fields, and twice as much when a state is saved.
    let sums = 3.0 * SUMS * points(scenario).iter().product::<f64>();
    let per_grain = match threads > at_once {
        true => PER_GRAIN_ON_THREADS,
        false => PER_GRAIN,
    };
    let memory = (per_grain * grains as f64 + sums) * at_once as f64;
    out.add("memory", bytes(memory));
    out.add("disk", bytes(space(scenario, runs, grains, beds.len())));
    let million = 1e-6 * speed;
    out.add(
        "speed of this machine",
        format!("{million:.1} million grain-steps/s (a settled bed of {TRIAL_GRAINS}, one thread)"),
    );
    if let Some(pace) = work.pace.speed(StageKind::Dragging) {
        let pace = format!(
            "{:.1} million grain-steps/s (of a small bed, one thread)",
            1e-6 * pace
        );
        out.add("speed in this folder so far", pace);
    }
    let time = work.time(grains, threads, speed);
    out.add("time", format!("{time} on {threads} thread(s)"));
    let longest = runs.iter().map(|run| run.steps()).max().unwrap_or(0);
    ranks::Needs {
        grains,
        memory,
        longest: longest as f64 * grains as f64 / speed / threads as f64,
    }
}

/// Dimensionless groups, of the scenario and of each run.
fn groups(scenario: &CheckedScenario, speed: f64, out: &mut Lines) {
    let units = scenario.units();
    let (rayleigh, collision) = (scenario.rayleigh_time(), scenario.shortest_contact());
    let bound = |time: f64, most: f64, name: &str| {
        let ratio = short(scenario.drag.dt / time);
        format!(
            "{ratio} (at most {most}; {name} {} {})",
            short(time),
            units.time
        )
    };
    out.gap();
    out.add(
        "time step / Rayleigh time",
        bound(rayleigh, RAYLEIGH_FRACTION_MAX, "the time"),
    );
    let (fastest, what) = scenario.fastest();
    let at = format!(
        "at the speed of {what}, {} {},",
        short(fastest),
        units.speed
    );
    out.add(
        "time step / collision",
        bound(collision, CONTACT_FRACTION_MAX, &at),
    );
    out.add("stiffness K_n/(rho g d)", short(stiffness(scenario)));
    runs(scenario, speed, out);
}

/// A row for each run.
fn runs(scenario: &CheckedScenario, speed: f64, out: &mut Lines) {
    let units = scenario.units();
    let beds = scenario.beds();
    out.gap();
    let mut rows = vec![[
        "run".to_string(),
        "steps".into(),
        "time".into(),
        format!("V ({})", units.speed),
        "Fr".into(),
        "inertial number".into(),
        "contact (steps)".into(),
        format!("depth ({})", units.length),
        "depth/D".into(),
    ]];
    for run in scenario.drags() {
        let plan = &beds[run.bed];
        let depth = planned_depth(scenario, plan);
        let contact = scenario.law.contact_duration(
            run.motion.speed,
            0.5 * scenario.mean_diameter(),
            scenario.bed.density,
        ) / scenario.drag.dt;
        rows.push([
            run.name.clone(),
            run.steps().to_string(),
            range(run.steps(), scenario.grain_count(plan.diameter), speed),
            short(run.motion.speed),
            short(run.froude),
            short(inertial(scenario, run, plan.diameter, depth)),
            short(contact),
            short(depth),
            short(depth / plan.diameter),
        ]);
    }
    let width = |k: usize| rows.iter().map(|row| row[k].chars().count()).max();
    let widths: Vec<usize> = (0..9).map(|k| width(k).unwrap_or(0)).collect();
    for row in &rows {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(k, (cell, &width))| match k {
            0 => format!("{cell:<width$}"),
            _ => format!("{cell:>width$}"),
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        out.text.push_str(line.trim_end());
        out.text.push('\n');
    }
    if scenario.drags().iter().any(|run| run.release.is_timed()) {
        out.text.push_str(
            "V of a drop is that of a fall from its height, V of a pull sqrt(g d): a scale, as the sphere is not \
             held at it.\n",
        );
    }
    out.text.push_str(
        "Depths are those expected at a packing fraction of 0.6, under a lid the effective depths; contacts are \
         those at V.\n",
    );
}

/// Depth, or effective depth under a lid, at the packing fraction that plans assume.
fn planned_depth(scenario: &CheckedScenario, plan: &BedPlan) -> f64 {
    let own = scenario.expected_surface(plan.diameter) - plan.center[2];
    let Some(lid) = &plan.lid else {
        return own;
    };
    let added = |density| scenario.lid_depth(density, PACKING_GUESS * scenario.bed.density);
    let below = if lid.pressure_gradient { own } else { 0.0 };
    match (lid.effective_depth, lid.density) {
        (Some(depth), _) => depth,
        (None, density) => below + density.map_or(0.0, added),
    }
}

fn system(scenario: &CheckedScenario) -> &'static str {
    match scenario.units {
        crate::scenario::UnitSystem::Reduced => "reduced units: rho = d = g = 1",
        crate::scenario::UnitSystem::Si => "SI units",
    }
}

/// Grains of the trial's bed.
pub(crate) const TRIAL_GRAINS: usize = 300;

/// Grain-steps a second on one thread: a small bed of the quick scenario's soft grains, poured just
/// now, with the scenario's friction.
pub(crate) fn trial(scenario: &CheckedScenario) -> Result<f64> {
    let sets = [
        "name=trial".to_string(),
        format!("bed.grains={TRIAL_GRAINS}"),
        "bed.box=[6.4, 6.4, 8.0]".into(),
        "bed.settled=1e-2".into(),
        "intruder.diameter=1.5".into(),
        "intruder.froude=1.0".into(),
        "drag.distance=6.0".into(),
        format!("law.mu={:?}", scenario.law.mu()),
    ];
    let small = crate::scenario::load("quick", &sets)?;
    let mut sim = bed::pour(&small, &small.beds()[0], &mut Stage::silent())?;
    let began = Instant::now();
    let mut steps = 0;
    while began.elapsed().as_secs_f64() < TRIAL {
        sim.steps(500)
            .map_err(|fault| Error::run("trial", steps, fault))?;
        steps += 500;
    }
    Ok((steps * sim.count() as u64) as f64 / began.elapsed().as_secs_f64())
}

/// Normal stiffness over the weight of a grain's height of material.
fn stiffness(scenario: &CheckedScenario) -> f64 {
    let weight = scenario.bed.density * scenario.gravity * scenario.mean_diameter();
    scenario.law.normal_stiffness() / weight
}

/// `(V/D) d / sqrt(P/rho)` with the pressure `P = phi rho g h` at the intruder's depth.
fn inertial(scenario: &CheckedScenario, run: &DragPlan, diameter: f64, depth: f64) -> f64 {
    let rate = run.motion.speed / diameter;
    rate * scenario.mean_diameter() / (PACKING_GUESS * scenario.gravity * depth).sqrt()
}
