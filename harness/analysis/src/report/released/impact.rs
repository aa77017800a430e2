//! Drops: the way down, the depth against the height, the force against the depth.

use super::super::plot::SHAPES;
use super::super::scatter::{Line, Mark, Range};
use super::super::table::Table;
use super::super::text::{brief, escape, typeset};
use super::curves::{Chart, Named, section};
use crate::fit::Fit;
use crate::released::FreeRun;
use crate::released::impact::{
    Drop, ForceLaw, UEHARA, density_ratio, depth_cube_root, depth_power, drops, force_law,
    friction_of_depths,
};
use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::{number_with_error, short};
use bitgrain_sim::units::Units;

/// Parts of the highest speed at which the force is shown against the depth, and how far a row may be off.
const SPEEDS: [f64; 4] = [0.75, 0.5, 0.3, 0.15];
const NEAR: f64 = 0.12;

/// The mass of the sphere.
fn mass(runs: &[FreeRun<'_>]) -> f64 {
    runs.first().map_or(f64::NAN, |free| free.released.mass)
}

/// What was found, in a sentence or two.
pub(super) fn lead(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let drops = drops(summary, runs);
    let unit = escape(&typeset(&summary.units.length));
    let ends = |of: fn(&Drop) -> f64| {
        let all = || drops.iter().map(of);
        let [low, high] = [
            all().fold(f64::INFINITY, f64::min),
            all().fold(f64::NEG_INFINITY, f64::max),
        ];
        format!("{} to {}&nbsp;{unit}", short(low), short(high))
    };
    let power = match depth_power(&drops) {
        Ok(fit) => format!(
            " The depth grows as the total drop to the power of {}.",
            value(&fit, 1)
        ),
        Err(why) => format!(" No power of the total drop was found: {}.", escape(&why.0)),
    };
    format!(
        "was dropped from {}, and its lowest point came to lie {} below the surface.{power}",
        ends(|drop| drop.height),
        ends(|drop| drop.depth)
    )
}

fn value(fit: &Fit, k: usize) -> String {
    let number = &fit.parameters[k];
    number_with_error(number.value, number.error)
}

/// All sections of drops.
pub(super) fn sections(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let drops = drops(summary, runs);
    let law = force_law(&drops, mass(runs)).map_err(|why| why.to_string());
    way(summary, runs, &drops)
        + &depths(summary, &drops, law.as_ref().ok())
        + &forces(summary, &drops, law.as_ref())
        + &table(summary, &drops)
}

/// Height and speed against time.
fn way(summary: &Summary, runs: &[FreeRun<'_>], drops: &[Drop]) -> String {
    let units = &summary.units;
    let curves = |of: &dyn Fn(&FreeRun<'_>, &SeriesRow) -> Option<f64>| -> Vec<Named> {
        let curve = |(free, drop): (&FreeRun<'_>, &Drop)| {
            let points = free
                .rows
                .iter()
                .filter_map(|row| Some((row.time, of(free, row)?)));
            (format!("from {}", short(drop.height)), points.collect())
        };
        runs.iter().zip(drops).map(curve).collect()
    };
    let height = curves(&|free, row| {
        let lowest = row.body?.place[2] - 0.5 * free.run.diameter;
        Some(lowest - free.released.surface)
    });
    let speed = curves(&|_, row| Some(row.body?.velocity[2]));
    let time = format!("time ({})", typeset(&units.time));
    let chart = |title, y: String, caption: &str| Chart {
        title,
        labels: [time.clone(), y],
        ranges: [Range::FromZero; 2],
        caption: caption.to_owned(),
    };
    let figures = chart(
        "Height against time",
        format!(
            "lowest point above the surface ({})",
            typeset(&units.length)
        ),
        "Height of the sphere&rsquo;s lowest point above the free surface of the settled bed.",
    )
    .curves(&height)
        + &chart(
            "Vertical velocity against time",
            format!("vertical velocity ({})", typeset(&units.speed)),
            "Upward velocity of the sphere&rsquo;s centre.",
        )
        .curves(&speed);
    let words = format!(
        "<p>Each sphere begins a tenth of d above the first grain that it will touch, with the speed of a fall from \
         rest whose lowest point began at the height named ({}).</p>\n",
        escape(&typeset(&units.length))
    );
    section("The way down", &words, &figures)
}

/// Depth against the total drop.
fn depths(summary: &Summary, drops: &[Drop], law: Option<&ForceLaw>) -> String {
    let unit = typeset(&summary.units.length);
    let mark = |drop: &Drop| Mark {
        hollow: drop.rest.is_none(),
        ..Mark::bare((drop.total(), drop.depth), 0)
    };
    let mut marks: Vec<Mark> = drops.iter().map(mark).collect();
    let gravity = summary.inputs.gravity;
    let by_law = law.iter().flat_map(|law| {
        drops.iter().filter_map(|drop| {
            let depth = law.stops_at(drop.speed, gravity)?;
            Some(Mark::bare((drop.height + depth, depth), 7))
        })
    });
    marks.extend(by_law);
    let ends = [f64::min, f64::max]
        .map(|pick: fn(f64, f64) -> f64| drops.iter().map(Drop::total).reduce(pick).unwrap_or(1.0));
    let line = |of: &dyn Fn(f64) -> f64, heavy| Line {
        points: ends.map(|x| (x, of(x))).into(),
        heavy,
    };
    let (power, root) = (depth_power(drops), depth_cube_root(drops));
    let mut lines = Vec::new();
    let mut words = String::from("<p>");
    match &power {
        Ok(fit) => {
            let [a, p] = [0, 1].map(|k| fit.parameters[k].value);
            lines.push(line(&|x| a * libm::pow(x, p), false));
            words += &format!(
                "Depth = A H<sup>p</sup>: A = {}, p = {} (thin line). ",
                value(fit, 0),
                value(fit, 1)
            );
        }
        Err(why) => words += &format!("No power is fitted: {}. ", escape(&why.0)),
    }
    if let Ok(fit) = &root {
        let a = fit.parameters[0].value;
        lines.push(line(&|x| a * libm::cbrt(x), true));
        let ratio = density_ratio(summary);
        let diameter = drops.first().map_or(f64::NAN, |drop| drop.diameter);
        words += &format!(
            "With the power held at one third, A = {} (thick line). Uehara et al. (2003) find \
             {UEHARA} (&rho;<sub>s</sub>/&rho;)<sup>1/2</sup> D<sup>2/3</sup>/&mu; for A, &rho; the bulk density and \
             &mu; the tangent of the angle of repose: that gives this A at &mu; = {}. ",
            value(fit, 0),
            short(friction_of_depths(a, diameter, ratio))
        );
    }
    words += "Errors are from the scatter of the points alone.</p>\n";
    let chart = Chart {
        title: "Depth against the total drop",
        labels: [
            format!("total drop H ({unit})"),
            format!("depth of the lowest point ({unit})"),
        ],
        ranges: [Range::Ratios; 2],
        caption: "H is the height of the fall and the depth together. Circles: as measured, hollow if the sphere still \
                  moved at the end. Hourglasses: by the force law below."
            .to_owned(),
    };
    section(
        "Depth against height",
        &words,
        &chart.figure(&[], &marks, &lines),
    )
}

/// Force against depth at some speeds, with the law.
fn forces(summary: &Summary, drops: &[Drop], law: Result<&ForceLaw, &String>) -> String {
    let units = &summary.units;
    let title = "The force that stops it";
    let law = match law {
        Ok(law) => law,
        Err(why) => {
            let words = format!("<p class=\"none\">No law is fitted: {}.</p>\n", escape(why));
            return section(title, &words, "");
        }
    };
    let fastest = drops.iter().map(|drop| drop.speed).fold(0.0, f64::max);
    let speeds = SPEEDS.map(|part| part * fastest);
    let (mut marks, mut lines, mut names) = (Vec::new(), Vec::new(), Vec::new());
    for (k, speed) in speeds.into_iter().enumerate() {
        let mut deepest = 0.0f64;
        for drop in drops {
            let near = |speeds: f64| (speeds / speed - 1.0).abs() < NEAR;
            let rows: Vec<_> = drop.stops.iter().filter(|s| near(s.speed)).collect();
            if rows.is_empty() {
                continue;
            }
            let n = rows.len() as f64;
            let depth = rows.iter().map(|s| s.depth).sum::<f64>() / n;
            let force = rows.iter().map(|s| s.force).sum::<f64>() / n;
            deepest = deepest.max(depth);
            marks.push(Mark::bare((depth, force), k % SHAPES));
        }
        let at = |depth: f64| (depth, law.at(depth, speed));
        lines.push(Line {
            points: vec![at(0.0), at(deepest)],
            heavy: false,
        });
        names.push(format!("v = {}", short(speed)));
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let chart = Chart {
        title: "Force against depth",
        labels: [
            format!("depth z ({})", typeset(&units.length)),
            format!("upward force F ({})", typeset(&units.force)),
        ],
        ranges: [Range::FromZero; 2],
        caption: format!(
            "Means over the rows of each drop whose speed is within {} % of the one named ({}); lines: the law at that \
             speed.",
            short(100.0 * NEAR),
            escape(&typeset(&units.speed))
        ),
    };
    section(
        title,
        &law_words(summary, drops, law, units),
        &chart.figure(&names, &marks, &lines),
    )
}

fn law_words(summary: &Summary, drops: &[Drop], law: &ForceLaw, units: &Units) -> String {
    let diameter = drops.first().map_or(f64::NAN, |drop| drop.diameter);
    let weight = law.mass * summary.inputs.gravity;
    let [force, length] = [&units.force, &units.length].map(|unit| escape(&typeset(unit)));
    format!(
        "<p>Katsuragi and Durian (2007) write the force on a sphere whose lowest point is at depth z as \
         F = k z + (m/d<sub>1</sub>) v<sup>2</sup>. Least squares over all {} rows of all drops, from the surface to \
         the first rest, give k = {}&nbsp;{force}/{length} and d<sub>1</sub> = {}&nbsp;{length}, or \
         k D/(m g) = {} and d<sub>1</sub>/D = {}. Rows of one drop are not independent: errors are those of \
         leaving out one drop after the other. What the rows have beside the law is {} of the force \
         (root mean squares): most of it comes and goes with single contacts.</p>\n",
        law.rows,
        number_with_error(law.k[0], law.k[1]),
        number_with_error(law.length[0], law.length[1]),
        short(law.k[0] * diameter / weight),
        short(law.length[0] / diameter),
        short(law.residual / law.force),
    )
}

/// The numbers of each drop.
fn table(summary: &Summary, drops: &[Drop]) -> String {
    let units = &summary.units;
    let mut t = Table::new("Drops", drops, |drop: &Drop| &drop.name);
    let note = "of its lowest point above the surface as it began to fall";
    t.row("Height", &units.length, note, |drop| brief(drop.height));
    t.row(
        "Speed",
        &units.speed,
        "of the fall at the surface",
        |drop| brief(drop.speed),
    );
    let note = "of its lowest point below the surface at the end";
    t.row("Depth", &units.length, note, |drop| brief(drop.depth));
    t.row("Total drop", &units.length, "height and depth", |drop| {
        brief(drop.total())
    });
    let note = "kinetic energy below 1e-4 m g d from then on; a dash: it moved at the end";
    t.row("At rest since", &units.time, note, |drop| {
        drop.rest.map_or("\u{2014}".to_owned(), brief)
    });
    format!("<section>\n<h2>Drops</h2>\n{}</section>\n", t.finish())
}
