//! Drawings to scale in the plane x, z: circles that the plane cuts, ticks, names of the axes.

use std::fmt::Write;

use super::plot::{Axis, axis};
use super::text::escape;

/// Width of the drawing; the rest follows from the box, at equal aspect.
pub(super) const WIDTH: f64 = 500.0;
/// Highest the box itself is drawn.
pub(super) const HEIGHT: f64 = 640.0;
/// Least room at the right, enough for half a tick label of two figures.
pub(super) const RIGHT: f64 = 14.0;
pub(super) const TOP: f64 = 10.0;
pub(super) const BOTTOM: f64 = 46.0;
/// Of lines, texts and the intruder.
pub(super) const INK: &str = "#161b22";
/// Letters of the longest tick label.
fn longest(axis: &Axis) -> f64 {
    let letters = axis.ticks.iter().map(|t| t.1.chars().count()).max();
    letters.unwrap_or(1) as f64
}

/// The circle in which a plane cuts a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// Of its centre.
    pub x: f64,
    /// Of its centre.
    pub z: f64,
    /// Smaller than the sphere's if the plane misses the centre.
    pub radius: f64,
}

/// From lengths of the bed to the drawing.
pub(super) struct Scale {
    /// Least x and z drawn.
    pub lo: [f64; 2],
    /// Largest x and z drawn.
    pub hi: [f64; 2],
    /// Length in the drawing of one unit of length.
    pub factor: f64,
    left: f64,
    up: Axis,
}

impl Scale {
    /// `None` if the box has no extent.
    pub(super) fn new(lo: [f64; 2], hi: [f64; 2]) -> Option<Self> {
        let size = [hi[0] - lo[0], hi[1] - lo[1]];
        let up = axis(lo[1], hi[1], 5);
        // Room for the tick labels and, turned, the name of the axis.
        let left = 34.0 + 8.0 * longest(&up);
        let right = RIGHT.max(4.0 + 4.5 * longest(&axis(lo[0], hi[0], 7)));
        let room = WIDTH - right - left;
        let factor = (room / size[0]).min(HEIGHT / size[1]);
        let fits = size.iter().all(|l| *l > 0.0) && factor.is_finite() && factor > 0.0;
        fits.then(|| Scale {
            lo,
            hi,
            factor,
            left: left + 0.5 * (room - factor * size[0]),
            up,
        })
    }

    /// Across the drawing.
    pub(super) fn x(&self, x: f64) -> f64 {
        self.left + self.factor * (x - self.lo[0])
    }

    /// Down the drawing.
    pub(super) fn z(&self, z: f64) -> f64 {
        TOP + self.factor * (self.hi[1] - z)
    }
}

/// The tag, its title, the hatching of frozen grains and a group clipped to what the scale shows.
pub(super) fn open(out: &mut String, class: &str, title: &str, id: &str, scale: &Scale) {
    let title = escape(title);
    let (x0, x1) = (scale.x(scale.lo[0]), scale.x(scale.hi[0]));
    let (z0, z1) = (scale.z(scale.lo[1]), scale.z(scale.hi[1]));
    let height = z0 + BOTTOM;
    push(
        out,
        format_args!(
            "<svg class=\"{class}\" viewBox=\"0 0 {WIDTH} {height:.1}\" role=\"img\" \
             aria-label=\"{title}\" font-family=\"sans-serif\" font-size=\"15\"><title>{title}\
             </title><defs><pattern id=\"hatch-{id}\" width=\"3.2\" height=\"3.2\" \
             patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">\
             <rect width=\"3.2\" height=\"3.2\" fill=\"#9aa1a8\"/>\
             <rect width=\"1.3\" height=\"3.2\" fill=\"#3a424c\"/></pattern>\
             <clipPath id=\"box-{id}\"><rect x=\"{x0:.1}\" y=\"{z1:.1}\" width=\"{:.1}\" \
             height=\"{:.1}\"/></clipPath></defs><g clip-path=\"url(#box-{id})\">",
            x1 - x0,
            z0 - z1
        ),
    );
}

/// Writing into a string cannot fail.
pub(super) fn push(out: &mut String, text: std::fmt::Arguments) {
    let _ = out.write_fmt(text);
}

/// Cuts as circles of one style.
pub(super) fn circles(out: &mut String, scale: &Scale, cuts: &[Cut], style: &str) {
    push(out, format_args!("<g {style} stroke-width=\"0.7\">"));
    for cut in cuts {
        let (x, z) = (scale.x(cut.x), scale.z(cut.z));
        let radius = cut.radius * scale.factor;
        push(
            out,
            format_args!("<circle cx=\"{x:.1}\" cy=\"{z:.1}\" r=\"{radius:.2}\"/>\n"),
        );
    }
    out.push_str("</g>");
}

/// Ticks and labels of both axes, whose names are given as markup.
pub(super) fn ticks(out: &mut String, scale: &Scale, names: [&str; 2]) {
    let (x0, x1) = (scale.x(scale.lo[0]), scale.x(scale.hi[0]));
    let (z0, z1) = (scale.z(scale.lo[1]), scale.z(scale.hi[1]));
    let across = axis(
        scale.lo[0],
        scale.hi[0],
        ((x1 - x0) / 60.0).max(2.0) as usize,
    );
    push(out, format_args!("<g fill=\"{INK}\" stroke=\"none\">"));
    for (x, label) in &across.ticks {
        let x = scale.x(*x);
        push(
            out,
            format_args!(
                "<path d=\"M{x:.1} {z0:.1}v5\" stroke=\"{INK}\"/>\
                 <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{label}</text>",
                z0 + 19.0
            ),
        );
    }
    for (z, label) in &scale.up.ticks {
        let z = scale.z(*z);
        push(
            out,
            format_args!(
                "<path d=\"M{x0:.1} {z:.1}h-5\" stroke=\"{INK}\"/>\
                 <text x=\"{:.1}\" y=\"{z:.1}\" dy=\"0.35em\" text-anchor=\"end\">{label}</text>",
                x0 - 8.0
            ),
        );
    }
    let (x, z) = (0.5 * (x0 + x1), 0.5 * (z0 + z1));
    let side = x0 - 16.0 - 8.0 * longest(&scale.up);
    push(
        out,
        format_args!(
            "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
             <text x=\"{side:.1}\" y=\"{z:.1}\" text-anchor=\"middle\" \
             transform=\"rotate(-90 {side:.1} {z:.1})\">{}</text></g>",
            z0 + 39.0,
            names[0],
            names[1],
        ),
    );
}
