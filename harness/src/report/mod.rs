//! The report of a run directory: one HTML page with pictures, charts and every number.
//!
//! The page is a pure function of what it shows: no time, no path and no name of a machine is in
//! it, and it needs no other file.

mod around;
mod arrow;
mod campaign;
mod chart;
mod course;
mod fieldmap;
mod fields;
mod flow;
mod flowing;
mod inputs;
mod loads;
mod picture;
mod plot;
mod rig_table;
mod scaling;
mod scatter;
mod statements;
mod table;
mod text;

pub use campaign::{Shown, campaign_page};
pub use course::Course;
pub use fields::FieldPicture;
pub use flow::{FlowGrain, FlowPicture};
pub use flowing::flowing_page;
use table::{bed_table, overlap_remark, plug_remark, rest_remark, run_table};
use text::{escape, plus_minus, typeset};
pub(crate) use text::{number_with_error, short};

use crate::scenario::Moves;
use crate::series::SeriesRow;
use crate::sim::Role;
use crate::summary::{BedSummary, RunSummary, Summary};

/// A settled bed to draw.
#[derive(Clone, Debug, PartialEq)]
pub struct BedPicture {
    /// Name of the bed.
    pub name: String,
    /// Lower corner of the box, periodic in x and y.
    pub lo: [f64; 3],
    /// Upper corner of the box.
    pub hi: [f64; 3],
    /// Height of the free surface.
    pub surface: f64,
    /// All grains, frozen ones included, the intruder not.
    pub grains: Vec<PictureGrain>,
    /// Centre and radius of the intruder.
    pub intruder: ([f64; 3], f64),
    /// Which of bed and intruder is to move along +x.
    pub moves: Moves,
}

/// A grain to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureGrain {
    /// Its centre.
    pub position: [f64; 3],
    /// Its radius.
    pub radius: f64,
    /// Whether it is free, of the base or of the lid.
    pub role: Role,
}

/// One self-contained HTML page. The series come in the order of the runs of the summary, the
/// pictures in that of its beds, the flows name their runs; where one is missing, the page says so.
pub fn page(
    summary: &Summary,
    scenario_text: &str,
    series: &[Vec<SeriesRow>],
    pictures: &[BedPicture],
    flows: &[FlowPicture],
) -> String {
    let kind = "Drag of a sphere through a bed of grains";
    let mut out = head(&escape(&summary.scenario), kind, "");
    out.push_str(&in_words(summary));
    out.push_str(&bed_figures(summary, pictures));
    out.push_str(&force_figures(summary, series));
    out.push_str(&froude_figure(summary));
    let all: Vec<usize> = (0..summary.runs.len()).collect();
    out.push_str(&around::section(summary, flows, &all));
    out.push_str(&numbers(summary, "", ""));
    out.push_str(&inputs::section(scenario_text, &summary.units));
    out.push_str(&repeat(summary, scenario_text));
    out.push_str("</main>\n</body>\n</html>\n");
    out
}

/// The page up to what it shows: its name and, as title and line below it, its kind, which begins with a
/// capital of its own.
fn head(name: &str, kind: &str, style: &str) -> String {
    let (first, rest) = kind.split_at(1);
    let title = first.to_lowercase() + rest;
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name}: {title}</title>\n\
         <style>{CSS}{style}</style>\n</head>\n<body>\n<main>\n\
         <header><h1>{name}</h1>\n\
         <p class=\"kind\">{kind}</p></header>\n"
    )
}

/// The main numbers as a paragraph.
fn in_words(summary: &Summary) -> String {
    let units = &summary.units;
    let runs = &summary.runs;
    let bed = |f: fn(&BedSummary) -> f64, unit| span(summary.beds.iter().map(f), unit);
    let run = |f: fn(&RunSummary) -> f64, unit| span(runs.iter().map(f), unit);
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
    let by_drag = |a: &&RunSummary, b: &&RunSummary| a.drag.mean.total_cmp(&b.drag.mean);
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
    let drag = |r: &RunSummary| {
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

/// The range of some numbers with its unit.
fn span(values: impl Iterator<Item = f64>, unit: &str) -> String {
    let finite = values.filter(|x| x.is_finite());
    let ends = finite.fold(None, |ends: Option<(f64, f64)>, x| {
        Some(ends.map_or((x, x), |(low, high)| (low.min(x), high.max(x))))
    });
    let (low, high) = ends.unwrap_or((f64::NAN, f64::NAN));
    let range = match (short(low), short(high)) {
        (low, high) if low == high => low,
        (low, high) => format!("{low} to {high}"),
    };
    match unit {
        "" => range,
        unit => format!("{range}&nbsp;{}", escape(&typeset(unit))),
    }
}

fn bed_figures(summary: &Summary, pictures: &[BedPicture]) -> String {
    let unit = &summary.units.length;
    let mut out = "<section>\n<h2>The settled bed</h2>\n".to_owned();
    for (k, bed) in summary.beds.iter().enumerate() {
        let name = escape(&bed.name);
        let drawn = pictures
            .get(k)
            .and_then(|p| Some((p, picture::slice(p, unit, k)?)));
        let Some((picture, svg)) = drawn else {
            out.push_str(&format!("<p>No picture of bed {name}.</p>\n"));
            continue;
        };
        let unit = escape(&typeset(unit));
        out.push_str(&format!(
            "<figure class=\"bed\">{svg}<figcaption><b>{name}</b>, slice at \
             y&nbsp;=&nbsp;{}&nbsp;{unit} through the intruder&rsquo;s centre. Each circle is the \
             cut of one grain, to scale, so cuts off centre are small. Light: free grains. \
             Hatched: frozen base. Black: the intruder. Arrow: direction of drag, +x. Dashed: \
             free surface at \
             z&nbsp;=&nbsp;{}&nbsp;{unit}. The box repeats along x and y.</figcaption></figure>\n",
            short(picture.intruder.0[1]),
            short(picture.surface),
        ));
    }
    out + "</section>\n"
}

fn force_figures(summary: &Summary, series: &[Vec<SeriesRow>]) -> String {
    let units = &summary.units;
    let runs = &summary.runs;
    let mut out = "<section>\n<h2>Drag against time</h2>\n".to_owned();
    if !runs.is_empty() {
        out.push_str(&format!("<p class=\"legend\">{LEGEND}</p>\n"));
    }
    out.push_str("<div class=\"grid\">\n");
    for (k, run) in runs.iter().enumerate() {
        let rows = series.get(k).map_or(&[][..], |s| s.as_slice());
        let chart = chart::force(run, rows, units, runs.len());
        let chart = chart.unwrap_or_else(|| "<p class=\"none\">No series.</p>".to_owned());
        let place = match summary.beds.len() {
            0 | 1 => String::new(),
            _ => format!(", {}", escape(&run.bed)),
        };
        out.push_str(&format!(
            "<figure>{chart}<figcaption><b>Fr = {}</b>{place}. Speed {}&nbsp;{}; mean drag of the \
             window {}&nbsp;{}.</figcaption></figure>\n",
            short(run.froude),
            short(run.speed),
            escape(&typeset(&units.speed)),
            plus_minus(run.drag),
            escape(&typeset(&units.force)),
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
            plot::marker(k),
            escape(&bed.name)
        )
    };
    let legend = match beds.len() {
        0 | 1 => String::new(),
        _ => {
            let keys: String = summary.beds.iter().enumerate().map(key).collect();
            format!("<p class=\"legend\">{keys}</p>\n")
        }
    };
    let points = match summary.runs.len() {
        1 => "1 point".to_owned(),
        n => format!("{n} points"),
    };
    format!(
        "{head}{legend}<figure class=\"narrow\">{svg}<figcaption>Mean drag \
         of each averaging window with bars of one standard error each way. No curve is fitted: \
         {points} cannot carry one.</figcaption></figure>\n</section>\n"
    )
}

/// All numbers as tables: a column for each bed or run, a row for each quantity; those of flowing beds are
/// given.
fn numbers(summary: &Summary, rigs: &str, flows: &str) -> String {
    let units = &summary.units;
    let list = [
        ("lengths", &units.length),
        ("times", &units.time),
        ("speeds", &units.speed),
        ("forces", &units.force),
        ("torques", &units.torque),
        ("energies", &units.energy),
    ];
    let list: Vec<String> = list
        .iter()
        .map(|(kind, unit)| format!("{kind} in {}", escape(&typeset(unit))))
        .collect();
    // In reduced units these three are the measures of everything.
    let symbols = match units.length.as_str() {
        "d" => "; d is the mean diameter of a grain, &rho; its density, g gravity",
        _ => "",
    };
    format!(
        "<section>\n<h2>Numbers</h2>\n<p>Units: {}{symbols}.</p>\n<h3>Beds</h3>\n{}{}{rigs}\
         <h3>Drags</h3>\n{}{}{}{flows}</section>\n",
        list.join(", "),
        bed_table(&summary.beds, units),
        rest_remark(&summary.beds),
        run_table(&summary.runs, units),
        plug_remark(&summary.runs),
        overlap_remark(&summary.runs),
    )
}

fn repeat(summary: &Summary, scenario_text: &str) -> String {
    let file = summary.inputs.bed.file.as_ref();
    let imported = file.map_or(String::new(), |file| {
        let file = escape(file);
        format!("<p>The bed comes from <code>{file}</code>, which must lie beside it.</p>\n")
    });
    format!(
        "<section>\n<h2>How to repeat it</h2>\n<p>Save the scenario below as \
         <code>scenario.toml</code> and, in the same folder, run</p>\n\
         <pre>bitgrain run scenario.toml</pre>\n{imported}<p>Made with bitgrain {}, arithmetic version {}: \
         runs with the same arithmetic version end in the digests above.</p>\n<h3>Scenario</h3>\n\
         <pre tabindex=\"0\">{}</pre>\n</section>\n",
        escape(&summary.version),
        summary.bits_version,
        escape(scenario_text),
    )
}

/// What the lines of a force chart are.
const LEGEND: &str = "<span><svg class=\"key\" viewBox=\"0 0 60 30\" aria-hidden=\"true\">\
<path d=\"M2 20L14 8L24 24L36 6L46 22L58 10\" fill=\"none\" stroke=\"#68778a\" \
stroke-width=\"2\"/></svg>drag, mean of each row</span><span><svg class=\"key\" \
viewBox=\"0 0 60 30\" aria-hidden=\"true\"><path d=\"M2 15H58\" stroke=\"#161b22\" \
stroke-width=\"6\"/></svg>its average from the start</span><span>\
<svg class=\"key\" viewBox=\"0 0 60 30\" aria-hidden=\"true\">\
<rect x=\"10\" width=\"50\" height=\"30\" fill=\"#f1ede2\"/><path d=\"M10 0V30\" \
stroke=\"#161b22\" stroke-width=\"3\" stroke-dasharray=\"6 4\"/></svg>averaging window</span>";

const CSS: &str = include_str!("style.css");

#[cfg(test)]
mod tests;
