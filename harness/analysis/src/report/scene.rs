//! The last snapshot of the last run in three dimensions: its grains as signs, which the viewer draws by WebGL.

use super::FlowPicture;
use super::flow::{GROUPS, NAMES, RAMP, group, shows};
use super::player::SIGNS;
use super::plot::drawable;
use super::text::{escape, typeset};
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::short;
use bitgrain_sim::motion::Moves;
use serde_json::json;

/// A state to look at from every side.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Its grains, and the intruder if that is a ball.
    pub state: FlowPicture,
    /// Half of the length of an intruder that is a cylinder along y: endless ones are as long as the box is wide.
    pub half_length: Option<f64>,
}

/// Most grains that a page shows so: eight letters each make 400 kB.
pub const GRAINS_MAX: usize = 50_000;

/// The section of the page; empty without a snapshot, or if it has too many grains.
pub(super) fn section(summary: &Summary, scene: Option<&Scene>) -> String {
    let Some(Scene { state, half_length }) = scene else {
        return String::new();
    };
    let good = |x: &f64| drawable(*x);
    let sound = state.grains.iter().all(|g| {
        g.position.iter().chain(&g.velocity).all(good) && drawable(g.radius) && g.radius > 0.0
    });
    if !shows(state) || !sound || state.grains.is_empty() || state.grains.len() > GRAINS_MAX {
        return String::new();
    }
    let (centre, radius) = state.intruder;
    let half = half_length.map(|half| half.min(0.5 * (state.hi[1] - state.lo[1])));
    let [lo, hi] = extent(state);
    let widest = state
        .grains
        .iter()
        .fold(0.0, |most: f64, g| most.max(g.radius));
    let data = json!({
        "lo": lo,
        "hi": hi,
        "radius": widest,
        "groups": GROUPS,
        "centre": centre,
        "body": radius,
        "half": half,
        "rows": packed(state, [lo, hi], widest),
    });
    let data = data.to_string().replace('<', "\\u003c");
    let dot = |colour: &str, name: &str| {
        format!("<span><span class=\"dot\" style=\"background:{colour}\"></span>{name}</span>")
    };
    let speeds: String = RAMP
        .iter()
        .zip(NAMES)
        .map(|(colour, name)| dot(colour, name))
        .collect();
    let way = match state.moves {
        Moves::Intruder => "The intruder moves along +x.",
        Moves::Bed => "The bed moves along +x.",
    };
    let length = escape(&typeset(&summary.units.length));
    format!(
        "<section>\n<h2>The last snapshot in three dimensions</h2>\n<p>Turn it by pointer, finger or arrow keys, bring \
         it nearer with + and &minus;; Home resets it. Colours are speeds over V, relative to the base.</p>\n\
         <p class=\"legend\">{speeds}{}{}</p>\n<figure class=\"scene\"><canvas tabindex=\"0\" role=\"application\" \
         aria-label=\"The grains of {} in three dimensions\" hidden></canvas><div class=\"controls\" hidden><label>\
         <input type=\"checkbox\"> cut open through the intruder</label></div><p class=\"none\">It needs scripts and \
         WebGL 2.</p><figcaption><b>{}</b>, Fr&nbsp;=&nbsp;{}, travel {}&nbsp;{length}. {way} Places are drawn to a \
         7,000th of the box, radii to a hundredth.</figcaption><script type=\"application/json\">{data}</script>\
         </figure>\n</section>\n",
        dot("#8f8c85", "base and lid"),
        dot("#db6b1a", "the intruder"),
        escape(&state.run),
        escape(&state.run),
        short(state.froude),
        short(state.travel),
    )
}

/// What of the box is filled, and all that the grains reach.
fn extent(state: &FlowPicture) -> [[f64; 3]; 2] {
    let ([mut lo, mut hi], (centre, radius)) = ([state.lo, state.hi], state.intruder);
    // Above the bed the box is empty.
    hi[2] = centre[2] + radius;
    for grain in &state.grains {
        for a in 0..3 {
            lo[a] = lo[a].min(grain.position[a] - grain.radius);
            hi[a] = hi[a].max(grain.position[a] + grain.radius);
        }
    }
    [lo, hi]
}

/// Eight signs a grain: two for each of x, y and z between the corners, one for the radius over the widest, one for
/// the group of its colour.
fn packed(state: &FlowPicture, [lo, hi]: [[f64; 3]; 2], widest: f64) -> String {
    let signs = SIGNS.as_bytes();
    let base = signs.len();
    let most = (base * base - 1) as f64;
    let mut out = String::with_capacity(8 * state.grains.len());
    for grain in &state.grains {
        for a in 0..3 {
            let n = (most * (grain.position[a] - lo[a]) / (hi[a] - lo[a])).round() as usize;
            let n = n.min(base * base - 1);
            out.push(char::from(signs[n / base]));
            out.push(char::from(signs[n % base]));
        }
        let radius = ((base - 1) as f64 * grain.radius / widest).round() as usize;
        out.push(char::from(signs[radius.min(base - 1)]));
        let [u, v, w] = grain.velocity.map(|v| v / state.speed);
        let place = group(grain.role, (u * u + v * v + w * w).sqrt());
        out.push(char::from(signs[place]));
    }
    out
}

/// The scripts of such figures: the viewer, which the live page has too, and what gives it the figures of a page.
pub(super) fn script() -> String {
    format!(
        "<script>\n{{\n{}{}}}\n</script>\n",
        include_str!("viewer.js"),
        include_str!("scene.js").replace("SIGNS", SIGNS)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::FlowGrain;
    use bitgrain_sim::simulation::Role;

    #[test]
    fn a_grain_takes_eight_signs_and_keeps_its_place() {
        let grain = |x: f64, radius: f64, role: Role| FlowGrain {
            position: [x, 1.0, 2.0],
            radius,
            velocity: [1.0, 0.0, 0.0],
            role,
        };
        let state = FlowPicture {
            run: "run".into(),
            froude: 1.0,
            speed: 2.0,
            travel: 1.0,
            lo: [0.0; 3],
            hi: [10.0, 4.0, 40.0],
            intruder: ([5.0, 2.0, 3.0], 1.0),
            reach: 1.0,
            moves: Moves::Intruder,
            grains: vec![grain(3.0, 0.25, Role::Free), grain(9.9, 0.5, Role::Base)],
        };
        let [lo, hi] = extent(&state);
        assert_eq!((lo, hi), ([0.0; 3], [10.4, 4.0, 4.0]));
        let text = packed(&state, [lo, hi], 0.5);
        assert_eq!(text.len(), 16);
        let value = |k: usize| SIGNS.find(&text[k..=k]).unwrap() as f64;
        let x = |grain: usize| 10.4 * (85.0 * value(8 * grain) + value(8 * grain + 1)) / 7224.0;
        // Half of a part of the box.
        assert!((x(0) - 3.0).abs() < 0.5 * 10.4 / 7224.0 + 1e-12);
        assert!((x(1) - 9.9).abs() < 0.5 * 10.4 / 7224.0 + 1e-12);
        assert_eq!([value(6), value(14)], [42.0, 84.0]);
        // Half of V is the fourth colour; the base has none.
        assert_eq!([value(7), value(15)], [3.0, RAMP.len() as f64]);
    }
}
