//! Sections that several pages have.

use super::table::{bed_table, run_table};
use super::text::{escape, typeset};
use crate::report::BedPicture;
use crate::report::picture;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::short;

/// The range of some numbers with its unit.
pub(super) fn span(values: impl Iterator<Item = f64>, unit: &str) -> String {
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

/// A slice of a bed: one to step through while there is room for it.
pub(super) fn bed_figure(
    picture: &BedPicture,
    unit: &str,
    index: usize,
    caption: &str,
    room: &mut usize,
) -> String {
    if let Some((html, circles)) = picture::stepped(picture, unit, index, caption, *room) {
        *room -= circles;
        return html;
    }
    match picture::slice(picture, unit, index) {
        Some(svg) => {
            format!("<figure class=\"bed\">{svg}<figcaption>{caption}</figcaption></figure>\n")
        }
        None => format!("<p>No picture of bed {}.</p>\n", escape(&picture.name)),
    }
}

/// All numbers as tables: a column for each bed or run, a row for each quantity; those of flowing beds are
/// given.
pub(super) fn numbers(summary: &Summary, rigs: &str, flows: &str) -> String {
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
    // In reduced units these three are the units of everything.
    let symbols = match units.length.as_str() {
        "d" => "; d is the mean diameter of a grain, &rho; its density, g gravity",
        _ => "",
    };
    format!(
        "<section>\n<h2>Numbers</h2>\n<p>Units: {}{symbols}.</p>\n<h3>Beds</h3>\n{}{rigs}\
         <h3>Drags</h3>\n{}{flows}</section>\n",
        list.join(", "),
        bed_table(&summary.beds, units),
        run_table(&summary.runs, units),
    )
}

pub(super) fn repeat(summary: &Summary, scenario_text: &str) -> String {
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
pub(super) const LEGEND: &str = "<span><svg class=\"key\" viewBox=\"0 0 60 30\" aria-hidden=\"true\">\
<path d=\"M2 20L14 8L24 24L36 6L46 22L58 10\" fill=\"none\" stroke=\"#68778a\" \
stroke-width=\"2\"/></svg>drag, mean of each row</span><span><svg class=\"key\" \
viewBox=\"0 0 60 30\" aria-hidden=\"true\"><path d=\"M2 15H58\" stroke=\"#161b22\" \
stroke-width=\"6\"/></svg>its average from the start</span><span>\
<svg class=\"key\" viewBox=\"0 0 60 30\" aria-hidden=\"true\">\
<rect x=\"10\" width=\"50\" height=\"30\" fill=\"#f1ede2\"/><path d=\"M10 0V30\" \
stroke=\"#161b22\" stroke-width=\"3\" stroke-dasharray=\"6 4\"/></svg>averaging window</span>";
