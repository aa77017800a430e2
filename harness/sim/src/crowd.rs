//! Crowds of grains that overlap: found before their pairs are listed, since the number of pairs grows with the
//! square of theirs.

use bitgrain_kernel::Row;

/// Fewest grains that are looked at: the pairs of fewer are few.
const LEAST: usize = 4096;

/// More grains of sizes within a factor of two whose centres share a cube as wide as the smallest cannot be without
/// two of them overlapping by more than half the smaller radius: there is room for 18.
const CROWD: usize = 64;

/// Places of two grains that overlap by more than half the smaller radius, ascending, if there is a crowd of such;
/// `counts` says which grains may not.
pub fn deep_pair(position: &[Row<f64>], counts: impl Fn(usize) -> bool) -> Option<(usize, usize)> {
    if position.len() < LEAST {
        return None;
    }
    let mut cells: Vec<(u64, u32)> = Vec::new();
    // If there is no memory even for this, the lists will be refused.
    cells.try_reserve_exact(position.len()).ok()?;
    let places = (0..position.len()).filter(|&i| counts(i));
    cells.extend(places.map(|i| (cell(&position[i]), i as u32)));
    cells.sort_unstable();
    cells
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|crowd| crowd.len() > CROWD)
        .find_map(|crowd| deepest_of(&crowd[..=CROWD], position))
}

/// A number for the cube that a centre is in, of edges as long as the smallest diameter of its class of sizes, which
/// goes up to twice that.
fn cell(x: &Row<f64>) -> u64 {
    let class = x[3].to_bits() >> 52;
    let side = 2.0 * f64::from_bits(class << 52);
    let mut number = class;
    for a in 0..3 {
        let along = (x[a] / side).floor() as i64;
        // Cubes that share a number are distinguished by the grains themselves.
        number = (number ^ along as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        number ^= number >> 29;
    }
    number
}

/// The first two of a few grains that overlap by more than half the smaller radius.
fn deepest_of(crowd: &[(u64, u32)], position: &[Row<f64>]) -> Option<(usize, usize)> {
    for (k, (_, j)) in crowd.iter().enumerate() {
        for (_, i) in &crowd[..k] {
            let (x, y) = (position[*i as usize], position[*j as usize]);
            let d = [x[0] - y[0], x[1] - y[1], x[2] - y[2]];
            let distance = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
            let least = if x[3] < y[3] { x[3] } else { y[3] };
            if (x[3] + y[3]) - distance > 0.5 * least {
                return Some((*i as usize, *j as usize));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crowd_is_seen_and_a_lattice_is_none() {
        let lattice = |n: usize, step: f64| -> Vec<Row<f64>> {
            let at = |k: usize| [k % n, k / n % n, k / n / n].map(|x| step * x as f64);
            (0..n * n * n)
                .map(|k| [at(k)[0], at(k)[1], at(k)[2], 0.5])
                .collect()
        };
        // As near as is allowed: 0.75 of a diameter.
        assert_eq!(deep_pair(&lattice(20, 0.751), |_| true), None);
        let same = vec![[0.3, 0.3, 0.3, 0.5]; 5000];
        assert_eq!(deep_pair(&same, |_| true), Some((0, 1)));
        assert_eq!(deep_pair(&same, |i| i < 60), None);
        assert_eq!(deep_pair(&same[..100], |_| true), None);
        let none = vec![[f64::NAN, f64::INFINITY, 0.0, f64::NAN]; 5000];
        assert_eq!(deep_pair(&none, |_| true), None);
    }
}
