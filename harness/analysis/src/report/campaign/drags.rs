//! Charts of the drag against the Froude number (Kumar 2018, Figs. 5, 10 and 16).

use super::super::plot::SHAPES;
use super::super::scatter::{Line, Range};
use super::super::text::escape;
use super::figure::{Figure, Series, ends, section, straight, traced};
use super::shown::{Shown, intruder, material};
use crate::analysis::{
    Analysis, Curve, Finding, Material, Method, Point, Pooled, Speeds, Value, Yield,
};

type Of<'a> = (&'a Curve, &'a Speeds, &'a Yield);

/// Curves of one material.
pub(super) fn of(analysis: &Analysis, wanted: Material) -> Vec<Of<'_>> {
    let all = analysis
        .curves
        .iter()
        .zip(&analysis.speeds)
        .zip(&analysis.yields);
    all.map(|((curve, speeds), own)| (curve, speeds, own))
        .filter(|(curve, ..)| curve.material == wanted)
        .collect()
}

pub(super) fn figures(shown: &Shown) -> String {
    let own = |pooled: &Pooled| {
        let curves = of(shown.analysis, pooled.material);
        // No more curves in a chart than there are markers.
        let some = curves
            .chunks(SHAPES)
            .map(|some| each(shown, pooled.material, some));
        some.collect::<String>() + &together(shown, pooled) + &uncut(shown, pooled)
    };
    let all: String = shown.analysis.pooled.iter().map(own).collect();
    section(
        "Drag against Froude number",
        "<p>Bars are one standard error each way; axes are logarithmic. Hollow: the error of the mean did not \
         converge. Kumar&rsquo;s absolute drags (Table I) are not drawn over these: they belong to other depths \
         and stiffnesses; his exponents and laws are below, beside ours.</p>\n",
        &all,
        "There is no drag to show.",
    )
}

/// The drags of some intruders in one material.
fn each(shown: &Shown, own: Material, curves: &[Of]) -> String {
    let series: Vec<Series> = curves
        .iter()
        .map(|(curve, ..)| {
            let points = curve.points.iter().map(|p| (p.froude, p.drag));
            let hollow = curve.points.iter().map(|p| shown.is_open(&p.name));
            Series::new(intruder(curve), points).with_hollow(hollow)
        })
        .collect();
    let line = |((_, speeds, own), series): (&Of, &Series)| -> Option<Line> {
        let [from, to] = ends(std::slice::from_ref(series))?;
        if let Finding::Found(regimes) = &speeds.regimes
            && regimes.needed
        {
            return Some(traced(from, to, |x| regimes.value(x), false));
        }
        let force = own.force.found()?.value;
        let flat = own.method == Method::Plateau && from < 1.0;
        flat.then(|| straight(from, 1.0, |_| force, false))
    };
    let lines: Vec<Line> = curves.iter().zip(&series).filter_map(line).collect();
    let caption = format!(
        "<b>{}</b>. Lines: three regimes if the points require them, else the plateau up \
         to Fr&nbsp;=&nbsp;1.",
        escape(&material(&own))
    );
    Figure {
        title: &format!("Drag against Froude number, {}", material(&own)),
        labels: ["Froude number Fr", &shown.label("drag F", "drag")],
        ranges: [Range::Ratios; 2],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}

/// The mean drag from the start over that of the averaging window, which leaves the start out.
fn uncut(shown: &Shown, pooled: &Pooled) -> String {
    let curves = of(shown.analysis, pooled.material);
    let series: Vec<Series> = curves
        .iter()
        .map(|(curve, ..)| {
            let point = |p: &Point| {
                let whole = shown.cell(&p.name, "drag_uncut")?.parse::<f64>().ok()?;
                let error = p.drag.error * whole / (p.drag.value * p.drag.value);
                Some((p.froude, Value::new(whole / p.drag.value, error)))
            };
            Series::new(intruder(curve), curve.points.iter().filter_map(point))
        })
        .collect();
    let line = ends(&series).map(|[from, to]| straight(from, to, |_| 1.0, false));
    let caption = format!(
        "<b>{}</b>, mean drag from the start over that of the averaging window. If it is not 1, start-up matters. \
         Bars: the error of the window&rsquo;s mean alone.",
        escape(&material(&pooled.material))
    );
    Figure {
        title: &format!("Start-up, {}", material(&pooled.material)),
        labels: ["Froude number Fr", "uncut over cut mean"],
        ranges: [Range::Ratios, Range::Tight],
        series: &series,
        lines: line.as_slice(),
        caption: &caption,
    }
    .html()
}

/// The same over their yield forces.
fn together(shown: &Shown, pooled: &Pooled) -> String {
    let curves = of(shown.analysis, pooled.material);
    let series: Vec<Series> = curves
        .iter()
        .filter_map(|(curve, _, own)| {
            let force = *own.force.found()?;
            let points = curve.points.iter().map(|p| (p.froude, p.drag.over(force)));
            let hollow = curve.points.iter().map(|p| shown.is_open(&p.name));
            Some(Series::new(intruder(curve), points).with_hollow(hollow))
        })
        .collect();
    let (mut lines, mut words) = (Vec::new(), String::new());
    match &pooled.regimes {
        Finding::Found(regimes) => {
            if let Some([from, to]) = ends(&series) {
                lines.push(traced(from, to, |x| regimes.value(x), true));
            }
            words.push_str(&format!("Thick line: three regimes; {}.", regimes.text()));
        }
        Finding::Refused(why) => words.push_str(&format!("No regimes: {}.", escape(&why.0))),
    }
    let caption = format!(
        "<b>{}</b>, every drag over the yield force of its intruder. {words}",
        escape(&material(&pooled.material))
    );
    Figure {
        title: &format!("Drag over yield force, {}", material(&pooled.material)),
        labels: ["Froude number Fr", "drag over yield force F/F_Y"],
        ranges: [Range::Ratios; 2],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}
