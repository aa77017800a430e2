//! Outlines of arrows.

use super::scale::push;

/// Adds to the data of a path the outline of an arrow of a length and a thickness in the direction
/// of a unit vector; a short one is nearly all head.
pub(super) fn arrow(out: &mut String, from: [f64; 2], along: [f64; 2], length: f64, thick: f64) {
    let head = (5.0 * thick).min(0.65 * length);
    let neck = length - head;
    let (shaft, wing) = (0.7 * thick, 0.5 * head);
    let corners = [
        (0.0, shaft),
        (neck, shaft),
        (neck, wing.max(shaft)),
        (length, 0.0),
        (neck, -wing.max(shaft)),
        (neck, -shaft),
        (0.0, -shaft),
    ];
    for (k, (far, aside)) in corners.into_iter().enumerate() {
        let x = from[0] + far * along[0] - aside * along[1];
        let z = from[1] + far * along[1] + aside * along[0];
        let step = if k == 0 { "M" } else { "L" };
        push(out, format_args!("{step}{x:.1} {z:.1}"));
    }
    out.push('Z');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_is_as_long_as_asked_and_points_along() {
        let mut out = String::new();
        arrow(&mut out, [100.0, 100.0], [0.0, -1.0], 20.0, 1.0);
        assert!(out.contains("L100.0 80.0"), "{out}");
    }
}
