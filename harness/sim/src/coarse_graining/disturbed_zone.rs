//! How far the intruder disturbs the bed above it and below (Guillard 2014, section III C and Fig. 9).

use super::plane::{FieldPoint, Fields, IntruderOutline};

/// Part of the box, on either side of the intruder, that is disturbed; beyond is the far field.
const NEAR: f64 = 0.25;

/// `integral |v - v_far|/V dA` above the intruder's centre and below it, over its diameter squared: V is the
/// speed of the motion, v_far the mean velocity of the far field at the same height, and both areas reach to
/// `reach` from the centre. The same of the far field, which is the noise, is subtracted. `None` if
/// nothing is known of one of them.
pub fn disturbance(
    fields: &Fields,
    hole: IntruderOutline,
    speed: f64,
    reach: f64,
) -> Option<[f64; 2]> {
    let [nx, _, nz] = fields.grid.counts;
    let [step_x, _, step_z] = fields.grid.step();
    let near = |kx: &usize| fields.grid.at(0, *kx).abs() < NEAR * fields.grid.size[0];
    let (mut areas, mut heights) = ([0.0; 2], [0.0; 2]);
    for kz in 0..nz {
        let row = |inside: bool| {
            let all = (0..nx).filter(move |kx| near(kx) == inside);
            all.filter_map(move |kx| fields.at(kx, kz))
        };
        let [close, far] = [true, false].map(|inside| row(inside).count() as f64);
        if close == 0.0 || far == 0.0 {
            continue;
        }
        let mean = [0, 1, 2].map(|a| row(false).map(|p| p.velocity[a]).sum::<f64>() / far);
        let apart = |p: &FieldPoint| {
            let off = [0, 1, 2].map(|a| p.velocity[a] - mean[a]);
            (off[0] * off[0] + off[1] * off[1] + off[2] * off[2]).sqrt()
        };
        let sum = |inside: bool| row(inside).map(apart).sum::<f64>();
        let own = (sum(true) - sum(false) * close / far) * step_x;
        // Of a cell across the centre each side gets its part.
        let z = fields.grid.at(2, kz) - hole.height;
        for (side, [low, high]) in [[0.0, reach], [-reach, 0.0]].into_iter().enumerate() {
            let part = (z + 0.5 * step_z).min(high) - (z - 0.5 * step_z).max(low);
            if part > 0.0 {
                areas[side] += own * part;
                heights[side] += part;
            }
        }
    }
    let square = 4.0 * hole.radius * hole.radius;
    // To equal distances, or they cannot be compared.
    let whole = |height: f64| reach > 0.0 && height > (1.0 - 1e-9) * reach;
    (whole(heights[0]) && whole(heights[1])).then(|| areas.map(|area| area / (speed * square)))
}

#[cfg(test)]
mod tests {
    use super::super::grid::Grid;
    use super::super::plane::Flag;
    use super::*;

    /// A patch that goes at twice the speed of all else, wider above than below.
    #[test]
    fn a_patch_has_its_area() {
        let grid = Grid {
            counts: [40, 1, 40],
            size: [20.0, 1.0, 20.0],
        };
        let place = |k: usize| [grid.at(0, k % 40), grid.at(2, k / 40) - 10.0];
        let point = |k: usize| {
            let [x, z] = place(k);
            let wide = if z > 0.0 { 4.0 } else { 2.0 };
            let fast = x.abs() < wide && z.abs() < 3.0;
            FieldPoint {
                packing_fraction: 0.6,
                velocity: [if fast { 2.0 } else { 1.0 }, 0.0, 0.0],
                stress: [[0.0; 3]; 3],
            }
        };
        let mut fields = Fields {
            grid,
            flags: vec![Flag::Whole; 1600],
            points: (0..1600).map(point).collect(),
        };
        let hole = IntruderOutline {
            height: 10.0,
            radius: 1.0,
            cylinder: true,
        };
        let areas = disturbance(&fields, hole, 1.0, 5.0).unwrap();
        assert_eq!(areas, [8.0 * 3.0 / 4.0, 4.0 * 3.0 / 4.0]);
        // A cell that the centre cuts is shared out; this grid has cells of half a unit.
        let off = IntruderOutline {
            height: 10.1,
            ..hole
        };
        let shared = disturbance(&fields, off, 1.0, 5.0).unwrap();
        let want = [8.0 * 2.9 / 4.0, (8.0 * 0.1 + 4.0 * 3.0) / 4.0];
        assert!(
            (0..2).all(|k| (shared[k] - want[k]).abs() < 1e-12),
            "{shared:?}"
        );
        // Nothing beyond the reach asked for counts.
        assert_eq!(disturbance(&fields, hole, 1.0, 1.0).unwrap(), [2.0, 1.0]);
        for k in 0..1600 {
            if place(k)[1] < 0.0 {
                fields.flags[k] = Flag::Empty;
            }
        }
        assert_eq!(disturbance(&fields, hole, 1.0, 5.0), None);
    }
}
