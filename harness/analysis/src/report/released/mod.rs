//! The page of spheres that forces move: dropped on a bed, pulled through it, or dragged and free to rise.

mod curves;
mod float;
mod impact;
mod pull;

use super::drawings::Drawings;
use super::page::{Top, assembled};
use super::sections::{numbers, repeat, span};
use super::text::{escape, typeset};
use super::{before, inputs, picture, scene};
use crate::released::{FreeRun, free_runs};
use bitgrain_lab::scenario::IntruderMotion;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::short;

/// One self-contained HTML page of runs whose intruders forces move.
pub fn released_page(summary: &Summary, scenario_text: &str, drawings: &Drawings<'_>) -> String {
    let runs = free_runs(summary, drawings.series);
    let mut out = match summary.inputs.intruder.motion {
        IntruderMotion::Dropped => impact::sections(summary, &runs),
        IntruderMotion::Pulled => pull::sections(summary, &runs),
        _ => float::sections(summary, &runs),
    };
    out.push_str(&pictures(summary, drawings));
    out.push_str(&scene::section(summary, drawings.scene));
    out.push_str(&numbers(summary, "", ""));
    out.push_str(&inputs::section(scenario_text, &summary.units));
    out.push_str(&repeat(summary, scenario_text));
    let kind = match summary.inputs.intruder.motion {
        IntruderMotion::Dropped => "A sphere dropped on a bed of grains",
        IntruderMotion::Pulled => "A sphere pulled through a bed of grains by a constant force",
        _ => "A sphere dragged through a bed of grains, free to rise",
    };
    let top = Top {
        name: &summary.scenario,
        kind,
        style: "",
        lead: lead(summary, &runs),
        remarks: before::remarks(summary),
        about: before::about(summary, drawings.closing),
    };
    assembled(&top, &out)
}

/// The main numbers as a paragraph.
fn lead(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let (units, inputs) = (&summary.units, &summary.inputs);
    let mass = runs.first().map_or(f64::NAN, |free| free.released.mass);
    let found = match inputs.intruder.motion {
        IntruderMotion::Dropped => impact::lead(summary, runs),
        IntruderMotion::Pulled => pull::lead(summary, runs),
        _ => float::lead(summary, runs),
    };
    format!(
        "<p class=\"lead\">{} of {} grains, free surface at height {}, packing fraction {}. A sphere of diameter {} \
         and mass {} {} {found} Errors are standard errors.</p>\n",
        match summary.beds.len() {
            1 => "A bed".to_owned(),
            n => format!("{n} beds"),
        },
        span(summary.beds.iter().map(|bed| bed.grains as f64), ""),
        span(summary.beds.iter().map(|bed| bed.surface), &units.length),
        span(summary.beds.iter().map(|bed| bed.packing_fraction), ""),
        span(runs.iter().map(|free| free.run.diameter), &units.length),
        short(mass),
        match inputs.units {
            bitgrain_lab::scenario::UnitSystem::Reduced => "&rho;&nbsp;d&sup3;",
            bitgrain_lab::scenario::UnitSystem::Si => "kg",
        },
    )
}

/// Slices of the beds, and of the last state of each run.
fn pictures(summary: &Summary, drawings: &Drawings<'_>) -> String {
    let unit = &summary.units.length;
    let all = drawings.beds.iter().chain(drawings.ends).enumerate();
    let mut figures = String::new();
    for (k, bed) in all {
        let Some(svg) = picture::slice(bed, unit, k) else {
            continue;
        };
        let what = match k < drawings.beds.len() {
            true => "settled",
            false => "at its end",
        };
        let y = short(bed.intruder.0[1]);
        figures.push_str(&format!(
            "<figure>{svg}<figcaption><b>{}</b>, {what}; slice at y&nbsp;=&nbsp;{y}&nbsp;{}.</figcaption></figure>\n",
            escape(&bed.name),
            escape(&typeset(unit)),
        ));
    }
    format!(
        "<section>\n<h2>Before and after</h2>\n<p>Slices through the sphere&rsquo;s centre, to scale: each circle is \
         the cut of one grain, so cuts off centre are small. Hatched: frozen base. Dashed: the free surface of the \
         settled bed. The box repeats along x and y.</p>\n<div class=\"grid\">\n{figures}</div>\n</section>\n"
    )
}
