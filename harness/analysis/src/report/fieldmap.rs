//! A map of one field in the plane x, z about the intruder, drawn from the points as bands of colour.

use super::scale::Scale;
use super::scale::{INK, open, push, ticks};
use bitgrain_sim::coarse_graining::IntruderOutline;
use bitgrain_sim::coarse_graining::grid::Grid;
use bitgrain_sim::format::short;

/// Matplotlib's viridis at twelve steps: equal steps look equally far apart, also to the colour-blind and in grey.
const RAMP: [&str; 12] = [
    "#440154", "#482173", "#433e85", "#38598c", "#2d708e", "#25858e", "#1e9b8a", "#2ab07f",
    "#52c569", "#86d549", "#c2df23", "#fde725",
];

/// Where nothing is known.
const NONE: &str = "#e6e6e2";

/// Part of the values that the scale reaches: beyond are a few points right at the intruder.
const REACHED: f64 = 0.995;

/// What a map shows.
pub(super) struct Map<'a> {
    /// Its name for screen readers.
    pub title: &'a str,
    /// Where the points are.
    pub grid: Grid,
    /// The intruder.
    pub hole: IntruderOutline,
    /// Radius of the averaging windows.
    pub window: f64,
    /// The value at each point, if it is known.
    pub values: &'a [Option<f64>],
    /// The value of the last colour.
    pub most: f64,
    /// Streamlines, places in units of length.
    pub lines: &'a [Vec<[f64; 2]>],
    /// Height of the free surface.
    pub surface: f64,
    /// How far the map reaches from the intruder's centre, in diameters: to either side, down, up.
    pub reach: [f64; 3],
    /// Keeps the names of clips of several maps on a page apart.
    pub index: &'a str,
}

/// The colour of a value.
fn level(value: f64, most: f64) -> usize {
    let part = value / most * RAMP.len() as f64;
    // Values that are not numbers or below zero get the first.
    (part.max(0.0) as usize).min(RAMP.len() - 1)
}

/// The top of a scale for some values: a round number that all but a few are below; `None` if there is nothing
/// above zero.
pub(super) fn top(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut all: Vec<f64> = values.filter(|x| x.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    let place = (REACHED * all.len() as f64) as usize;
    let top = *all.get(place.min(all.len().checked_sub(1)?))?;
    if top <= 0.0 {
        return None;
    }
    // Quarters of these are short to write.
    const ROUND: [f64; 9] = [1.0, 1.2, 1.6, 2.0, 2.4, 3.2, 4.0, 6.0, 8.0];
    let power: i32 = format!("{top:e}").split_once('e')?.1.parse().ok()?;
    let all = [power, power + 1]
        .into_iter()
        .flat_map(|p| ROUND.map(|r| format!("{r}e{p}")));
    all.filter_map(|text| text.parse().ok())
        .find(|round| *round >= top)
}

/// The map as SVG; `None` if it would have no extent.
pub(super) fn map(map: &Map) -> Option<String> {
    let hole = map.hole;
    let d = 2.0 * hole.radius;
    let [side, down, up] = map.reach;
    let scale = Scale::new([-side, -down], [side, up])?;
    let place = |x: f64, z: f64| (scale.x(x / d), scale.z((z - hole.height) / d));
    let mut out = String::new();
    open(&mut out, "slice", map.title, map.index, &scale);
    let (left, top) = (scale.x(-side), scale.z(up));
    let (right, bottom) = (scale.x(side), scale.z(-down));
    push(
        &mut out,
        format_args!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{NONE}\"/>",
            right - left,
            bottom - top
        ),
    );
    bands(&mut out, map, &scale);
    out.push_str("<g fill=\"none\" stroke=\"#fff\" stroke-width=\"1.1\" stroke-opacity=\"0.85\">");
    for line in map.lines {
        out.push_str("<path d=\"");
        let mut pen = "M";
        // Every other step of the integration is enough for the eye.
        for [x, z] in line.iter().step_by(2) {
            let (x, z) = place(*x, *z);
            push(&mut out, format_args!("{pen}{x:.1} {z:.1}"));
            pen = "L";
        }
        out.push_str("\"/>");
    }
    out.push_str("</g>");
    let (x, z) = place(0.0, hole.height);
    let radius = |r: f64| r / d * scale.factor;
    let rim = radius(hole.radius + map.window);
    push(
        &mut out,
        format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{z:.1}\" r=\"{rim:.1}\" fill=\"none\" stroke=\"#fff\" \
             stroke-dasharray=\"4 3\"/><circle cx=\"{x:.1}\" cy=\"{z:.1}\" r=\"{:.1}\" fill=\"{INK}\" \
             stroke=\"#fff\"/></g>",
            radius(hole.radius)
        ),
    );
    let surface = scale.z((map.surface - hole.height) / d);
    if surface > top {
        push(
            &mut out,
            // White between the dashes: seen on the darkest colour too.
            format_args!(
                "<path d=\"M{left:.1} {surface:.1}H{right:.1}\" stroke=\"#fff\" stroke-width=\"1.6\"/>\
                 <path d=\"M{left:.1} {surface:.1}H{right:.1}\" stroke=\"{INK}\" stroke-width=\"1.6\" \
                 stroke-dasharray=\"7 5\"/>"
            ),
        );
    }
    ticks(&mut out, &scale, ["x / D", "z / D, from the centre"]);
    out.push_str("</svg>");
    Some(out)
}

/// Cells by colour: one path for each, of rectangles that hold as many neighbours as are alike.
fn bands(out: &mut String, map: &Map, scale: &Scale) {
    let grid = map.grid;
    let [nx, _, nz] = grid.counts;
    let d = 2.0 * map.hole.radius;
    let step = grid.step();
    let mut paths = vec![String::new(); RAMP.len()];
    for kz in 0..nz {
        let z = (grid.at(2, kz) - map.hole.height) / d;
        let half = 0.5 * step[2] / d;
        if z + half < scale.lo[1] || z - half > scale.hi[1] {
            continue;
        }
        let (high, low) = (scale.z(z + half), scale.z(z - half));
        let shown = |kx: usize| {
            let x = grid.at(0, kx) / d;
            let inside = x.abs() < scale.hi[0] + 0.5 * step[0] / d;
            let value = map.values[kz * nx + kx].filter(|_| inside)?;
            Some(level(value, map.most))
        };
        let mut kx = 0;
        while kx < nx {
            let first = kx;
            let own = shown(kx);
            while kx < nx && shown(kx) == own {
                kx += 1;
            }
            let Some(level) = own else {
                continue;
            };
            let from = scale.x((grid.at(0, first) - 0.5 * step[0]) / d);
            let wide = (kx - first) as f64 * step[0] / d * scale.factor;
            let tall = low - high;
            // A little larger than the cell, so that no seam shows between neighbours.
            push(
                &mut paths[level],
                format_args!(
                    "M{from:.1} {high:.1}h{:.1}v{:.1}h-{:.1}z",
                    wide + 0.3,
                    tall + 0.3,
                    wide + 0.3
                ),
            );
        }
    }
    for (path, colour) in paths.iter().zip(RAMP) {
        if !path.is_empty() {
            push(out, format_args!("<path fill=\"{colour}\" d=\"{path}\"/>"));
        }
    }
}

/// The scale of colours from zero to `most`, with its name.
pub(super) fn key(name: &str, most: f64) -> String {
    let mut bar = String::new();
    for (k, colour) in RAMP.iter().enumerate() {
        let x = 30 * k;
        bar.push_str(&format!(
            "<rect x=\"{x}\" width=\"30.5\" height=\"20\" fill=\"{colour}\"/>"
        ));
    }
    for k in 0..=4 {
        let (x, anchor) = match k {
            0 => (0, "start"),
            4 => (360, "end"),
            k => (90 * k, "middle"),
        };
        let beyond = if k == 4 { "\u{2265}\u{a0}" } else { "" };
        let value = short(most * f64::from(k) / 4.0);
        bar.push_str(&format!(
            "<text x=\"{x}\" y=\"38\" text-anchor=\"{anchor}\" fill=\"{INK}\">{beyond}{value}</text>"
        ));
    }
    format!(
        "<p class=\"legend\"><span>{name}:</span><svg class=\"scale\" viewBox=\"0 0 361 42\" role=\"img\" \
         aria-label=\"scale of colours\" font-family=\"sans-serif\" font-size=\"15\">{bar}</svg>\
         <span><svg class=\"key\" viewBox=\"0 0 24 24\" aria-hidden=\"true\"><rect width=\"24\" height=\"24\" \
         fill=\"{NONE}\"/></svg>no data</span></p>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(values: &[Option<f64>], lines: &[Vec<[f64; 2]>]) -> String {
        let grid = Grid {
            counts: [20, 1, 20],
            size: [10.0, 1.0, 10.0],
        };
        map(&Map {
            title: "a < b",
            grid,
            hole: IntruderOutline {
                height: 5.0,
                radius: 0.5,
                cylinder: true,
            },
            window: 1.0,
            values,
            most: 1.2,
            lines,
            surface: 9.0,
            reach: [4.0, 4.0, 4.5],
            index: "a",
        })
        .unwrap()
    }

    /// Alike neighbours are one rectangle: a row of a flat field, of which the map shows sixteen.
    #[test]
    fn neighbours_of_one_colour_are_one_rectangle() {
        let flat = drawn(&[Some(0.55); 400], &[]);
        assert_eq!(flat.matches("z\"/>").count(), 1, "one colour");
        let rows = flat.matches('z').count();
        assert!((17..=30).contains(&flat.matches("h-").count()), "{rows}");
        assert!(flat.contains("a &lt; b") && flat.contains(RAMP[5]));
        let mut holed = vec![Some(0.55); 400];
        holed[10 * 20 + 10] = None;
        assert_eq!(
            drawn(&holed, &[]).matches("h-").count(),
            flat.matches("h-").count() + 1
        );
        let line = drawn(&holed, &[vec![[-3.0, 5.0], [0.0, 6.0], [3.0, 5.0]]]);
        assert!(line.len() > flat.len() && !line.contains("NaN"));
    }

    #[test]
    fn scales_reach_all_but_a_few_values() {
        assert_eq!(top((0..1000).map(f64::from)), Some(1000.0));
        assert_eq!(top([2.25, 0.1].into_iter()), Some(2.4));
        assert_eq!(top([0.033].into_iter()), Some(0.04));
        assert_eq!(top([f64::NAN, -1.0].into_iter()), None);
        assert_eq!(top([].into_iter()), None);
        assert_eq!(
            [-1.0, 0.0, 0.5, 1.0, 9.0].map(|x| level(x, 1.0)),
            [0, 0, 6, 11, 11]
        );
        assert_eq!(level(f64::NAN, 1.0), 0);
        let key = key("P/P<sub>0</sub>", 8.0);
        assert!(key.contains("\u{2265}\u{a0}8<") && key.contains(">4<"));
    }
}
