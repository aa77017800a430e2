//! Pulls: speed and travel against time for each force, and the yield force.

use super::super::plot::SHAPES;
use super::super::scatter::{Line, Mark, Range};
use super::super::table::Table;
use super::super::text::{brief, escape, plus_minus, typeset};
use super::curves::{Chart, Named, section};
use crate::released::FreeRun;
use crate::released::pull::{Pull, Regime, bracket, pulls, slowest};
use bitgrain_lab::scenario::Release;
use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::short;

/// Rows over which speeds are averaged for the chart, over all of a pull.
const SMOOTH: usize = 60;

/// What was found, in a sentence or two.
pub(super) fn lead(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let pulls = pulls(summary, runs);
    let unit = escape(&typeset(&summary.units.force));
    let names = |regime: Regime| {
        let own = pulls.iter().filter(|pull| pull.regime == regime);
        let forces: Vec<String> = own.map(|pull| short(pull.force)).collect();
        match forces.is_empty() {
            true => "at none".to_owned(),
            false => format!("at {}", forces.join(", ")),
        }
    };
    let by_force = match bracket(&pulls) {
        Some([least, most]) => format!(
            " The yield force lies between {} and {}&nbsp;{unit}",
            short(least),
            short(most)
        ),
        None => " The yield force is not enclosed by these forces".to_owned(),
    };
    let by_speed = match slowest(summary) {
        Some(slow) => format!(
            "; the drag on the same sphere at the constant speed {} is {}&nbsp;{unit}.",
            short(slow.speed),
            plus_minus(slow.drag)
        ),
        None => ".".to_owned(),
    };
    format!(
        "was pulled along x by constant forces: it crept {}, yielded and stopped {}, and ran {}&nbsp;{unit}.{by_force}\
         {by_speed}",
        names(Regime::Creeping),
        names(Regime::Yielding),
        names(Regime::Running)
    )
}

/// All sections of pulls.
pub(super) fn sections(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let pulls = pulls(summary, runs);
    against_time(summary, runs) + &against_force(summary, &pulls) + &table(summary, &pulls)
}

/// Means over so many rows.
fn smoothed(rows: &[SeriesRow], of: impl Fn(&SeriesRow) -> Option<f64>) -> Vec<(f64, f64)> {
    let apart = rows.len().div_ceil(SMOOTH).max(1);
    let mean = |rows: &[SeriesRow]| {
        let values: Vec<f64> = rows.iter().filter_map(&of).collect();
        let n = values.len() as f64;
        Some((rows.last()?.time, values.iter().sum::<f64>() / n))
    };
    rows.chunks(apart).filter_map(mean).collect()
}

fn against_time(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let units = &summary.units;
    let pulled: Vec<(f64, &FreeRun<'_>)> = runs
        .iter()
        .filter_map(|free| match free.release {
            Release::Pulled { force, .. } => Some((force, free)),
            _ => None,
        })
        .collect();
    let curves = |of: &dyn Fn(&FreeRun<'_>) -> Vec<(f64, f64)>| -> Vec<Named> {
        let named =
            |(force, free): &(f64, &FreeRun<'_>)| (format!("F = {}", short(*force)), of(free));
        pulled.iter().map(named).collect()
    };
    let speed = curves(&|free| smoothed(free.rows, |row| Some(row.body?.velocity[0])));
    let travel = curves(&|free| {
        free.rows
            .iter()
            .map(|row| (row.time, row.distance))
            .collect()
    });
    let chart = |title, y: String, caption: &str| Chart {
        title,
        labels: [format!("time ({})", typeset(&units.time)), y],
        ranges: [Range::FromZero; 2],
        caption: caption.to_owned(),
    };
    let figures = chart(
        "Speed against time",
        format!("speed along x ({})", typeset(&units.speed)),
        "Means over a sixtieth of each pull.",
    )
    .curves(&speed)
        + &chart(
            "Travel against time",
            format!("travel ({})", typeset(&units.length)),
            "Travel of the sphere&rsquo;s centre along x.",
        )
        .curves(&travel);
    let how = match summary.inputs.intruder.rises {
        true => "along x and z",
        false => "along x alone",
    };
    let spin = match summary.inputs.intruder.spins {
        true => "and spins freely",
        false => "and does not spin",
    };
    let words = format!(
        "<p>The sphere is free {how} {spin}. Forces F in {}.</p>\n",
        escape(&typeset(&units.force))
    );
    section("Against time", &words, &figures)
}

/// Late speed against the force, with the drags at constant speed.
fn against_force(summary: &Summary, pulls: &[Pull]) -> String {
    let units = &summary.units;
    let mark = |pull: &Pull| Mark {
        hollow: pull.regime != Regime::Running,
        ..Mark::bare((pull.force, pull.speed), 0)
    };
    let mut marks: Vec<Mark> = pulls.iter().map(mark).collect();
    let held = summary.runs.iter().filter(|run| run.released.is_none());
    marks.extend(held.map(|run| Mark::bare((run.drag.mean, run.speed), 1 % SHAPES)));
    let top = marks.iter().map(|mark| mark.at.1).fold(0.0, f64::max);
    let ends = bracket(pulls).into_iter().flatten();
    let lines: Vec<Line> = ends
        .map(|force| Line {
            points: vec![(force, 0.0), (force, top)],
            heavy: false,
        })
        .collect();
    let chart = Chart {
        title: "Speed against force",
        labels: [
            format!("force ({})", typeset(&units.force)),
            format!("speed ({})", typeset(&units.speed)),
        ],
        ranges: [Range::FromZero; 2],
        caption: "Circles: mean speed in the second half of each pull, hollow if it went less than a grain&rsquo;s \
                  diameter in it. Squares: the mean drag at constant speed. Thin lines enclose the yield force."
            .to_owned(),
    };
    let words = "<p>At a constant force the sphere stops wherever the bed resists more than that, at the peaks of its \
                 drag; at constant speed it goes through them, and the mean drag is measured. So a sphere may stop at \
                 a force above the mean drag.</p>\n";
    let names = ["pulled", "dragged"];
    section(
        "The yield force",
        words,
        &chart.figure(&names, &marks, &lines),
    )
}

fn table(summary: &Summary, pulls: &[Pull]) -> String {
    let units = &summary.units;
    let mut t = Table::new("Pulls", pulls, |pull: &Pull| &pull.name);
    t.row("Force", &units.force, "along x", |pull| brief(pull.force));
    t.row("Travel", &units.length, "in all", |pull| brief(pull.travel));
    t.row("Late travel", &units.length, "in the second half", |pull| {
        brief(pull.late)
    });
    t.row("Late speed", &units.speed, "mean over that", |pull| {
        brief(pull.speed)
    });
    let note =
        "creeping: less than d in all; yielding: less than d in the second half; else running";
    t.row("Regime", "", note, |pull| pull.regime.word().to_owned());
    t.row("Own wake", "", "whether it went beyond the box", |pull| {
        if pull.wake { "yes" } else { "no" }.to_owned()
    });
    format!("<section>\n<h2>Pulls</h2>\n{}</section>\n", t.finish())
}
