//! Numbers from several points: the slope of the drag, the plateau of the lift.

use super::points::{DEEP, Group, Point};

/// Depths that differ by less than this part are one depth: seeds and packing vary it.
pub const SAME_DEPTH: f64 = 0.05;

/// Whether two depths are one.
pub fn same_depth(a: f64, b: f64) -> bool {
    (a / b - 1.0).abs() <= SAME_DEPTH
}

/// Whether an effective depth over D is one where lifts count as saturated, to a twentieth.
pub(super) fn is_deep(over_diameter: f64) -> bool {
    over_diameter > (1.0 - SAME_DEPTH) * DEEP
}

/// A straight line through the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// `sum x y / sum x^2`: least squares, every point with the same weight.
    pub slope: f64,
    /// Its standard error, from the points' errors or from their residuals, whichever is larger.
    pub error: f64,
    /// Largest residual over the line's value there.
    pub residual: f64,
    /// The same over the combined standard error of line and point.
    pub residual_in_errors: f64,
    /// How many depths there are.
    pub depths: usize,
}

/// C_d: the slope of drag over D L against rho g h~, all ways together (Guillard 2014, eq. 2 and
/// Fig. 8(a)); `None` without points.
pub fn drag_slope(group: &Group) -> Option<Slope> {
    slope_against(group, |p| p.pressure)
}

/// The same against the weight above the axis over the area of the box. It is less than rho g h~ with a pressure
/// gradient: h reaches to the tops of the highest grains, and rho is that of the flowing bed while h is that of the
/// settled one, which is higher.
pub fn drag_slope_by_weight(group: &Group) -> Option<Slope> {
    slope_against(group, |p| p.weight)
}

/// The slope of drag over D L against a pressure.
fn slope_against(group: &Group, pressure: fn(&Point) -> f64) -> Option<Slope> {
    let points: Vec<&Point> = group.points.iter().collect();
    let squares: f64 = points.iter().map(|p| pressure(p) * pressure(p)).sum();
    let products: f64 = points.iter().map(|p| pressure(p) * p.drag.mean).sum();
    let slope = products / squares;
    if !slope.is_finite() {
        return None;
    }
    let weighted = points.iter().map(|p| pressure(p) * p.drag.error);
    let known = weighted.map(|e| e * e).sum::<f64>().sqrt() / squares;
    let off = |p: &Point| p.drag.mean - slope * pressure(p);
    let spread: f64 = points.iter().map(|p| off(p) * off(p)).sum();
    let seen = match points.len() {
        1 => 0.0,
        n => (spread / (n as f64 - 1.0) / squares).sqrt(),
    };
    let error = if seen > known { seen } else { known };
    let largest = |of: &dyn Fn(&Point) -> f64| {
        let larger = |a: f64, p: &&Point| if of(p) > a { of(p) } else { a };
        points.iter().fold(0.0, larger)
    };
    let combined = |p: &Point| both(error * pressure(p), p.drag.error);
    Some(Slope {
        slope,
        error,
        residual: largest(&|p| (off(p) / (slope * pressure(p))).abs()),
        residual_in_errors: largest(&|p| (off(p) / combined(p)).abs()),
        depths: depths(&points),
    })
}

/// Two independent errors together.
pub(super) fn both(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// How many depths were asked for that are not the same to [`SAME_DEPTH`]: beds of one depth differ a little.
pub fn depths(points: &[&Point]) -> usize {
    let mut all: Vec<f64> = points.iter().map(|p| p.asked).collect();
    all.sort_by(f64::total_cmp);
    let (mut count, mut last) = (0, 0.0);
    for depth in all {
        if depth > (1.0 + SAME_DEPTH) * last {
            (count, last) = (count + 1, depth);
        }
    }
    count
}

/// Where the lift no longer grows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plateau {
    /// Lift over buoyancy, mean over its points.
    pub lift: f64,
    /// Its standard error.
    pub error: f64,
    /// How many of the deepest points it is made of.
    pub points: usize,
    /// Effective depth at which the lift has 90 % of it, on the lines between points; none if the
    /// least depth has more already (Guillard 2014, Fig. 6).
    pub depth: Option<f64>,
}

/// The deepest points, which come by depth, that agree with the deepest within two combined errors: at
/// least two, at two depths, whose mean differs from zero by two errors, and the shallowest of which
/// differs by two errors from what a lift that grows with depth would have there; else `None`.
pub fn plateau(points: &[&Point]) -> Option<Plateau> {
    let flat = flat(points)?;
    let count = flat.len();
    let n = count as f64;
    let lift = flat.iter().map(|p| p.lift.mean).sum::<f64>() / n;
    let squares = flat.iter().map(|p| p.lift.error * p.lift.error);
    let error = squares.sum::<f64>().sqrt() / n;
    // A value with too large an error agrees with everything.
    let told = lift.abs() > 2.0 * error;
    let (shallow, deep) = (flat[0], flat[count - 1]);
    let part = shallow.effective_depth / deep.effective_depth;
    let above = shallow.lift.mean - part * deep.lift.mean;
    let bent = above > 2.0 * both(shallow.lift.error, part * deep.lift.error);
    if !told || !bent {
        return None;
    }
    Some(Plateau {
        lift,
        error,
        points: count,
        depth: depth_of(points, 0.9 * lift),
    })
}

/// The deepest points that agree with the deepest within two combined errors, if they have two depths.
pub(super) fn flat<'a, 'b>(points: &'a [&'b Point]) -> Option<&'a [&'b Point]> {
    let deepest = points.last()?.lift;
    let agrees = |p: &&&Point| {
        let apart = (p.lift.mean - deepest.mean).abs();
        apart <= 2.0 * both(p.lift.error, deepest.error)
    };
    let count = points.iter().rev().take_while(agrees).count();
    let flat = &points[points.len() - count..];
    (depths(flat) > 1).then_some(flat)
}

/// Effective depth at which the lift first has this value, on the lines between points.
fn depth_of(points: &[&Point], lift: f64) -> Option<f64> {
    let above = points.iter().position(|p| p.lift.mean >= lift)?;
    let (after, before) = (points[above], points[above.checked_sub(1)?]);
    let part = (lift - before.lift.mean) / (after.lift.mean - before.lift.mean);
    Some(before.effective_depth + part * (after.effective_depth - before.effective_depth))
}

/// Lift over buoyancy of one cylinder, C_l (Guillard 2014, eq. 3 and Fig. 5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftCoefficient {
    /// D/d.
    pub over_grain: f64,
    /// Mean over the plateau's points, or the value of the deepest one.
    pub mean: f64,
    /// Least of the runs of these points.
    pub least: f64,
    /// Largest of them.
    pub most: f64,
    /// Whether there is a plateau.
    pub saturated: bool,
}

/// C_l from the points with a pressure gradient; `None` without any.
pub fn lift_coefficient(group: &Group) -> Option<LiftCoefficient> {
    let points = group.with_gradient(true);
    let plateau = plateau(&points);
    let count = plateau.map_or(1, |p| p.points);
    let used = points.get(points.len().checked_sub(count)?..)?;
    let deepest = used.last()?;
    let fold = |start: f64, of: fn(&Point) -> f64, better: fn(f64, f64) -> bool| {
        let pick = |a: f64, p: &&Point| if better(of(p), a) { of(p) } else { a };
        used.iter().fold(start, pick)
    };
    Some(LiftCoefficient {
        over_grain: group.over_grain,
        mean: plateau.map_or(deepest.lift.mean, |p| p.lift),
        least: fold(f64::INFINITY, |p| p.lift.least, |a, b| a < b),
        most: fold(f64::NEG_INFINITY, |p| p.lift.most, |a, b| a > b),
        saturated: plateau.is_some(),
    })
}

#[cfg(test)]
mod tests {
    use super::super::place::Place;
    use super::super::points::{Spread, Way, groups};
    use super::super::synthetic::{self, Asked};
    use super::*;

    fn point(depth: f64, drag: f64, lift: f64) -> Point {
        let known = |x: f64| Spread::of(&[(x - 0.1, 0.1), (x + 0.1, 0.1)]);
        Point {
            way: Way::Lid,
            runs: vec![0, 1],
            asked: depth,
            effective_depth: depth,
            place: Place {
                floor: 3.0,
                surface: depth,
            },
            pressure: 2.0 * depth,
            weight: 1.6 * depth,
            drag: known(drag),
            drag_over_depth: known(drag / (2.0 * depth)),
            drag_over_weight: known(drag / (1.6 * depth)),
            drag_over_pressure: known(drag / (2.0 * depth)),
            lift: known(lift),
            far_field: 1.0,
            travel: 90.0,
            converged: [true; 2],
        }
    }

    fn group(points: &[Point]) -> Group {
        Group {
            diameter: 3.3,
            axis: None,
            over_grain: 3.3,
            speed: 1.0,
            points: points.to_vec(),
        }
    }

    #[test]
    fn a_line_through_the_origin_is_found_with_its_residuals() {
        let line = [1.0, 2.0, 4.0].map(|h| point(h, 20.0 * h, 30.0));
        let fit = drag_slope(&group(&line)).unwrap();
        assert!((fit.slope - 10.0).abs() < 1e-12 && fit.residual < 1e-12);
        let weight = drag_slope_by_weight(&group(&line)).unwrap();
        assert!((weight.slope - 12.5).abs() < 1e-12 && weight.residual < 1e-12);
        assert_eq!(fit.depths, 3);
        // The points' own errors: 0.1 each.
        let known = 0.1 / (4.0f64 + 16.0 + 64.0).sqrt();
        assert!((fit.error - known).abs() < 1e-12, "{fit:?}");
        let bent = [1.0, 2.0, 4.0].map(|h| point(h, 20.0 * h * h, 30.0));
        let fit = drag_slope(&group(&bent)).unwrap();
        assert!(fit.residual > 0.3 && fit.error > known, "{fit:?}");
        assert!(drag_slope(&group(&[])).is_none());
    }

    #[test]
    fn depths_that_are_nearly_alike_are_one() {
        let points = [1.0, 1.04, 2.0].map(|h| point(h, 1.0, 1.0));
        assert_eq!(depths(&points.iter().collect::<Vec<_>>()), 2);
    }

    #[test]
    fn a_plateau_is_the_deepest_points_that_agree() {
        let lifts = [(1.0, 10.0), (2.0, 20.0), (3.0, 30.1), (4.0, 30.0)];
        let points = lifts.map(|(h, lift)| point(h, 1.0, lift));
        let points: Vec<&Point> = points.iter().collect();
        let found = plateau(&points).unwrap();
        assert_eq!(found.points, 2);
        assert!((found.lift - 30.05).abs() < 1e-12);
        // 27.045 lies between 20 and 30.1.
        let depth = found.depth.unwrap();
        assert!((depth - (2.0 + 7.045 / 10.1)).abs() < 1e-12, "{depth}");
        assert!(plateau(&points[..3]).is_none(), "it still grows");
        assert!(plateau(&points[3..]).is_none(), "one point is no plateau");
        // All flat: the depth at which it saturates is not among those measured.
        assert_eq!(plateau(&points[2..]).unwrap().depth, None);
        // A lift that grows with depth agrees with itself if errors are large.
        let mut growing = [2.0, 3.5, 5.5].map(|h| point(h, 1.0, 6.5 * h));
        for (p, error) in growing.iter_mut().zip([4.0, 5.0, 8.0]) {
            p.lift.error = error;
        }
        let growing: Vec<&Point> = growing.iter().collect();
        assert_eq!(flat(&growing).unwrap().len(), 2);
        assert!(plateau(&growing).is_none());
        let vague = [3.0, 4.0].map(|h| point(h, 1.0, 0.1));
        assert!(plateau(&[&vague[0], &vague[1]]).is_none());
        // Two points at one depth do not show growth.
        assert!(plateau(&[points[3], points[3]]).is_none());
    }

    #[test]
    fn a_coefficient_of_lift_has_the_runs_extremes() {
        let groups = groups(&synthetic::summary(&Asked::default()));
        let found = lift_coefficient(&groups[0]).unwrap();
        assert!(
            found.saturated && (found.mean - 30.0).abs() < 1.0,
            "{found:?}"
        );
        assert!(found.least < found.mean && found.mean < found.most);
        let growing = [1.0, 2.0].map(|h| point(h, 1.0, 10.0 * h));
        let found = lift_coefficient(&group(&growing)).unwrap();
        assert!(!found.saturated && found.mean == 20.0);
        assert!((found.least, found.most) == (19.9, 20.1), "{found:?}");
        assert!(lift_coefficient(&group(&[])).is_none());
    }
}
