//! Pictures of the grains round the intruder, coloured by speed: a vertical slice through its
//! centre, with the intruder in the middle.

use super::arrow::arrow;
use super::picture::LID;
use super::plot::drawable;
use super::scale::{Cut, Scale};
use super::scale::{INK, circles, open, push, ticks};
use bitgrain_lab::frames::nearest;
use bitgrain_sim::format::short;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::simulation::Role;

/// The grains round the intruder at one instant of a drag.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowPicture {
    /// Name of the run.
    pub run: String,
    /// Froude number of the run.
    pub froude: f64,
    /// Speed V of the intruder along x.
    pub speed: f64,
    /// How far it had travelled.
    pub travel: f64,
    /// Lower corner of the box, periodic in x and y; its z is the floor.
    pub lo: [f64; 3],
    /// Upper corner of the box.
    pub hi: [f64; 3],
    /// Centre and radius of the intruder.
    pub intruder: ([f64; 3], f64),
    /// How far from its centre grains are drawn.
    pub reach: f64,
    /// Which of bed and intruder moves along +x.
    pub moves: Moves,
    /// All grains, frozen ones included, the intruder not.
    pub grains: Vec<FlowGrain>,
}

/// A grain of such a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowGrain {
    /// Its centre.
    pub position: [f64; 3],
    /// Its radius.
    pub radius: f64,
    /// Its velocity, in the frame in which the base is at rest.
    pub velocity: [f64; 3],
    /// Whether it is free, of the base or of the lid.
    pub role: Role,
}

/// Bounds between the colours, as speed over V: half-decades, because speeds fall off by decades
/// away from the intruder.
const BOUNDS: [f64; 4] = [0.03, 0.1, 0.3, 1.0];
/// ColorBrewer's YlGnBu: distinct to the colour-blind, and darker with every step in grey too.
pub(super) const RAMP: [&str; 5] = ["#ffffd4", "#a1dab4", "#41b6c4", "#2c7fb8", "#253494"];
/// Names of the colours in the key.
pub(super) const NAMES: [&str; 5] = [
    "below 0.03",
    "0.03 to 0.1",
    "0.1 to 0.3",
    "0.3 to 1",
    "above 1",
];
/// Grains faster than this part of V have an arrow.
pub(super) const MOVING: f64 = 0.1;
/// Length of an arrow of speed V over the intruder's radius: the intruder's own arrow reaches out of it.
const ARROW: f64 = 1.5;
/// The outline of a light grain, so that it is seen on white.
pub(super) const OUTLINE: &str = "stroke=\"#75786f\"";

/// What all pictures of a page show about the intruder's centre, so that their scale is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// To the left and right.
    half: f64,
    /// Below the centre, at most down to the floor.
    down: f64,
    /// Above the centre, at most up to the top of the bed.
    up: f64,
}

/// A grain's cut, relative to the intruder's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Seen {
    pub(super) cut: Cut,
    /// Speed over V.
    pub(super) ratio: f64,
    /// Parts of the velocity over V along x and z.
    velocity: [f64; 2],
    pub(super) role: Role,
}

/// Whether there is something to draw.
pub(super) fn shows(flow: &FlowPicture) -> bool {
    let (centre, radius) = flow.intruder;
    let places = centre.iter().chain(&flow.lo).chain(&flow.hi);
    let sizes = [radius, flow.speed, flow.hi[0] - flow.lo[0], flow.reach];
    places.chain(&sizes).all(|x| drawable(*x)) && sizes.iter().all(|x| *x > 0.0)
}

/// The window that holds what each of `flows` has to show.
pub(super) fn window(flows: &[&FlowPicture]) -> Window {
    let mut window = Window {
        half: 0.0,
        down: 0.0,
        up: 0.0,
    };
    for flow in flows {
        let (centre, radius) = flow.intruder;
        let reach = flow.reach;
        let tops = flow.grains.iter().map(|g| g.position[2] + g.radius);
        let top = tops
            .filter(|z| drawable(*z))
            .fold(centre[2] + radius, f64::max);
        window.half = window.half.max(reach.min(0.5 * (flow.hi[0] - flow.lo[0])));
        window.down = window
            .down
            .max(reach.min((centre[2] - flow.lo[2]).max(radius)));
        window.up = window.up.max(reach.min(1.03 * (top - centre[2])));
    }
    window
}

/// Cuts of the grains by the plane through the intruder's centre, as far as they reach into the
/// window; one for each image along x.
pub(super) fn seen(flow: &FlowPicture, window: &Window) -> Vec<Seen> {
    let (centre, _) = flow.intruder;
    let size = [flow.hi[0] - flow.lo[0], flow.hi[1] - flow.lo[1]];
    let mut out = Vec::new();
    for grain in &flow.grains {
        let off = nearest(grain.position[1] - centre[1], size[1]);
        let x = nearest(grain.position[0] - centre[0], size[0]);
        let z = grain.position[2] - centre[2];
        let square = grain.radius * grain.radius - off * off;
        let [u, v, w] = grain.velocity.map(|v| v / flow.speed);
        let ratio = (u * u + v * v + w * w).sqrt();
        let numbers = [x, z, square, ratio];
        if square <= 0.0 || !numbers.iter().all(|x| drawable(*x)) {
            continue;
        }
        let radius = square.sqrt();
        for x in [x, x - size[0], x + size[0]] {
            let cut = Cut { x, z, radius };
            let inside = x.abs() < window.half + radius
                && z > -window.down - radius
                && z < window.up + radius;
            if inside {
                out.push(Seen {
                    cut,
                    ratio,
                    velocity: [u, w],
                    role: grain.role,
                });
            }
        }
    }
    out
}

/// Which colour a speed over V has.
fn class(ratio: f64) -> usize {
    BOUNDS.iter().filter(|bound| ratio >= **bound).count()
}

/// Groups of circles of one style: those of the speeds, base, lid.
pub(super) const GROUPS: usize = RAMP.len() + 2;

/// The place of the group that a grain belongs to, by its speed over V.
pub(super) fn group(role: Role, ratio: f64) -> usize {
    match role {
        Role::Free => class(ratio),
        Role::Base => RAMP.len(),
        Role::Lid => RAMP.len() + 1,
    }
}

/// The cuts of each group in its style, and the intruder in the middle.
pub(super) fn coloured(
    out: &mut String,
    scale: &Scale,
    id: &str,
    cuts: impl Fn(usize) -> Vec<Cut>,
    radius: f64,
) {
    let speeds = RAMP.map(|colour| format!("fill=\"{colour}\" {OUTLINE}"));
    let base = format!("fill=\"url(#hatch-{id})\" stroke=\"{INK}\"");
    let looks = speeds.into_iter().chain([base, LID.to_string()]);
    for (place, look) in looks.enumerate() {
        circles(out, scale, &cuts(place), &look);
    }
    let body = [Cut {
        x: 0.0,
        z: 0.0,
        radius,
    }];
    circles(
        out,
        scale,
        &body,
        &format!("fill=\"{INK}\" stroke=\"#fff\""),
    );
}

/// One picture as SVG, or `None` if the window has no extent.
pub(super) fn drawing(
    flow: &FlowPicture,
    window: Window,
    unit: &str,
    index: usize,
) -> Option<String> {
    let radius = flow.intruder.1;
    let scale = Scale::new([-window.half, -window.down], [window.half, window.up])?;
    let seen = seen(flow, &window);
    let cuts = |place: usize| -> Vec<Cut> {
        let own = seen.iter().filter(|s| group(s.role, s.ratio) == place);
        own.map(|s| s.cut).collect()
    };
    let mut out = String::new();
    let id = format!("flow-{index}");
    let title = "Speeds of the grains round the intruder";
    let title = match flow.moves {
        Moves::Intruder => format!("{title} at Froude number {}", short(flow.froude)),
        Moves::Bed => format!("{title} in {}", flow.run),
    };
    open(&mut out, "flow", &title, &id, &scale);
    coloured(&mut out, &scale, &id, cuts, radius);
    arrows(
        &mut out,
        &scale,
        &seen,
        ARROW * radius,
        flow.moves.forward(),
    );
    out.push_str("</g>");
    frame(&mut out, &scale, flow.lo[2] - flow.intruder.0[2]);
    let name = |axis| {
        let low = "<tspan dy=\"4\" font-size=\"14\">i</tspan>";
        format!("{axis} \u{2212} {axis}{low}<tspan dy=\"-4\"> ({unit})</tspan>")
    };
    ticks(&mut out, &scale, [&name("x"), &name("z")]);
    out.push_str("</svg>");
    Some(out)
}

/// Velocities in the plane, `length` long at speed V, from the centres of the cuts: dark with a
/// light rim, which is seen on every colour. Last the intruder's own, larger.
fn arrows(out: &mut String, scale: &Scale, seen: &[Seen], length: f64, forward: f64) {
    let factor = scale.factor * length;
    let style = "stroke=\"#fff\" stroke-linejoin=\"round\" paint-order=\"stroke\"";
    push(
        out,
        format_args!("<path fill=\"{INK}\" {style} stroke-width=\"2\" d=\""),
    );
    for s in seen.iter().filter(|s| s.role == Role::Free) {
        let [u, w] = s.velocity;
        let share = (u * u + w * w).sqrt();
        if share > MOVING {
            let from = [scale.x(s.cut.x), scale.z(s.cut.z)];
            // Down the drawing is along -z.
            let along = [u / share, -w / share];
            arrow(out, from, along, factor * share, 1.0);
        }
    }
    push(
        out,
        format_args!("\"/>\n<path fill=\"{INK}\" {style} stroke-width=\"3.5\" d=\""),
    );
    let centre = [scale.x(0.0), scale.z(0.0)];
    arrow(out, centre, [forward, 0.0], factor, 2.2);
    out.push_str("\"/>");
}

/// The edges of the window, thick if one is the floor.
pub(super) fn frame(out: &mut String, scale: &Scale, floor: f64) {
    let (x0, x1) = (scale.x(scale.lo[0]), scale.x(scale.hi[0]));
    let (z0, z1) = (scale.z(scale.lo[1]), scale.z(scale.hi[1]));
    push(
        out,
        format_args!(
            "<path d=\"M{x0:.1} {z0:.1}V{z1:.1}H{x1:.1}V{z0:.1}Z\" fill=\"none\" stroke=\"{INK}\" \
             stroke-width=\"0.8\"/>"
        ),
    );
    if floor >= scale.lo[1] && floor <= scale.hi[1] {
        let z = scale.z(floor);
        push(
            out,
            format_args!(
                "<path d=\"M{x0:.1} {z:.1}H{x1:.1}\" stroke=\"{INK}\" stroke-width=\"2.6\"/>"
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grain(position: [f64; 3], velocity: [f64; 3]) -> FlowGrain {
        FlowGrain {
            position,
            radius: 0.5,
            velocity,
            role: Role::Free,
        }
    }

    fn flow(grains: &[FlowGrain]) -> FlowPicture {
        FlowPicture {
            run: "run".into(),
            froude: 2.0,
            speed: 2.0,
            travel: 6.0,
            lo: [0.0; 3],
            hi: [20.0, 10.0, 30.0],
            intruder: ([19.0, 9.5, 4.0], 1.0),
            reach: 7.0,
            moves: Moves::Intruder,
            grains: grains.to_vec(),
        }
    }

    #[test]
    fn grains_are_seen_about_the_intruder_through_the_edges_of_the_box() {
        let flow = flow(&[
            grain([1.0, 9.9, 5.0], [0.0, 0.0, 1.0]),
            grain([19.0, 0.1, 5.0], [1.0; 3]),
            grain([9.0, 9.5, 5.0], [1.0; 3]),
            grain([19.0, 9.5, 13.0], [1.0; 3]),
            grain([19.0, f64::NAN, 5.0], [1.0; 3]),
        ]);
        let window = Window {
            half: 7.0,
            down: 4.0,
            up: 7.0,
        };
        let seen = seen(&flow, &window);
        assert_eq!(seen.len(), 1, "{seen:?}");
        let Seen {
            cut,
            ratio,
            velocity,
            ..
        } = seen[0];
        assert_eq!((cut.x, cut.z, ratio), (2.0, 1.0, 0.5));
        assert_eq!(velocity, [0.0, 0.5]);
        assert!((cut.radius - 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_window_as_wide_as_the_box_shows_a_grain_at_both_edges() {
        let mut flow = flow(&[grain([9.2, 9.5, 5.0], [0.0; 3])]);
        flow.reach = 28.0;
        let window = window(&[&flow]);
        assert_eq!(window.half, 10.0);
        let places: Vec<f64> = seen(&flow, &window)
            .iter()
            .map(|s| s.cut.x.round())
            .collect();
        assert_eq!(places, [-10.0, 10.0]);
    }

    #[test]
    fn colours_part_at_their_bounds() {
        let classes = [0.0, 0.029, 0.03, 0.1, 0.3, 0.99, 1.0, 9.0].map(class);
        assert_eq!(classes, [0, 0, 1, 2, 3, 3, 4, 4]);
    }

    #[test]
    fn the_colours_darken_with_speed() {
        let part =
            |colour: &str, k: usize| f64::from(u8::from_str_radix(&colour[k..k + 2], 16).unwrap());
        let light = |c: &str| 0.2126 * part(c, 1) + 0.7152 * part(c, 3) + 0.0722 * part(c, 5);
        let light: Vec<f64> = RAMP.iter().map(|c| light(c)).collect();
        assert!(light.windows(2).all(|w| w[1] < w[0] - 20.0), "{light:?}");
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let mut flat = flow(&[]);
        assert!(shows(&flat));
        flat.hi[0] = 0.0;
        assert!(!shows(&flat));
        let mut slow = flow(&[]);
        slow.speed = f64::NAN;
        assert!(!shows(&slow));
    }
}
