//! The picture of a settled bed: a vertical slice through the intruder's centre, to scale.

use super::player::{State, figure};
use super::scale::{Cut, INK, Scale, circles, open, push, ticks};
use super::text::{escape, typeset};
use bitgrain_sim::format::short;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::simulation::Role;

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
    /// Half of its length if it is a bar along y, endless for a cylinder, which is as long as the box is wide and looks
    /// alike at every y; none of a sphere.
    pub half_length: Option<f64>,
    /// Which of bed and intruder is to move along +x.
    pub moves: Moves,
    /// Whether an arrow shows that.
    pub arrow: bool,
}

/// A grain to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureGrain {
    /// Its centre.
    pub position: [f64; 3],
    /// Its radius.
    pub radius: f64,
    /// Whether it is free, of the base or of the lid.
    pub role: Role,
}

/// How grains of a lid are drawn: darker than free ones, without the hatching of the base.
pub(super) const LID: &str = "fill=\"#7d9fbd\" stroke=\"#161b22\"";

/// Cuts of a sphere by the plane at `y`, one for each periodic image that reaches into the box.
fn cuts(bed: &BedPicture, y: f64, position: [f64; 3], radius: f64) -> Vec<Cut> {
    let size = [bed.hi[0] - bed.lo[0], bed.hi[1] - bed.lo[1]];
    let off = position[1] - y;
    let off = off - size[1] * (off / size[1]).round();
    let square = radius * radius - off * off;
    let x = position[0] - size[0] * ((position[0] - bed.lo[0]) / size[0]).floor();
    if !(square > 0.0 && x.is_finite() && position[2].is_finite()) {
        return Vec::new();
    }
    let radius = square.sqrt();
    [0.0, -1.0, 1.0]
        .into_iter()
        .map(|image| x + image * size[0])
        .filter(|x| x + radius > bed.lo[0] && x - radius < bed.hi[0])
        .map(|x| Cut {
            x,
            z: position[2],
            radius,
        })
        .collect()
}

/// What a plane at `y` cuts of each kind of body: free grains, base, lid, intruder.
fn kinds(bed: &BedPicture, y: f64) -> [Vec<Cut>; 4] {
    let (centre, radius) = bed.intruder;
    let all = |role: Role| -> Vec<Cut> {
        let grains = bed.grains.iter().filter(|g| g.role == role);
        grains
            .flat_map(|g| cuts(bed, y, g.position, g.radius))
            .collect()
    };
    let [free, frozen, lid] = [Role::Free, Role::Base, Role::Lid].map(all);
    let intruder = match bed.half_length {
        Some(half) if (y - centre[1]).abs() <= half => cuts(bed, centre[1], centre, radius),
        Some(_) => vec![],
        None => cuts(bed, y, centre, radius),
    };
    [free, frozen, lid, intruder]
}

/// The scale of a slice, to what is filled of the box; `None` if that has no extent.
fn scale(bed: &BedPicture, drawn: &[Vec<Cut>; 4]) -> Option<Scale> {
    let drawn = || drawn.iter().flatten();
    // The box may reach far above the bed, to the height of the fall: draw the filled part.
    let top = drawn().fold(bed.surface, |top, c| top.max(c.z + c.radius));
    let low = drawn().fold(bed.lo[2], |low, c| low.min(c.z - c.radius));
    let top = if top > low { top } else { bed.hi[2] };
    let top = top + 0.03 * (top - low);
    Scale::new([bed.lo[0], low], [bed.hi[0], top])
}

/// Most planes that a bed can be stepped through at.
const PLANES: usize = 40;

/// The slice as a figure that can be stepped through along y, and how many circles that takes; `None` if there is
/// nothing to step through, or no `room` for it.
pub(super) fn stepped(
    bed: &BedPicture,
    unit: &str,
    index: usize,
    caption: &str,
    room: usize,
) -> Option<(String, usize)> {
    let (lo, size) = (bed.lo[1], bed.hi[1] - bed.lo[1]);
    let radii: f64 = bed.grains.iter().map(|g| g.radius).sum();
    // A grain is cut twice.
    let apart = radii / bed.grains.len() as f64;
    let count = ((size / apart) as usize).min(PLANES);
    if count < 2 || !apart.is_finite() || !size.is_finite() {
        return None;
    }
    let home = kinds(bed, bed.intruder.0[1]);
    let scale = scale(bed, &home)?;
    // The position of the intruder's own plane among the others.
    let middle = bed.intruder.0[1];
    let mut planes: Vec<f64> = (0..count)
        .map(|k| lo + size * (k as f64 + 0.5) / count as f64)
        .collect();
    let place = planes.partition_point(|y| *y < middle);
    planes.insert(place, middle);
    // A lid that is not there has no group.
    let there = [true, true, !home[2].is_empty(), true];
    let group = |kind: usize| there[..kind].iter().filter(|own| **own).count();
    let state = |y: &f64| {
        let kinds = kinds(bed, *y);
        let all = kinds.iter().enumerate().filter(|(kind, _)| there[*kind]);
        State {
            label: format!("y = {} {}", short(*y), typeset(unit)),
            cuts: all
                .flat_map(|(kind, cuts)| cuts.iter().map(move |cut| (*cut, kind)))
                .map(|(cut, kind)| (cut, group(kind)))
                .collect(),
        }
    };
    let states: Vec<State> = planes.iter().map(state).collect();
    let circles = states.iter().map(|s| s.cuts.len()).sum();
    let title = format!("Slices of the settled bed {}", bed.name);
    if circles > room {
        return None;
    }
    let svg = slice(bed, unit, index)?;
    let words = (&title[..], caption);
    let html = figure("played bed", &svg, words, &scale, group(4), &states, place);
    Some((html, circles))
}

/// The slice as SVG, or `None` if the box has no extent. `index` keeps the names of clips and
/// patterns of several pictures on a page apart.
pub(super) fn slice(bed: &BedPicture, unit: &str, index: usize) -> Option<String> {
    let drawn = kinds(bed, bed.intruder.0[1]);
    let scale = scale(bed, &drawn)?;
    let [free, frozen, lid, intruder] = drawn;
    let mut out = String::new();
    let title = format!(
        "Slice of the settled bed {} through the intruder's centre",
        bed.name
    );
    open(&mut out, "slice", &title, &index.to_string(), &scale);
    circles(
        &mut out,
        &scale,
        &free,
        "fill=\"#dcd8cd\" stroke=\"#8a877d\"",
    );
    let hatch = format!("fill=\"url(#hatch-{index})\" stroke=\"{INK}\"");
    circles(&mut out, &scale, &frozen, &hatch);
    if !lid.is_empty() {
        circles(&mut out, &scale, &lid, LID);
    }
    circles(
        &mut out,
        &scale,
        &intruder,
        &format!("fill=\"{INK}\" stroke=\"#fff\""),
    );
    // A bar turns: it has no direction in this plane.
    let goes = bed.arrow && bed.half_length.is_none_or(f64::is_infinite);
    if let Some(cut) = intruder.first().filter(|_| goes) {
        let reach = scale.factor * cut.radius;
        match bed.moves {
            Moves::Intruder => arrow(&mut out, &scale, scale.x(cut.x), cut.z, reach + 34.0),
            // In the bed, which is what moves.
            Moves::Bed => arrow(&mut out, &scale, scale.x(bed.lo[0]) + 8.0, cut.z, 48.0),
        }
    }
    out.push_str("</g>");
    lines(&mut out, &scale, bed);
    let unit = escape(&typeset(unit));
    ticks(
        &mut out,
        &scale,
        [&format!("x ({unit})"), &format!("z ({unit})")],
    );
    out.push_str("</svg>");
    Some(out)
}

/// Along +x, dark with a light rim: seen on the intruder and on grains.
fn arrow(out: &mut String, scale: &Scale, from: f64, z: f64, length: f64) {
    let z = scale.z(z);
    let tip = (from + length).min(scale.x(scale.hi[0]) - 4.0);
    let (tail, neck) = (tip - length, tip - 11.0);
    let shape = format!(
        "M{tail:.1} {:.1}H{neck:.1}V{:.1}L{tip:.1} {z:.1}L{neck:.1} {:.1}V{:.1}H{tail:.1}Z",
        z - 1.8,
        z - 6.5,
        z + 6.5,
        z + 1.8
    );
    push(
        out,
        format_args!(
            "<path d=\"{shape}\" fill=\"{INK}\" stroke=\"#fff\" stroke-width=\"4\" \
             stroke-linejoin=\"round\" paint-order=\"stroke\"/>"
        ),
    );
}

/// Edges of the box, the floor and the free surface.
fn lines(out: &mut String, scale: &Scale, bed: &BedPicture) {
    let (x0, x1) = (scale.x(scale.lo[0]), scale.x(scale.hi[0]));
    let (z0, z1) = (scale.z(scale.lo[1]), scale.z(scale.hi[1]));
    let mut line = |path: String, colour: &str, style: &str| {
        push(
            out,
            format_args!("<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" {style}/>"),
        );
    };
    let sides = format!("M{x0:.1} {z1:.1}V{z0:.1}M{x1:.1} {z1:.1}V{z0:.1}");
    line(sides, INK, "stroke-width=\"0.8\"");
    let floor = format!("M{x0:.1} {:.1}H{x1:.1}", scale.z(bed.lo[2]));
    line(floor, INK, "stroke-width=\"2.6\"");
    if bed.surface.is_finite() {
        // A light line under the dashes keeps them apart from the outlines of grains.
        let surface = format!("M{x0:.1} {:.1}H{x1:.1}", scale.z(bed.surface));
        line(
            surface.clone(),
            "#fff",
            "stroke-width=\"4\" opacity=\"0.8\"",
        );
        line(
            surface,
            INK,
            "stroke-width=\"1.8\" stroke-dasharray=\"8 5\"",
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::PictureGrain;
    use super::*;
    use crate::report::scale::{RIGHT, WIDTH};

    fn bed(grains: &[([f64; 3], bool)]) -> BedPicture {
        let grain = |(position, frozen): &([f64; 3], bool)| PictureGrain {
            position: *position,
            radius: 0.5,
            role: if *frozen { Role::Base } else { Role::Free },
        };
        BedPicture {
            name: "<a>".into(),
            lo: [0.0; 3],
            hi: [10.0, 8.0, 40.0],
            surface: 6.0,
            grains: grains.iter().map(grain).collect(),
            intruder: ([5.0, 1.0, 3.0], 1.0),
            half_length: None,
            moves: Moves::Intruder,
            arrow: true,
        }
    }

    fn count(bed: &BedPicture) -> usize {
        let text = slice(bed, "d", 0).unwrap();
        text.matches("<circle").count() - 1
    }

    #[test]
    fn a_grain_across_the_x_edge_is_drawn_at_both() {
        assert_eq!(count(&bed(&[([0.2, 1.0, 2.0], false)])), 2);
        assert_eq!(count(&bed(&[([9.8, 1.0, 2.0], true)])), 2);
        assert_eq!(count(&bed(&[([5.0, 1.0, 0.6], false)])), 1);
        // One box length away is the same grain.
        assert_eq!(count(&bed(&[([-9.8, 1.0, 2.0], false)])), 2);
    }

    #[test]
    fn the_plane_cuts_what_it_meets_through_the_y_edge_too() {
        let near = bed(&[]);
        let cut = cuts(&near, 0.1, [4.0, 7.8, 2.0], 0.5);
        assert_eq!(cut.len(), 1);
        assert!((cut[0].radius - 0.4).abs() < 1e-12, "{cut:?}");
        assert!(cuts(&near, 0.1, [4.0, 7.5, 2.0], 0.5).is_empty());
        assert!(cuts(&near, 1.0, [4.0, 1.0, f64::NAN], 0.5).is_empty());
    }

    #[test]
    fn a_picture_is_to_scale_and_names_are_escaped() {
        let text = slice(&bed(&[([3.0, 1.0, 2.0], false)]), "d", 0).unwrap();
        let factor = (WIDTH - RIGHT - 42.0) / 10.0;
        assert!(
            text.contains(&format!("r=\"{:.2}\"", 0.5 * factor)),
            "{text}"
        );
        assert!(text.contains(&format!("r=\"{factor:.2}\"")), "{text}");
        assert!(text.contains("&lt;a&gt;") && !text.contains("<a>"));
    }

    #[test]
    fn a_box_without_extent_has_no_picture() {
        let mut flat = bed(&[([3.0, 1.0, 2.0], false)]);
        flat.hi = flat.lo;
        assert!(slice(&flat, "d", 0).is_none());
    }
}
