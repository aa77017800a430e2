//! Curves of one shape, fitted together.

use super::super::synthetic::{assert_spread, exact, noisy, unscaled};
use super::*;

const SPEEDS: [f64; 9] = [0.3, 0.6, 0.9, 1.4, 2.0, 2.7, 3.5, 4.3, 5.2];

/// Curves with these scales; the second has fewer points.
fn curves(shape: Shape, strength: f64, q: f64, part: f64) -> Vec<Vec<Datum>> {
    let of = |(k, scale): (usize, f64)| {
        let speeds: Vec<f64> = SPEEDS.iter().step_by(k % 2 + 1).copied().collect();
        let curve = |x: f64| scale * (1.0 + strength * shape.at(x, q)[0]);
        exact(&speeds, curve, |y| part * y)
    };
    [140.0, 290.0, 420.0, 600.0]
        .into_iter()
        .enumerate()
        .map(of)
        .collect()
}

fn with_noise(curves: &[Vec<Datum>], seed: u64) -> Vec<Vec<Datum>> {
    let own = curves.iter().enumerate();
    own.map(|(k, data)| noisy(data, 1.0, 10 * seed + k as u64))
        .collect()
}

const POWER: Shape = Shape::Power { from: 1.0 };
const PARABOLA: Shape = Shape::Parabola { from: 1.0, at: 3.0 };

#[test]
fn exact_points_give_back_their_shape() {
    for (shape, q) in [(POWER, 0.9), (POWER, 1.7), (PARABOLA, 1.5), (PARABOLA, 0.4)] {
        let found = joint(&curves(shape, 0.19, q, 0.05), shape).unwrap();
        let [a, own] = [&found.fit.parameters[0], &found.fit.parameters[1]];
        assert!(
            (a.value - 0.19).abs() < 1e-7 && (own.value - q).abs() < 1e-6,
            "{found:?}"
        );
        for ((scale, _), want) in found.scales.iter().zip([140.0, 290.0, 420.0, 600.0]) {
            assert!((scale / want - 1.0).abs() < 1e-7);
        }
    }
}

/// Whatever the errors: a + b x^2 beyond 3 has 1.5 at equal slopes, and half of that with half of the slope; a
/// straight line has about 1.
#[test]
fn a_parabola_is_half_as_steep_again_at_equal_slopes() {
    let line = |x: f64| 100.0 + 30.0 * (x - 1.0).max(0.0);
    let square = |x: f64, b: f64| line(x.min(3.0)) + b * (x * x - 9.0).max(0.0);
    for errors in [|y: f64| 0.01 * y, |y: f64| 0.1 * y * y] {
        for (law, ratio, within) in [
            (exact(&SPEEDS, |x| square(x, 5.0), errors), 1.5, 1e-7),
            (exact(&SPEEDS, |x| square(x, 2.5), errors), 0.75, 1e-7),
            (exact(&SPEEDS, line, errors), 1.0, 0.2),
        ] {
            let r = joint(&[law], PARABOLA).unwrap().fit.parameters[1].value;
            assert!((r - ratio).abs() < within, "{r} {ratio}");
        }
    }
}

#[test]
fn numbers_scatter_as_their_errors_say() {
    for (shape, q) in [(POWER, 1.0), (PARABOLA, 1.5)] {
        let data = curves(shape, 0.25, q, 0.02);
        assert_spread(200, |seed| {
            unscaled(&joint(&with_noise(&data, seed), shape).unwrap().fit)
        });
    }
}

/// Of 1,000 draws with the errors that drags have, the truth lies within two errors in 93 to 97 %: two errors of
/// a normal number hold 95.4 %, of which 1,000 draws tell 1.3 % at two errors.
#[test]
fn the_truth_is_held_as_often_as_errors_say() {
    for (shape, q) in [(POWER, 1.0), (PARABOLA, 1.5)] {
        let data = curves(shape, 0.19, q, 0.04);
        let (mut held, mut all) = (0, 0);
        for seed in 0..1000 {
            let Ok(found) = joint(&with_noise(&data, seed), shape) else {
                continue;
            };
            let (values, covariance) = unscaled(&found.fit);
            all += 1;
            held += usize::from((values[1] - q).abs() <= 2.0 * covariance[1][1].sqrt());
        }
        assert!(all > 980, "{shape:?}: {all}");
        let share = held as f64 / all as f64;
        assert!((0.93..0.97).contains(&share), "{shape:?}: {share}");
    }
}

/// Dividing by forces found before and dropping what is below them, on the same draws: the exponent comes out low.
#[test]
fn points_below_their_force_count() {
    let data = curves(POWER, 0.19, 1.0, 0.05);
    let (mut together, mut apart, mut sets) = (0.0, 0.0, 0.0);
    for seed in 0..200 {
        let drawn = with_noise(&data, seed);
        let mut over = Vec::new();
        for own in &drawn {
            let slow: Vec<Datum> = own.iter().filter(|d| d.x < 1.0).copied().collect();
            let force = slow.iter().map(|d| d.y).sum::<f64>() / slow.len() as f64;
            let fast = own.iter().filter(|d| d.x > 1.0 && d.y > force);
            over.extend(fast.map(|d| Datum {
                x: d.x - 1.0,
                y: d.y / force - 1.0,
                error: d.error / force,
            }));
        }
        if let (Ok(one), Ok(other)) = (joint(&drawn, POWER), super::super::power::power(&over, "x"))
        {
            together += one.fit.parameters[1].value;
            apart += other.parameters[1].value;
            sets += 1.0;
        }
    }
    assert!(sets > 150.0);
    // Means of some 200 exponents known to 0.15 each: 0.01.
    assert!((together / sets - 1.0).abs() < 0.06, "{}", together / sets);
    assert!(
        apart < together - 0.05 * sets,
        "{} {}",
        apart / sets,
        together / sets
    );
}

#[test]
fn what_points_cannot_carry_is_refused() {
    let told = |c: &[Vec<Datum>]| joint(c, POWER).unwrap_err().0;
    let all = curves(POWER, 0.2, 1.0, 0.02);
    let slow: Vec<Vec<Datum>> = all.iter().map(|c| c[..2].to_vec()).collect();
    assert!(told(&slow).starts_with("a joint fit takes 3 values of x or more beyond 1; there are"));
    let apart = |c: &Vec<Datum>| {
        c.iter()
            .filter(|d| d.x < 1.0 || d.x > 3.0)
            .copied()
            .collect()
    };
    let bent = curves(PARABOLA, 0.2, 1.5, 0.02);
    let gap: Vec<Vec<Datum>> = bent.iter().map(apart).collect();
    let refused = joint(&gap, PARABOLA).unwrap_err().0;
    assert!(
        refused.starts_with("a joint fit takes 2 values of x or more from 1 to 3; there are 0"),
        "{refused}"
    );
    let at_one_speed = |x: f64| exact(&[x, x], |x| 100.0 * x, |y| 0.1 * y);
    let alone = [1.5, 2.0, 2.5, 3.0].map(at_one_speed);
    assert!(told(&alone).contains("do not tell"), "{}", told(&alone));
    let vague = curves(POWER, 0.2, 1.0, 0.5);
    assert!(told(&vague).contains("standard error"), "{}", told(&vague));
    assert!(told(&[]).contains("there are 0"));
    let mut bad = all;
    bad[1][0].error = 0.0;
    assert!(told(&bad).contains("errors are above zero"));
}
