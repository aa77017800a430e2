//! A tank from above, and how its grains go round.

use super::fieldmap::{Map, map};
use super::picture::BedPicture;
use super::scale::{Cut, INK, Scale, circles, open, push, ticks};
use super::text::{escape, typeset};
use bitgrain_lab::summary::{DragSummary, Tank};
use bitgrain_lab::tank_tables::{RING, SECTORS, VelocityRow};
use bitgrain_sim::coarse_graining::IntruderOutline;
use bitgrain_sim::coarse_graining::grid::Grid;
use bitgrain_sim::simulation::Role;

/// Part of the width that is left free round a tank.
const MARGIN: f64 = 0.02;

/// The cut of a bed at the height of its bar's axis as SVG, with the bar along y; `None` if it has no extent. `index`
/// keeps the names of clips and patterns of several pictures on a page apart.
pub(super) fn from_above(bed: &BedPicture, unit: &str, index: usize) -> Option<String> {
    let ([x, y, z], radius) = bed.intruder;
    let half = bed.half_length?;
    let margin = MARGIN * (bed.hi[0] - bed.lo[0]);
    let [lo, hi] =
        [(bed.lo, -margin), (bed.hi, margin)].map(|(at, more)| [at[0] + more, at[1] + more]);
    let scale = Scale::new(lo, hi)?;
    let cut = |role: Role| -> Vec<Cut> {
        let grains = bed.grains.iter().filter(|grain| grain.role == role);
        grains
            .filter_map(|grain| {
                let off = grain.position[2] - z;
                let square = grain.radius * grain.radius - off * off;
                (square > 0.0).then(|| Cut {
                    x: grain.position[0],
                    z: grain.position[1],
                    radius: square.sqrt(),
                })
            })
            .collect()
    };
    let mut out = String::new();
    let title = format!("The bed {} from above, at the height of the bar", bed.name);
    open(&mut out, "slice", &title, &index.to_string(), &scale);
    circles(
        &mut out,
        &scale,
        &cut(Role::Free),
        "fill=\"#dcd8cd\" stroke=\"#8a877d\"",
    );
    let hatch = format!("fill=\"url(#hatch-{index})\" stroke=\"{INK}\"");
    circles(&mut out, &scale, &cut(Role::Base), &hatch);
    let (left, top) = (scale.x(x - radius), scale.z(y + half));
    let (wide, tall) = (2.0 * radius * scale.factor, 2.0 * half * scale.factor);
    let wall = 0.5 * (bed.hi[0] - bed.lo[0]);
    push(
        &mut out,
        format_args!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{wide:.1}\" height=\"{tall:.1}\" fill=\"{INK}\" \
             stroke=\"#fff\"/><circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"{:.1}\" fill=\"none\" stroke=\"{INK}\" \
             stroke-width=\"1.6\"/></g>",
            scale.x(bed.lo[0] + wall),
            scale.z(bed.lo[1] + wall),
            wall * scale.factor
        ),
    );
    let unit = escape(&typeset(unit));
    ticks(
        &mut out,
        &scale,
        [&format!("x ({unit})"), &format!("y ({unit})")],
    );
    out.push_str("</svg>");
    Some(out)
}

/// The mean speed round the axis in the ring that a bar sweeps, as SVG, in the first half turn or `after` it; `None` if
/// there is none. `index` is as that of [`from_above`].
pub(super) fn speed_map(
    run: &DragSummary,
    tank: &Tank,
    rows: &[VelocityRow],
    surface: f64,
    after: bool,
    index: &str,
) -> Option<String> {
    let value = |row: &VelocityRow| if after { row.ahead_after } else { row.ahead };
    let values: Vec<Option<f64>> = rows.iter().map(value).collect();
    values.iter().flatten().next()?;
    let layers = rows.len() / SECTORS;
    let layer = 2.0 * rows.first()?.height;
    // Half a turn at the mean radius of the ring.
    let arc = std::f64::consts::PI * 0.25 * (RING[0] + RING[1]) * tank.length;
    let (center, radius) = (surface - run.depth, 0.5 * run.diameter);
    let top = layers as f64 * layer;
    let when = if after {
        "after the first half turn"
    } else {
        "in the first half turn"
    };
    map(&Map {
        title: &format!("Speed of the grains round the axis {when}, {}", run.name),
        grid: Grid {
            counts: [SECTORS, 1, layers],
            size: [arc, 1.0, top],
        },
        hole: IntruderOutline {
            height: center,
            radius,
            cylinder: true,
        },
        window: 0.0,
        values: &values,
        most: 1.0,
        lines: &[],
        surface,
        reach: [0.5 * arc, center, top - center].map(|length| length / run.diameter),
        index,
    })
}

#[cfg(test)]
mod tests {
    use super::super::picture::PictureGrain;
    use super::*;
    use bitgrain_sim::motion::Moves;

    /// Grains at the height of the bar are drawn, others are not; the bar lies along y.
    #[test]
    fn a_tank_is_cut_at_the_height_of_its_bar() {
        let grain = |position, role| PictureGrain {
            position,
            radius: 0.5,
            role,
        };
        let bed = BedPicture {
            name: "bed".into(),
            lo: [0.0; 3],
            hi: [10.0, 10.0, 30.0],
            surface: 8.0,
            grains: vec![
                grain([2.0, 3.0, 4.2], Role::Free),
                grain([9.5, 5.0, 4.0], Role::Base),
                grain([4.0, 5.0, 6.0], Role::Free),
            ],
            intruder: ([5.0, 5.0, 4.0], 1.0),
            half_length: Some(3.0),
            moves: Moves::Intruder,
            arrow: true,
        };
        let svg = from_above(&bed, "d", 0).unwrap();
        // Two grains and the wall.
        assert_eq!(svg.matches("<circle").count(), 3);
        let size = |name: &str| -> f64 {
            let bar = svg.split("<rect").last().unwrap();
            let rest = bar.split(&format!("{name}=\"")).nth(1).unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        };
        assert!((size("height") / size("width") - 3.0).abs() < 0.01, "{svg}");
        let ball = BedPicture {
            half_length: None,
            ..bed
        };
        assert!(from_above(&ball, "d", 0).is_none());
    }
}
