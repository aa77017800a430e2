//! The section of a page with the pictures of the grains round the intruder: its words, its key and its
//! captions.

use super::caption::depth_text;
use super::flow::{
    FlowPicture, MOVING, NAMES, OUTLINE, RAMP, Seen, Window, drawing, seen, shows, window,
};
use super::picture::LID;
use super::scale::INK;
use super::text::{count, escape, typeset};
use bitgrain_lab::summary::{DragSummary, Summary};
use bitgrain_sim::format::short;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::simulation::Role;

/// The section of the page with a picture for each of the runs at these places that has one.
pub(super) fn section(summary: &Summary, flows: &[FlowPicture], places: &[usize]) -> String {
    let wanted = |f: &&FlowPicture| {
        let mut runs = places.iter().filter_map(|k| summary.runs.get(*k));
        shows(f) && runs.any(|run| run.name == f.run)
    };
    let flows: Vec<&FlowPicture> = flows.iter().filter(wanted).collect();
    let unit = escape(&typeset(&summary.units.length));
    let (mut figures, mut missing) = (String::new(), Vec::new());
    let window = window(&flows);
    for &k in places {
        let Some(run) = summary.runs.get(k) else {
            continue;
        };
        let flow = flows.iter().find(|f| f.run == run.name);
        let drawn = flow.and_then(|f| Some((f, drawing(f, window, &unit, k)?)));
        match drawn {
            Some((flow, svg)) => {
                let caption = caption(flow, &window, run, summary);
                figures.push_str(&format!(
                    "<figure>{svg}<figcaption>{caption}</figcaption></figure>\n"
                ));
            }
            None => missing.push(escape(&run.name)),
        }
    }
    let mut out = "<section>\n<h2>Flow round the intruder</h2>\n".to_owned();
    if !figures.is_empty() {
        let bed_moves = flows.iter().any(|f| f.moves == Moves::Bed);
        let lid = flows
            .iter()
            .any(|f| f.grains.iter().any(|g| g.role == Role::Lid));
        let (way, frame) = match bed_moves {
            true => (
                "through the bed moves to the left at speed V",
                "base, which moves to the right,",
            ),
            false => ("moves to the right at speed V", "box,"),
        };
        out.push_str(&format!(
            "<p>Vertical slices through the intruder&rsquo;s centre, which stays in the middle and \
             {way}. Each circle is the cut of one grain; its colour is the \
             size of the grain&rsquo;s velocity, all three components, over V. Arrows are velocities in the plane \
             of the slice, drawn from {}&nbsp;V on; the intruder&rsquo;s own, to the same scale, is V. Velocities are \
             relative to the {frame} and all pictures have the same scale.</p>\n{}<div class=\"grid\">\n\
             {figures}</div>\n",
            short(MOVING),
            key(lid)
        ));
    }
    if figures.is_empty() {
        out.push_str("<p class=\"none\">No run has a picture of its grains.</p>\n");
    } else if !missing.is_empty() {
        let names = missing.join(", ");
        out.push_str(&format!("<p class=\"none\">No picture of {names}.</p>\n"));
    }
    out + "</section>\n"
}

/// The colours and their names, once for all pictures.
pub(super) fn key(lid: bool) -> String {
    let swatch = |(colour, name): (&str, &str)| {
        format!(
            "<span><svg class=\"key\" viewBox=\"0 0 24 24\" aria-hidden=\"true\"><circle \
             cx=\"12\" cy=\"12\" r=\"11\" fill=\"{colour}\" {OUTLINE}/></svg>{name}</span>"
        )
    };
    let lid = match lid {
        true => format!(
            "<span><svg class=\"key\" viewBox=\"0 0 24 24\" aria-hidden=\"true\"><circle \
             cx=\"12\" cy=\"12\" r=\"11\" {LID}/></svg>lid</span>"
        ),
        false => String::new(),
    };
    let swatches: String = RAMP.into_iter().zip(NAMES).map(swatch).collect();
    format!(
        "<p class=\"legend\"><span>speed / V:</span>{swatches}<span><svg class=\"key\" \
         viewBox=\"0 0 24 24\" aria-hidden=\"true\"><circle cx=\"12\" cy=\"12\" r=\"11\" \
         fill=\"#9aa1a8\" stroke=\"{INK}\"/><path d=\"M5 19L19 5M2 12L12 2M12 22L22 12\" \
         stroke=\"#3a424c\" stroke-width=\"3\"/></svg>frozen</span>{lid}<span><svg class=\"key\" \
         viewBox=\"0 0 24 24\" aria-hidden=\"true\"><circle cx=\"12\" cy=\"12\" r=\"11\" \
         fill=\"{INK}\"/></svg>the intruder</span></p>\n"
    )
}

/// What the picture of a run shows, with how many of its grains move ahead and behind.
fn caption(flow: &FlowPicture, window: &Window, run: &DragSummary, summary: &Summary) -> String {
    let units = &summary.units;
    let unit = |name: &str| escape(&typeset(name));
    let place = match summary.beds.len() {
        0 | 1 => String::new(),
        _ => format!(", {}", escape(&run.bed)),
    };
    let half = 0.5 * (flow.hi[0] - flow.lo[0]);
    let seen = seen(flow, window);
    let forward = flow.moves.forward();
    let moving = |ahead: bool| {
        // Each grain once: not the images beyond half the box.
        let there = |s: &&Seen| {
            s.role == Role::Free && s.cut.x.abs() <= half && (forward * s.cut.x >= 0.0) == ahead
        };
        let all = || seen.iter().filter(there);
        let fast = all().filter(|s| s.ratio >= MOVING).count();
        format!("{} of {}", count(fast as u64), count(all().count() as u64))
    };
    let name = match run.flow {
        Some(_) => format!("<b>{}</b>{}", escape(&run.name), depth_text(summary, run)),
        None => format!("<b>Fr = {}</b>{place}", short(flow.froude)),
    };
    format!(
        "{name}, after a travel of {}&nbsp;{}. V&nbsp;=&nbsp;{}&nbsp;{}. Faster \
         than {}&nbsp;V: {} free grains drawn ahead of the intruder&rsquo;s centre, {} behind it.",
        short(flow.travel),
        unit(&units.length),
        short(flow.speed),
        unit(&units.speed),
        short(MOVING),
        moving(true),
        moving(false),
    )
}
