//! What a campaign's analysis says of the claims about yield forces and how they scale.

use bitgrain_sim::format::{number_with_error, short};

use super::combine::weighted_mean;
use super::kumar_curves::{MU, Of, found, name, parameter};
use super::number::{Found, Number};
use crate::analysis::{
    Collapse, Curve, Exponent, Finding, SHALLOW, Scaling, Speeds, Stiffness, Value, Yield,
};

pub(super) fn yields(id: &str, of: &Of) -> Option<Found> {
    let slick = || of.curves().filter(|(c, ..)| c.material.mu < 0.05);
    Some(match id {
        "table-1" | "table-1-offset" => {
            let offset = id == "table-1-offset";
            let one = |(curve, speeds, own): (&Curve, &Speeds, &Yield)| -> Option<(Value, String)> {
                if offset {
                    let force = *own.force.found()?;
                    let scale =
                        curve.effective_diameter() * curve.effective_diameter() * curve.depth;
                    return Some((force.divided(scale), name(curve)));
                }
                let fit = speeds.first.as_ref()?.found()?;
                Some((parameter(fit, "c").ok()?, name(curve)))
            };
            let wide = slick().filter(|(c, ..)| !offset || c.diameter > 1.5 * c.mean_diameter);
            of.claim.together(
                wide.filter_map(one).collect(),
                "no first regime without friction was found: each exponent was refused",
            )
        }
        "frictionless-yield" => {
            let over = |(curve, _, own): (&Curve, &Speeds, &Yield)| {
                let force = own.force.found()?;
                // In units of its error, so that its own error is one.
                Some((Value::new(force.value / force.error, 1.0), name(curve)))
            };
            of.claim.together(
                slick().filter_map(over).collect(),
                "no yield force without friction was found",
            )
        }
        "yield-rises" => {
            let over = |(curve, _, own): (&Curve, &Speeds, &Yield)| {
                let rough = of.yield_at(MU, curve)?;
                Some((rough.over(*own.force.found()?), name(curve)))
            };
            of.claim.together(
                slick().filter_map(over).collect(),
                "no intruder has a yield force with and without friction",
            )
        }
        "yield-saturates" => saturation(of),
        _ => return None,
    })
}

/// Rise of the yield force from mu = 0.5 to 0.9 over that from 0 to 0.5. Where none was found without friction the
/// slowest drag stands for it: that is larger, and makes the ratio too large, which the claim bounds from above.
fn saturation(of: &Of) -> Found {
    let one = |(curve, _, own): (&Curve, &Speeds, &Yield)| {
        let least = curve.points.first()?.froude;
        let slowest = || {
            let all = curve.points.iter().take_while(|p| p.froude == least);
            Value::mean(all.map(|p| p.drag))
        };
        let (a, note) = match own.force.found() {
            Some(force) => (*force, name(curve)),
            None => (
                slowest()?,
                format!("{}, at most: its slowest drag as yield force", name(curve)),
            ),
        };
        let [b, c] = [of.yield_at(MU, curve)?, of.yield_at(0.9, curve)?];
        let (low, high) = (b.value - a.value, c.value - b.value);
        let ratio = high / low;
        let by = [
            ratio / low * a.error,
            (1.0 + ratio) / low * b.error,
            c.error / low,
        ];
        let error = by.iter().map(|e| e * e).sum::<f64>().sqrt();
        Some((Value::new(ratio, error), note))
    };
    let slick = of.curves().filter(|(c, ..)| c.material.mu < 0.05);
    of.claim.together(
        slick.filter_map(one).collect(),
        "no intruder has drags at mu = 0 and yield forces at 0.5 and 0.9",
    )
}

/// Weighted mean of the exponents of a list.
fn exponent(list: &[Exponent], what: &str) -> Found {
    let mut why = format!("no {what} was found");
    let mut all = Vec::new();
    for e in list {
        match &e.fit {
            Finding::Found(fit) => all.push(parameter(fit, "p")?),
            Finding::Refused(refusal) => why = refusal.to_string(),
        }
    }
    let (mean, _) = weighted_mean(&all).ok_or(why)?;
    let note = match all.len() {
        1 => format!("one fit of {what}"),
        n => format!("mean of {n} fits of {what}"),
    };
    Ok(Number::one(mean, note))
}

/// An exponent from the slow drags at equal Froude numbers, if the yield forces give none.
fn slow(scaling: &Scaling, name: &str, why: String) -> Found {
    let found = scaling.slow.found().ok_or(why.clone())?;
    let note =
        format!("of drags up to Fr = 1.3, if all grow alike with the speed; of yields none: {why}");
    Ok(Number::one(parameter(&found.fit, name)?, note))
}

fn number(v: Value) -> String {
    number_with_error(v.value, v.error)
}

/// alpha as the paper takes it, the mean over the drags at several speeds (Kumar 2018, section III H, Fig. 18), with
/// that of the yield forces beside it and the depths that it rests on; if there is none, that of the yield forces.
fn alpha(own: &Scaling) -> Found {
    let yields = exponent(&own.alpha, "alpha").or_else(|why| slow(own, "alpha", why));
    let Finding::Found(mean) = &own.alpha_mean else {
        return yields;
    };
    let beside = yields.map_or(String::new(), |own| {
        format!("; {} {}", number(own.value), own.note)
    });
    let [least, most] = own.depths;
    let fits = own
        .alpha_at_speed
        .iter()
        .filter(|at| at.fit.found().is_some());
    let note = format!(
        "mean of {} fits at a size and a speed, h = {} to {} d{beside}",
        fits.count(),
        short(least),
        short(most)
    );
    Ok(Number::one(*mean, note))
}

fn difference(a: Found, b: Found) -> Found {
    let (a, b) = (a?, b?);
    let note = format!(
        "{:.3} ({}) less {:.3} ({})",
        a.value.value, a.note, b.value.value, b.note
    );
    Ok(Number::one(a.value.less(b.value), note))
}

pub(super) fn exponents(id: &str, of: &Of) -> Option<Found> {
    let phi = |mu: f64| {
        let own = of.scaling(mu)?;
        exponent(&own.phi, "phi").or_else(|why| slow(own, "phi", why))
    };
    let alpha_at = |mu: f64| alpha(of.scaling(mu)?);
    Some(match id {
        "phi-0" => phi(0.0),
        "phi-falls" => difference(phi(0.0), phi(MU)),
        "phi-depth" => within(of, |s| &s.phi),
        "phi-stiffness" => across(of, |s| &s.phi, "phi"),
        "alpha-0" => alpha_at(0.0),
        "alpha-above-one" => alpha_at(MU),
        "alpha-rises" => difference(alpha_at(MU), alpha_at(0.0)),
        "alpha-stiffness" => {
            let mut own: Vec<&Scaling> = of
                .analysis
                .scaling
                .iter()
                .filter(|s| (s.material.mu - MU).abs() < 1e-9)
                .collect();
            own.sort_by(|a, b| a.material.kn.total_cmp(&b.material.kn));
            match &own[..] {
                [soft, .., hard] if hard.material.kn > soft.material.kn => {
                    difference(alpha(hard), alpha(soft))
                }
                _ => Err("the runs have one K_n".into()),
            }
        }
        "sum" => of.claim.together(
            of.analysis.scaling.iter().flat_map(sums).collect(),
            "no material has yield forces or slow drags at several sizes and depths",
        ),
        _ => return None,
    })
}

/// phi + alpha of a material, with the phi of each depth from 25 d on, where the paper has it (system I), or else of
/// each that there is.
fn sums(own: &Scaling) -> Vec<(Value, String)> {
    let Ok(alpha) = alpha(own) else {
        return Vec::new();
    };
    let both = own.both.found().or(own.slow.found());
    let both = both.map_or(String::new(), |both| {
        format!("; {} of yield forces or slow drags", number(both.sum))
    });
    let found = own.phi.iter().filter_map(|phi| {
        let value = parameter(phi.fit.found()?, "p").ok()?;
        Some((phi.at, value))
    });
    let mut found: Vec<(f64, Value)> = found.collect();
    let is_deep = |(at, _): &(f64, Value)| *at >= SHALLOW;
    if found.iter().any(is_deep) {
        found.retain(is_deep);
    }
    let named = |(at, phi): (f64, Value)| (format!(" at {} d", short(at)), phi);
    let mut all: Vec<(String, Value)> = found.into_iter().map(named).collect();
    if let (true, Ok(phi)) = (all.is_empty(), slow(own, "phi", String::new())) {
        all.push((String::new(), phi.value));
    }
    let sum = |(place, phi): (String, Value)| {
        let [a, b] = [phi.error, alpha.value.error];
        let error = (a * a + b * b).sqrt();
        let words = format!(
            "mu = {}, phi {}{place}, alpha {}: {}{both}",
            own.material.mu,
            number(phi),
            number(alpha.value),
            alpha.note
        );
        (Value::new(phi.value + alpha.value.value, error), words)
    };
    all.into_iter().map(sum).collect()
}

type Exponents = fn(&Scaling) -> &Vec<Exponent>;

/// Differences of an exponent within one material.
fn within(of: &Of, list: Exponents) -> Found {
    let mut all = Vec::new();
    for scaling in &of.analysis.scaling {
        let fits: Vec<Value> = list(scaling)
            .iter()
            .filter_map(|e| parameter(e.fit.found()?, "p").ok())
            .collect();
        for (k, a) in fits.iter().enumerate() {
            all.extend(fits[..k].iter().map(|b| apart(*a, *b, scaling.material.mu)));
        }
    }
    of.claim
        .together(all, "no material has the exponent at two depths")
}

/// Differences of an exponent between materials of one friction.
fn across(of: &Of, list: Exponents, what: &str) -> Found {
    let mut all = Vec::new();
    let scalings = &of.analysis.scaling;
    for (k, a) in scalings.iter().enumerate() {
        for b in scalings[..k]
            .iter()
            .filter(|b| b.material.mu == a.material.mu)
        {
            if let (Ok(x), Ok(y)) = (exponent(list(a), what), exponent(list(b), what)) {
                all.push(apart(x.value, y.value, a.material.mu));
            }
        }
    }
    of.claim.together(all, "the runs have one K_n")
}

fn apart(a: Value, b: Value, mu: f64) -> (Value, String) {
    let apart = a.less(b);
    (
        Value::new(apart.value.abs(), apart.error),
        format!("mu = {mu}"),
    )
}

pub(super) fn collapses(id: &str, of: &Of) -> Option<Found> {
    // Beyond the errors: what is left when they are taken out in squares.
    let beyond = |collapse: &Collapse| -> Number {
        let left = collapse.spread * collapse.spread - collapse.expected * collapse.expected;
        let error = collapse.spread / (2.0 * collapse.deviations).sqrt();
        let note = format!(
            "spread {:.3}, of which errors {:.3}, at {} speeds",
            collapse.spread,
            collapse.expected,
            collapse.speeds.len()
        );
        let spread = if left > 0.0 { left.sqrt() } else { 0.0 };
        Number::one(Value::new(spread, error), note)
    };
    let which: fn(&Scaling) -> &Finding<Collapse> = match id {
        "collapse-size" | "collapse-size-frictionless" => |s| &s.by_size,
        "collapse-depth" => |s| &s.by_depth_deep,
        "collapse-shallow" => |s| &s.shallow_off_deep,
        _ => return None,
    };
    let mu = if id == "collapse-size-frictionless" {
        0.0
    } else {
        MU
    };
    Some(of.scaling(mu).and_then(|s| Ok(beyond(found(which(s))?))))
}

pub(super) fn stiffness(id: &str, of: &Of) -> Option<Found> {
    let groups = |what: &str| -> Vec<&Stiffness> {
        of.analysis
            .stiffness
            .iter()
            .filter(|g| g.what == what && (g.mu - MU).abs() < 1e-9)
            .collect()
    };
    let place = |group: &Stiffness| format!("D = {}, h = {}", group.diameter, group.depth_asked);
    let none = |what: &str| format!("no intruder was dragged beyond Fr = 5 at several {what}");
    let slow = |what: &str| {
        let ratio = |group: &&Stiffness| {
            let [first, .., last] = &group.levels[..] else {
                return None;
            };
            Some((last.slow.over(first.slow), place(group)))
        };
        of.claim.together(
            groups(what).iter().filter_map(ratio).collect(),
            &format!("no intruder has yield forces at several {what}"),
        )
    };
    Some(match id {
        "fast-stiffness" => {
            let mut all = Vec::new();
            for group in groups("kn") {
                let levels = group.levels.iter();
                all.extend(levels.filter_map(|l| {
                    Some((l.fast?, format!("{}, K_n = {:e}", place(group), l.kn)))
                }));
            }
            of.claim.together(all, &none("kn"))
        }
        // Of the largest damping over the smallest, and not of those that differ most by chance.
        "fast-damping" => {
            let ends = |group: &&Stiffness| {
                let ratio = group.levels.last()?.fast?;
                let off = Value::new((ratio.value - 1.0).abs(), ratio.error);
                Some((off, place(group)))
            };
            of.claim.together(
                groups("gamma_n").iter().filter_map(ends).collect(),
                &none("gamma_n"),
            )
        }
        "slow-stiffness" => slow("kn"),
        "slow-damping" => slow("gamma_n"),
        _ => return None,
    })
}
