//! What a campaign would take, before it runs: its members, their work in grain-steps, and the time.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use super::folder::CampaignFolder;
use super::only::Only;
use super::plan::Plan;
use crate::bed::{self, library::BedCache, recipe::Recipe};
use crate::folder::Folder;
use crate::forecast::{TRIAL_GRAINS, side_by_side, space, trial};
use crate::pace::{StageKind, gain, of_small};
use crate::scenario::{CheckedScenario, DragPlan};
use bitgrain_sim::disk;
use bitgrain_sim::error::Result;
use bitgrain_sim::format::short;

/// Grain-steps of a job that are counted as one, so that sums stay far below 2^64.
const GRAIN_STEPS: f64 = 1e6;

/// Hours that stages take, so many side by side, at a speed of a small bed.
fn hours_of(jobs: &[u64], side: usize, speed: f64) -> f64 {
    side_by_side(jobs, side) as f64 / 1000.0 * GRAIN_STEPS / speed / 3600.0
}

/// What is left of a campaign.
struct Left {
    /// A line for each member.
    text: String,
    /// Beds to pour and drags to do, as thousandths of a million grain-steps of a small bed.
    pours: Vec<u64>,
    drags: Vec<u64>,
    /// Million grain-steps of all of them.
    work: f64,
    bytes: f64,
    /// Drags that are done.
    done: usize,
}

/// The forecast of the wanted runs of a campaign that are not done in the folder `out`, as text: `jobs` stages side by
/// side on this many threads, beds from `library`. If stages went in that folder before, the time is by their speed.
///
/// # Errors
/// Errors of the trial of this machine's speed.
pub fn forecast(
    plan: &Plan,
    only: &Only,
    out: &Path,
    library: &BedCache,
    threads: usize,
    jobs: usize,
) -> Result<String> {
    let speed = trial(&plan.members[0].scenario)?;
    let pace = CampaignFolder(out).pace();
    let measured = [StageKind::Pouring, StageKind::Dragging].map(|kind| pace.speed(kind));
    let [pouring, dragging] = measured.map(|measured| measured.unwrap_or(speed));
    // A bed that takes more steps than planned is poured so much more slowly.
    let speeds = [pouring / pace.of_plan(), dragging];
    let left = left(plan, only, CampaignFolder(out), library, speeds)?;
    let side = jobs.min(threads).max(1);
    let hours = hours_of(&left.pours, side, speeds[0]) + hours_of(&left.drags, side, speeds[1]);
    // If there are fewer jobs than threads, a job runs on several.
    let hours = hours / gain(threads as f64 / side as f64);
    let mut text = head(plan) + &left.text + "\n";
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<32} {value}");
    };
    let done = match left.done {
        0 => String::new(),
        n => format!(" ({n} are done)"),
    };
    line("runs", format!("{}{done}", left.drags.len()));
    line("beds to pour", left.pours.len().to_string());
    line(
        "work",
        format!("{} G grain-steps", short(left.work * GRAIN_STEPS * 1e-9)),
    );
    line("disk", format!("{:.1} GB", left.bytes * 1e-9));
    let million = |speed: f64| format!("{:.1} million grain-steps/s", speed * 1e-6);
    line(
        "speed of this machine",
        format!(
            "{} (a settled bed of {TRIAL_GRAINS}, one thread)",
            million(speed)
        ),
    );
    if let [Some(pouring), Some(dragging)] = measured {
        line(
            "speed in this folder so far",
            format!(
                "pouring {}, dragging {} (of a small bed, one thread)",
                million(pouring),
                million(dragging)
            ),
        );
    }
    line(
        "time",
        format!(
            "about {} on {threads} thread(s), {side} stages at a time",
            span(hours)
        ),
    );
    Ok(text)
}

/// What is left to do in a folder, at these speeds of pouring and dragging a small bed.
fn left(
    plan: &Plan,
    only: &Only,
    folder: CampaignFolder<'_>,
    library: &BedCache,
    speeds: [f64; 2],
) -> Result<Left> {
    let mut left = Left {
        text: String::new(),
        pours: Vec::new(),
        drags: Vec::new(),
        work: 0.0,
        bytes: 0.0,
        done: 0,
    };
    let mut recipes: Vec<String> = Vec::new();
    for member in &plan.members {
        let scenario = &member.scenario;
        let wanted = |run: &DragPlan| only.wants(&member.name, &run.name);
        let plans = scenario.drags().iter();
        let mut plans: Vec<DragPlan> = plans.filter(|run| wanted(run)).cloned().collect();
        let asked = plans.len();
        plans.retain(|run| {
            let places = [
                folder.member(&member.name),
                folder.task(&member.name, &run.name),
            ];
            let done = |place: &PathBuf| Folder(place).of_run(&run.name, "summary.json");
            !places.iter().any(|place| disk::is_there(&done(place)))
        });
        left.done += asked - plans.len();
        if plans.is_empty() {
            continue;
        }
        let poured = pouring(scenario, library, &mut recipes)?;
        let runs = dragging(scenario, &plans);
        let sizes = scenario.beds().iter();
        let sizes = sizes.map(|bed| scenario.grain_count(bed.diameter));
        let grains = sizes.max().unwrap_or(0);
        // An empty sum is -0.
        let [pours, drags] = [&poured, &runs].map(|work| work.iter().sum::<f64>() + 0.0);
        let _ = writeln!(
            left.text,
            "{:<32} {grains:>8} {:>5} {pours:>14.0} {drags:>14.0} {:>9.2}",
            member.name,
            runs.len(),
            of_small(pours / speeds[0] + drags / speeds[1], grains) * GRAIN_STEPS / 3600.0
        );
        left.bytes += space(scenario, &plans, grains, scenario.beds().len());
        left.work += pours + drags;
        let job = |work: &f64| (1000.0 * of_small(*work, grains)) as u64;
        left.pours.extend(poured.iter().map(job));
        left.drags.extend(runs.iter().map(job));
    }
    Ok(left)
}

/// The campaign's name, and over its members what their columns are.
fn head(plan: &Plan) -> String {
    let columns = |names: [&str; 6]| {
        let [member, grains, count, bed, runs, hours] = names;
        format!("{member:<32} {grains:>8} {count:>5} {bed:>14} {runs:>14} {hours:>9}\n")
    };
    format!(
        "campaign {}: {} members\n\n{}{}",
        plan.campaign.name,
        plan.members.len(),
        columns(["member", "grains", "runs", "bed", "runs", "hours"]),
        columns(["", "", "", "M grain-steps", "M grain-steps", "1 thread"]),
    )
}

fn span(hours: f64) -> String {
    match hours {
        h if h < 1.5 => format!("{:.0} minutes", 60.0 * h),
        h if h < 72.0 => format!("{h:.1} hours"),
        h => format!("{:.0} days", h / 24.0),
    }
}

/// Million grain-steps of each bed that is not at hand; a recipe counts once.
fn pouring(
    scenario: &CheckedScenario,
    library: &BedCache,
    recipes: &mut Vec<String>,
) -> Result<Vec<f64>> {
    let mut work = Vec::new();
    if scenario.source.is_some() {
        return Ok(work);
    }
    for bed in scenario.beds() {
        let recipe = Recipe::new(scenario, bed);
        let digest = recipe.digest();
        if library.has(&recipe) || recipes.contains(&digest) {
            continue;
        }
        recipes.push(digest);
        let grains = scenario.grain_count(bed.diameter) as f64;
        work.push(bed::pouring_steps(scenario, bed) as f64 * grains / GRAIN_STEPS);
    }
    Ok(work)
}

/// Million grain-steps of each drag.
fn dragging(scenario: &CheckedScenario, runs: &[DragPlan]) -> Vec<f64> {
    let beds = scenario.beds();
    runs.iter()
        .map(|run| {
            let grains = scenario.grain_count(beds[run.bed].diameter) as f64;
            run.steps() as f64 * grains / GRAIN_STEPS
        })
        .collect()
}
