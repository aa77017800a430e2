//! The section of a page with the load on the cylinder by angle (Guillard 2014, Figs. 11 and 12, and appendix
//! B).

use super::plot::{axis, marker};
use super::scale::{INK, push};
use super::scaling::subject;
use super::scatter::{Line, Mark, Range, scatter};
use super::text::escape;
use crate::analysis::Value;
use crate::claims::Group;
use crate::claims::load::{
    PointLoad, difference, equation_4, highest, loads, odd_part, pairs, split,
};
use bitgrain_lab::summary::Summary;
use bitgrain_sim::coarse_graining::load::{POINTS, theta};
use bitgrain_sim::format::{number_with_error, short};

/// Points of a curve from one marker to the next.
const APART: usize = 4;
/// Size of a polar drawing, and the radius of the cylinder in it.
const POLAR: (f64, f64) = (420.0, 46.0);

/// The section; empty if no run has a load.
pub(super) fn section(summary: &Summary, groups: &[Group]) -> String {
    let mut figures = String::new();
    for group in groups {
        let loads = loads(summary, group);
        if loads.is_empty() {
            continue;
        }
        let (pairs, name) = (pairs(&loads), subject(group, summary));
        for load in &loads {
            let mut pairs = pairs.iter();
            let pair = pairs.find(|(a, b)| load == *a || load == *b);
            match (load.gradient, pair) {
                (true, pair) => figures.push_str(&stresses(load, pair.map(|p| p.1), &name)),
                (false, None) => figures.push_str(&stresses(load, None, &name)),
                // Drawn beside its partner.
                (false, Some(_)) => (),
            }
        }
        figures.push_str(&differences(&loads, &name));
        figures.push_str(&parts(&loads, &name));
    }
    if figures.is_empty() {
        return String::new();
    }
    format!(
        "<section>\n<h2>Load on the cylinder</h2>\n<p>Stress by angle &theta;: 0 is the front, where grains come \
         from, and 0 to &pi;/2 the bottom front quarter. P<sub>0</sub> is the vertical stress at \
         the axis: the weight above over the area of the box, and half of what the lift adds below. Forces of \
         single contacts are shared out with a standard deviation of 8&deg;. Means over seeds. \
         <code>load.csv</code> in the folder of each run has the numbers.</p>\n\
         <div class=\"grid\">\n{figures}</div>\n</section>\n"
    )
}

/// A curve from -pi to pi.
fn curve(values: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = values.enumerate().map(|(m, v)| (theta(m), v)).collect();
    let turn = 2.0 * std::f64::consts::PI;
    for point in &mut points[POINTS / 2..] {
        point.0 -= turn;
    }
    points.rotate_left(POINTS / 2);
    points
}

fn mean(values: &[Value]) -> Vec<(f64, f64)> {
    curve(values.iter().map(|v| v.value))
}

/// Markers with bars on some points of a curve.
fn marks(values: &[Value], shape: usize) -> Vec<Mark> {
    let ends = |sign: f64| curve(values.iter().map(move |v| v.value + sign * v.error));
    let (low, high) = (ends(-1.0), ends(1.0));
    let all = mean(values).into_iter().zip(low).zip(high);
    all.map(|((at, low), high)| Mark {
        at,
        bar: (low.1, high.1),
        shape,
        hollow: false,
    })
    .skip(APART / 2)
    .step_by(APART)
    .collect()
}

fn line(points: Vec<(f64, f64)>, heavy: bool) -> Line {
    Line { points, heavy }
}

fn figure(svg: Option<String>, keys: &[(usize, String)], caption: &str) -> String {
    let Some(svg) = svg else {
        return String::new();
    };
    let key =
        |(shape, name): &(usize, String)| format!("<span>{}{name}</span>", marker(*shape, false));
    let keys: String = keys.iter().map(key).collect();
    format!(
        "<figure><div class=\"legend\">{keys}</div>{svg}<figcaption>{caption}</figcaption></figure>\n"
    )
}

fn depth(load: &PointLoad) -> String {
    format!("h\u{303}/D = {}", short(load.depth))
}

const THETA: &str = "angle \u{3b8} (rad)";

/// Normal and tangential stress at one depth, with a gradient and without, Cartesian and polar.
fn stresses(load: &PointLoad, partner: Option<&PointLoad>, name: &str) -> String {
    let labels = [THETA.to_owned(), "stress over P\u{2080}".to_owned()];
    let word = |l: &PointLoad| {
        if l.gradient {
            "with gradient"
        } else {
            "without"
        }
    };
    let all: Vec<&PointLoad> = [Some(load), partner].into_iter().flatten().collect();
    let (mut points, mut lines, mut keys) = (Vec::new(), Vec::new(), Vec::new());
    for (k, l) in all.iter().enumerate() {
        for (shape, values, what) in [(0, &l.normal, "normal"), (1, &l.tangential, "tangential")] {
            // Open markers for the second.
            points.extend(marks(values, shape + 4 * k));
            lines.push(line(mean(values), k == 0));
            keys.push((shape + 4 * k, format!("{what}, {}", word(l))));
        }
    }
    let svg = scatter(
        &format!("Stress on the cylinder by angle, {}", depth(load)),
        &labels,
        &points,
        &lines,
        [Range::Tight, Range::FromZero],
    );
    let numbers: Vec<String> = all
        .iter()
        .map(|l| {
            let part = number_with_error(100.0 * l.tangential_part.value, 100.0 * l.tangential_part.error);
            format!(
                "{}: the tangential stress makes {part} % of the force, the normal one a drag of {} P<sub>0</sub> D L",
                word(l),
                number_with_error(l.drag.value, l.drag.error)
            )
        })
        .collect();
    let caption = format!("{name}, {}. {}.", depth(load), numbers.join("; "));
    let own = figure(svg, &keys, &caption);
    own + &polar(&all, &format!("{name}, {}", depth(load)))
}

/// The normal stress drawn outward from the cylinder.
fn polar(loads: &[&PointLoad], name: &str) -> String {
    let (size, own) = POLAR;
    let most = highest(loads);
    if most <= 0.0 {
        return String::new();
    }
    let (middle, factor) = (0.5 * size, (0.5 * size - own - 22.0) / most);
    let at = |m: usize, stress: f64| {
        let r = own + factor * stress;
        // The front at the left, where grains come from, and the bottom below.
        (
            middle - r * libm::cos(theta(m)),
            middle + r * libm::sin(theta(m)),
        )
    };
    let mut svg = format!(
        "<svg class=\"slice\" viewBox=\"0 0 {size} {size}\" role=\"img\" aria-label=\"Normal stress round the \
         cylinder\" font-family=\"sans-serif\" font-size=\"15\"><title>Normal stress round the cylinder</title>"
    );
    for (value, label) in axis(0.0, most, 4).ticks {
        if value > 0.0 {
            let r = own + factor * value;
            push(
                &mut svg,
                format_args!(
                    "<circle cx=\"{middle}\" cy=\"{middle}\" r=\"{r:.1}\" fill=\"none\" stroke=\"#c9c9c4\"/>\
                     <text x=\"{:.1}\" y=\"{:.1}\" fill=\"{INK}\">{label}</text>",
                    middle + 0.71 * r + 3.0,
                    middle - 0.71 * r - 3.0
                ),
            );
        }
    }
    push(
        &mut svg,
        format_args!(
            "<circle cx=\"{middle}\" cy=\"{middle}\" r=\"{own}\" fill=\"#dcd8cd\" stroke=\"{INK}\"/>"
        ),
    );
    for (k, load) in loads.iter().enumerate() {
        svg.push_str("<path fill=\"none\" d=\"");
        for (m, v) in load.normal.iter().enumerate() {
            let (x, y) = at(m, if v.value > 0.0 { v.value } else { 0.0 });
            push(
                &mut svg,
                format_args!("{}{x:.1} {y:.1}", if m == 0 { "M" } else { "L" }),
            );
        }
        svg.push_str(match k {
            0 => "Z\" stroke=\"#161b22\" stroke-width=\"2.2\"/>",
            _ => "Z\" stroke=\"#68778a\" stroke-width=\"1.8\" stroke-dasharray=\"6 4\"/>",
        });
    }
    svg.push_str("</svg>");
    let second = if loads.len() > 1 {
        "; dashed: without"
    } else {
        ""
    };
    let first = if loads[0].gradient {
        "with a gradient"
    } else {
        "without a gradient"
    };
    format!(
        "<figure>{svg}<figcaption>{name}. Normal stress over P<sub>0</sub>, drawn outward from the cylinder; grains \
         come from the left. Line: {first}{second}.</figcaption></figure>\n"
    )
}

/// Curves with markers, each with its key, and light lines to compare them with.
struct Curves<'a> {
    title: &'a str,
    label: &'a str,
    own: Vec<(String, Vec<Value>)>,
    light: Vec<Vec<f64>>,
    caption: String,
}

impl Curves<'_> {
    fn html(self) -> String {
        let (mut points, mut keys) = (Vec::new(), Vec::new());
        let mut lines: Vec<Line> = Vec::new();
        lines.extend(
            self.light
                .into_iter()
                .map(|own| line(curve(own.into_iter()), false)),
        );
        for (k, (name, values)) in self.own.into_iter().enumerate() {
            points.extend(marks(&values, k));
            lines.push(line(mean(&values), true));
            if !name.is_empty() {
                keys.push((k, name));
            }
        }
        let labels = [THETA.to_owned(), self.label.to_owned()];
        let ranges = [Range::Tight, Range::FromZero];
        let svg = scatter(self.title, &labels, &points, &lines, ranges);
        figure(svg, &keys, &self.caption)
    }
}

fn plain(values: &[Value]) -> Vec<f64> {
    values.iter().map(|v| v.value).collect()
}

/// What a gradient adds, at all depths (Fig. 12).
fn differences(loads: &[PointLoad], name: &str) -> String {
    let pairs = pairs(loads);
    let added = Curves {
        title: "What a pressure gradient adds to the normal stress",
        label: "(\u{3c3}\u{2099} \u{2212} \u{3c3}\u{2099} without)/(\u{3c1} g D)",
        own: pairs
            .iter()
            .map(|pair| (depth(pair.0), difference(pair)))
            .collect(),
        light: pairs
            .last()
            .map(|(_, without)| equation_4(without))
            .into_iter()
            .collect(),
        caption: format!(
            "{name}. What a pressure gradient adds to the normal stress, over &rho;gD. Thin line: what eq. 4 \
             makes of the stress without a gradient and the local hydrostatic pressure."
        ),
    };
    let with = loads.iter().filter(|l| l.gradient);
    let odd = Curves {
        title: "Odd part of the normal stress with a gradient",
        label: "[\u{3c3}\u{2099}(\u{3b8}) \u{2212} \u{3c3}\u{2099}(\u{2212}\u{3b8})]/(2 \u{3c1} g D)",
        own: with.map(|load| (depth(load), odd_part(load))).collect(),
        light: Vec::new(),
        caption: format!(
            "{name}. The odd part of the normal stress with a gradient, over &rho;gD: a second estimate."
        ),
    };
    added.html() + &odd.html()
}

/// The part that goes with the pressure and that which goes with its gradient (appendix B), or why it is not
/// known.
fn parts(loads: &[PointLoad], name: &str) -> String {
    let fits = match split(loads) {
        Ok(fits) => fits,
        Err(why) => return format!("<p class=\"none\">Appendix B: {}.</p>\n", escape(&why)),
    };
    let of = |parameter: &str| -> Vec<Value> {
        let values = fits
            .iter()
            .filter_map(|f| f.parameter(parameter).map(Value::from));
        values.collect()
    };
    let without = loads.iter().filter(|l| !l.gradient);
    let slope = Curves {
        title: "Part of the normal stress in proportion to the pressure",
        label: "part of \u{3c3}\u{2099} with P\u{2080}",
        own: vec![(String::new(), of("b"))],
        light: without.map(|l| plain(&l.normal)).collect(),
        caption: format!(
            "{name}. Slope of the normal stress against P<sub>0</sub> at each angle, with a gradient (appendix B of \
             Guillard 2014). Thin lines: normal stress over P<sub>0</sub> without a gradient."
        ),
    };
    let intercept = Curves {
        title: "Part of the normal stress in proportion to the gradient",
        label: "part of \u{3c3}\u{2099} with \u{3c1} g D",
        own: vec![(String::new(), of("a"))],
        light: pairs(loads)
            .iter()
            .map(|pair| plain(&difference(pair)))
            .collect(),
        caption: format!(
            "{name}. Intercept of the same lines over &rho;gD. Thin lines: differences with and without a \
             gradient, as above. Both parts come from the runs with a gradient alone."
        ),
    };
    slope.html() + &intercept.html()
}
