//! The plane's table, read again.

use super::grid::Grid;
use super::plane::{FieldPoint, Fields, Flag};
use super::text::{PLANE, PlaneRow};

/// The fields of a table with a row for each point of this grid's plane.
///
/// # Errors
/// The line that is not the row that should be there, counted from 1; if rows are missing, the one after
/// the last.
pub fn plane(text: &str, grid: Grid) -> Result<Fields, usize> {
    let grid = Grid {
        counts: [grid.counts[0], 1, grid.counts[2]],
        ..grid
    };
    let mut fields = Fields {
        grid,
        flags: Vec::with_capacity(grid.points()),
        points: Vec::with_capacity(grid.points()),
    };
    let rows = PLANE.numbered(text)?;
    for (k, (line, row)) in rows.iter().enumerate() {
        let (kx, kz) = (k % grid.counts[0], k / grid.counts[0]);
        // Another grid has its points elsewhere.
        let place = [grid.at(0, kx), grid.at(2, kz)].map(|p| Some(p as f32));
        if k == grid.points() || row.place.map(|p| p.map(|p| p as f32)) != place {
            return Err(*line);
        }
        fields.flags.push(row.flag);
        fields.points.push(point(row).ok_or(*line)?);
    }
    match rows.len() == grid.points() {
        true => Ok(fields),
        false => Err(rows.last().map_or(text.lines().count(), |(line, _)| *line) + 1),
    }
}

/// What a row says of its point; `None` if a number is missing.
fn point(row: &PlaneRow) -> Option<FieldPoint> {
    if row.flag == Flag::Empty {
        return Some(FieldPoint {
            packing_fraction: 0.0,
            velocity: [0.0; 3],
            stress: [[0.0; 3]; 3],
        });
    }
    let three = |v: [Option<f64>; 3]| Some([v[0]?, v[1]?, v[2]?]);
    let [x, y, z] = row.stress.map(three);
    Some(FieldPoint {
        packing_fraction: row.packing_fraction?,
        velocity: three(row.velocity)?,
        stress: [x?, y?, z?],
    })
}
