//! Spheres free to rise: height against time, and lift against weight.

use super::super::plot::SHAPES;
use super::super::scatter::{Line, Mark, Range};
use super::super::table::Table;
use super::super::text::{brief, escape, plus_minus, typeset};
use super::curves::{Chart, Named, section};
use crate::released::FreeRun;
use crate::released::float::{Float, Way, floats};
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::short;

/// What was found, in a sentence or two.
pub(super) fn lead(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let all = floats(summary, runs);
    let sure: Vec<&Float> = all
        .iter()
        .filter(|float| float.foretold != Way::Open)
        .collect();
    let right = sure
        .iter()
        .filter(|float| float.found == float.foretold)
        .count();
    let count = |way: Way| all.iter().filter(|float| float.found == way).count();
    let weight = all.first().map_or(f64::NAN, |float| float.weight);
    let buoyancy = all.first().map_or(f64::NAN, |float| float.buoyancy);
    let unit = escape(&typeset(&summary.units.force));
    format!(
        "(weight {}&nbsp;{unit}, buoyancy {}&nbsp;{unit}) was dragged along x, held in its height and free along z: \
         of {} free drags it rose in {} and sank in {}. The lift on the held sphere differs from the weight by more \
         than two standard errors in {} of them, and {right} of these went as it says; without regard to \
         errors {} of all did.",
        short(weight),
        short(buoyancy),
        all.len(),
        count(Way::Rises),
        count(Way::Sinks),
        sure.len(),
        all.iter()
            .filter(|float| float.found == float.points)
            .count()
    )
}

/// All sections of floating drags.
pub(super) fn sections(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let all = floats(summary, runs);
    heights(summary, runs) + &lifts(summary, &all) + &table(summary, &all)
}

/// Height against travel.
fn heights(summary: &Summary, runs: &[FreeRun<'_>]) -> String {
    let units = &summary.units;
    let curve = |free: &FreeRun<'_>| -> Named {
        let depth = |z: f64| free.released.surface - z;
        let rows = free.rows.iter();
        let points = rows.filter_map(|row| Some((row.distance, -depth(row.body?.place[2]))));
        let name = format!("{}, V = {}", escape(&free.run.name), short(free.run.speed));
        (name, points.collect())
    };
    let curves: Vec<Named> = runs.iter().map(curve).collect();
    let chart = |title, x: &str| Chart {
        title,
        labels: [
            x.to_owned(),
            format!("centre above the surface ({})", typeset(&units.length)),
        ],
        ranges: [Range::FromZero, Range::Tight],
        caption: "Height of the sphere&rsquo;s centre above the free surface of the settled bed."
            .to_owned(),
    };
    let timed = |free: &FreeRun<'_>| -> Named {
        let (name, points) = curve(free);
        let per = 1.0 / free.run.speed;
        (name, points.iter().map(|(x, z)| (x * per, *z)).collect())
    };
    let times: Vec<Named> = runs.iter().map(timed).collect();
    let figures = chart(
        "Height against time",
        &format!("time ({})", typeset(&units.time)),
    )
    .curves(&times)
        + &chart(
            "Height against travel",
            &format!("travel ({})", typeset(&units.length)),
        )
        .curves(&curves);
    let words = "<p>The sphere goes along x at constant speed V and is free along z, where the bed and its weight move \
                 it.</p>\n";
    section("Does it rise?", words, &figures)
}

/// Rise against the lift on the held sphere.
fn lifts(summary: &Summary, all: &[Float]) -> String {
    let units = &summary.units;
    let mark = |(k, float): (usize, &Float)| Mark {
        at: (float.lift.mean - float.weight, float.rise),
        bar: (float.rise, float.rise),
        shape: k % SHAPES,
        hollow: float.foretold == Way::Open,
    };
    let marks: Vec<Mark> = all.iter().enumerate().map(mark).collect();
    let xs = || marks.iter().map(|mark| mark.at.0);
    let across = [xs().fold(0.0, f64::min), xs().fold(0.0, f64::max)];
    let lines = [Line {
        points: across.map(|x| (x, 0.0)).into(),
        heavy: false,
    }];
    let names: Vec<String> = all
        .iter()
        .map(|float| format!("{}, V = {}", escape(&float.name), short(float.speed)))
        .collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let chart = Chart {
        title: "Rise against lift",
        labels: [
            format!(
                "lift on the held sphere less the weight ({})",
                typeset(&units.force)
            ),
            format!("rise of the free sphere ({})", typeset(&units.length)),
        ],
        ranges: [Range::FromZero; 2],
        caption: "Hollow: the lift differs from the weight by less than two standard errors."
            .to_owned(),
    };
    let words = "<p>The lift on the sphere that is held in its height, from the same bed at the same speed, \
                 says whether the free one should rise: if it exceeds the weight. The buoyancy is a part of \
                 that lift.</p>\n";
    section(
        "Rise against lift",
        words,
        &chart.figure(&names, &marks, &lines),
    )
}

fn table(summary: &Summary, all: &[Float]) -> String {
    let (force, length) = (&summary.units.force, &summary.units.length);
    let mut t = Table::new("Floating drags", all, |float: &Float| &float.name);
    t.row("Held in its height", "", "the same drag", |float| {
        escape(&float.twin)
    });
    t.row("Speed V", &summary.units.speed, "along x", |float| {
        brief(float.speed)
    });
    t.row("Weight", force, "of the sphere", |float| {
        brief(float.weight)
    });
    t.row(
        "Lift, held",
        force,
        "upward force on the held sphere",
        |float| plus_minus(float.lift),
    );
    t.row(
        "Points",
        "",
        "the way that lift and weight point",
        |float| float.points.word().to_owned(),
    );
    t.row("Foretold", "", "if two standard errors tell", |float| {
        float.foretold.word().to_owned()
    });
    t.row("Rise", length, "from beginning to end", |float| {
        brief(float.rise)
    });
    t.row("Found", "", "by a tenth of d or more", |float| {
        float.found.word().to_owned()
    });
    t.row("Depth at the end", length, "of its centre", |float| {
        brief(float.depth)
    });
    t.row("Drag, held", force, "", |float| plus_minus(float.drags[0]));
    t.row("Drag, free", force, "", |float| plus_minus(float.drags[1]));
    format!(
        "<section>\n<h2>Floating drags</h2>\n{}</section>\n",
        t.finish()
    )
}
