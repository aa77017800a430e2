//! What a campaign's analysis says of the claims about yield forces and how they scale.

use bitgrain_sim::format::{number_with_error, short};

use super::kumar_curves::{Found, MU, Of, farthest, found, least, mean, name, parameter};
use crate::analysis::{
    Collapse, Curve, Exponent, Finding, Scaling, Speeds, Stiffness, Value, Yield,
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
            let all: Vec<(Value, String)> = wide.filter_map(one).collect();
            mean(
                &all,
                "no first regime without friction was found: each exponent was refused",
            )
        }
        "frictionless-yield" => {
            let over = |(curve, _, own): (&Curve, &Speeds, &Yield)| {
                let force = own.force.found()?;
                // In units of its error, so that its own error is one.
                Some((Value::new(force.value / force.error, 1.0), name(curve)))
            };
            least(
                slick().filter_map(over).collect(),
                "no yield force without friction was found",
            )
        }
        "yield-rises" => {
            let over = |(curve, _, own): (&Curve, &Speeds, &Yield)| {
                let rough = of.yield_at(MU, curve)?;
                Some((rough.over(*own.force.found()?), name(curve)))
            };
            least(
                slick().filter_map(over).collect(),
                "no intruder has a yield force with and without friction",
            )
        }
        "yield-saturates" => saturation(of),
        _ => return None,
    })
}

fn saturation(of: &Of) -> Found {
    let one = |(curve, _, _): (&Curve, &Speeds, &Yield)| {
        let [a, b, c] = [
            of.yield_at(0.0, curve)?,
            of.yield_at(MU, curve)?,
            of.yield_at(0.9, curve)?,
        ];
        let (low, high) = (b.value - a.value, c.value - b.value);
        let ratio = high / low;
        let by = [
            ratio / low * a.error,
            (1.0 + ratio) / low * b.error,
            c.error / low,
        ];
        let error = by.iter().map(|e| e * e).sum::<f64>().sqrt();
        Some((Value::new(ratio, error), name(curve)))
    };
    let slick = of.curves().filter(|(c, ..)| c.material.mu < 0.05);
    mean(
        &slick.filter_map(one).collect::<Vec<_>>(),
        "no run has mu = 0.9",
    )
}

/// Weighted mean of the exponents of a list.
fn exponent(list: &[Exponent], what: &str) -> Found {
    let mut why = format!("no {what} was found");
    let mut all = Vec::new();
    for e in list {
        match &e.fit {
            Finding::Found(fit) => all.push((parameter(fit, "p")?, String::new())),
            Finding::Refused(refusal) => why = refusal.to_string(),
        }
    }
    let of = |n: usize| match n {
        1 => format!("one fit of {what}"),
        n => format!("mean of {n} fits of {what}"),
    };
    mean(&all, &why).map(|(v, _)| (v, of(all.len())))
}

/// An exponent from the slow drags at equal Froude numbers, if the yield forces give none.
fn slow(scaling: &Scaling, name: &str, why: String) -> Found {
    let found = scaling.slow.found().ok_or(why.clone())?;
    let note =
        format!("of drags up to Fr = 1.3, if all grow alike with the speed; of yields none: {why}");
    Ok((parameter(&found.fit, name)?, note))
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
    let beside = yields.map_or(String::new(), |(v, note)| format!("; {} {note}", number(v)));
    let [least, most] = own.depths;
    let note = format!(
        "mean over {} speeds, h = {} to {} d{beside}",
        own.alpha_at_speed
            .iter()
            .filter(|at| at.fit.found().is_some())
            .count(),
        short(least),
        short(most)
    );
    Ok((*mean, note))
}

fn difference(a: Found, b: Found) -> Found {
    let ((a, first), (b, second)) = (a?, b?);
    let note = format!("{:.3} ({first}) less {:.3} ({second})", a.value, b.value);
    Ok((a.less(b), note))
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
        "sum" => {
            let all = of.analysis.scaling.iter().filter_map(|s| {
                let phi = exponent(&s.phi, "phi").or_else(|why| slow(s, "phi", why));
                let ((phi, _), (alpha, note)) = (phi.ok()?, alpha(s).ok()?);
                let sum = Value::new(
                    phi.value + alpha.value,
                    (phi.error * phi.error + alpha.error * alpha.error).sqrt(),
                );
                let own = s
                    .both
                    .found()
                    .or(s.slow.found())
                    .map_or(String::new(), |both| {
                        format!("; {} of yield forces or slow drags", number(both.sum))
                    });
                let mu = s.material.mu;
                Some((
                    sum,
                    format!(
                        "mu = {mu}, phi {}, alpha {}: {note}{own}",
                        number(phi),
                        number(alpha)
                    ),
                ))
            });
            farthest(
                all.collect(),
                3.0,
                "no material has yield forces or slow drags at several sizes and depths",
            )
        }
        _ => return None,
    })
}

type Exponents = fn(&Scaling) -> &Vec<Exponent>;

/// The largest difference of an exponent within one material.
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
    farthest(all, 0.0, "no material has the exponent at two depths")
}

/// The largest difference of an exponent between materials of one friction.
fn across(of: &Of, list: Exponents, what: &str) -> Found {
    let mut all = Vec::new();
    let scalings = &of.analysis.scaling;
    for (k, a) in scalings.iter().enumerate() {
        for b in scalings[..k]
            .iter()
            .filter(|b| b.material.mu == a.material.mu)
        {
            if let (Ok((x, _)), Ok((y, _))) = (exponent(list(a), what), exponent(list(b), what)) {
                all.push(apart(x, y, a.material.mu));
            }
        }
    }
    farthest(all, 0.0, "the runs have one K_n")
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
    let beyond = |collapse: &Collapse| -> (Value, String) {
        let left = collapse.spread * collapse.spread - collapse.expected * collapse.expected;
        let n: f64 = collapse.speeds.iter().map(|s| s.runs as f64 - 1.0).sum();
        let error = collapse.spread / (2.0 * n).sqrt();
        let note = format!(
            "spread {:.3}, of which errors {:.3}, at {} speeds",
            collapse.spread,
            collapse.expected,
            collapse.speeds.len()
        );
        (
            Value::new(if left > 0.0 { left.sqrt() } else { 0.0 }, error),
            note,
        )
    };
    let which: fn(&Scaling) -> &Finding<Collapse> = match id {
        "collapse-size" | "collapse-size-frictionless" => |s| &s.by_size,
        "collapse-depth" => |s| &s.by_depth_deep,
        "collapse-shallow" => |s| &s.by_depth_shallow,
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
    let fast = |what: &str, far: f64| {
        let mut all = Vec::new();
        for group in groups(what) {
            let note = format!("D = {}, h = {}", group.diameter, group.depth_asked);
            let levels = group.levels.iter().filter_map(|level| level.fast);
            all.extend(levels.map(|v| (v, note.clone())));
        }
        farthest(
            all,
            far,
            &format!("no intruder was dragged beyond Fr = 5 at several {what}"),
        )
    };
    let slow = |what: &str| {
        let ratio = |group: &&Stiffness| {
            let [first, .., last] = &group.levels[..] else {
                return None;
            };
            let note = format!("D = {}, h = {}", group.diameter, group.depth_asked);
            Some((last.slow.over(first.slow), note))
        };
        let all: Vec<(Value, String)> = groups(what).iter().filter_map(ratio).collect();
        mean(
            &all,
            &format!("no intruder has yield forces at several {what}"),
        )
    };
    Some(match id {
        "fast-stiffness" => fast("kn", 1.0),
        "fast-damping" => {
            fast("gamma_n", 1.0).map(|(v, note)| (Value::new((v.value - 1.0).abs(), v.error), note))
        }
        "slow-stiffness" => slow("kn"),
        "slow-damping" => slow("gamma_n"),
        _ => return None,
    })
}
