//! Charts of the near field of the intruder (Kumar 2018, Figs. 6 to 8), and of the bed above it.

use super::super::scatter::{Line, Range};
use super::super::text::escape;
use super::drags::of;
use super::figure::{Figure, Series, add, ends, section, straight, traced};
use super::shown::{Shown, intruder, material, text_of};
use crate::analysis::{Curve, KappaWithin, NearField, Point, Value};
use crate::fit::Fit;
use bitgrain_lab::plug_flow::bounds;
use bitgrain_sim::format::short;

/// The paper's laws: eq. 7 and Fig. 8.
const ANGLE: [f64; 3] = [-0.15, 0.38, 2.45];
const KAPPA: [f64; 2] = [0.887, 0.185];

/// Place of the last marker, which is hollow.
const OPEN: usize = 7;

type Reading = fn(&Point) -> Option<Value>;

pub(super) fn figures(shown: &Shown) -> String {
    let all = &shown.analysis.near_field;
    let own = |a: &NearField| {
        angles(shown, a)
            + &kappas(shown, a)
            + &kappas_within(shown, a)
            + &floating(shown, a)
            + &shares(shown, a)
    };
    section(
        "Round the intruder",
        "<p>Intruders smaller than 2&nbsp;d have too few contacts for the laws of angle and coordination, and are \
         left out there.</p>\n",
        &all.iter().map(own).collect::<String>(),
        "Nothing round the intruder was measured.",
    )
}

/// Points of a curve by Froude number.
fn points(curve: &Curve, of: Reading) -> Vec<(f64, Value)> {
    let all = curve.points.iter();
    all.filter_map(|p| Some((p.froude, of(p)?))).collect()
}

/// Curves of intruders with enough contacts.
fn wide<'a>(shown: &'a Shown, near_field: &NearField) -> Vec<&'a Curve> {
    let all = of(shown.analysis, near_field.material).into_iter();
    all.map(|(curve, ..)| curve)
        .filter(|c| c.is_wide())
        .collect()
}

fn numbers(fit: &Fit) -> Vec<f64> {
    fit.parameters.iter().map(|p| p.value).collect()
}

fn angles(shown: &Shown, near_field: &NearField) -> String {
    let curves = wide(shown, near_field);
    let mut series: Vec<Series> = Vec::new();
    for curve in &curves {
        let name = format!("D = {}", short(curve.diameter));
        add(&mut series, name, points(curve, |p| p.angle));
    }
    series.truncate(OPEN);
    series.resize_with(OPEN, || Series::new(String::new(), []));
    let begins = curves.iter().flat_map(|c| points(c, |p| p.new_angle));
    let begins = Series::new("contacts as they begin, all of them".into(), begins);
    let hollow = vec![true; begins.points.len()];
    series.push(begins.with_hollow(hollow));
    let law = |x: f64, [y1, y2, y3]: [f64; 3]| y1 * libm::pow(x, y2) + std::f64::consts::PI / y3;
    let mut lines = Vec::new();
    if let Some([from, to]) = ends(&series) {
        lines.push(traced(from, to, |x| law(x, ANGLE), false));
        for reading in [&near_field.contacts, &near_field.new_contacts] {
            if let Some([y1, y2, y3]) = reading.law.found().map(numbers).as_deref() {
                lines.push(traced(from, to, |x| law(x, [*y1, *y2, *y3]), true));
            }
        }
    }
    let caption = format!(
        "<b>{}</b>, contact angle. Thick line: {}; upper one, contacts as they begin: {}. Thin: the paper&rsquo;s law \
         for &mu;&nbsp;=&nbsp;0.5.",
        escape(&material(&near_field.material)),
        text_of(&near_field.contacts.law),
        text_of(&near_field.new_contacts.law)
    );
    Figure {
        title: &format!("Contact angle, {}", material(&near_field.material)),
        labels: ["Froude number Fr", "contact angle \u{3b8} (rad)"],
        ranges: [Range::FromZero, Range::Tight],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}

fn kappas(shown: &Shown, near_field: &NearField) -> String {
    let curves = wide(shown, near_field);
    let each = |c: &&Curve| Series::new(intruder(c), points(c, |p| p.kappa));
    let series: Vec<Series> = curves.iter().map(each).collect();
    let mut lines: Vec<Line> = Vec::new();
    if let Some([from, to]) = ends(&series) {
        lines.push(straight(from, to, |x| KAPPA[0] + KAPPA[1] * x, false));
        if let Some([a, b]) = near_field.kappa.found().map(numbers).as_deref() {
            lines.push(straight(from, to, |x| a + b * x, true));
        }
    }
    let caption = format!(
        "<b>{}</b>, normalised coordination number of the intruder. Thick line: {}. Thin: the paper&rsquo;s law for \
         &mu;&nbsp;=&nbsp;0.5.",
        escape(&material(&near_field.material)),
        text_of(&near_field.kappa)
    );
    Figure {
        title: &format!(
            "Normalised coordination number, {}",
            material(&near_field.material)
        ),
        labels: ["Froude number Fr", "\u{3ba}"],
        ranges: [Range::FromZero; 2],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}

/// Kappa of the widest intruder with the most speeds, by the distance within which coordination is counted.
fn kappas_within(shown: &Shown, near_field: &NearField) -> String {
    let curves = wide(shown, near_field);
    let rank = |c: &Curve| (c.points.len(), c.diameter);
    let Some(curve) = curves
        .into_iter()
        .reduce(|a, b| if rank(b) > rank(a) { b } else { a })
    else {
        return String::new();
    };
    let each = |within: &KappaWithin| {
        let of = |p: &Point| {
            let own = p.within.iter().find(|w| w.reach == within.reach)?;
            Some((p.froude, own.kappa))
        };
        let name = format!("within {} d", short(within.reach));
        Series::new(name, curve.points.iter().filter_map(of))
    };
    let series: Vec<Series> = near_field.within.iter().map(each).collect();
    let line =
        ends(&series).map(|[from, to]| straight(from, to, |x| KAPPA[0] + KAPPA[1] * x, false));
    let words = |within: &KappaWithin| {
        format!(
            "within {} d: {}",
            short(within.reach),
            text_of(&within.line)
        )
    };
    let words: Vec<String> = near_field.within.iter().map(words).collect();
    let caption = format!(
        "<b>{}</b>, {}: the normalised coordination number by the distance from the intruder within which \
         coordination is counted; the paper does not give its own. Lines through all intruders: {}. Thin: the \
         paper&rsquo;s law for &mu;&nbsp;=&nbsp;0.5.",
        escape(&material(&near_field.material)),
        escape(&intruder(curve)),
        words.join("; ")
    );
    Figure {
        title: &format!(
            "Normalised coordination number by distance, {}",
            material(&near_field.material)
        ),
        labels: ["Froude number Fr", "\u{3ba}"],
        ranges: [Range::FromZero; 2],
        series: &series,
        lines: line.as_slice(),
        caption: &caption,
    }
    .html()
}

fn floating(shown: &Shown, near_field: &NearField) -> String {
    let curves = of(shown.analysis, near_field.material);
    let each = |(c, ..): &(&Curve, _, _)| Series::new(intruder(c), points(c, |p| p.floating));
    let series: Vec<Series> = curves.iter().map(each).collect();
    let caption = format!(
        "<b>{}</b>, share of the grains within 2&nbsp;d of the intruder&rsquo;s surface that touch nothing.",
        escape(&material(&near_field.material))
    );
    Figure {
        title: &format!(
            "Grains without contacts, {}",
            material(&near_field.material)
        ),
        labels: ["Froude number Fr", "share without contacts"],
        ranges: [Range::FromZero; 2],
        series: &series,
        lines: &[],
        caption: &caption,
    }
    .html()
}

/// Shares of grains by their contacts, of the curve with the most speeds, at a few of them.
fn shares(shown: &Shown, near_field: &NearField) -> String {
    let curves = wide(shown, near_field);
    let longest = curves.iter().rev().max_by_key(|c| c.points.len());
    let Some(curve) = longest else {
        return String::new();
    };
    let there: Vec<&Point> = curve
        .points
        .iter()
        .filter(|p| !p.coordination.is_empty())
        .collect();
    let shown_points: Vec<&Point> = match there.len() {
        0 => return String::new(),
        n => (0..4).map(|k| there[k * (n - 1) / 3]).collect(),
    };
    let mut series: Vec<Series> = Vec::new();
    let mut lines = Vec::new();
    for point in shown_points {
        let name = format!("Fr = {}", short(point.froude));
        if series.iter().any(|s| s.name == name) {
            continue;
        }
        let at: Vec<(f64, f64)> = (0..)
            .map(f64::from)
            .zip(point.coordination.iter().copied())
            .collect();
        let marks = at.iter().map(|(z, share)| (*z, Value::new(*share, 0.0)));
        series.push(Series::new(name, marks));
        lines.push(Line {
            points: at,
            heavy: false,
        });
    }
    let caption = format!(
        "<b>{}</b>, {}: share of the grains within 2&nbsp;d of the intruder&rsquo;s surface with so many contacts.",
        escape(&material(&near_field.material)),
        escape(&intruder(curve))
    );
    Figure {
        title: &format!("Coordination numbers, {}", material(&near_field.material)),
        labels: ["contacts of a grain", "share of the grains"],
        ranges: [Range::FromZero; 2],
        series: &series,
        lines: &lines,
        caption: &caption,
    }
    .html()
}

/// Drift of the layers above against the part of their weight that the drag is.
pub(super) fn drifts(shown: &Shown) -> String {
    let mut series: Vec<Series> = Vec::new();
    let mut held = Vec::new();
    for curve in &shown.analysis.curves {
        let name = format!("\u{3bc} = {}", curve.material.mu);
        let all = curve
            .points
            .iter()
            .filter_map(|p| Some((p.plug_ratio, p.drift?)));
        if series.iter().all(|s| s.name != name) {
            let [sound, slides] = bounds(curve.material.mu).map(short);
            held.push(format!("{sound} and {slides} at {}", escape(&name)));
        }
        add(&mut series, name, all);
    }
    let left_out = match shown.analysis.sliding {
        0 => String::new(),
        n if shown.analysis.plugs => format!(" {n} such runs are shown nevertheless."),
        n => format!(" {n} such runs are left out of this page."),
    };
    let caption = format!(
        "Speed of the layers above the intruder&rsquo;s top over its own, against the drag over the weight of the \
         bed above its lowest point. A bed counts as sound up to the first of these ratios, and as sliding \
         beyond the second if its layers drift by a tenth: {}.{left_out}",
        held.join("; ")
    );
    let figure = Figure {
        title: "Drift of the layers above",
        labels: ["drag over weight above", "drift over V"],
        ranges: [Range::FromZero; 2],
        series: &series,
        lines: &[],
        caption: &caption,
    };
    section(
        "Does the bed above stay?",
        "<p>In a box that repeats along x and y only friction holds the grains above the intruder back.</p>\n",
        &figure.html(),
        "No drift was measured.",
    )
}
