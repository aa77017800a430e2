//! What a campaign's analysis says of each claim of Kumar 2018.

use super::book::Claim;
use super::combine::weighted_mean;
use super::kumar_curves::{MU, Of, found, name, parameter};
use super::kumar_drags::drags;
use super::kumar_scaling::{collapses, exponents, stiffness, yields};
use super::number::{Found, Number};
use crate::analysis::{Analysis, Contacts, NearField, Value};
use crate::fit::Fit;
use crate::fit::regimes::Crossover;
use bitgrain_sim::format::number_with_error;

/// Normal quantile of 97.5 %: a 95 % interval is so many standard errors each way.
const WIDE: f64 = 1.96;

/// Ratios of drags below Fr = 1 of curves with such friction.
fn flat(of: &Of, which: impl Fn(f64) -> bool) -> Vec<(Value, String)> {
    let own = of.curves().filter(|(c, ..)| which(c.material.mu));
    own.filter_map(|(curve, speeds, _)| {
        let f = speeds.flatness.found()?;
        let note = format!("Fr {} over {}, {}", f.froude[1], f.froude[0], name(curve));
        Some((f.ratio, note))
    })
    .collect()
}

/// Means of such ratios over the curves of one friction: those of one material vary by chance alone.
fn by_friction(of: &Of, which: impl Fn(f64) -> bool) -> Vec<(Value, String)> {
    let mut frictions: Vec<f64> = of.curves().map(|(c, ..)| c.material.mu).collect();
    frictions.retain(|mu| which(*mu));
    frictions.sort_by(f64::total_cmp);
    frictions.dedup();
    let mean = |mu: f64| {
        let own = flat(of, |other| other == mu);
        let values: Vec<Value> = own.iter().map(|(value, _)| *value).collect();
        let note = match &own[..] {
            [(_, only)] => only.clone(),
            _ => format!("mu = {mu}, mean of {} curves", own.len()),
        };
        Some((weighted_mean(&values)?.0, note))
    };
    frictions.into_iter().filter_map(mean).collect()
}

/// The measurement of a claim of Kumar 2018; `None` if this paper has no such claim.
pub fn measure(claim: &Claim, analysis: &Analysis) -> Option<Found> {
    let of = Of { analysis, claim };
    let rest = claim.id.strip_prefix("kumar-")?;
    speeds(rest, &of)
        .or_else(|| drags(rest, &of))
        .or_else(|| near_field(rest, &of))
        .or_else(|| yields(rest, &of))
        .or_else(|| exponents(rest, &of))
        .or_else(|| collapses(rest, &of))
        .or_else(|| stiffness(rest, &of))
}

fn speeds(id: &str, of: &Of) -> Option<Found> {
    let none = "no curve has two speeds below Fr = 1 that lie a factor of 1.6 apart";
    let together = |all, none| of.claim.together(all, none);
    Some(match id {
        "flat" => together(flat(of, |mu| (mu - MU).abs() < 1e-9), none),
        "plateau" => together(by_friction(of, |mu| (0.05..MU).contains(&mu)), none),
        "no-plateau" => together(flat(of, |mu| mu < 0.05), none),
        "quadratic" => together(quadratic(of), "no curve has runs at Fr = 5, 7 and 10"),
        "crossover-1" => crossover(of, MU, |r| r.first),
        "crossover-2" => crossover(of, MU, |r| r.second),
        "crossovers-friction" => (|| {
            let (slick, rough) = (
                crossover(of, 0.0, |r| r.first)?,
                crossover(of, MU, |r| r.first)?,
            );
            let note = format!("{}; {}", slick.note, rough.note);
            Ok(Number::one(slick.value.over(rough.value), note))
        })(),
        "crossovers-size-depth" => curves_apart(of),
        "crossovers-stiffness" => (|| {
            let all = of
                .analysis
                .pooled
                .iter()
                .filter(|p| (p.material.mu - MU).abs() < 1e-9);
            let all: Vec<Value> = all.filter_map(|p| at(&p.regimes.found()?.first)).collect();
            let [first, rest @ ..] = &all[..] else {
                return Err("crossovers of other K_n or gamma_n were not found".into());
            };
            let ratios = rest
                .iter()
                .map(|x| (x.over(*first), "K_n or gamma_n varied".to_string()));
            together(ratios.collect(), "the runs have one K_n and one gamma_n")
        })(),
        _ => return None,
    })
}

/// A crossover whose interval is closed, as a number with an error.
fn at(crossover: &Crossover) -> Option<Value> {
    let (low, high) = (crossover.low?, crossover.high?);
    Some(Value::new(crossover.at, (high - low) / (2.0 * WIDE)))
}

fn crossover(of: &Of, mu: f64, which: fn(&crate::fit::regimes::Regimes) -> Crossover) -> Found {
    let pooled = of.pooled(mu)?;
    let regimes = found(&pooled.regimes)?;
    let crossover = which(regimes);
    let end = |x: Option<f64>| x.map_or("open".to_string(), |x| format!("{x:.2}"));
    let note = format!(
        "{:.2}, 95 % from {} to {}, of {} runs at mu = {mu}{}",
        crossover.at,
        end(crossover.low),
        end(crossover.high),
        pooled.runs,
        if regimes.needed {
            ""
        } else {
            "; fewer regimes fit as well"
        }
    );
    match at(&crossover) {
        Some(value) => Ok(Number::one(value, note)),
        None => Err(note),
    }
}

fn curves_apart(of: &Of) -> Found {
    let pooled = found(&of.pooled(MU)?.regimes)?;
    let whole = [at(&pooled.first), at(&pooled.second)];
    let mut all = Vec::new();
    for (curve, speeds, _) in of
        .curves()
        .filter(|(c, ..)| (c.material.mu - MU).abs() < 1e-9)
    {
        let Some(own) = speeds.regimes.found() else {
            continue;
        };
        for (x, all_curves) in [at(&own.first), at(&own.second)].into_iter().zip(whole) {
            let (Some(x), Some(all_curves)) = (x, all_curves) else {
                continue;
            };
            let ratio = x.over(all_curves);
            all.push((
                Value::new((ratio.value - 1.0).abs(), ratio.error),
                name(curve),
            ));
        }
    }
    of.claim
        .together(all, "no single curve has crossovers with closed intervals")
}

fn quadratic(of: &Of) -> Vec<(Value, String)> {
    let own = of
        .curves()
        .filter(|(c, ..)| (c.material.mu - MU).abs() < 1e-9);
    own.filter_map(|(curve, ..)| {
        let drag = |froude: f64| {
            curve
                .points
                .iter()
                .find(|p| (p.froude - froude).abs() < 1e-6)
                .map(|p| p.drag)
        };
        let [a, b, c] = [drag(5.0)?, drag(7.0)?, drag(10.0)?];
        let (long, short) = (c.value - a.value, b.value - a.value);
        let ratio = long / short;
        // By each drag: of the first both differences depend.
        let by = [
            (ratio - 1.0) / short * a.error,
            ratio / short * b.error,
            c.error / short,
        ];
        let error = by.iter().map(|e| e * e).sum::<f64>().sqrt();
        Some((Value::new(ratio, error), name(curve)))
    })
    .collect()
}

fn near_field(id: &str, of: &Of) -> Option<Found> {
    // The paper does not give the distance within which it counts coordination, and what kappa does with the speed
    // depends on it: no distance of ours is the paper's.
    let of_kappa = |name: &'static str| -> Found {
        let near_field = of.near_field(MU)?;
        let number = |fit: &Fit| {
            let value = parameter(fit, name)?;
            Ok::<_, String>(number_with_error(value.value, value.error))
        };
        let mut each = Vec::new();
        if near_field.within.is_empty() {
            each.push(format!("{} within 2 d", number(found(&near_field.kappa)?)?));
        }
        for one in &near_field.within {
            let all = number(found(&one.line)?)?;
            let slow = one.slow.found().map(number).transpose()?;
            let slow = slow.map_or(String::new(), |slow| format!(" ({slow} up to Fr = 5)"));
            each.push(format!("{all}{slow} within {} d", one.reach));
        }
        Err(format!(
            "the paper does not give the distance, on which the number depends: {}",
            each.join(", ")
        ))
    };
    let (id, contacts): (_, fn(&NearField) -> &Contacts) = match id.strip_suffix("-collisions") {
        Some(id) => (id, |a| &a.new_contacts),
        None => (id, |a| &a.contacts),
    };
    let of_angle = |name: &'static str| -> Found {
        let fit = found(&contacts(of.near_field(MU)?).law)?;
        Ok(Number::one(parameter(fit, name)?, fit.line()))
    };
    Some(match id {
        "angle-one" => (|| {
            let fit = found(&contacts(of.near_field(MU)?).law)?;
            let (y1, y3) = (parameter(fit, "Y1")?, parameter(fit, "Y3")?);
            let pi = std::f64::consts::PI;
            let slope = -pi / (y3.value * y3.value);
            let c = &fit.covariance;
            let variance = c[0][0] + slope * slope * c[2][2] + 2.0 * slope * c[0][2];
            let value = Value::new(y1.value + pi / y3.value, variance.sqrt());
            Ok(Number::one(value, fit.line()))
        })(),
        "angle-ten" => (|| {
            let fit = found(&contacts(of.near_field(MU)?).at_ten)?;
            Ok(Number::one(parameter(fit, "a")?, fit.line()))
        })(),
        "angle-exponent" => of_angle("Y2"),
        "angle-size" => of.near_field(MU).and_then(|a| {
            let offset = |o: &crate::analysis::Offset| {
                (
                    Value::new(o.residual.value.abs(), o.residual.error),
                    format!("D = {}", o.diameter),
                )
            };
            let all = a.contacts.offsets.iter().map(offset).collect();
            of.claim
                .together(all, "no law of the contact angle was found")
        }),
        "kappa-intercept" => of_kappa("a"),
        "kappa-slope" => of_kappa("b"),
        "kappa-size" => (|| {
            let near_field = of.near_field(MU)?;
            let fit = found(&near_field.kappa)?;
            let five = parameter(fit, "a")?.value + 5.0 * parameter(fit, "b")?.value;
            let offset = |o: &crate::analysis::Offset| {
                let residual = Value::new(o.residual.value.abs(), o.residual.error).divided(five);
                (residual, format!("D = {}", o.diameter))
            };
            let all = near_field.kappa_offsets.iter().map(offset).collect();
            of.claim.together(all, "no line was found")
        })(),
        "floating" => of.near_field(MU).and_then(|a| {
            let ratio = |f: &crate::analysis::Floating| {
                let note = format!("D = {}, h = {}", f.diameter, f.depth_asked);
                (f.fastest.over(f.slowest), note)
            };
            let all = a.floating.iter().map(ratio).collect();
            of.claim.together(all, "no curve has two speeds")
        }),
        _ => return None,
    })
}
