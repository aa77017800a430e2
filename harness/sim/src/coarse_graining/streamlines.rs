//! Streamlines of the mean flow in the plane x, z.

use super::plane::Fields;

/// The velocity along x and z at a place, linear between the four points round it; `None` beyond the points,
/// and if one of the four is empty.
pub fn velocity(fields: &Fields, [x, z]: [f64; 2]) -> Option<[f64; 2]> {
    let [nx, _, nz] = fields.grid.counts;
    let ([step_x, _, step_z], low) = (fields.grid.step(), fields.grid.low());
    let (u, w) = ((x - low[0]) / step_x - 0.5, (z - low[2]) / step_z - 0.5);
    let inside = |t: f64, n: usize| t >= 0.0 && t <= (n - 1) as f64;
    if nx < 2 || nz < 2 || !inside(u, nx) || !inside(w, nz) {
        return None;
    }
    let (kx, kz) = ((u as usize).min(nx - 2), (w as usize).min(nz - 2));
    let (a, b) = (u - kx as f64, w - kz as f64);
    let mut out = [0.0; 2];
    for (dx, dz, weight) in [
        (0, 0, (1.0 - a) * (1.0 - b)),
        (1, 0, a * (1.0 - b)),
        (0, 1, (1.0 - a) * b),
        (1, 1, a * b),
    ] {
        let v = fields.at(kx + dx, kz + dz)?.velocity;
        out[0] += weight * v[0];
        out[1] += weight * v[2];
    }
    Some(out)
}

/// The line through a place, along the flow and against it, by the fourth-order Runge-Kutta rule with steps of
/// length `step`; it ends where the velocity is not known, or after `most` steps each way.
pub fn streamline(fields: &Fields, start: [f64; 2], step: f64, most: usize) -> Vec<[f64; 2]> {
    let half = |sign: f64| {
        let mut line = vec![start];
        let mut at = start;
        for _ in 0..most {
            let Some(next) = advance(fields, at, sign * step) else {
                break;
            };
            line.push(next);
            at = next;
        }
        line
    };
    let mut line = half(-1.0);
    line.reverse();
    line.pop();
    line.extend(half(1.0));
    line
}

/// One step along the direction of the flow.
fn advance(fields: &Fields, at: [f64; 2], step: f64) -> Option<[f64; 2]> {
    let direction = |at: [f64; 2]| {
        let [x, z] = velocity(fields, at)?;
        let length = (x * x + z * z).sqrt();
        (length > 0.0).then(|| [x / length, z / length])
    };
    let shifted =
        |by: [f64; 2], part: f64| [at[0] + part * step * by[0], at[1] + part * step * by[1]];
    let k1 = direction(at)?;
    let k2 = direction(shifted(k1, 0.5))?;
    let k3 = direction(shifted(k2, 0.5))?;
    let k4 = direction(shifted(k3, 1.0))?;
    let sum = |a: usize| (k1[a] + 2.0 * k2[a] + 2.0 * k3[a] + k4[a]) / 6.0;
    Some([at[0] + step * sum(0), at[1] + step * sum(1)])
}

#[cfg(test)]
mod tests {
    use super::super::grid::Grid;
    use super::super::plane::{FieldPoint, Flag};
    use super::*;

    fn flow(of: fn(f64, f64) -> [f64; 2]) -> Fields {
        let grid = Grid {
            counts: [41, 1, 41],
            size: [20.5, 1.0, 20.5],
        };
        let point = |k: usize| {
            let [x, z] = of(grid.at(0, k % 41), grid.at(2, k / 41) - 10.25);
            FieldPoint {
                packing_fraction: 0.6,
                velocity: [x, 0.0, z],
                stress: [[0.0; 3]; 3],
            }
        };
        Fields {
            grid,
            flags: vec![Flag::Whole; 41 * 41],
            points: (0..41 * 41).map(point).collect(),
        }
    }

    /// A rigid turn is linear, so that a line through it is a circle but for the rule's error.
    #[test]
    fn a_turn_has_circles() {
        let fields = flow(|x, z| [-z, x]);
        let [x, z] = velocity(&fields, [3.3, 10.4]).unwrap();
        assert!(
            (x + 0.15).abs() < 1e-12 && (z - 3.3).abs() < 1e-12,
            "{x} {z}"
        );
        let line = streamline(&fields, [5.0, 10.25], 0.2, 300);
        assert!(line.len() > 500);
        for [x, z] in line {
            let r = (x * x + (z - 10.25) * (z - 10.25)).sqrt();
            assert!((r - 5.0).abs() < 1e-4, "{r}");
        }
    }

    #[test]
    fn lines_end_where_nothing_is_known() {
        let mut fields = flow(|_, _| [1.0, 0.0]);
        for kz in 0..41 {
            fields.flags[kz * 41 + 30] = Flag::Empty;
        }
        let line = streamline(&fields, [0.0, 9.0], 0.25, 1000);
        let (first, last) = (line[0], line[line.len() - 1]);
        assert!(
            first[0] < -9.7 && last[0] > 4.0 && last[0] < 5.0,
            "{first:?} {last:?}"
        );
        assert!(line.iter().all(|p| p[1] == 9.0));
        assert_eq!(velocity(&fields, [5.0, 9.0]), None);
        assert_eq!(velocity(&fields, [0.0, 0.1]), None);
        let rest = flow(|_, _| [0.0, 0.0]);
        assert_eq!(streamline(&rest, [0.0, 9.0], 0.25, 10), [[0.0, 9.0]]);
    }
}
