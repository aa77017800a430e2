//! What of a grain, and of a contact, lies inside a spherical averaging window (Guillard 2014, eqs. A2 and
//! A3).

/// Volume that two balls share, of radii `a` and `b` and so far between their centres.
pub fn lens(a: f64, b: f64, distance: f64) -> f64 {
    let pi = std::f64::consts::PI;
    if distance >= a + b {
        return 0.0;
    }
    if distance <= (a - b).abs() {
        let least = if a < b { a } else { b };
        return 4.0 / 3.0 * pi * (least * least * least);
    }
    let depth = a + b - distance;
    let off = a - b;
    pi * (depth * depth) * (distance * (distance + 2.0 * (a + b)) - 3.0 * (off * off))
        / (12.0 * distance)
}

/// Part, 0 to 1, of the straight line between two points that lies inside a ball; the points are given from
/// the ball's centre.
pub fn part_inside(from: [f64; 3], to: [f64; 3], radius: f64) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (square, middle) = (dot(along, along), dot(from, along));
    let outside = dot(from, from) - radius * radius;
    if square == 0.0 {
        return if outside <= 0.0 { 1.0 } else { 0.0 };
    }
    // |from + t along| = radius at two t.
    let root = middle * middle - square * outside;
    if root <= 0.0 {
        return 0.0;
    }
    let root = root.sqrt();
    let enters = ((-middle - root) / square).clamp(0.0, 1.0);
    let leaves = ((-middle + root) / square).clamp(0.0, 1.0);
    leaves - enters
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against slices of the smaller ball, each the area that two circles share.
    #[test]
    fn lenses_are_the_volumes_of_slices() {
        let (a, b) = (1.0, 0.5);
        for distance in [0.55, 0.7, 1.0, 1.2, 1.49] {
            let slices = 20_000;
            let thick = 2.0 * b / slices as f64;
            let volume: f64 = (0..slices)
                .map(|k| {
                    // A slice across the line of centres is a disc of whichever ball is narrower there.
                    let x = distance - b + (k as f64 + 0.5) * thick;
                    let disc = |r: f64, x: f64| (r * r - x * x).max(0.0);
                    disc(a, x).min(disc(b, x - distance)) * std::f64::consts::PI * thick
                })
                .sum();
            let got = lens(a, b, distance);
            assert!((got - volume).abs() < 1e-6, "{distance}: {got} {volume}");
            assert_eq!(got, lens(b, a, distance));
        }
        let grain = std::f64::consts::PI / 6.0;
        assert!((lens(a, b, 0.4) - grain).abs() < 1e-15);
        assert!((lens(a, b, 0.5) - grain).abs() < 1e-15);
        assert_eq!(lens(a, b, 1.5), 0.0);
    }

    #[test]
    fn parts_of_a_line_add_up() {
        let part = |a: f64, b: f64| part_inside([a, 0.3, 0.0], [b, 0.3, 0.0], 0.5);
        assert!((part(-2.0, 2.0) - 0.8 / 4.0).abs() < 1e-15);
        assert!((part(0.0, 2.0) - 0.4 / 2.0).abs() < 1e-15);
        assert_eq!(part(-0.1, 0.2), 1.0);
        assert_eq!(part(0.6, 2.0), 0.0);
        assert_eq!(part_inside([0.0, 0.6, 0.0], [9.0, 0.6, 0.0], 0.5), 0.0);
        assert_eq!(part_inside([0.1; 3], [0.1; 3], 0.5), 1.0);
        assert_eq!(part_inside([0.4; 3], [0.4; 3], 0.5), 0.0);
    }
}
