//! The loads and each claim of Guillard 2014, section IV and appendix B.

use super::angles::spread;
use super::book::Claim;
use super::combine::weighted_mean;
use super::fits::same_depth;
use super::front::{beside, near};
use super::load::{PointLoad, deep, difference, equation_4, highest, is_deep, odd_part, pairs};
use super::number::{Found, Number};
use super::points::Spread;
use super::points::{DEEP, SEEDS};
use super::shape::{ALIKE, share};
use crate::analysis::Value;
use crate::fit::Datum;
use crate::fit::linear::line;
use bitgrain_sim::coarse_graining::load::POINTS;
use bitgrain_sim::format::{number_with_error, plural};

const NO_LOAD: &str = "no run has a load: measure.fields asks for them";

/// The measurement of a claim about loads; `None` if this is not one.
pub(super) fn measure(id: &str, claim: &Claim, loads: &[PointLoad]) -> Option<Found> {
    let without = || loads.iter().filter(|l| !l.gradient);
    let all = |of: &dyn Fn(&PointLoad) -> Value| -> Found {
        let values: Vec<(f64, f64)> = without().map(of).map(|v| (v.value, v.error)).collect();
        match values.len() {
            0 => Err(
                "no run without a pressure gradient has a load: measure.fields asks for them"
                    .into(),
            ),
            n => Ok(Number::one(
                Spread::of(&values).into(),
                format!("mean of {}", plural(n, "effective depth")),
            )),
        }
    };
    Some(match id {
        "front" => all(&|l| near(l, 0)).map(|found| {
            let fit = beside(&without().collect::<Vec<_>>());
            let note = format!("{}; {fit}", found.note);
            Number { note, ..found }
        }),
        "rear" => all(&|l| near(l, POINTS / 2)),
        "equation-4" => all(&|l| l.simple_lift),
        "tangential" => in_figure_11(claim, loads, |l| l.tangential_part),
        "tangential-stress" => in_figure_11(claim, loads, largest_tangential),
        "stress-pressure" => apart(&without().collect::<Vec<_>>()),
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

/// Lift over what eq. 4 makes of the load without gradient: the mean over the pairs from 16 D on, where the lift has
/// its plateau.
fn tenfold(loads: &[PointLoad]) -> Found {
    let pairs = deep_pairs(loads);
    let none = "no two runs with loads, with and without a pressure gradient, have one effective depth from \
                16 D on";
    let fewest = pairs.iter().map(|(with, _)| with.runs.len()).min();
    let fewest = fewest.ok_or(none)?;
    if fewest < SEEDS {
        return Err(format!(
            "a lift is told from {SEEDS} seeds or more; there are {fewest}"
        ));
    }
    let ratio = |(with, without): &(&PointLoad, &PointLoad)| with.lift.over(without.simple_lift);
    let ratios: Vec<Value> = pairs.iter().map(ratio).collect();
    let each = pairs.iter().zip(&ratios).map(|((with, _), ratio)| {
        let number = number_with_error(ratio.value, ratio.error);
        format!("{number} at {}", note(with))
    });
    let each: Vec<String> = each.collect();
    let (mean, _) = weighted_mean(&ratios).ok_or("the lifts have no errors")?;
    Ok(Number::one(mean, each.join(", ")))
}

/// A number of the load at the effective depth of the paper's Fig. 11(a), 16 D, or the next depth from there on, with
/// and without a gradient; of the other depths it is told beside.
fn in_figure_11(claim: &Claim, loads: &[PointLoad], of: fn(&PointLoad) -> Value) -> Found {
    if loads.is_empty() {
        return Err(NO_LOAD.into());
    }
    let said = |l: &PointLoad| match l.gradient {
        true => format!("{}, with gradient", note(l)),
        false => format!("{}, without gradient", note(l)),
    };
    let depths = loads.iter().filter(|l| is_deep(l)).map(|l| l.asked);
    let own = depths.fold(f64::INFINITY, |a, x| if x < a { x } else { a });
    let (here, others): (Vec<_>, Vec<_>) = loads.iter().partition(|l| same_depth(l.asked, own));
    let numbers = here.iter().map(|l| (of(l), said(l)));
    let found = claim.together(
        numbers.collect(),
        &format!("no load is from {DEEP} D or deeper, the depth of the paper's figure"),
    )?;
    let beside = others.iter().map(|l| {
        let v = of(l);
        format!("{:.3} +- {:.3} at {}", v.value, v.error, said(l))
    });
    let beside: Vec<String> = beside.collect();
    let note = match beside.is_empty() {
        true => found.note,
        false => format!("{}; {}", found.note, beside.join("; ")),
    };
    Ok(Number { note, ..found })
}

/// Spread over depths of the normal stress over P_0, over its mean.
fn apart(loads: &[&PointLoad]) -> Found {
    if loads.len() < 2 {
        return Err(
            "the stress at several pressures takes two effective depths without gradient".into(),
        );
    }
    let curves: Vec<Vec<Value>> = loads.iter().map(|l| l.normal.clone()).collect();
    let spread = spread(&curves);
    let over = spread.over.ok_or("the stress is not told from none")?;
    Ok(Number::one(
        over,
        format!("over {} effective depths", loads.len()),
    ))
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

/// Spread over depths of the differences over their mean.
fn collapse(pairs: &[(&PointLoad, &PointLoad)]) -> Found {
    let curves: Vec<Vec<Value>> = pairs.iter().map(difference).collect();
    if curves.len() < 2 {
        return Err(format!(
            "a collapse takes two effective depths of {DEEP} D or more with loads with and without gradient"
        ));
    }
    let spread = spread(&curves);
    let told = format!(
        "largest difference {:.0} +- {:.0} rho g D over {} effective depths of {DEEP} D or more",
        spread.peak.value,
        spread.peak.error,
        curves.len()
    );
    match spread.over {
        Some(over) => Ok(Number::one(over, told)),
        None => Err(format!("{told}, which is not told from none")),
    }
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
        "mean of {}; {:.1} +- {:.1} of the odd part with gradient alone",
        plural(pairs.len(), "effective depth"),
        odd.value,
        odd.error
    );
    Ok(Number::one(mean(&difference), note))
}

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
    let note = format!(
        "lines through {} effective depths of {DEEP} D or more",
        deep.len()
    );
    Ok(Number::one(lift.over(drag), note))
}

#[cfg(test)]
mod tests {
    use super::super::load::{equation_4, odd_part, split};
    use super::super::synthetic::shipped;
    use super::super::synthetic_load::{load, noisy};
    use super::*;
    use bitgrain_sim::coarse_graining::load::theta;

    fn all(off: f64) -> Vec<PointLoad> {
        let depths = [16.0, 20.0, 35.0];
        let with = depths.map(|h| load(h, true, 0.0));
        let without = depths.map(|h| load(h, false, if h > 30.0 { off } else { 0.0 }));
        with.into_iter().chain(without).collect()
    }

    fn found(id: &str, loads: &[PointLoad]) -> Found {
        measure(id, &shipped(&format!("guillard-{id}")), loads).unwrap()
    }

    fn value(id: &str, loads: &[PointLoad]) -> Value {
        found(id, loads).unwrap().value
    }

    #[test]
    fn claims_are_read_off_the_model() {
        let loads = all(0.0);
        assert!((value("front", &loads).value - 15.0).abs() < 0.05);
        assert!(value("rear", &loads).value.abs() < 1e-9);
        assert!((value("equation-4", &loads).value - 3.18).abs() < 0.02);
        assert_eq!(value("tangential", &loads).value, 0.06);
        assert_eq!(value("stress-pressure", &loads).value, 0.0);
        assert!(found("tenfold", &loads).unwrap_err().contains("2 seeds"));
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
        let note = found("asymmetric", &loads).unwrap().note;
        assert!(note.contains("2.7 +- "), "{note}");
        assert!((value("tangential-stress", &loads).value - 0.5 / 15.0).abs() < 1e-3);
        assert!(value("split", &loads).value.abs() < 1e-9);
        assert!(measure("steady", &shipped("guillard-steady"), &loads).is_none());
    }

    #[test]
    fn stress_that_does_not_go_with_the_pressure_is_seen() {
        let loads = all(0.2);
        let apart = value("stress-pressure", &loads);
        // Of 1, 1 and 1.2 the deviation over the mean.
        assert!((apart.value - 0.1155 / 1.0667).abs() < 0.002, "{apart:?}");
        // One of three lies 105 cos off: 60.6 cos of deviation, 30.3 over the turn; the mean is 20 sin cos less
        // 35 cos, 18.2 over the turn.
        assert!((value("collapse", &loads).value - 30.3 / 18.2).abs() < 0.01);
    }

    /// What the paper says at 16 D is judged there, with gradient and without; deeper it is told beside.
    #[test]
    fn tangential_stresses_are_judged_at_the_depth_of_the_figure() {
        let mut loads = all(0.0);
        for l in loads.iter_mut().filter(|l| l.depth > 30.0) {
            l.tangential_part = Value::new(0.2, 0.01);
        }
        let number = found("tangential", &loads).unwrap();
        assert_eq!((number.value.value, number.of), (0.06, 2));
        let note = number.note;
        assert!(
            note.starts_with("h~/D = 16, with gradient, worst of 2; "),
            "{note}"
        );
        assert_eq!(
            note.matches("0.200 +- 0.010 at h~/D = 35").count(),
            2,
            "{note}"
        );
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
        assert!(found("collapse", &near).is_err());
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
        let (mut inside, mut sets, mut alike) = (0, 0, 0);
        for seed in 0..60 {
            let without = all(false, seed, false);
            let none = [all(false, 100 + seed, true), without.clone()].concat();
            assert!(found("collapse", &none).is_err(), "{seed}");
            let loads = [all(true, 200 + seed, true), without].concat();
            if let Ok(number) = found("collapse", &loads) {
                let spread = number.value;
                sets += 1;
                inside += usize::from(spread.value <= 2.0 * spread.error);
            }
            let apart = value("stress-pressure", &loads);
            alike += usize::from(apart.value <= 2.0 * apart.error);
        }
        // Nineteen of twenty would be so by chance alone.
        assert!(sets > 30 && inside * 10 >= sets * 9, "{inside} of {sets}");
        assert!(alike >= 54, "{alike} of 60");
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
        let why = |id: &str, loads: &[PointLoad]| found(id, loads).unwrap_err();
        assert!(why("front", &[]).contains("measure.fields"));
        assert!(why("collapse", &all(0.0)[..1]).contains("two effective depths"));
        assert!(why("split", &all(0.0)[..2]).contains("three effective depths"));
        assert!(why("tenfold", &all(0.0)[..3]).contains("no two runs"));
        assert!(why("asymmetric", &all(0.0)[..3]).contains("no two runs"));
        assert!(why("tangential-stress", &[]).contains("measure.fields"));
        assert!(why("tangential", &[load(5.0, true, 0.0)]).contains("16 D or deeper"));
        assert!(why("stress-pressure", &all(0.0)[..4]).contains("two effective depths"));
    }
}
