//! The report of a run directory: one HTML page with pictures, charts and every number.
//!
//! The page is a pure function of what it shows: no time, no path and no name of a machine is in
//! it, and it needs no other file.

mod arrow;
mod before;
mod benchmark;
mod campaign;
mod caption;
mod chart;
mod claims;
mod course;
mod drawings;
mod fieldmap;
mod fields;
mod film;
mod flow;
mod flowing;
mod input_keys;
mod inputs;
mod loads;
mod means;
mod near_field;
mod page;
mod picture;
mod player;
mod plot;
mod released;
mod rig_table;
mod scale;
mod scaling;
mod scatter;
mod scene;
mod sections;
mod table;
mod tank;
mod tank_charts;
mod tank_views;
mod text;

pub use benchmark::benchmark_page;
use bitgrain_sim::format::short;
pub use campaign::campaign_page;
pub use course::FlowSeries;
pub use drawings::Drawings;
pub use fields::FieldPicture;
pub use film::Film;
pub use flow::{FlowGrain, FlowPicture};
pub use flowing::flowing_page;
use page::{Top, assembled};
pub use picture::{BedPicture, PictureGrain};
pub use released::released_page;
pub use scene::{GRAINS_MAX, Scene};
use sections::{LEGEND, bed_figure, numbers, repeat, span};
pub use tank::tank_page;
pub use tank_charts::TankSeries;
use text::{escape, plus_minus, to_error, typeset};

use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::{BedSummary, DragSummary, Summary};

/// One self-contained HTML page of drags of a sphere.
pub fn page(summary: &Summary, scenario_text: &str, drawings: &Drawings<'_>) -> String {
    let mut out = String::new();
    out.push_str(&force_figures(summary, drawings.series));
    out.push_str(&froude_figure(summary));
    out.push_str(&bed_figures(summary, drawings.beds));
    out.push_str(&film::section(summary, drawings.films));
    let all: Vec<usize> = (0..summary.runs.len()).collect();
    out.push_str(&near_field::section(summary, drawings.flows, &all));
    out.push_str(&scene::section(summary, drawings.scene));
    out.push_str(&numbers(summary, "", ""));
    out.push_str(&inputs::section(scenario_text, &summary.units));
    out.push_str(&repeat(summary, scenario_text));
    let top = Top {
        name: &summary.scenario,
        kind: "Drag of a sphere through a bed of grains",
        style: "",
        lead: lead_text(summary),
        remarks: before::remarks(summary),
        about: before::about(summary, drawings.closing),
    };
    assembled(&top, &out)
}

/// The main numbers as a paragraph.
fn lead_text(summary: &Summary) -> String {
    let units = &summary.units;
    let runs = &summary.runs;
    let bed = |f: fn(&BedSummary) -> f64, unit| span(summary.beds.iter().map(f), unit);
    let run = |f: fn(&DragSummary) -> f64, unit| span(runs.iter().map(f), unit);
    let several = |n: usize, one: &str, name: &str| match n {
        1 => one.to_owned(),
        n => format!("{n} {name}"),
    };
    let mut text = match summary.beds.len() {
        0 => "There is no settled bed.".to_owned(),
        n => format!(
            "{} of {} grains, {} of them a frozen base, settled to a free surface at height {} \
             and a packing fraction of {}; the intruder&rsquo;s centre lies {} below the surface.",
            several(n, "A bed", "beds"),
            bed(|b| b.grains as f64, ""),
            bed(|b| b.frozen as f64, ""),
            bed(|b| b.surface, &units.length),
            bed(|b| b.packing_fraction, ""),
            bed(|b| b.depth, &units.length),
        ),
    };
    let by_drag = |a: &&DragSummary, b: &&DragSummary| a.drag.mean.total_cmp(&b.drag.mean);
    let finite = || runs.iter().filter(|r| r.drag.mean.is_finite());
    let (Some(least), Some(most)) = (finite().min_by(by_drag), finite().max_by(by_drag)) else {
        return format!("<p class=\"lead\">{text} No drag was measured.</p>\n");
    };
    text.push_str(&format!(
        " A sphere of diameter {} was dragged through in {}, at speed {} (Froude number {}).",
        run(|r| r.diameter, &units.length),
        several(runs.len(), "one run", "runs"),
        run(|r| r.speed, &units.speed),
        run(|r| r.froude, ""),
    ));
    let force = escape(&typeset(&units.force));
    let drag = |r: &DragSummary| {
        let (mean, froude) = (plus_minus(r.drag), short(r.froude));
        format!("{mean}&nbsp;{force} at Fr&nbsp;=&nbsp;{froude}")
    };
    text.push_str(&match runs.len() {
        1 => format!(" The mean drag is {}.", drag(least)),
        _ => format!(
            " The mean drag lies between {} and {}.",
            drag(least),
            drag(most)
        ),
    });
    format!("<p class=\"lead\">{text} Errors are standard errors.</p>\n")
}

fn bed_figures(summary: &Summary, pictures: &[BedPicture]) -> String {
    let unit = &summary.units.length;
    let mut out = "<section>\n<h2>The settled bed</h2>\n<p>Slices, to scale: each circle is the cut of one grain, so \
                   cuts off centre are small. Hatched: frozen base. The arrow, on the intruder, is the direction of \
                   drag. Dashed: free surface. The box repeats along x and y.</p>\n"
        .to_owned();
    let mut room = player::ROOM;
    for (k, bed) in summary.beds.iter().enumerate() {
        let name = escape(&bed.name);
        let Some(picture) = pictures.get(k) else {
            out.push_str(&format!("<p>No picture of bed {name}.</p>\n"));
            continue;
        };
        let unit_set = escape(&typeset(unit));
        let caption = format!(
            "<b>{name}</b>, through the intruder&rsquo;s centre at y&nbsp;=&nbsp;{}&nbsp;{unit_set}; free surface at \
             z&nbsp;=&nbsp;{}&nbsp;{unit_set}.",
            short(picture.intruder.0[1]),
            short(picture.surface),
        );
        out.push_str(&bed_figure(picture, unit, k, &caption, &mut room));
    }
    out + "</section>\n"
}

fn force_figures(summary: &Summary, series: &[Vec<SeriesRow>]) -> String {
    let units = &summary.units;
    let force = escape(&typeset(&units.force));
    let runs = &summary.runs;
    let mut out = "<section>\n<h2>Drag against travel</h2>\n".to_owned();
    if !runs.is_empty() {
        out.push_str(&format!("<p class=\"legend\">{LEGEND}</p>\n"));
    }
    out.push_str("<div class=\"grid\">\n");
    for (k, run) in runs.iter().enumerate() {
        let rows = series.get(k).map_or(&[][..], |s| s.as_slice());
        let chart = chart::along_travel(run, rows, units, runs.len(), false);
        let chart = chart.unwrap_or_else(|| "<p class=\"none\">No series.</p>".to_owned());
        let place = match summary.beds.len() {
            0 | 1 => String::new(),
            _ => format!(", {}", escape(&run.bed)),
        };
        out.push_str(&format!(
            "<figure>{chart}<figcaption><b>{}, Fr = {}</b>{place}. Speed {}&nbsp;{}; mean drag of the window \
             {}&nbsp;{force}, from the start {}&nbsp;{force}.</figcaption></figure>\n",
            escape(&run.name),
            short(run.froude),
            short(run.speed),
            escape(&typeset(&units.speed)),
            plus_minus(run.drag),
            to_error(run.drag_uncut, run.drag.standard_error),
        ));
    }
    out + "</div>\n</section>\n"
}

fn froude_figure(summary: &Summary) -> String {
    let beds: Vec<&str> = summary.beds.iter().map(|b| b.name.as_str()).collect();
    let head = "<section>\n<h2>Drag against Froude number</h2>\n";
    let Some(svg) = chart::froude(&summary.runs, &beds, &summary.units) else {
        return format!("{head}<p>There is no drag to show.</p>\n</section>\n");
    };
    let key = |(k, bed): (usize, &BedSummary)| {
        let depth = format!(
            "{}&nbsp;{}",
            short(bed.depth),
            escape(&typeset(&summary.units.length))
        );
        format!(
            "<span>{}{}, depth {depth}</span>",
            plot::marker(k, false),
            escape(&bed.name)
        )
    };
    let several = beds.len() > 1;
    let beds = summary.beds.iter().enumerate().filter(|_| several);
    let keys: String = beds.map(key).collect();
    let points = match summary.runs.len() {
        1 => "1 point".to_owned(),
        n => format!("{n} points"),
    };
    format!(
        "{head}<p class=\"legend\">{keys}<span>{}mean of the averaging window</span><span>{}its error did not \
         converge</span><span>{}mean from the start</span></p>\n<figure class=\"narrow\">{svg}<figcaption>Bars: one \
         standard error each way. No curve is fitted: {points} do not suffice for one. Kumar&rsquo;s Table I and \
         Fig. 5 are not drawn: they are drags in beds of other depth and stiffness, and only fits over many depths \
         and sizes, as a campaign makes them, can be compared with them.</figcaption></figure>\n</section>\n",
        plot::marker(0, false),
        plot::marker(0, true),
        plot::CROSS,
    )
}

#[cfg(test)]
mod tests;
