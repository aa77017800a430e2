//! The page of beds that flow past their intruder.

use super::caption::depth_text;
use super::claims;
use super::drawings::Drawings;
use super::page::{Top, assembled};
use super::picture::BedPicture;
use super::sections::{bed_figure, numbers, repeat, span};
use super::text::{escape, typeset};
use super::{before, chart, course, fields, film, near_field, scene};
use super::{inputs, loads, means, player, rig_table, scaling};
use crate::claims::book::Book;
use crate::claims::{Group, Verdict, drag_slope, evidence, groups};
use bitgrain_lab::scenario::IntruderShape;
use bitgrain_lab::series::SeriesRow;
use bitgrain_lab::summary::{DragSummary, Flow, Summary};
use bitgrain_sim::format::{number_with_error, short};
use bitgrain_sim::motion::Moves;

/// One self-contained HTML page of beds that flow.
pub fn flowing_page(summary: &Summary, scenario_text: &str, drawings: &Drawings<'_>) -> String {
    let groups = groups(summary);
    let book = evidence::book_of_run(summary);
    // One run of each point stands for its seeds in pictures of grains.
    let first: Vec<usize> = groups
        .iter()
        .flat_map(|group| group.points.iter().filter_map(|p| p.runs.first().copied()))
        .collect();
    let mut out = String::new();
    out.push_str(&scaling::section(summary, &groups));
    out.push_str(&means::section(summary, &groups));
    out.push_str(&claims::section(
        &book,
        &summary.scenario,
        " Statements for which these runs give no number are left out: <code>bitgrain claims FOLDER</code> says why.",
    ));
    out.push_str(&force_figures(summary, drawings.series));
    out.push_str(&film::section(summary, drawings.films));
    out.push_str(&bed_figures(summary, drawings.beds, &first));
    out.push_str(&course::section(summary, &groups, drawings.courses));
    out.push_str(&near_field::section(summary, drawings.flows, &first));
    out.push_str(&scene::section(summary, drawings.scene));
    out.push_str(&fields::section(summary, &groups, drawings.maps));
    out.push_str(&loads::section(summary, &groups));
    out.push_str(&numbers(
        summary,
        &rig_table::rig_table(summary),
        &rig_table::flow_table(&summary.runs, &summary.units),
    ));
    out.push_str(&rig_table::law_table(summary));
    out.push_str(&inputs::section(scenario_text, &summary.units));
    out.push_str(&repeat(summary, scenario_text));
    let top = Top {
        name: &summary.scenario,
        kind: &format!("Drag and lift on a {} in a flowing bed", shape(summary)),
        style: STYLE,
        lead: lead_text(summary, &groups, &book),
        remarks: before::remarks(summary),
        about: before::about(summary, drawings.closing),
    };
    assembled(&top, &out)
}

fn shape(summary: &Summary) -> &'static str {
    match summary.inputs.intruder.shape {
        IntruderShape::Sphere => "sphere",
        IntruderShape::Cylinder => "cylinder",
        IntruderShape::Bar => "bar",
    }
}

/// The runs with how their beds flowed.
fn passages(summary: &Summary) -> impl Iterator<Item = (&DragSummary, &Flow)> + Clone {
    let runs = summary.runs.iter();
    runs.filter_map(|run| Some((run, run.flow.as_ref()?)))
}

/// The main numbers as a paragraph.
fn lead_text(summary: &Summary, groups: &[Group], book: &Book) -> String {
    let (units, inputs) = (&summary.units, &summary.inputs);
    let rigs = || summary.beds.iter().filter_map(|bed| bed.rig.as_ref());
    let flow = |of: fn(&Flow) -> f64| span(passages(summary).map(|(_, f)| of(f)), "");
    let seeds = inputs.all_seeds().len();
    let moves = match inputs.drag.moves {
        Moves::Bed => "is at rest while base and lid carry the bed past it",
        Moves::Intruder => "moves through the bed",
    };
    let lids = match rigs().any(|rig| rig.lid_grains > 0) {
        true => " Heavy grains on top of the bed make depths beyond its own.",
        false => "",
    };
    let mut text = format!(
        "A {} of diameter {} (D/d = {}) {moves} at {}, at effective depths of {}, in {} with {} of each \
         kind.{lids}",
        shape(summary),
        span(rigs().map(|rig| rig.diameter), &units.length),
        span(rigs().map(|rig| rig.diameter / inputs.mean_diameter()), ""),
        span(summary.runs.iter().map(|run| run.speed), &units.speed),
        span(
            passages(summary).map(|(_, f)| f.effective_depth),
            &units.length
        ),
        several(summary.runs.len(), "run", "runs"),
        several(seeds, "seed", "seeds"),
    );
    for group in groups {
        if let Some(fit) = drag_slope(group) {
            text.push_str(&format!(
                " The drag on the {} of D/d = {} is {} times the pressure on D L.",
                shape(summary),
                short(group.over_grain),
                number_with_error(fit.slope, fit.error)
            ));
        }
    }
    let lift = |gradient: bool| {
        let fits = move |(_, f): &(&DragSummary, &Flow)| f.pressure_gradient == gradient;
        let lifts = passages(summary)
            .filter(fits)
            .map(|(_, f)| f.lift_over_buoyancy);
        (lifts.clone().count() > 0).then(|| span(lifts, ""))
    };
    if let Some(lift) = lift(true) {
        text.push_str(&format!(" The lift is {lift} times the buoyancy"));
        text.push_str(if inputs.lid.is_some() {
            " with a pressure gradient."
        } else {
            "."
        });
    }
    if let Some(lift) = lift(false) {
        text.push_str(&format!(
            " Without a pressure gradient it is {lift} times the buoyancy."
        ));
    }
    text.push_str(&format!(
        " Far from it the bed moves past at {} of the speed asked for.",
        flow(|f| f.far_field)
    ));
    let [agree, disagree, open] = [Verdict::Agrees, Verdict::Disagrees, Verdict::NotResolved]
        .map(|verdict| claims::count(book, &summary.scenario, verdict));
    let said = match agree + disagree + open {
        0 => String::new(),
        all => format!(
            " Of {all} statements about it, {agree} agree, {disagree} disagree and {open} are not resolved."
        ),
    };
    format!("<p class=\"lead\">{text}{said}</p>\n")
}

fn several(n: usize, one: &str, many: &str) -> String {
    match n {
        1 => format!("one {one}"),
        n => format!("{n} {many}"),
    }
}

/// A slice of the first bed of each point.
fn bed_figures(summary: &Summary, pictures: &[BedPicture], first: &[usize]) -> String {
    let unit = escape(&typeset(&summary.units.length));
    let mut out = "<section>\n<h2>The settled bed</h2>\n".to_owned();
    if summary.beds.len() > first.len() {
        out.push_str("<p>One of the seeds of each kind.</p>\n");
    }
    let bed_moves = summary.inputs.drag.moves == Moves::Bed;
    let moving = match bed_moves {
        true => "the motion of bed, base and lid past the intruder, which is at rest",
        false => "the motion of the intruder",
    };
    out.push_str(&format!(
        "<p>Each circle is the cut of one grain, to scale, so cuts off centre are small. \
         Hatched: the base; bluish: the lid. Arrow: {moving}. Dashed: free \
         surface. The box repeats along x and y.</p>\n"
    ));
    out.push_str("<div class=\"grid\">\n");
    let mut shown: Vec<&str> = Vec::new();
    let mut room = player::ROOM;
    for run in first.iter().filter_map(|&k| summary.runs.get(k)) {
        let name = run.bed.as_str();
        if shown.contains(&name) {
            continue;
        }
        shown.push(name);
        let Some(picture) = pictures.iter().find(|p| p.name == name) else {
            out.push_str(&format!("<p>No picture of bed {}.</p>\n", escape(name)));
            continue;
        };
        let caption = format!(
            "<b>{}</b>{}. Slice at y&nbsp;=&nbsp;{}&nbsp;{unit}; free surface at z&nbsp;=&nbsp;{}&nbsp;{unit}.",
            escape(name),
            depth_text(summary, run),
            short(picture.intruder.0[1]),
            short(picture.surface),
        );
        out.push_str(&bed_figure(
            picture,
            &summary.units.length,
            shown.len(),
            &caption,
            &mut room,
        ));
    }
    out + "</div>\n</section>\n"
}

/// Drag and lift against travel, side by side, for every run.
fn force_figures(summary: &Summary, series: &[Vec<SeriesRow>]) -> String {
    let figures = force_grid(summary, series, "drag", &|run| depth_text(summary, run));
    format!(
        "<section>\n<h2>Drag and lift against travel</h2>\n<p class=\"legend\">{}</p>\n{figures}</section>\n",
        super::LEGEND.replacen("drag, mean", "force, mean", 1)
    )
}

/// Charts of drag and lift for every run, with what the drag is called and what else is said of a run.
pub(super) fn force_grid(
    summary: &Summary,
    series: &[Vec<SeriesRow>],
    drag: &str,
    more: &dyn Fn(&DragSummary) -> String,
) -> String {
    let (units, runs) = (&summary.units, &summary.runs);
    let force = escape(&typeset(&units.force));
    let mut figures = String::new();
    for (k, run) in runs.iter().enumerate() {
        let rows = series.get(k).map_or(&[][..], |s| s.as_slice());
        for (lift, mean) in [(false, run.drag), (true, run.lift)] {
            let chart = chart::along_travel(run, rows, units, 2 * runs.len(), lift);
            let chart = chart.unwrap_or_else(|| "<p class=\"none\">No series.</p>".to_owned());
            figures.push_str(&format!(
                "<figure>{chart}<figcaption><b>{}, {}</b>{}. Mean of the window {}&nbsp;{force}.\
                 </figcaption></figure>\n",
                escape(&run.name),
                if lift { "lift" } else { drag },
                more(run),
                super::plus_minus(mean),
            ));
        }
    }
    format!("<div class=\"grid\">\n{figures}</div>\n")
}

/// What this page has in addition.
pub(super) const STYLE: &str = "\nsvg.scale{width:22rem;max-width:100%;vertical-align:middle}\n";
