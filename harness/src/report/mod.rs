//! The report of a run directory: one HTML page with pictures, charts and every number.
//!
//! The page is a pure function of what it shows: no time, no path and no name of a machine is in
//! it, and it needs no other file.

mod chart;
mod picture;

use crate::summary::{BedSummary, Mean, RunSummary, SeriesRow, Summary, Units};

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
}

/// A grain to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureGrain {
    /// Its centre.
    pub position: [f64; 3],
    /// Its radius.
    pub radius: f64,
    /// Whether it belongs to the frozen base.
    pub frozen: bool,
}

/// Plug ratio from which the layers above the intruder may add to the drag, and the one from which
/// they do; both measured for a friction coefficient of 0.5.
const PLUG: [f64; 2] = [0.12, 0.3];

/// One self-contained HTML page. The series come in the order of the runs of the summary, the
/// pictures in that of its beds; where one is missing, the page says so.
pub fn page(
    summary: &Summary,
    scenario_text: &str,
    series: &[Vec<SeriesRow>],
    pictures: &[BedPicture],
) -> String {
    let name = escape(&summary.scenario);
    let mut out = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{name}: drag of a sphere through a bed of grains</title>\n\
         <style>{CSS}</style>\n</head>\n<body>\n<main>\n\
         <header><h1>{name}</h1>\n\
         <p class=\"kind\">Drag of a sphere through a bed of grains</p></header>\n"
    );
    out.push_str(&in_words(summary));
    out.push_str(&bed_figures(summary, pictures));
    out.push_str(&force_figures(summary, series));
    out.push_str(&froude_figure(summary));
    out.push_str(&numbers(summary));
    out.push_str(&repeat(summary, scenario_text));
    out.push_str("</main>\n</body>\n</html>\n");
    out
}
