//! Spatial order: numbers that keep near grains near in memory.

/// Places of the points along a Morton curve through cells of `width`, ties by place: entry `k` is
/// the point that comes `k`-th.
pub fn spatial_order(points: &[[f64; 4]], width: f64) -> Vec<usize> {
    let mut lo = [f64::INFINITY; 3];
    for x in points {
        for a in 0..3 {
            if x[a] < lo[a] {
                lo[a] = x[a];
            }
        }
    }
    let key = |x: &[f64; 4]| {
        let cell = |a: usize| ((x[a] - lo[a]) / width) as u64;
        spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2
    };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by_key(|&k| (key(&points[k]), k));
    order
}

/// The lowest 21 bits, two zeros between each.
fn spread(value: u64) -> u64 {
    let mut x = value & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreading_keeps_every_bit_in_order() {
        for bit in 0..21 {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
    }

    #[test]
    fn near_points_get_near_places() {
        let points: Vec<[f64; 4]> = (0..64)
            .map(|k| [(k % 4) as f64, (k / 4 % 4) as f64, (k / 16) as f64, 0.0])
            .collect();
        let order = spatial_order(&points, 1.0);
        let first: Vec<usize> = order[..8].to_vec();
        assert_eq!(first, [0, 1, 4, 5, 16, 17, 20, 21]);
    }
}
