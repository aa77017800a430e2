//! The loads and each claim of Guillard 2014, section IV and appendix B.

use super::front::{beside, near};
use super::kumar_curves::{Found, farthest};
use super::load::{PointLoad, deep, difference, equation_4, highest, is_deep, odd_part, pairs};
use super::points::Spread;
use super::points::{DEEP, SEEDS};
use super::shape::{ALIKE, share};
use crate::analysis::Value;
use crate::fit::Datum;
use crate::fit::linear::line;
use bitgrain_sim::coarse_graining::load::{POINTS, WIDTH, theta};

/// A difference counts as one from this many errors on.
const TOLD: f64 = 5.0;

const NO_LOAD: &str = "no run has a load: measure.fields asks for them";

/// The measurement of a claim about loads; `None` if this is not one.
pub(super) fn measure(id: &str, loads: &[PointLoad]) -> Option<Found> {
    let without = || loads.iter().filter(|l| !l.gradient);
    let all = |of: &dyn Fn(&PointLoad) -> Value| -> Found {
        let values: Vec<(f64, f64)> = without().map(of).map(|v| (v.value, v.error)).collect();
        match values.len() {
            0 => Err(
                "no run without a pressure gradient has a load: measure.fields asks for them"
                    .into(),
            ),
            n => Ok((
                Spread::of(&values).into(),
                format!("mean of {n} effective depths"),
            )),
        }
    };
    Some(match id {
        "front" => all(&|l| near(l, 0)).map(|(value, note)| {
            let fit = beside(&without().collect::<Vec<_>>());
            (value, format!("{note}; {fit}"))
        }),
        "rear" => all(&|l| near(l, POINTS / 2)),
        "equation-4" => all(&|l| l.simple_lift),
        "tangential" => {
            let parts = loads.iter().map(|l| (l.tangential_part, note(l)));
            farthest(parts.collect(), 0.0, NO_LOAD)
        }
        "stress-pressure" => apart(&without().collect::<Vec<_>>()),
        "tangential-stress" => {
            let ratios = loads.iter().map(|l| (largest_tangential(l), note(l)));
            farthest(ratios.collect(), 0.0, NO_LOAD)
        }
        "collapse" => collapse(&deep_pairs(loads)),
        "asymmetric" => over_equation_4(&deep_pairs(loads)),
        "tenfold" => tenfold(loads),
        "split" => lift_of_slope(loads),
        _ => return None,
    })
}

fn note(load: &PointLoad) -> String {
    format!("h~/D = {:.0}", load.depth)
}

/// Lift of the deepest pair over what eq. 4 makes of its load without gradient.
fn tenfold(loads: &[PointLoad]) -> Found {
    let pairs = pairs(loads);
    let deepest = pairs
        .into_iter()
        .reduce(|a, b| if b.0.depth > a.0.depth { b } else { a });
    let none =
        "no two runs with loads, with and without a pressure gradient, have one effective depth";
    let (with, without) = deepest.ok_or(none)?;
    if with.runs.len() < SEEDS {
        return Err(format!(
            "a lift is told from {SEEDS} seeds or more; there are {}",
            with.runs.len()
        ));
    }
    Ok((with.lift.over(without.simple_lift), note(with)))
}

/// Largest difference between depths at any angle, beyond two errors of it, over the largest stress.
fn apart(loads: &[&PointLoad]) -> Found {
    let mut largest: Option<(Value, String)> = None;
    for (k, a) in loads.iter().enumerate() {
        for b in &loads[..k] {
            for m in 0..POINTS {
                let off = a.normal[m].less(b.normal[m]);
                let beyond = Value::new(off.value.abs() - 2.0 * off.error, off.error);
                if largest
                    .as_ref()
                    .is_none_or(|(most, _)| beyond.value > most.value)
                {
                    let place =
                        format!("{} against {} at theta = {:.2}", note(a), note(b), theta(m));
                    largest = Some((beyond, place));
                }
            }
        }
    }
    let (most, place) = largest.ok_or("one effective depth alone has a load without gradient")?;
    let peak = highest(loads);
    let beyond = if most.value > 0.0 { most.value } else { 0.0 };
    Ok((Value::new(beyond, most.error).divided(peak), place))
}

/// Loads with and without a gradient at the effective depths where appendix B holds.
fn deep_pairs(loads: &[PointLoad]) -> Vec<(&PointLoad, &PointLoad)> {
    let all = pairs(loads).into_iter();
    all.filter(|(with, _)| is_deep(with)).collect()
}

/// The largest tangential stress over the largest normal one.
fn largest_tangential(load: &PointLoad) -> Value {
    let all = load.tangential.iter();
    let most = all.reduce(|a, b| if b.value.abs() > a.value.abs() { b } else { a });
    most.map_or(Value::new(0.0, 0.0), |v| {
        Value::new(v.value.abs(), v.error).divided(highest(&[load]))
    })
}

/// Spread over depths of the differences beyond their errors, over the mean of them all, both as root mean squares
/// over the angles. Refused if the mean is not distinct from zero: then noise alone would make the spread.
fn collapse(pairs: &[(&PointLoad, &PointLoad)]) -> Found {
    let curves: Vec<Vec<Value>> = pairs.iter().map(difference).collect();
    let n = curves.len() as f64;
    if curves.len() < 2 {
        return Err(format!(
            "a collapse takes two effective depths of {DEEP} D or more with loads with and without gradient"
        ));
    }
    let (mut seen, mut known, mut fourth, mut square) = (0.0, 0.0, 0.0, 0.0);
    let mut peak = Value::new(0.0, 1.0);
    for m in 0..POINTS {
        let at: Vec<Value> = curves.iter().map(|c| c[m]).collect();
        let mean = at.iter().map(|v| v.value).sum::<f64>() / n;
        let own: f64 = at.iter().map(|v| v.error * v.error).sum();
        seen += at
            .iter()
            .map(|v| (v.value - mean) * (v.value - mean))
            .sum::<f64>()
            / (n - 1.0);
        known += own / n;
        fourth += at.iter().map(|v| libm::pow(v.error, 4.0)).sum::<f64>() / n;
        square += mean * mean - own / (n * n);
        if mean.abs() > peak.value {
            peak = Value::new(mean.abs(), own.sqrt() / n);
        }
    }
    let told = format!(
        "largest difference {:.0} +- {:.0} rho g D over {} effective depths of {DEEP} D or more",
        peak.value,
        peak.error,
        curves.len()
    );
    if peak.value < TOLD * peak.error || square <= 0.0 {
        return Err(format!("{told}, which is not told from none"));
    }
    // Numbers of unequal variance count as fewer, and neighbouring angles as one.
    let angles = known * known / fourth / POINTS as f64 * SQUARES;
    let points = POINTS as f64;
    let (seen, known, square) = (seen / points, known / points, square / points);
    let left = if seen > known { seen - known } else { 0.0 };
    // Error of a mean of squares of numbers with this variance of noise, of so many.
    let noise = |known: f64, left: f64, count: f64| {
        ((2.0 * known * known + 4.0 * known * left) / count).sqrt()
    };
    let own = noise(known, left, angles * (n - 1.0));
    let spread = left.sqrt();
    // The error of a root, unless it is near zero.
    let (slope, most) = (0.5 * own / spread, own.sqrt());
    let error = if slope < most { slope } else { most };
    let mean = square.sqrt();
    let mean = Value::new(mean, 0.5 * noise(known / n, square, angles) / mean);
    Ok((Value::new(spread, error).over(mean), told))
}

/// How much of eq. 4's curve the differences hold, by least squares: mean over the depths; the odd parts of
/// the loads with a gradient are a second estimate.
fn over_equation_4(pairs: &[(&PointLoad, &PointLoad)]) -> Found {
    if pairs.is_empty() {
        return Err(format!(
            "no two runs with loads, with and without a pressure gradient, have one effective depth of {DEEP} D \
             or more"
        ));
    }
    let mean = |of: &dyn Fn(&(&PointLoad, &PointLoad)) -> Vec<Value>| -> Value {
        let all = pairs.iter().map(|pair| {
            let v = share(&of(pair), &equation_4(pair.1), &ALIKE);
            (v.value, v.error)
        });
        Spread::of(&all.collect::<Vec<_>>()).into()
    };
    let odd = mean(&|pair| odd_part(pair.0));
    let note = format!(
        "mean of {} effective depths; {:.1} +- {:.1} of the odd part with gradient alone",
        pairs.len(),
        odd.value,
        odd.error
    );
    Ok((mean(&difference), note))
}

/// How many angles are independent of each other in a mean of squares: the Gaussian's own correlation, squared, is
/// that much long.
const SQUARES: f64 = ROOT_TWO_PI / WIDTH;
/// sqrt(2 pi).
const ROOT_TWO_PI: f64 = 2.506_628_274_631;

/// Lift over drag of the part of the normal forces that goes with the pressure: it is symmetric in appendix B.
fn lift_of_slope(loads: &[PointLoad]) -> Found {
    let deep = deep(loads)?;
    let slope = |of: fn(&PointLoad) -> Value| -> Result<Value, String> {
        let own = deep.iter().map(|l| of(l).times(l.pressure).at(l.pressure));
        let fit = line(&own.collect::<Vec<Datum>>()).map_err(|why| why.to_string())?;
        Ok(fit
            .parameter("b")
            .map(Value::from)
            .expect("a line has a slope"))
    };
    let (lift, drag) = (slope(|l| l.normal_lift)?, slope(|l| l.drag)?);
    Ok((
        lift.over(drag),
        format!(
            "lines through {} effective depths of {DEEP} D or more",
            deep.len()
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::super::load::{equation_4, odd_part, split};
    use super::super::synthetic_load::{load, noisy};
    use super::*;

    fn all(off: f64) -> Vec<PointLoad> {
        let depths = [16.0, 20.0, 35.0];
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
        assert!(
            measure("tenfold", &loads)
                .unwrap()
                .unwrap_err()
                .contains("2 seeds")
        );
        let twice = |mut l: PointLoad| {
            l.runs.push(l.runs[0].clone());
            l
        };
        let two: Vec<PointLoad> = loads.iter().cloned().map(twice).collect();
        assert!((value("tenfold", &two).value - 30.0 / 3.18).abs() < 0.1);
        assert!(value("collapse", &loads).value < 1e-6);
        // Of 20 cos sin in front the curve of eq. 4 has 7.5 cos sin.
        let share = value("asymmetric", &loads);
        assert!(
            (share.value - 20.0 / 7.5).abs() < 1e-9 && share.error < 0.3,
            "{share:?}"
        );
        let (_, note) = measure("asymmetric", &loads).unwrap().unwrap();
        assert!(note.contains("2.7 +- "), "{note}");
        assert!((value("tangential-stress", &loads).value - 0.5 / 15.0).abs() < 1e-3);
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
        // One of three lies 105 cos off: 60.6 cos of deviation, 30.3 over the turn; the mean is 20 sin cos less
        // 35 cos, 18.2 over the turn.
        assert!((value("collapse", &loads).value - 30.3 / 18.2).abs() < 0.01);
    }

    /// A difference that goes with the pressure does not collapse; one near the surface is not tested for collapse.
    #[test]
    fn a_part_in_proportion_to_the_pressure_is_seen() {
        // Errors so small that none of the spread is noise.
        let sure = |mut l: PointLoad| {
            for v in &mut l.normal {
                v.error = 1e-3;
            }
            l.runs.clear();
            l
        };
        let in_proportion = |depth: f64| {
            let mut l = load(depth, true, 0.0);
            for m in 0..POINTS {
                let plain = load(depth, false, 0.0).normal[m];
                let more = l.normal[m].less(plain).value * depth / 20.0;
                l.normal[m].value = plain.value + more;
            }
            sure(l)
        };
        let without = |depth| sure(load(depth, false, 0.0));
        let all = |depths: &[f64]| -> Vec<PointLoad> {
            let with = depths.iter().map(|h| in_proportion(*h));
            with.chain(depths.iter().map(|h| without(*h))).collect()
        };
        // Deviation over mean of 20, 35 and 53.
        let spread = value("collapse", &all(&[20.0, 35.0, 53.0]));
        assert!((spread.value - 16.52 / 36.0).abs() < 0.01, "{spread:?}");
        let near = [all(&[20.0]), all(&[8.0])].concat();
        assert!(measure("collapse", &near).unwrap().is_err());
    }

    /// Of curves that are alike but for noise that grows with the depth, the spread is zero within its error; if
    /// there is no difference at all, noise does not make one.
    #[test]
    fn noise_does_not_collapse() {
        let all = |gradient: bool, seed: u64, poses: bool| -> Vec<PointLoad> {
            let one = |depth| PointLoad {
                gradient: poses,
                ..noisy(load(depth, gradient, 0.0), |_| 0.05, seed)
            };
            [16.0, 20.0, 35.0].map(one).to_vec()
        };
        let (mut inside, mut sets) = (0, 0);
        for seed in 0..60 {
            let without = all(false, seed, false);
            let none = [all(false, 100 + seed, true), without.clone()].concat();
            assert!(measure("collapse", &none).unwrap().is_err(), "{seed}");
            let loads = [all(true, 200 + seed, true), without].concat();
            if let Ok((spread, _)) = measure("collapse", &loads).unwrap() {
                sets += 1;
                inside += usize::from(spread.value <= 2.0 * spread.error);
            }
        }
        // Nineteen of twenty would be so by chance alone.
        assert!(sets > 30 && inside * 10 >= sets * 9, "{inside} of {sets}");
    }

    #[test]
    fn differences_and_splits_are_the_parts_of_the_model() {
        let mut loads = all(0.0);
        // What is deeper by a part has more of the symmetric part, which is no difference.
        loads[1] = PointLoad {
            asked: 20.0,
            ..load(20.6, true, 0.0)
        };
        let pairs = pairs(&loads);
        assert_eq!(pairs.len(), 3);
        let fits = split(&loads).unwrap();
        for (m, fit) in fits.iter().enumerate() {
            let front = libm::cos(theta(m));
            let front = if front > 0.0 { front } else { 0.0 };
            let own = 20.0 * front * libm::sin(theta(m));
            assert!((difference(&pairs[1])[m].value - own).abs() < 1e-9);
            assert!((odd_part(pairs[0].0)[m].value - own).abs() < 1e-9);
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
        assert!(why("asymmetric", &all(0.0)[..3]).contains("no two runs"));
        assert!(why("tangential-stress", &[]).contains("measure.fields"));
    }
}
