//! The section of a page with maps of pressure and velocity, with a pressure gradient and without side by
//! side (Guillard 2014, Figs. 9 and 13).

use super::caption::depth_text;
use super::fieldmap::{Map, key, map, top};
use super::text::escape;
use crate::claims::{Group, same_depth};
use bitgrain_lab::summary::{DragSummary, Summary};
use bitgrain_sim::coarse_graining::streamlines::streamline;
use bitgrain_sim::coarse_graining::{FieldPoint, Fields, Flag, IntruderOutline};

/// Mean fields of a run in the plane x, z.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldPicture {
    /// Name of the run.
    pub run: String,
    /// The fields.
    pub fields: Fields,
    /// Its intruder.
    pub hole: IntruderOutline,
    /// Radius of the averaging windows.
    pub window: f64,
    /// Height of the free surface of the settled bed.
    pub surface: f64,
    /// Velocity along x of the far grains, as asked for, in the intruder's frame.
    pub far: f64,
}

/// How far maps reach from the intruder's centre, in diameters: to either side, down, up.
const REACH: [f64; 3] = [7.0, 6.0, 9.5];
/// Streamlines of a map.
const LINES: usize = 22;
/// Length of a step along them, in cells.
const STEP: f64 = 0.5;

/// A quantity of a map: its name, whether streamlines are drawn, and its value at a point.
type Quantity = (
    &'static str,
    bool,
    fn(&FieldPicture, &DragSummary, &FieldPoint) -> f64,
);

const QUANTITIES: [Quantity; 3] = [
    ("pressure over \u{3c1}gh\u{303}", false, |_, run, point| {
        let pressure = run.flow.as_ref().map_or(f64::NAN, |flow| flow.pressure);
        point.pressure() / pressure
    }),
    (
        "speed over V in the frame of the intruder, with streamlines",
        true,
        |_, run, point| size(point.velocity) / run.speed,
    ),
    (
        "speed over V in the frame of the far grains",
        false,
        |picture, run, point| {
            let [x, y, z] = point.velocity;
            size([x - picture.far, y, z]) / run.speed
        },
    ),
];

fn size([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// The section; empty if no run has fields.
pub(super) fn section(summary: &Summary, groups: &[Group], pictures: &[FieldPicture]) -> String {
    if pictures.is_empty() {
        return String::new();
    }
    let mut body = String::new();
    for (k, row) in rows(summary, groups, pictures).iter().enumerate() {
        for (q, quantity) in QUANTITIES.iter().enumerate() {
            body.push_str(&figures(summary, row, quantity, &format!("f{k}{q}")));
        }
    }
    format!(
        "<section>\n<h2>Fields round the intruder</h2>\n<p>Means over the steady state in spherical windows, and \
         along y, without a pressure gradient at the left and with one at the right if there are both; one \
         scale for both. V is the speed of the motion. Inside the dashed \
         circle the intruder fills a part of the windows, and the pressure is too low. Dashed line: free surface of \
         the settled bed. One of the seeds of each kind; <code>fields.vti</code> in the folder of each run is for \
         ParaView, <code>plane.csv</code> has the numbers drawn here.</p>\n{body}</section>\n"
    )
}

/// Pictures that are shown side by side: of each cylinder and effective depth the first seed's, without and with a
/// gradient.
fn rows<'a>(
    summary: &'a Summary,
    groups: &[Group],
    pictures: &'a [FieldPicture],
) -> Vec<Vec<(&'a DragSummary, &'a FieldPicture)>> {
    let mut all = Vec::new();
    for group in groups {
        let mut rows: Vec<(f64, Vec<(&DragSummary, &FieldPicture)>)> = Vec::new();
        let points = [false, true].map(|gradient| group.with_gradient(gradient));
        for point in points.into_iter().flatten() {
            let mut shown = point.runs.iter().filter_map(|&k| {
                let run = &summary.runs[k];
                Some((run, pictures.iter().find(|p| p.run == run.name)?))
            });
            let Some(first) = shown.next() else {
                continue;
            };
            match rows
                .iter_mut()
                .find(|(depth, _)| same_depth(*depth, point.asked))
            {
                Some((_, row)) => row.push(first),
                None => rows.push((point.asked, vec![first])),
            }
        }
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.extend(rows.into_iter().map(|(_, row)| row));
    }
    all
}

/// One quantity of a row of pictures, to one scale.
fn figures(
    summary: &Summary,
    row: &[(&DragSummary, &FieldPicture)],
    (name, lines, of): &Quantity,
    index: &str,
) -> String {
    let values: Vec<Vec<Option<f64>>> = row
        .iter()
        .map(|(run, picture)| {
            let known = picture.fields.points.iter().zip(&picture.fields.flags);
            known
                .map(|(point, flag)| (*flag != Flag::Empty).then(|| of(picture, run, point)))
                .collect()
        })
        .collect();
    let Some(most) = top(values.iter().flatten().flatten().copied()) else {
        return String::new();
    };
    let mut out = String::new();
    // One window for all, so that lengths are comparable.
    let farther = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[k].max(b[k]));
    let reach = row
        .iter()
        .map(|(_, picture)| reach(picture))
        .fold([0.0; 3], farther);
    for (k, ((run, picture), values)) in row.iter().zip(&values).enumerate() {
        let lines = match lines {
            true => streamlines(picture, reach),
            false => Vec::new(),
        };
        let drawn = map(&Map {
            title: &format!("{}, {}", name, run.name),
            grid: picture.fields.grid,
            hole: picture.hole,
            window: picture.window,
            values,
            most,
            lines: &lines,
            surface: picture.surface,
            reach,
            index: &format!("{index}{k}"),
        });
        if let Some(svg) = drawn {
            out.push_str(&format!(
                "<figure>{svg}<figcaption><b>{}</b>{}: {name}.</figcaption></figure>\n",
                escape(&run.name),
                depth_text(summary, run)
            ));
        }
    }
    format!("{}<div class=\"grid\">\n{out}</div>\n", key(name, most))
}

/// How far a map goes: never beyond the box, nor far above what is known.
fn reach(picture: &FieldPicture) -> [f64; 3] {
    let (grid, d) = (picture.fields.grid, 2.0 * picture.hole.radius);
    let known = (0..grid.counts[2]).rev().find(|kz| {
        let row = kz * grid.counts[0]..(kz + 1) * grid.counts[0];
        picture.fields.flags[row].iter().any(|f| *f != Flag::Empty)
    });
    let top = known.map_or(grid.size[2], |kz| grid.at(2, kz) + grid.step()[2]);
    let most = [
        0.5 * grid.size[0],
        picture.hole.height,
        top - picture.hole.height,
    ]
    .map(|x| x / d);
    [0, 1, 2].map(|a| {
        if most[a] < REACH[a] {
            most[a]
        } else {
            REACH[a]
        }
    })
}

/// Lines through places at equal heights where the flow comes in.
fn streamlines(picture: &FieldPicture, [side, down, up]: [f64; 3]) -> Vec<Vec<[f64; 2]>> {
    let (grid, d) = (picture.fields.grid, 2.0 * picture.hole.radius);
    let step = STEP * grid.step()[0];
    let most = (4.0 * side * d / step) as usize;
    let start = |k: usize| {
        let part = (k as f64 + 0.5) / LINES as f64;
        let x = 0.98 * side * d * -picture.far.signum();
        [x, picture.hole.height + d * (part * (down + up) - down)]
    };
    let all = (0..LINES).map(|k| streamline(&picture.fields, start(k), step, most));
    all.filter(|line| line.len() > 2).collect()
}
