//! Charts of yield forces and how they scale (Kumar 2018, Figs. 11 to 15 and 17 to 20).

use super::super::scatter::{Line, Range};
use super::super::text::escape;
use super::drags::of;
use super::figure::{Figure, Series, add, ends, section, straight};
use super::shown::{Shown, grains, intruder, material, text_of};
use crate::analysis::{Collapse, Curve, Exponent, Finding, Level, Scaling, Stiffness, Value, near};
use crate::fit::Fit;
use bitgrain_sim::format::short;

pub(super) fn figures(shown: &Shown) -> String {
    let mut all = friction(shown);
    for own in &shown.analysis.scaling {
        all += &sizes(shown, own);
        all += &depths(shown, own);
        all += &collapse(shown, own, &own.by_size, true);
        all += &collapse(shown, own, &own.by_depth, false);
    }
    let groups = shown.analysis.stiffness.iter();
    all += &groups.map(stiffness).collect::<String>();
    section(
        "Yield force",
        "<p>The drag in the limit of zero speed. With friction it is the mean of the plateau; without, it is \
         extrapolated from the slow runs, unless there are runs as slow as the paper&rsquo;s.</p>\n",
        &all,
        "No yield force was found.",
    )
}

/// Yield force against the friction coefficient, if there are several.
fn friction(shown: &Shown) -> String {
    let analysis = shown.analysis;
    let mut series = Vec::new();
    for (curve, own) in analysis.curves.iter().zip(&analysis.yields) {
        let Some(force) = own.force.found() else {
            continue;
        };
        let name = format!(
            "D = {}, h = {} asked, {}",
            short(curve.diameter),
            short(curve.depth_asked),
            grains(&curve.material)
        );
        add(&mut series, name, [(curve.material.mu, *force)]);
    }
    let several = |s: &Series| s.points.iter().any(|p| p.0 != s.points[0].0);
    series.retain(several);
    Figure {
        title: "Yield force against friction",
        labels: ["friction coefficient \u{3bc}", &shown.label("yield force F_Y", "drag")],
        ranges: [Range::FromZero; 2],
        series: &series,
        lines: &[],
        caption: "Yield force against the friction coefficient of the grains; depths are as settled, and differ.",
    }
    .html()
}

/// Curves of a scaling with their yield forces.
fn known<'a>(shown: &'a Shown, own: &Scaling) -> Vec<(&'a Curve, Value)> {
    let all = of(shown.analysis, own.material).into_iter();
    all.filter_map(|(curve, _, own)| Some((curve, *own.force.found()?)))
        .collect()
}

/// Yield forces that have one depth, or one diameter, with the power through them; all such in words.
struct Powers {
    series: Vec<Series>,
    lines: Vec<Line>,
    words: String,
}

impl Powers {
    /// Their figure, as HTML.
    fn figure(&self, shown: &Shown, title: &str, label: &str, caption: &str) -> String {
        Figure {
            title,
            labels: [label, &shown.label("yield force F_Y", "drag")],
            ranges: [Range::Ratios; 2],
            series: &self.series,
            lines: &self.lines,
            caption,
        }
        .html()
    }
}

/// The powers found, if two or more of `points` are shown; `what` the forces have in common.
fn powers(all: &[Exponent], what: &str, points: impl Fn(&Exponent) -> Vec<(f64, Value)>) -> Powers {
    let (mut series, mut lines, mut words) = (Vec::new(), Vec::new(), Vec::new());
    for found in all {
        let own = Series::new(format!("{what} = {}", short(found.at)), points(found));
        if own.points.len() < 2 {
            continue;
        }
        let line = |fit: &Fit| {
            let (a, p) = (fit.parameter("A")?.value, fit.parameter("p")?.value);
            let [from, to] = ends(std::slice::from_ref(&own))?;
            Some(straight(from, to, |x| a * libm::pow(x, p), false))
        };
        lines.extend(found.fit.found().and_then(line));
        words.push(format!("at {}: {}", own.name, text_of(&found.fit)));
        series.push(own);
    }
    Powers {
        series,
        lines,
        words: words.join("; "),
    }
}

fn sizes(shown: &Shown, own: &Scaling) -> String {
    let known = known(shown, own);
    let found = powers(&own.phi, "h", |found| {
        let there = known.iter().filter(|(c, _)| near(c.depth_asked, found.at));
        let brought = |c: &Curve, force| c.brought_to(found.at, own.brought_by, force);
        there
            .map(|(c, force)| (c.effective_diameter(), brought(c, *force)))
            .collect()
    });
    let caption = format!(
        "<b>{}</b>, yield force against D + d, scaled to the depth asked for by h<sup>{}</sup>; \
         f (D + d)<sup>&phi;</sup> with A = f and p = &phi;, {}.",
        escape(&material(&own.material)),
        short(own.brought_by),
        found.words
    );
    let title = format!("Yield force against size, {}", material(&own.material));
    found.figure(shown, &title, &shown.label("D + d", "diameter"), &caption)
}

fn depths(shown: &Shown, own: &Scaling) -> String {
    let known = known(shown, own);
    let found = powers(&own.alpha, "D", |found| {
        let there = known.iter().filter(|(c, _)| near(c.diameter, found.at));
        there.map(|(c, force)| (c.depth, *force)).collect()
    });
    let mean = match &own.alpha_mean {
        Finding::Found(mean) => format!(
            "; &alpha;, mean over speeds: {}",
            bitgrain_sim::format::number_with_error(mean.value, mean.error)
        ),
        Finding::Refused(_) => String::new(),
    };
    let caption = format!(
        "<b>{}</b>, yield force against depth, g h<sup>&alpha;</sup> with A = g and p = &alpha;, {}{mean}.",
        escape(&material(&own.material)),
        found.words
    );
    let title = format!("Yield force against depth, {}", material(&own.material));
    found.figure(shown, &title, &shown.label("depth h", "depth"), &caption)
}

/// Drags over (D + d)^phi h^alpha.
fn collapse(shown: &Shown, own: &Scaling, found: &Finding<Collapse>, by_size: bool) -> String {
    let Some(collapse) = found.found() else {
        return String::new();
    };
    let curves = of(shown.analysis, own.material);
    let group = |c: &Curve| if by_size { c.depth_asked } else { c.diameter };
    // Only what is compared: curves that have a partner.
    let partner = |c: &Curve| {
        let same = curves.iter().filter(|(o, ..)| near(group(o), group(c)));
        same.count() > 1
    };
    let series: Vec<Series> = curves
        .iter()
        .filter(|(c, ..)| partner(c))
        .map(|(c, ..)| {
            let scale = c.scale(collapse.exponents);
            let over = c.points.iter().map(|p| (p.froude, p.drag.divided(scale)));
            Series::new(intruder(c), over)
        })
        .collect();
    let (what, label) = match by_size {
        true => ("sizes", "F/((D + d)^\u{3c6} h^\u{3b1})"),
        false => ("depths", "F/h^\u{3b1}"),
    };
    let [phi, alpha] = collapse.exponents.map(short);
    let exponents = match by_size {
        true => format!("&phi; = {phi}, &alpha; = {alpha}"),
        false => format!("&alpha; = {alpha}"),
    };
    let caption = format!(
        "<b>{}</b>, collapse of {what} with {exponents}: at equal Froude numbers they are {} % off their mean, \
         root mean square; errors alone would make it {} %.",
        escape(&material(&own.material)),
        short(100.0 * collapse.spread),
        short(100.0 * collapse.expected)
    );
    Figure {
        title: &format!("Collapse of {what}, {}", material(&own.material)),
        labels: ["Froude number Fr", label],
        ranges: [Range::Ratios; 2],
        series: &series,
        lines: &[],
        caption: &caption,
    }
    .html()
}

/// Yield force and fast drag, both over the first's, against stiffness or damping.
fn stiffness(group: &Stiffness) -> String {
    let (label, at): (&str, fn(&Level) -> f64) = match group.what.as_str() {
        "kn" => ("stiffness K_n", |l| l.kn),
        _ => ("damping \u{3b3}_n", |l| l.gamma_n),
    };
    let Some(first) = group.levels.first() else {
        return String::new();
    };
    // The first over itself is one, without an error.
    let over = |l: &Level| match at(l) == at(first) {
        true => Value::new(1.0, 0.0),
        false => l.slow.over(first.slow),
    };
    let slow = group.levels.iter().map(|l| (at(l), over(l)));
    let fast = group.levels.iter().filter_map(|l| Some((at(l), l.fast?)));
    let series = [
        Series::new("yield force".into(), slow),
        Series::new("drag from Fr = 5 on".into(), fast),
    ];
    let with = match group.what.as_str() {
        "kn" => "at equal &gamma;<sub>n</sub>/K<sub>n</sub><sup>0.6</sup>",
        _ => "at equal K<sub>n</sub>",
    };
    let caption = format!(
        "D = {}, h near {}, &mu; = {}: both over those of the smallest, {with}.",
        short(group.diameter),
        short(group.depth_asked),
        group.mu
    );
    Figure {
        title: &format!("Drag against {label}"),
        labels: [label, "over that of the smallest"],
        ranges: [Range::Ratios, Range::FromZero],
        series: &series,
        lines: &[],
        caption: &caption,
    }
    .html()
}
