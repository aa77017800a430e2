//! What runs say together of the load on the cylinder (Guillard 2014, section IV and appendix B).

use super::kumar::{Found, farthest, mean};
use super::points::{Group, Point, Spread};
use crate::analysis::Value;
use crate::fields::load::{Load, POINTS, WIDTH, drag_coefficient, odd, simple_lift, theta};
use crate::fit::linear::line;
use crate::fit::{Datum, Fit};
use crate::summary::{Flow, Summary};

/// The load of the runs of a point, mean over its seeds; every curve by angle, as [`theta`] has it.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLoad {
    /// Effective depth over D, mean over the seeds.
    pub depth: f64,
    /// The one that the plan asks for, over D.
    pub asked: f64,
    /// Whether the bed has weight below the lid.
    pub gradient: bool,
    /// Normal stress over the pressure P_0 = rho g h~.
    pub normal: Vec<Value>,
    /// Tangential stress over the same.
    pub tangential: Vec<Value>,
    /// The force that the tangential stress makes over the whole.
    pub tangential_part: Value,
    /// What eq. 4 would make of it: lift over buoyancy.
    pub simple_lift: Value,
    /// Drag over P_0 D L that the normal stress makes.
    pub drag: Value,
    /// Mean lift over buoyancy, of all steps.
    pub lift: Value,
}

/// Loads of all points of a group whose runs have them, with a pressure gradient and then without, by effective
/// depth.
pub fn loads(summary: &Summary, group: &Group) -> Vec<PointLoad> {
    let points = [true, false].map(|gradient| group.with_gradient(gradient));
    let all = points.into_iter().flatten();
    all.filter_map(|p| point_load(summary, group, p)).collect()
}

fn point_load(summary: &Summary, group: &Group, point: &Point) -> Option<PointLoad> {
    let runs = point.runs.iter().map(|&k| {
        let flow = summary.runs[k].flow.as_ref()?;
        Some((flow, flow.load.as_ref()?))
    });
    let runs: Vec<(&Flow, &Load)> = runs.collect::<Option<_>>()?;
    let curve = |of: fn(&Load) -> (&[f64], &[f64])| -> Vec<Value> {
        let at = |m: usize| {
            let values = runs.iter().map(|(flow, load)| {
                let (stress, error) = of(load);
                (stress[m] / flow.pressure, error[m] / flow.pressure)
            });
            Spread::of(&values.collect::<Vec<_>>()).into()
        };
        (0..POINTS).map(at).collect()
    };
    // Errors of neighbouring angles go together: at worst they all do.
    let integral = |of: fn(&[f64]) -> f64, weight: fn(f64) -> f64| -> Value {
        let values = runs.iter().map(|(flow, load)| {
            let s: Vec<f64> = load.normal.iter().map(|s| s / flow.pressure).collect();
            let own = load.normal_error.iter().enumerate();
            let own: Vec<f64> = own
                .map(|(m, e)| e / flow.pressure * weight(theta(m)).abs())
                .collect();
            (of(&s), own.iter().sum::<f64>() / POINTS as f64)
        });
        Spread::of(&values.collect::<Vec<_>>()).into()
    };
    let parts: Vec<(f64, f64)> = runs
        .iter()
        .map(|(_, load)| (load.tangential_part(), part_error(load)))
        .collect();
    Some(PointLoad {
        depth: point.effective_depth / group.diameter,
        asked: point.asked / group.diameter,
        gradient: point.way.has_gradient(),
        normal: curve(|l| (&l.normal, &l.normal_error)),
        tangential: curve(|l| (&l.tangential, &l.tangential_error)),
        tangential_part: Spread::of(&parts).into(),
        simple_lift: integral(simple_lift, |t| 2.0 * libm::sin(t) * libm::sin(t)),
        drag: integral(drag_coefficient, |t| std::f64::consts::PI * libm::cos(t)),
        lift: point.lift.into(),
    })
}

/// Standard error of the part of the force that is the tangential stress's, that of the force left aside.
fn part_error(load: &Load) -> f64 {
    let squares = load.tangential_error.iter().map(|e| e * e).sum::<f64>();
    let [drag, lift] = load.forces();
    let force = (drag * drag + lift * lift).sqrt();
    (squares * shared()).sqrt() * std::f64::consts::PI / POINTS as f64 / force
}

/// Loads with and without a gradient at one effective depth.
pub fn pairs(loads: &[PointLoad]) -> Vec<(&PointLoad, &PointLoad)> {
    let (with, without): (Vec<_>, Vec<_>) = loads.iter().partition(|l| l.gradient);
    let near = |a: &PointLoad, b: &PointLoad| (a.asked / b.asked - 1.0).abs() <= super::SAME_DEPTH;
    let partner = |a: &'_ PointLoad| without.iter().copied().find(|b| near(a, b));
    let with = with.into_iter();
    with.filter_map(|a| Some((a, partner(a)?))).collect()
}

/// `(sigma_n - sigma_n without gradient)/(rho g D)` by angle (Guillard 2014, Fig. 12).
pub fn difference(pair: &(&PointLoad, &PointLoad)) -> Vec<Value> {
    let (with, without) = pair;
    let less = |(a, b): (&Value, &Value)| a.times(with.depth).less(b.times(without.depth));
    with.normal.iter().zip(&without.normal).map(less).collect()
}

/// The odd part of a load with gradient, over rho g D: a second estimate of what [`difference`] has of one.
pub fn odd_part(load: &PointLoad) -> Vec<f64> {
    let stress: Vec<f64> = load.normal.iter().map(|v| v.value * load.depth).collect();
    odd(&stress)
}

/// What eq. 4 says of that difference, from a load without gradient: `s sin(theta)/2`.
pub fn equation_4(without: &PointLoad) -> Vec<f64> {
    let all = without.normal.iter().enumerate();
    all.map(|(m, s)| 0.5 * s.value * libm::sin(theta(m)))
        .collect()
}

/// Appendix B: at each angle the normal stress with a gradient over rho g D as a line in h~/D. Its slope `b` is
/// the part in proportion to the pressure, its intercept `a` that in proportion to the gradient. `None` with
/// fewer than three depths.
pub fn split(loads: &[PointLoad]) -> Option<Vec<Fit>> {
    let with: Vec<&PointLoad> = loads.iter().filter(|l| l.gradient).collect();
    let at = |m: usize| {
        let data: Vec<Datum> = with
            .iter()
            .map(|l| l.normal[m].times(l.depth).at(l.depth))
            .filter(|d| d.error > 0.0)
            .collect();
        line(&data).ok().filter(|_| data.len() > 2)
    };
    (0..POINTS).map(at).collect()
}

/// The measurement of a claim about loads; `None` where this is none.
pub(super) fn measure(id: &str, loads: &[PointLoad]) -> Option<Found> {
    let without = || loads.iter().filter(|l| !l.gradient);
    let note = |l: &PointLoad| format!("h~/D = {:.0}", l.depth);
    let all = |of: &dyn Fn(&PointLoad) -> Value| -> Vec<(Value, String)> {
        without().map(|l| (of(l), note(l))).collect()
    };
    let none = "no run without a pressure gradient has a load: measure.fields asks for them";
    Some(match id {
        "front" => mean(&all(&|l| near(l, 0)), none),
        "rear" => mean(&all(&|l| near(l, POINTS / 2)), none),
        "equation-4" => mean(&all(&|l| l.simple_lift), none),
        "tangential" => {
            let parts = loads.iter().map(|l| (l.tangential_part, note(l)));
            farthest(parts.collect(), 0.0, "no run has a load")
        }
        "stress-pressure" => apart(&without().collect::<Vec<_>>()),
        "collapse" => collapse(&pairs(loads)),
        "tenfold" => {
            let pairs = pairs(loads);
            let deepest = pairs
                .into_iter()
                .reduce(|a, b| if b.0.depth > a.0.depth { b } else { a });
            let over = deepest.map(|(a, b)| (a.lift.over(b.simple_lift), note(a)));
            over.ok_or_else(|| NO_PAIR.to_string())
        }
        "split" => lift_of_slope(loads),
        _ => return None,
    })
}

const NO_PAIR: &str =
    "no two runs with loads, with and without a pressure gradient, have one effective depth";

/// Mean of the two points on either side of an angle.
fn near(load: &PointLoad, m: usize) -> Value {
    let (a, b) = (load.normal[(m + POINTS - 1) % POINTS], load.normal[m]);
    // They share nearly all of their contacts.
    Value::new(0.5 * (a.value + b.value), 0.5 * (a.error + b.error))
}

/// Largest difference between depths at any angle, beyond two errors of it, over the largest stress.
fn apart(loads: &[&PointLoad]) -> Found {
    let mut largest: Option<(f64, f64, String)> = None;
    for (k, a) in loads.iter().enumerate() {
        for b in &loads[..k] {
            for m in 0..POINTS {
                let off = a.normal[m].less(b.normal[m]);
                let beyond = off.value.abs() - 2.0 * off.error;
                if largest.as_ref().is_none_or(|(most, ..)| beyond > *most) {
                    let note = format!(
                        "h~/D = {:.0} against {:.0} at theta = {:.2}",
                        a.depth,
                        b.depth,
                        theta(m)
                    );
                    largest = Some((beyond, off.error, note));
                }
            }
        }
    }
    let (beyond, error, note) =
        largest.ok_or("one effective depth alone has a load without gradient")?;
    let peak = loads
        .iter()
        .flat_map(|l| &l.normal)
        .fold(0.0, |a, v| if v.value > a { v.value } else { a });
    let beyond = if beyond > 0.0 { beyond } else { 0.0 };
    Ok((Value::new(beyond, error).divided(peak), note))
}

/// How many angles are independent of each other: a contact counts within some widths of the Gaussian.
fn independent() -> f64 {
    libm::sqrt(std::f64::consts::PI) / WIDTH
}

/// How many neighbouring points count as one.
fn shared() -> f64 {
    POINTS as f64 / independent()
}

/// Spread over depths of the differences, root mean square over the angles and beyond their errors, over the
/// largest mean difference.
fn collapse(pairs: &[(&PointLoad, &PointLoad)]) -> Found {
    let curves: Vec<Vec<Value>> = pairs.iter().map(difference).collect();
    let n = curves.len() as f64;
    if curves.len() < 2 {
        return Err(
            "a collapse takes two effective depths or more with loads with and without gradient"
                .into(),
        );
    }
    let (mut seen, mut known, mut peak) = (0.0, 0.0, 0.0);
    for m in 0..POINTS {
        let at: Vec<Value> = curves.iter().map(|c| c[m]).collect();
        let mean = at.iter().map(|v| v.value).sum::<f64>() / n;
        let squares: f64 = at.iter().map(|v| (v.value - mean) * (v.value - mean)).sum();
        seen += squares / (n - 1.0) / POINTS as f64;
        known += at.iter().map(|v| v.error * v.error).sum::<f64>() / n / POINTS as f64;
        peak = if mean.abs() > peak { mean.abs() } else { peak };
    }
    let left = if seen > known { seen - known } else { 0.0 };
    // A variance from so many numbers is known to that part.
    let noise = known * (2.0 / ((n - 1.0) * independent())).sqrt();
    let spread = left.sqrt();
    let error = if spread > 0.0 {
        0.5 * noise / spread
    } else {
        noise.sqrt()
    };
    let most = noise.sqrt();
    let error = if error > most { most } else { error };
    let note = format!(
        "{} effective depths, largest difference {peak:.0} rho g D",
        curves.len()
    );
    Ok((Value::new(spread, error).divided(peak), note))
}

/// Lift over drag of the part of the stress that goes with the pressure: appendix B has it symmetric.
fn lift_of_slope(loads: &[PointLoad]) -> Found {
    let fits = split(loads)
        .ok_or("splitting a load takes three effective depths with a pressure gradient")?;
    let slopes: Vec<Value> = fits
        .iter()
        .filter_map(|f| f.parameter("b").map(Value::from))
        .collect();
    let sum = |w: fn(f64) -> f64| {
        let each = slopes.iter().enumerate();
        each.map(|(m, s)| s.value * w(theta(m))).sum::<f64>()
    };
    let drag = sum(libm::cos);
    let squares = slopes.iter().enumerate().map(|(m, s)| {
        let part = s.error * libm::sin(theta(m));
        part * part
    });
    let error = (squares.sum::<f64>() * shared()).sqrt();
    let depths = loads.iter().filter(|l| l.gradient).count();
    Ok((
        Value::new(sum(libm::sin), error).divided(drag),
        format!("lines through {depths} effective depths at each angle"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A load of the form that appendix B has: `P_0 15 cos(theta)` in front and a part `rho g D 20 sin(theta)`
    /// there with a gradient.
    fn load(depth: f64, gradient: bool, off: f64) -> PointLoad {
        let at = |m: usize| {
            let front = libm::cos(theta(m));
            let front = if front > 0.0 { front } else { 0.0 };
            let asymmetric = if gradient {
                20.0 * front * libm::sin(theta(m)) / depth
            } else {
                0.0
            };
            Value::new((1.0 + off) * 15.0 * front + asymmetric, 0.05)
        };
        let normal: Vec<Value> = (0..POINTS).map(at).collect();
        let plain: Vec<f64> = normal.iter().map(|v| v.value).collect();
        PointLoad {
            depth,
            asked: depth,
            gradient,
            tangential: vec![Value::new(0.5, 0.1); POINTS],
            tangential_part: Value::new(if gradient { 0.06 } else { 0.04 }, 0.01),
            simple_lift: Value::new(simple_lift(&plain), 0.1),
            drag: Value::new(drag_coefficient(&plain), 0.1),
            lift: Value::new(30.0, 1.0),
            normal,
        }
    }

    fn all(off: f64) -> Vec<PointLoad> {
        let depths = [8.0, 20.0, 35.0];
        let with = depths.map(|h| load(h, true, 0.0));
        let without = depths.map(|h| load(h, false, if h > 30.0 { off } else { 0.0 }));
        with.into_iter().chain(without).collect()
    }

    fn value(id: &str, loads: &[PointLoad]) -> Value {
        measure(id, loads).unwrap().unwrap().0
    }

    #[test]
    fn claims_are_read_off_the_model() {
        let loads = all(0.0);
        assert!((value("front", &loads).value - 15.0).abs() < 0.05);
        assert!(value("rear", &loads).value.abs() < 1e-9);
        assert!((value("equation-4", &loads).value - 3.18).abs() < 0.02);
        assert_eq!(value("tangential", &loads).value, 0.06);
        assert_eq!(value("stress-pressure", &loads).value, 0.0);
        assert!((value("tenfold", &loads).value - 30.0 / 3.18).abs() < 0.1);
        assert!(value("collapse", &loads).value < 1e-6);
        assert!(value("split", &loads).value.abs() < 1e-9);
        assert!(measure("steady", &loads).is_none());
    }

    #[test]
    fn stress_that_does_not_go_with_the_pressure_is_seen() {
        let loads = all(0.2);
        let apart = value("stress-pressure", &loads);
        // A fifth less two errors of a difference.
        assert!(
            (apart.value - (3.0 - 2.0 * 0.05 * 2.0_f64.sqrt()) / 18.0).abs() < 0.01,
            "{apart:?}"
        );
        // One of three lies 105 cos off: 60.6 cos of deviation, 30.3 over the turn, of a largest mean of 39.5.
        assert!((value("collapse", &loads).value - 30.3 / 39.5).abs() < 0.01);
    }

    #[test]
    fn differences_and_splits_are_the_parts_of_the_model() {
        let loads = all(0.0);
        let pairs = pairs(&loads);
        assert_eq!(pairs.len(), 3);
        let fits = split(&loads).unwrap();
        for (m, fit) in fits.iter().enumerate() {
            let front = libm::cos(theta(m));
            let front = if front > 0.0 { front } else { 0.0 };
            let own = 20.0 * front * libm::sin(theta(m));
            assert!((difference(&pairs[1])[m].value - own).abs() < 1e-9);
            assert!((odd_part(pairs[0].0)[m] - own).abs() < 1e-9);
            assert!((fit.parameter("a").unwrap().value - own).abs() < 1e-9);
            assert!((fit.parameter("b").unwrap().value - 15.0 * front).abs() < 1e-9);
            let simple = equation_4(pairs[0].1)[m];
            assert!((simple - 7.5 * front * libm::sin(theta(m))).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_missing_is_said() {
        let why = |id: &str, loads: &[PointLoad]| measure(id, loads).unwrap().unwrap_err();
        assert!(why("front", &[]).contains("measure.fields"));
        assert!(why("collapse", &all(0.0)[..1]).contains("two effective depths"));
        assert!(why("split", &all(0.0)[..2]).contains("three effective depths"));
        assert!(why("tenfold", &all(0.0)[..3]).contains("no two runs"));
    }
}
