//! What a campaign would take, before it runs: its members, their work in grain-steps, and the time.

use std::fmt::Write;

use super::only::Only;
use super::plan::Plan;
use crate::bed::{self, library::BedCache, recipe::Recipe};
use crate::forecast::{disk, side_by_side, trial};
use crate::scenario::{CheckedScenario, DragPlan};
use bitgrain_sim::error::Result;
use bitgrain_sim::format::short;

/// Grain-steps of a job that are counted as one, so that sums stay far below 2^64.
const GRAIN_STEPS: f64 = 1e6;

/// Speed of beds of that many grains and more, over that of a small bed: the rows of grains leave the
/// caches one after the other.
const LARGE: [(usize, f64); 3] = [(5_000, 0.85), (50_000, 0.7), (500_000, 0.6)];

/// The forecast of the wanted runs of a campaign as text: `jobs` stages side by side on this many threads, beds
/// from `library`.
///
/// # Errors
/// Errors of the trial of this machine's speed.
pub fn forecast(
    plan: &Plan,
    only: &Only,
    library: &BedCache,
    threads: usize,
    jobs: usize,
) -> Result<String> {
    let speed = trial(&plan.members[0].scenario)?;
    let mut out = head(plan);
    let mut say = |line: String| {
        out.push_str(&line);
        out.push('\n');
    };
    let mut recipes: Vec<String> = Vec::new();
    let (mut pours, mut drags) = (Vec::new(), Vec::new());
    let (mut bytes, mut count) = (0.0, 0);
    for member in &plan.members {
        let scenario = &member.scenario;
        let wanted = |run: &DragPlan| only.wants(&member.name, &run.name);
        let plans = scenario.drags().iter();
        let plans: Vec<DragPlan> = plans.filter(|run| wanted(run)).cloned().collect();
        if plans.is_empty() {
            continue;
        }
        let poured = pouring(scenario, library, &mut recipes)?;
        let runs = dragging(scenario, &plans);
        let grains = scenario
            .beds()
            .iter()
            .map(|b| scenario.grain_count(b.diameter))
            .max();
        let grains = grains.unwrap_or(0);
        let slower = slower(grains);
        let all = poured.iter().sum::<f64>() + runs.iter().sum::<f64>();
        say(format!(
            "{:<32} {grains:>8} {:>5} {:>14.0} {:>14.0} {:>9.2}",
            member.name,
            runs.len(),
            poured.iter().sum::<f64>() + 0.0, // an empty sum is -0
            runs.iter().sum::<f64>(),
            all * GRAIN_STEPS / (speed * slower) / 3600.0
        ));
        count += runs.len();
        bytes += disk(scenario, &plans, grains, scenario.beds().len());
        // As jobs, in thousandths of a million grain-steps on a small bed.
        let job = |work: &f64| (1000.0 * work / slower) as u64;
        pours.extend(poured.iter().map(job));
        drags.extend(runs.iter().map(job));
    }
    let whole =
        (pours.iter().sum::<u64>() + drags.iter().sum::<u64>()) as f64 / 1000.0 * GRAIN_STEPS;
    let side = jobs.min(threads).max(1);
    let longest = side_by_side(&pours, side) + side_by_side(&drags, side);
    // If there are fewer jobs than threads, a job runs on several at half their speed each.
    let gain = 1.0 + 0.5 * (threads as f64 / side as f64 - 1.0);
    let hours = longest as f64 / 1000.0 * GRAIN_STEPS / speed / gain / 3600.0;
    say(String::new());
    let mut line = |name: &str, value: String| {
        let _ = writeln!(out, "{name:<32} {value}");
    };
    line("runs", count.to_string());
    line("beds to pour", pours.len().to_string());
    line(
        "work",
        format!("{} G grain-steps of a small bed", short(whole * 1e-9)),
    );
    line("disk", format!("{:.1} GB", bytes * 1e-9));
    line(
        "speed of this machine",
        format!(
            "{:.1} million grain-steps/s (a settled bed of 500, one thread)",
            speed * 1e-6
        ),
    );
    line(
        "time",
        format!(
            "about {} on {threads} thread(s), {side} stages at a time",
            span(hours)
        ),
    );
    Ok(out)
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

/// Speed of a bed of this many grains, over that of the small one of the trial.
fn slower(grains: usize) -> f64 {
    let below = LARGE.iter().rev().find(|(least, _)| grains >= *least);
    below.map_or(1.0, |(_, part)| *part)
}
