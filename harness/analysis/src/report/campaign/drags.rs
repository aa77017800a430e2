//! Charts of the drag against the Froude number (Kumar 2018, Figs. 5, 10 and 16).

use super::super::plot::SHAPES;
use super::super::scatter::{Line, Range};
use super::super::text::escape;
use super::figure::{Figure, Series, ends, section, straight, traced};
use super::shown::{Shown, intruder, material};
use crate::analysis::{
    Analysis, CROSSOVERS, Curve, Finding, Material, Method, PLATEAU_MU, Point, Pooled, Speeds,
    TableOne, Value, Yield, near, table_one_law,
};
use crate::fit::regimes::regime_fits;
use crate::fit::{Datum, Fit};
use bitgrain_sim::format::{number_with_error, short};

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
        let some = curves.chunks(SHAPES).map(|some| {
            each(shown, pooled.material, some, false) + &each(shown, pooled.material, some, true)
        });
        some.collect::<String>() + &together(shown, pooled) + &uncut(pooled, &curves)
    };
    let all: String = shown.analysis.pooled.iter().map(own).collect();
    let all = all + &table_one(shown);
    section(
        "Drag against Froude number",
        "<p>Bars are one standard error each way; axes are logarithmic. Hollow: the error of the mean did not \
         converge. Kumar&rsquo;s own absolute drags (Table I) are in a chart of their own, at his depth; his exponents \
         and laws are below, beside ours.</p>\n",
        &all,
        "There is no drag to show.",
    )
}

/// The drags of some intruders in one material: those of the averaging window, or with nothing cut.
fn each(shown: &Shown, own: Material, curves: &[Of], whole: bool) -> String {
    let drag = |p: &Point| match whole {
        true => Some((p.froude, p.uncut?)),
        false => Some((p.froude, p.drag)),
    };
    let series: Vec<Series> = curves
        .iter()
        .map(|(curve, ..)| {
            let points = curve.points.iter().filter_map(drag);
            let hollow = curve.points.iter().filter(|p| drag(p).is_some());
            let hollow = hollow.map(|p| !whole && shown.is_open(&p.name));
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
    let lines: Vec<Line> = match whole {
        true if own.mu >= PLATEAU_MU => series.iter().flat_map(paper_regimes).collect(),
        true => Vec::new(),
        false => curves.iter().zip(&series).filter_map(line).collect(),
    };
    let words = match whole {
        true if !lines.is_empty() => {
            "mean drag with nothing cut, as the paper averages (Fig. 4): the start-up counts. Lines: the paper&rsquo;s \
             law (eq. 9) through these points, each regime by itself: a constant up to Fr&nbsp;=&nbsp;1, \
             a&nbsp;+&nbsp;b&nbsp;Fr from 1 to 5, a&prime;&nbsp;+&nbsp;b&prime;&nbsp;Fr<sup>2</sup> from there."
        }
        true => "mean drag with nothing cut, as the paper averages (Fig. 4): the start-up counts.",
        false => {
            "mean drag of the averaging window, which leaves the start-up out. Lines: three regimes if the points \
             require them, else the plateau up to Fr&nbsp;=&nbsp;1."
        }
    };
    let caption = format!("<b>{}</b>, {words}", escape(&material(&own)));
    let name = if whole { "uncut drag F" } else { "drag F" };
    Figure {
        title: &format!("Drag against Froude number, {}", material(&own)),
        labels: ["Froude number Fr", &shown.label(name, "drag")],
        ranges: [Range::Ratios; 2],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}

/// The regimes of eq. 9 through the points of a curve, each fitted alone; those without enough points are left out.
fn paper_regimes(series: &Series) -> Vec<Line> {
    let points = series.points.iter();
    let data: Vec<Datum> = points.map(|(froude, drag)| drag.at(*froude)).collect();
    let [first, second] = CROSSOVERS;
    let fits = regime_fits(&data, first, second);
    let Some([from, to]) = ends(std::slice::from_ref(series)) else {
        return Vec::new();
    };
    let line = |fit: Result<Fit, _>, [from, to]: [f64; 2], of: fn(f64) -> f64| {
        let fit = fit.ok().filter(|_| from < to)?;
        let number = |k: usize| fit.parameters.get(k).map_or(0.0, |p| p.value);
        let (a, b) = (number(0), number(1));
        Some(traced(from, to, |x| a + b * of(x), false))
    };
    let lines = [
        line(fits.first, [from, first.min(to)], |_| 0.0),
        line(fits.second, [first.max(from), second.min(to)], |x| x),
        line(fits.third, [second.max(from), to], |x| x * x),
    ];
    lines.into_iter().flatten().collect()
}

/// The mean drag from the start over that of the averaging window, which leaves the start out.
fn uncut(pooled: &Pooled, curves: &[Of]) -> String {
    let series: Vec<Series> = curves
        .iter()
        .map(|(curve, ..)| {
            let point = |p: &Point| {
                let ratio = p.uncut?.value / p.drag.value;
                // They share the window: its error alone moves the ratio.
                Some((p.froude, Value::new(ratio, ratio * p.drag.relative())))
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

/// Frictionless drags at the depth of the paper's Table I, on its curves.
fn table_one(shown: &Shown) -> String {
    let all = &shown.analysis.table_one;
    let each = |one: &TableOne| {
        let points = one.points.iter().map(|(froude, drag, _)| (*froude, *drag));
        Series::new(format!("D = {}", short(one.diameter)), points)
    };
    let series: Vec<Series> = all.iter().map(each).collect();
    let curve = |one: &TableOne| {
        traced(
            0.1,
            1.0,
            |x| table_one_law(one.diameter, x).unwrap_or(0.0),
            false,
        )
    };
    let lines: Vec<Line> = all.iter().map(curve).collect();
    let ratio = |one: &TableOne| {
        let number = number_with_error(one.ratio.value, one.ratio.error);
        format!(
            "D = {}, {}: {number}",
            short(one.diameter),
            one.reading.words()
        )
    };
    let ratios: Vec<String> = all.iter().map(ratio).collect();
    let [least, most] = all.first().map_or([0.0; 2], |one| one.depths).map(short);
    let caption = format!(
        "Without friction, at the paper&rsquo;s depth: {least} to {most}&nbsp;d, by how densely its bed lies. Lines: \
         Table I, a&Prime; + b&Prime; Fr<sup>c&Prime;</sup>. Bars: errors of the drags alone. Mean ratios to the \
         lines, with the errors of depth and exponent: {}.",
        ratios.join("; ")
    );
    Figure {
        title: "Frictionless drags beside Table I",
        labels: [
            "Froude number Fr",
            &shown.label("drag F at the paper's depth", "drag"),
        ],
        ranges: [Range::Ratios; 2],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}

/// The drags at one depth, each curve over the force that is fitted with the regimes.
fn together(shown: &Shown, pooled: &Pooled) -> String {
    let curves = of(shown.analysis, pooled.material);
    let series: Vec<Series> = curves
        .iter()
        .filter(|(curve, ..)| near(curve.depth_asked, pooled.depth_asked))
        .filter_map(|(curve, ..)| {
            let scale = pooled
                .scales
                .iter()
                .find(|scale| scale.0 == curve.diameter)?
                .1;
            let points = curve
                .points
                .iter()
                .map(|p| (p.froude, p.drag.divided(scale)));
            let hollow = curve.points.iter().map(|p| shown.is_open(&p.name));
            Some(Series::new(intruder(curve), points).with_hollow(hollow))
        })
        .collect();
    let mut lines = Vec::new();
    let (scale, words) = match &pooled.regimes {
        Finding::Found(regimes) => {
            if let Some([from, to]) = ends(&series) {
                lines.push(traced(from, to, |x| regimes.value(x), true));
            }
            let words = format!(
                "the force of its intruder that lays the curves on one another. Thick line: three regimes; {}.",
                regimes.text()
            );
            (["yield force", "its scale F/F_Y"], words)
        }
        Finding::Refused(why) => {
            let words = format!(
                "the drag of its intruder at that intruder&rsquo;s lowest speed: curves that begin at other speeds do \
                 not fall on one another. No regimes: {}.",
                escape(&why.0)
            );
            (
                ["that at the lowest speed", "that at the lowest speed"],
                words,
            )
        }
    };
    let caption = format!(
        "<b>{}</b>, every drag over {words}",
        escape(&material(&pooled.material))
    );
    Figure {
        title: &format!("Drag over {}, {}", scale[0], material(&pooled.material)),
        labels: ["Froude number Fr", &format!("drag over {}", scale[1])],
        ranges: [Range::Ratios; 2],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on eq. 9 give back its three regimes, each between the paper's crossovers; without points no line.
    #[test]
    fn the_papers_regimes_go_through_points_on_them() {
        let law = |x: f64| match x {
            0.0..1.0 => 100.0,
            1.0..5.0 => 80.0 + 20.0 * x,
            _ => 130.0 + 2.0 * x * x,
        };
        let of = |all: &[f64]| {
            let points = all.iter().map(|x| (*x, Value::new(law(*x), 1.0)));
            paper_regimes(&Series::new("a".into(), points))
        };
        let lines = of(&[0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 6.0, 8.0, 10.0]);
        assert_eq!(lines.len(), 3);
        for (line, [from, to]) in lines.iter().zip([[0.25, 1.0], [1.0, 5.0], [5.0, 10.0]]) {
            let (first, last) = (line.points[0].0, line.points[line.points.len() - 1].0);
            assert!((first - from).abs() < 1e-9 && (last - to).abs() < 1e-9);
            let off = line.points.iter().map(|(x, y)| (y - law(*x)).abs());
            assert!(off.fold(0.0, f64::max) < 1e-6);
        }
        let few = of(&[0.25, 0.5]);
        assert_eq!(few.len(), 1);
        assert!((few[0].points[80].0 - 0.5).abs() < 1e-9);
    }
}
