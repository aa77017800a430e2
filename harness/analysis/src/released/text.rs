//! What runs with intruders that forces moved say, as text.

use std::fmt::Write;

use super::float;
use super::impact::{self, Drop};
use super::pull::{self, Pull};
use super::runs::free_runs;
use crate::fit::{Fit, Refusal};
use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::{number_with_error, short};

/// Everything found of them, to be read; empty without any. `series` has the rows of the summary's runs.
pub fn text(summary: &Summary, series: &[Vec<SeriesRow>]) -> String {
    let runs = free_runs(summary, series);
    let mut out = String::new();
    let drops = impact::drops(summary, &runs);
    if !drops.is_empty() {
        let mass = runs.first().map_or(f64::NAN, |free| free.released.mass);
        impacts(summary, &drops, mass, &mut out);
    }
    pulled(summary, &pull::pulls(summary, &runs), &mut out);
    floating(&float::floats(summary, &runs), &mut out);
    out
}

/// Writing into a string cannot fail.
fn line(out: &mut String, text: &str) {
    let _ = writeln!(out, "{}", text.trim_end());
}

fn found(fit: Result<Fit, Refusal>) -> String {
    fit.map_or_else(|why| format!("none: {why}"), |fit| fit.line())
}

fn impacts(summary: &Summary, drops: &[Drop], mass: f64, out: &mut String) {
    let unit = &summary.units.length;
    line(
        out,
        &format!(
            "{:<10} {:>10} {:>10} {:>10} {:>10}",
            "drop",
            format!("from ({unit})"),
            "speed",
            "depth",
            "at rest"
        ),
    );
    for drop in drops {
        let rest = drop.rest.map_or("no".to_owned(), short);
        line(
            out,
            &format!(
                "{:<10} {:>10} {:>10} {:>10} {rest:>10}",
                drop.name,
                short(drop.height),
                short(drop.speed),
                short(drop.depth)
            ),
        );
    }
    let power = impact::depth_power(drops);
    line(out, &format!("depth = A H^p: {}", found(power)));
    let root = impact::depth_cube_root(drops);
    if let Ok(fit) = &root {
        let ratio = impact::density_ratio(summary);
        let mu = impact::friction_of_depths(fit.parameters[0].value, drops[0].diameter, ratio);
        line(
            out,
            &format!("friction with which Uehara's law has this A: {}", short(mu)),
        );
    }
    line(out, &format!("depth = A H^(1/3): {}", found(root)));
    match impact::force_law(drops, mass) {
        Err(why) => line(out, &format!("F = k z + (m/d_1) v^2: none: {why}")),
        Ok(law) => {
            let gravity = summary.inputs.gravity;
            let diameter = drops[0].diameter;
            line(
                out,
                &format!(
                    "F = k z + (m/d_1) v^2: k = {}, d_1 = {}; k D/(m g) = {}, d_1/D = {}",
                    number_with_error(law.k[0], law.k[1]),
                    number_with_error(law.length[0], law.length[1]),
                    short(law.k[0] * diameter / (mass * gravity)),
                    short(law.length[0] / diameter)
                ),
            );
            line(
                out,
                &format!(
                    "{} rows, residual {} of the force (root mean squares)",
                    law.rows,
                    short(law.residual / law.force)
                ),
            );
            for drop in drops {
                let stops = law.stops_at(drop.speed, gravity);
                let stops = stops.map_or("none".to_owned(), short);
                let depth = short(drop.depth);
                line(
                    out,
                    &format!("{:<10} depth {depth}, by this law {stops}", drop.name),
                );
            }
        }
    }
}

fn pulled(summary: &Summary, pulls: &[Pull], out: &mut String) {
    if pulls.is_empty() {
        return;
    }
    line(
        out,
        &format!(
            "{:<10} {:>10} {:>10} {:>10} {:>12}  regime",
            "pull", "force", "travel", "later", "later speed"
        ),
    );
    for pull in pulls {
        let wake = if pull.wake { ", in its own wake" } else { "" };
        line(
            out,
            &format!(
                "{:<10} {:>10} {:>10.3} {:>10.3} {:>12.4}  {}{wake}",
                pull.name,
                short(pull.force),
                pull.travel,
                pull.late,
                pull.speed,
                pull.regime.word()
            ),
        );
    }
    let force = &summary.units.force;
    let between = match pull::bracket(pulls) {
        Some([least, most]) => format!("between {} and {} {force}", short(least), short(most)),
        None => "not enclosed: some pull must creep and some run".to_owned(),
    };
    line(out, &format!("yield force by force: {between}"));
    if let Some(slow) = pull::slowest(summary) {
        line(
            out,
            &format!(
                "drag at the lowest constant speed, {}: {} {force}",
                short(slow.speed),
                number_with_error(slow.drag.mean, slow.drag.standard_error)
            ),
        );
    }
}

fn floating(floats: &[float::Float], out: &mut String) {
    let Some(first) = floats.first() else {
        return;
    };
    line(
        out,
        &format!(
            "weight {}, buoyancy {}",
            short(first.weight),
            short(first.buoyancy)
        ),
    );
    line(
        out,
        &format!(
            "{:<12} {:>8} {:>18} {:>10} {:>10} {:>10} {:>10}",
            "float", "speed", "lift if held", "points", "foretold", "rise", "found"
        ),
    );
    for float in floats {
        let lift = number_with_error(float.lift.mean, float.lift.standard_error);
        line(
            out,
            &format!(
                "{:<12} {:>8} {lift:>18} {:>10} {:>10} {:>10.3} {:>10}",
                float.name,
                short(float.speed),
                float.points.word(),
                float.foretold.word(),
                float.rise,
                float.found.word()
            ),
        );
    }
}
