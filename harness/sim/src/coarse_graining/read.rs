//! The plane's table, read again.

use super::grid::Grid;
use super::plane::{FieldPoint, Fields, Flag};
use super::text::PLANE_COLUMNS;
use crate::files::finite;

/// Columns that hold what cannot be made of others: up to the last stress.
const OWN: usize = 17;

/// The fields of a table with a row for each point of this grid's plane.
///
/// # Errors
/// The line that is not the row that should be there, counted from 1; where rows are missing, the one after
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
    let mut last = 0;
    for (k, line) in text.lines().enumerate() {
        last = k + 1;
        if line.starts_with('#') || line == PLANE_COLUMNS {
            continue;
        }
        let place = fields.points.len();
        let ([x, z], flag, point) = row(line).ok_or(k + 1)?;
        let (kx, kz) = (place % grid.counts[0], place / grid.counts[0]);
        // Another grid has its points elsewhere.
        if place == grid.points() || [x, z] != [grid.at(0, kx), grid.at(2, kz)].map(|p| p as f32) {
            return Err(k + 1);
        }
        fields.flags.push(flag);
        fields.points.push(point);
    }
    match fields.points.len() == grid.points() {
        true => Ok(fields),
        false => Err(last + 1),
    }
}

fn row(line: &str) -> Option<([f32; 2], Flag, FieldPoint)> {
    let cells: Vec<&str> = line.split(',').collect();
    if cells.len() != PLANE_COLUMNS.split(',').count() {
        return None;
    }
    let place = [finite(cells[0])? as f32, finite(cells[1])? as f32];
    let flag = Flag::of(cells[2].parse().ok()?)?;
    let mut numbers = [0.0; OWN];
    if flag != Flag::Empty {
        for (number, cell) in numbers.iter_mut().zip(&cells).skip(3) {
            *number = finite(cell)?;
        }
    }
    let s = &numbers[8..];
    let point = FieldPoint {
        packing_fraction: numbers[3],
        velocity: [numbers[4], numbers[5], numbers[6]],
        stress: [[s[0], s[1], s[2]], [s[3], s[4], s[5]], [s[6], s[7], s[8]]],
    };
    Some((place, flag, point))
}
