//! Crossovers of synthetic drags.

use super::super::synthetic::{assert_spread, exact, noisy, spread, unscaled};
use super::*;

fn curve(first: First, slope: f64, x: f64) -> f64 {
    let (low, at) = match first {
        First::Flat => (500.0, 500.0),
        _ => (440.0 + 310.0 * libm::pow(x, 0.6), 750.0),
    };
    match x {
        x if x < 1.0 => low,
        x if x < 5.0 => at + slope * (x - 1.0),
        x => at + slope * 4.0 + 30.0 * (x * x - 25.0),
    }
}

fn drags(first: First, slope: f64, n: usize, part: f64) -> Vec<Datum> {
    exact(
        &spread(0.1, 10.0, n),
        |x| curve(first, slope, x),
        |y| part * y,
    )
}

#[test]
fn exact_points_give_back_their_regimes() {
    for first in [First::Flat, First::Given(0.6), First::Power] {
        let found = regimes(&drags(first, 130.0, 60, 0.05), first).unwrap();
        let truths = [
            ("a", if first == First::Flat { 500.0 } else { 440.0 }),
            ("b", 310.0),
            ("c", 0.6),
            ("s", 130.0),
            ("q", 30.0),
            ("x1", 1.0),
            ("x2", 5.0),
        ];
        let there = truths.map(|(name, truth)| {
            let p = found.fit.parameter(name);
            assert!(
                p.is_none_or(|p| (p.value / truth - 1.0).abs() < 1e-10),
                "{p:?}"
            );
            usize::from(p.is_some())
        });
        let numbers = match first {
            First::Flat => 5,
            First::Given(_) => 6,
            First::Power => 7,
        };
        assert_eq!(there.iter().sum::<usize>(), numbers);
        assert_eq!(
            (found.first.at, found.fit.degrees_of_freedom),
            (found.fit.parameter("x1").unwrap().value, 60 - numbers)
        );
        assert!(found.needed && found.simpler.len() == 6);
        for x in [0.2, 0.9, 2.0, 4.9, 8.0] {
            let truth = curve(first, 130.0, x);
            assert!((found.value(x) / truth - 1.0).abs() < 1e-10, "{x}");
        }
    }
}

/// Points with 5 % each, so many that every one of 20 sets has its crossovers within 0.2 of 1 and 5, the
/// second of which is the harder one behind a plateau, the first one behind a power. Root mean squares are
/// known to a sixth from 20.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn crossovers_are_recovered() {
    for (first, slope, n, rms) in [
        (First::Flat, 130.0, 1280, [0.021, 0.06]),
        (First::Given(0.6), 130.0, 5000, [0.042, 0.037]),
        (First::Power, 130.0, 5000, [0.05, 0.04]),
        (First::Power, 30.0, 320, [0.06, 0.065]),
    ] {
        let data = drags(first, slope, n, 0.05);
        let mut squares = [0.0; 2];
        for seed in 0..20 {
            let found = regimes(&noisy(&data, 1.0, seed), first).unwrap();
            let off = [found.first.at - 1.0, found.second.at - 5.0];
            assert!(
                off.iter().all(|o| o.abs() < 0.2),
                "{first:?} {slope} {n}, set {seed}: {off:?}"
            );
            squares
                .iter_mut()
                .zip(off)
                .for_each(|(s, o)| *s += o * o / 20.0);
            assert!(found.needed, "{:?}", found.simpler);
        }
        for (square, rms) in squares.iter().zip(rms) {
            let ratio = square.sqrt() / rms;
            assert!(
                (0.5..1.5).contains(&ratio),
                "{first:?} {slope} {n}: {square:?}"
            );
        }
    }
}

/// How many of the sets have each crossover in its interval.
fn held(first: First, slope: f64, n: usize, sets: u64) -> [u64; 2] {
    let data = drags(first, slope, n, 0.05);
    let mut held = [0; 2];
    for seed in 0..sets {
        let found = regimes(&noisy(&data, 1.0, seed), first).unwrap();
        for (count, (c, truth)) in held
            .iter_mut()
            .zip([(found.first, 1.0), (found.second, 5.0)])
        {
            let inside =
                c.low.is_none_or(|low| low <= truth) && c.high.is_none_or(|high| truth <= high);
            *count += u64::from(inside);
            assert!(c.low.is_none_or(|low| low <= c.at) && c.high.is_none_or(|high| c.at <= high));
        }
    }
    held
}

/// Of 200 sets 190 are to be held, with a standard deviation of 3; three of these are allowed, and one more
/// downwards, as breakpoints are not smooth and measured coverage is 93 to 97 %.
#[test]
fn intervals_hold_the_truth_nineteen_times_in_twenty() {
    for (first, slope) in [(First::Flat, 130.0), (First::Given(0.6), 30.0)] {
        let held = held(first, slope, 160, 200);
        assert!(
            held.iter().all(|h| (178..200).contains(h)),
            "{first:?}: {held:?}"
        );
    }
}

/// The same with the exponent fitted, of 100 sets: 95, give or take 2.2.
#[test]
#[ignore = "half a minute: `.ci/run long`"]
fn intervals_hold_the_truth_where_the_exponent_is_fitted() {
    let held = held(First::Power, 30.0, 160, 100);
    assert!(held.iter().all(|h| (87..=100).contains(h)), "{held:?}");
}

/// With many points the numbers scatter as the covariance says, breakpoints included.
#[test]
fn numbers_scatter_as_their_errors_say() {
    let data = drags(First::Flat, 130.0, 1280, 0.05);
    assert_spread(200, |seed| {
        unscaled(&regimes(&noisy(&data, 1.0, seed), First::Flat).unwrap().fit)
    });
}

/// Points on a line, a parabola, a plateau with a line: sets in which three regimes are called needed. That
/// is to be one in twenty or fewer; for the last it is one in twelve, as breakpoints are not ordinary numbers.
#[test]
fn fewer_regimes_do_where_there_are_fewer() {
    let line = |x: f64| 400.0 + 130.0 * x;
    let parabola = |x: f64| 500.0 + 30.0 * x * x;
    let bent = |x: f64| 500.0 + 130.0 * if x > 1.0 { x - 1.0 } else { 0.0 };
    let curves: [&dyn Fn(f64) -> f64; 3] = [&line, &parabola, &bent];
    for (curve, most) in curves.into_iter().zip([10, 10, 30]) {
        let data = exact(&spread(0.1, 10.0, 160), curve, |y| 0.05 * y);
        let sets = (0..200).filter_map(|seed| regimes(&noisy(&data, 1.0, seed), First::Flat).ok());
        let needed = sets.filter(|r| r.needed).count();
        assert!(needed <= most, "{needed}");
    }
    let found = regimes(
        &noisy(&drags(First::Flat, 130.0, 160, 0.05), 1.0, 1),
        First::Flat,
    )
    .unwrap();
    for s in &found.simpler {
        assert!(
            s.probability < 0.05 && s.chi_square > found.fit.chi_square,
            "{s:?}"
        );
    }
    // Two numbers more: the ratio by hand.
    let line = &found.simpler[3];
    let worse = (line.chi_square - found.fit.chi_square) / 2.0 / found.fit.reduced_chi_square;
    assert_eq!((line.model.as_str(), line.numbers), ("a, then a line", 3));
    assert_eq!(line.probability, chance::fisher_tail(worse, 2, 155));
}

#[test]
fn what_points_cannot_carry_is_refused() {
    let told = |d: &[Datum], first| regimes(d, first).unwrap_err().to_string();
    let all = drags(First::Flat, 130.0, 60, 0.05);
    let few = |least: usize, there: usize| {
        format!("three regimes take {least} points or more at different x; there are {there}")
    };
    assert_eq!(told(&all[..7], First::Flat), few(8, 7));
    assert_eq!(told(&all[..8], First::Given(0.6)), few(9, 8));
    assert_eq!(told(&all[..9], First::Power), few(10, 9));
    assert_eq!(told(&[all[3]; 20], First::Flat), few(8, 1));
    let given = "the exponent given for the first regime is -1: one above zero is wanted";
    assert_eq!(told(&all, First::Given(-1.0)), given);
    assert!(told(&all, First::Given(f64::NAN)).starts_with("the exponent given"));
    let mut bad = all.clone();
    bad[5].x = 0.0;
    assert_eq!(
        told(&bad, First::Flat),
        "point 6 has x = 0: a power takes x above zero"
    );
    bad[4].y = f64::NAN;
    assert!(told(&bad, First::Flat).starts_with("point 5 of 60 has y = NaN"));
    // No point, then one beyond the second crossover.
    let end =
        "points or more at different x; with the best crossovers, 1.000 and 4.793, there are 1";
    let short = exact(
        &spread(0.1, 5.3, 40),
        |x| curve(First::Flat, 130.0, x),
        |y| 0.05 * y,
    );
    assert_eq!(
        told(&short, First::Flat),
        format!("the third of three regimes takes 2 {end}")
    );
    let late = exact(
        &spread(0.9, 10.0, 200),
        |x| curve(First::Flat, 130.0, x),
        |y| 0.05 * y,
    );
    let told = told(&noisy(&late, 1.0, 1), First::Flat);
    assert!(
        told.starts_with("the first of three regimes takes 2 points"),
        "{told}"
    );
}

#[test]
fn regimes_are_fitted_alone() {
    let mut data = drags(First::Flat, 130.0, 61, 0.05);
    data[30].x = 1.0;
    data[30].y = 500.0;
    let alone = regime_fits(&data, 1.0, 5.0);
    let [first, second, third] =
        [&alone.first, &alone.second, &alone.third].map(|f| f.as_ref().unwrap());
    let values = |f: &Fit| -> Vec<f64> { f.parameters.iter().map(|p| p.value).collect() };
    let near = |f: &Fit, truths: &[f64]| {
        values(f)
            .iter()
            .zip(truths)
            .all(|(v, t)| (v - t).abs() < 1e-9)
    };
    assert!(near(first, &[500.0]) && near(second, &[370.0, 130.0]) && near(third, &[270.0, 30.0]));
    // The point at 1 counts twice.
    let points = first.residuals.len() + second.residuals.len() + third.residuals.len();
    assert_eq!((points, first.residuals.len()), (62, 31));
    let refused = regime_fits(&data, 0.05, 9.9);
    assert_eq!(
        refused.first.unwrap_err().0,
        "a fit of 1 number takes 2 points or more; there are 0"
    );
    assert_eq!(
        refused.third.unwrap_err().0,
        "a fit of 2 numbers takes 3 points or more; there are 1"
    );
    let json = serde_json::to_string(&alone).unwrap();
    assert_eq!(serde_json::from_str::<RegimeFits>(&json).unwrap(), alone);
    data[2].x = f64::NAN;
    assert!(
        regime_fits(&data, 1.0, 5.0)
            .first
            .unwrap_err()
            .0
            .contains("no number")
    );
}

/// Curves with scales that nobody knows: these are found with the regimes, and the crossovers' intervals hold the truth
/// nearly as often as if the scales were known: 1,000 sets tell a share of 95 % to 1.4 % at two errors.
#[test]
#[ignore = "ten seconds: `.ci/run long`"]
fn curves_of_unknown_scale_are_found_together() {
    let scales = [1.0, 2.2, 0.4];
    let one = drags(First::Flat, 130.0, 21, 0.03);
    let scaled = |scale: f64| -> Vec<Datum> {
        let at = |d: &Datum| Datum {
            x: d.x,
            y: d.y * scale,
            error: d.error * scale,
        };
        one.iter().map(at).collect()
    };
    let (mut held, mut all, mut off) = ([0; 2], 0, 0.0);
    for seed in 0..1000 {
        let curves: Vec<Vec<Datum>> = scales
            .iter()
            .enumerate()
            .map(|(k, scale)| noisy(&scaled(*scale), 1.0, 10_000 * (k as u64 + 1) + seed))
            .collect();
        let first: Vec<f64> = curves.iter().map(|data| data[0].y).collect();
        let Ok((found, scales)) = scaled_regimes(&curves, First::Flat, first) else {
            continue;
        };
        all += 1;
        off += scales[1] / scales[0] / 2.2 - 1.0;
        for (count, (crossover, truth)) in held
            .iter_mut()
            .zip([(found.first, 1.0), (found.second, 5.0)])
        {
            let low = crossover.low.is_none_or(|low| low <= truth);
            *count += usize::from(low && crossover.high.is_none_or(|high| high >= truth));
        }
    }
    assert!(all > 980, "{all}");
    assert!((off / all as f64).abs() < 0.002, "{}", off / all as f64);
    let shares = held.map(|count| count as f64 / all as f64);
    assert!(
        shares.iter().all(|share| (0.93..0.97).contains(share)),
        "{shares:?}"
    );
}
