//! What a scenario would take, before it runs: sizes, dimensionless groups, and the time, from the
//! speed of this machine on a small settled bed.

use std::fmt::Write;
use std::time::Instant;

use bitgrain_kernel::law::{HertzHistory, HertzTsuji};

use crate::bed;
use crate::bed::library::Library;
use crate::bed::recipe::Recipe;
use crate::coefficients::table_text;
use crate::error::{Error, Result};
use crate::progress::Stage;
use crate::report::short;
use crate::scenario::{BedPlan, PACKING_GUESS, RunPlan, Scenario, UnitSystem};
use crate::sim::{AnyLaw, sphere_mass};

/// Bytes of memory a grain takes, from beds of 10,000 and 70,000 grains.
const MEMORY: f64 = 510.0;
/// Bytes of a grain in a checkpoint with its contacts.
const CHECKPOINT: f64 = 290.0;
/// Bytes of a grain in a data file.
const DATA: f64 = 300.0;
/// Bytes of a grain in a snapshot: dump, VTK grains, VTK contacts.
const SNAPSHOT: f64 = 1400.0;
/// Bytes of a row of the force series.
const ROW: f64 = 260.0;
/// Least duration of the trial, in seconds.
const TRIAL: f64 = 0.5;

/// The forecast of a scenario as text: `threads` jobs run side by side, beds come from `library`.
///
/// # Errors
/// What the trial may meet: a run that goes wrong.
pub fn forecast(scenario: &Scenario, library: &Library, threads: usize) -> Result<String> {
    let speed = trial(scenario)?;
    let mut work = Work::default();
    if scenario.source.is_none() {
        let absent = |plan: &BedPlan| {
            let found = library.find(&Recipe::new(scenario, plan))?;
            Ok::<bool, Error>(found.is_none())
        };
        for plan in scenario.beds() {
            if !absent(&plan)? {
                continue;
            }
            if plan.lid.is_some() {
                work.covered.push(bed::covering_steps(scenario, &plan));
            }
            work.missing.push(plan.name);
        }
        for plan in crate::run::bare_beds(scenario) {
            if absent(&plan)? {
                work.poured.push(bed::pouring_steps(scenario, &plan));
            }
        }
    }
    let mut out = Lines::default();
    cost(scenario, &work, threads, speed, &mut out);
    let si = scenario.units == UnitSystem::Si;
    let (d, density) = (scenario.mean_diameter(), scenario.bed.density);
    if let Some(table) = table_text(&scenario.law, d, density, si) {
        out.gap();
        out.text.push_str(&table);
    }
    groups(scenario, speed, &mut out);
    Ok(out.text)
}

/// What has to be done before the drags.
#[derive(Default)]
struct Work {
    /// Names of the beds that are not at hand.
    missing: Vec<String>,
    /// Steps of each pouring.
    poured: Vec<u64>,
    /// Steps of each settling under a lid.
    covered: Vec<u64>,
}

/// Lines of a name and a value.
#[derive(Default)]
struct Lines {
    text: String,
}

impl Lines {
    fn add(&mut self, name: &str, value: impl std::fmt::Display) {
        // Writing into a string has no way to fail.
        let _ = writeln!(self.text, "{name:<34}{value}");
    }

    fn gap(&mut self) {
        self.text.push('\n');
    }
}

/// Grains, steps, memory, disk and time.
fn cost(scenario: &Scenario, work: &Work, threads: usize, speed: f64, out: &mut Lines) {
    let (beds, runs) = (scenario.beds(), scenario.runs());
    let sizes = beds.iter().map(|plan| scenario.grain_count(plan.diameter));
    let grains = sizes.max().unwrap_or(0);
    let dragged: Vec<u64> = runs.iter().map(|run| run.steps).collect();
    let stages = [&work.poured, &work.covered, &dragged];
    let whole: u64 = stages.iter().map(|jobs| side_by_side(jobs, threads)).sum();
    let steps: u64 = stages.iter().flat_map(|jobs| jobs.iter()).sum();

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
    let drags = dragged.iter().sum::<u64>();
    out.add("steps in all", format!("{steps} (drags {drags})"));
    let at_once = threads.min(runs.len());
    out.add("memory", bytes(MEMORY * (grains * at_once) as f64));
    out.add("disk", bytes(disk(scenario, &runs, grains, beds.len())));
    let million = 1e-6 * speed;
    out.add(
        "speed of this machine",
        format!("{million:.1} million grain-steps/s (a settled bed of {TRIAL_GRAINS}, one thread)"),
    );
    let time = duration(whole as f64 * grains as f64 / speed);
    out.add(
        "time",
        format!(
            "about {time} on {threads} thread(s); beds of many more grains take up to 1.5 times as long"
        ),
    );
}

/// Dimensionless groups, of the scenario and of each run.
fn groups(scenario: &Scenario, speed: f64, out: &mut Lines) {
    let units = scenario.units();
    let beds = scenario.beds();
    let ratio = scenario.drag.dt / scenario.rayleigh_time();
    out.gap();
    out.add(
        "time step / Rayleigh time",
        format!("{} (at most 0.2)", short(ratio)),
    );
    out.add("stiffness K_n/(rho g d)", short(stiffness(scenario)));
    for run in scenario.runs() {
        let plan = &beds[run.bed];
        let depth = planned_depth(scenario, plan);
        let seconds = run.steps as f64 * scenario.grain_count(plan.diameter) as f64 / speed;
        let contact = contact_time(scenario, run.speed) / scenario.drag.dt;
        out.gap();
        out.add(
            &run.name,
            format!("{} steps, about {}", run.steps, duration(seconds)),
        );
        out.add("  speed V", format!("{} {}", short(run.speed), units.speed));
        out.add("  Froude number", short(run.froude));
        out.add(
            "  inertial number",
            short(inertial(scenario, &run, plan.diameter, depth)),
        );
        out.add(
            "  contact duration",
            format!("{} steps at V", short(contact)),
        );
        let which = if plan.lid.is_some() {
            "  effective depth"
        } else {
            "  depth"
        };
        out.add(
            which,
            format!(
                "{} {} ({} D) at a packing fraction of 0.6",
                short(depth),
                units.length,
                short(depth / plan.diameter)
            ),
        );
    }
}

/// Depth, or effective depth under a lid, at the packing fraction that plans assume.
fn planned_depth(scenario: &Scenario, plan: &BedPlan) -> f64 {
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

fn system(scenario: &Scenario) -> &'static str {
    match scenario.units {
        crate::scenario::UnitSystem::Reduced => "reduced units: rho = d = g = 1",
        crate::scenario::UnitSystem::Si => "SI units",
    }
}

/// Steps that the busiest of `threads` workers does, the longest job first.
fn side_by_side(jobs: &[u64], threads: usize) -> u64 {
    let mut jobs = jobs.to_vec();
    jobs.sort_unstable_by(|a, b| b.cmp(a));
    let mut load = vec![0u64; threads.max(1)];
    for job in jobs {
        if let Some(least) = load.iter_mut().min() {
            *least += job;
        }
    }
    load.into_iter().max().unwrap_or(0)
}

fn disk(scenario: &Scenario, runs: &[RunPlan], grains: usize, beds: usize) -> f64 {
    let grains = grains as f64;
    // Twice: in the library and in the run directory.
    let bed = grains * (2.0 * CHECKPOINT + DATA);
    let rows = |run: &RunPlan| (run.steps / scenario.measure.every) as f64;
    let drag = |run: &RunPlan| rows(run) * ROW + run.snapshots.len() as f64 * grains * SNAPSHOT;
    beds as f64 * bed + runs.iter().map(drag).sum::<f64>()
}

/// Grains of the trial's bed.
const TRIAL_GRAINS: usize = 500;

/// Grain-steps a second on one thread: a small bed of the quick scenario's soft grains, poured just
/// now, with the scenario's friction.
fn trial(scenario: &Scenario) -> Result<f64> {
    let sets = [
        "name=trial".to_string(),
        format!("bed.grains={TRIAL_GRAINS}"),
        "bed.box=[8.0, 8.0, 8.0]".into(),
        "bed.settled=1e-3".into(),
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

impl Scenario {
    /// Shortest Rayleigh time among the smallest grain and the intruder.
    fn rayleigh_time(&self) -> f64 {
        let times = self.sizes().into_iter();
        let times = times.map(|(radius, density)| self.law.rayleigh_time(radius, density));
        times.fold(f64::INFINITY, |a, b| if b < a { b } else { a })
    }
}

/// Normal stiffness of the law as a pressure: `F_n = K_n sqrt(R delta) delta`.
fn normal_stiffness(scenario: &Scenario) -> f64 {
    match scenario.law.build() {
        Ok(AnyLaw::HertzHistory(HertzHistory { kn, .. })) => kn,
        Ok(AnyLaw::HertzTsuji(HertzTsuji { kn, .. })) => kn,
        Err(_) => f64::NAN,
    }
}

/// Normal stiffness over the weight of a grain's height of material.
fn stiffness(scenario: &Scenario) -> f64 {
    let weight = scenario.bed.density * scenario.gravity * scenario.mean_diameter();
    normal_stiffness(scenario) / weight
}

/// `(V/D) d / sqrt(P/rho)` with the pressure `P = phi rho g h` at the intruder's depth.
fn inertial(scenario: &Scenario, run: &RunPlan, diameter: f64, depth: f64) -> f64 {
    let rate = run.speed / diameter;
    rate * scenario.mean_diameter() / (PACKING_GUESS * scenario.gravity * depth).sqrt()
}

/// Duration of an undamped Hertz collision of two mean grains at this speed (time): 2.943 times the
/// deepest overlap over the speed, with the overlap `(5 m v^2/(4 K_n sqrt(R)))^(2/5)`, effective mass
/// and radius (Landau and Lifshitz, Theory of Elasticity, section 9).
fn contact_time(scenario: &Scenario, speed: f64) -> f64 {
    let d = scenario.mean_diameter();
    let mass = 0.5 * sphere_mass(d, scenario.bed.density);
    let stiffness = normal_stiffness(scenario) * (0.25 * d).sqrt();
    let deepest = libm::pow(1.25 * mass * speed * speed / stiffness, 0.4);
    2.943 * deepest / speed
}

/// Bytes in words.
pub fn bytes(count: f64) -> String {
    match count {
        0.0..1e3 => format!("{count:.0} B"),
        1e3..1e6 => format!("{:.0} kB", 1e-3 * count),
        1e6..1e9 => format!("{:.0} MB", 1e-6 * count),
        _ => format!("{:.1} GB", 1e-9 * count),
    }
}

/// Seconds in words.
fn duration(seconds: f64) -> String {
    match seconds {
        ..100.0 => format!("{seconds:.0} s"),
        ..6000.0 => format!("{:.0} min", seconds / 60.0),
        ..172_800.0 => format!("{:.1} h", seconds / 3600.0),
        _ => format!("{:.0} days", seconds / 86_400.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_jobs_are_shared_out_first() {
        assert_eq!(side_by_side(&[3, 5, 4, 2], 2), 7);
        assert_eq!(side_by_side(&[3, 5], 1), 8);
        assert_eq!(side_by_side(&[], 2), 0);
    }

    /// A head-on collision, integrated: the contact lasts as long as the closed form says.
    #[test]
    fn a_collision_lasts_as_long_as_foreseen() {
        let sets = ["law.gamma_n=0.0".to_string(), "law.gamma_t=0.0".to_string()];
        let scenario = crate::scenario::load("quick", &sets).unwrap();
        let (speed, dt) = (1.3, 1e-6);
        let (mass, kn) = (0.5 * sphere_mass(1.0, 1.0), normal_stiffness(&scenario));
        let (mut x, mut v, mut steps) = (0.0f64, speed, 0u64);
        while x >= 0.0 {
            // Half a kick, drift, half a kick would do no better: the step is a thousandth.
            v -= kn * (0.25 * x).sqrt() * x / mass * dt;
            x += v * dt;
            steps += 1;
        }
        let foreseen = contact_time(&scenario, speed);
        // The step over the duration, and the four digits of 2.943.
        assert!(
            (steps as f64 * dt / foreseen - 1.0).abs() < 2e-3,
            "{foreseen}"
        );
    }

    #[test]
    fn sizes_and_times_are_told_in_words() {
        assert_eq!(bytes(1.3e6), "1 MB");
        assert_eq!(duration(7200.0), "2.0 h");
    }
}
