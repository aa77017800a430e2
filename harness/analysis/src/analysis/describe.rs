//! The analysis in words and numbers, for a terminal.

use super::{
    Analysis, Collapse, Curve, ErrorOf, Exponent, Finding, Material, Method, NearField, Pooled,
    Reading, Scaled, Scaling, Stiffness, Value,
};
use crate::fit::Fit;
use crate::fit::regimes::Regimes;
use bitgrain_sim::format::{number_with_error, short};

fn value(v: &Value) -> String {
    number_with_error(v.value, v.error)
}

/// What was found, or `none:` and why.
fn describe_finding<T>(finding: &Finding<T>, of: impl Fn(&T) -> String) -> String {
    match finding {
        Finding::Found(found) => of(found),
        Finding::Refused(why) => format!("none: {why}"),
    }
}

fn line(fit: &Finding<Fit>) -> String {
    describe_finding(fit, |fit| format!("{}: {}", fit.model, fit.line()))
}

/// Grains in words.
pub(crate) fn material(m: &Material) -> String {
    match grains(m) {
        own if own.is_empty() => format!("mu = {}", m.mu),
        own => format!("mu = {}, {own}", m.mu),
    }
}

/// Their properties besides friction; nothing under a law without these numbers.
pub(crate) fn grains(m: &Material) -> String {
    match m.kn {
        0.0 => String::new(),
        kn => format!("K_n = {kn:e}, gamma_n = {}", short(m.gamma_n)),
    }
}

/// An intruder in words.
pub(crate) fn intruder(curve: &Curve) -> String {
    format!("D = {}, h = {}", short(curve.diameter), short(curve.depth))
}

/// All of it, a line for each finding.
pub fn describe(analysis: &Analysis) -> String {
    let counted = match analysis.plugs {
        true => "counted although",
        false => "left out because",
    };
    let mut lines = vec![format!(
        "{} runs, {} failed, {} {counted} the bed slid along",
        analysis.rows, analysis.failed, analysis.sliding
    )];
    curves(analysis, &mut lines);
    analysis.pooled.iter().for_each(|p| pooled(p, &mut lines));
    analysis
        .near_field
        .iter()
        .for_each(|a| near_field(a, &mut lines));
    analysis.scaling.iter().for_each(|s| scaling(s, &mut lines));
    table_one(analysis, &mut lines);
    analysis
        .stiffness
        .iter()
        .for_each(|g| levels(g, &mut lines));
    lines.join("\n") + "\n"
}

fn curves(analysis: &Analysis, lines: &mut Vec<String>) {
    let both = analysis.curves.iter().zip(&analysis.speeds);
    let mut last = None;
    for ((curve, speeds), own) in both.zip(&analysis.yields) {
        if last != Some(curve.material) {
            lines.push(format!("\n{}", material(&curve.material)));
            last = Some(curve.material);
        }
        let how = match own.method {
            Method::SlowRun => "slow run",
            Method::Plateau => "plateau",
            Method::Extrapolated => "extrapolated",
        };
        let force = describe_finding(&own.force, value);
        let several = curve.points.iter().filter(|p| p.beds > 1);
        let spread = several.clone().filter(|p| p.error_of == ErrorOf::Beds);
        let beds = match several.clone().count() {
            0 => String::new(),
            n => format!(
                ", {n} speeds through several beds, whose spread is the error at {} of them",
                spread.count()
            ),
        };
        lines.push(format!(
            "  {}: {} runs{beds}",
            intruder(curve),
            curve.runs.len()
        ));
        lines.push(format!("    yield force ({how} of {}): {force}", own.runs));
        let flat = describe_finding(&speeds.flatness, |f| {
            let [slow, fast] = f.froude.map(short);
            format!("F({fast})/F({slow}) = {}", value(&f.ratio))
        });
        lines.push(format!("    below Fr = 1: {flat}"));
        if let Some(first) = &speeds.first {
            lines.push(format!("    first regime: {}", line(first)));
        }
        let all = describe_finding(&speeds.regimes, Regimes::text);
        lines.push(format!("    regimes: {all}"));
    }
}

fn pooled(pooled: &Pooled, lines: &mut Vec<String>) {
    let name = material(&pooled.material);
    lines.push(format!(
        "\nall intruders together, depth asked h = {}, {name}",
        short(pooled.depth_asked)
    ));
    let regimes = describe_finding(&pooled.regimes, Regimes::text);
    lines.push(format!("  regimes: {regimes}"));
    for growth in &pooled.growth {
        let on = match (growth.reading, pooled.path) {
            (Reading::CutOnPath | Reading::UncutOnPath, Some(path)) => format!(" of {path} d"),
            _ => String::new(),
        };
        lines.push(format!("  drags with {}{on}", growth.reading.words()));
        lines.push(format!(
            "    F/F_Y - 1 against Fr - 1 up to Fr = 5: {}",
            line(&growth.second)
        ));
        lines.push(format!(
            "    parabola above Fr = 5, mean slope to 10 over that below: {}",
            line(&growth.third)
        ));
    }
}

fn near_field(near_field: &NearField, lines: &mut Vec<String>) {
    lines.push(format!(
        "\nround the intruder, {}",
        material(&near_field.material)
    ));
    lines.push(format!(
        "  contact angle: {}",
        line(&near_field.contacts.law)
    ));
    lines.push(format!(
        "  where contacts begin: {}",
        line(&near_field.new_contacts.law)
    ));
    lines.push(format!("  kappa: {}", line(&near_field.kappa)));
    for one in &near_field.within {
        let [least, most] = one.floating.map(|share| short(100.0 * share));
        lines.push(format!(
            "  kappa within {} d: {}; up to Fr = 5: {}; {least} to {most} % of the grains float at the highest Fr",
            short(one.reach),
            line(&one.line),
            line(&one.slow)
        ));
    }
    for f in &near_field.floating {
        lines.push(format!(
            "  grains without contacts, D = {}, h = {}: {} at the lowest speed, {} at the highest",
            short(f.diameter),
            short(f.depth_asked),
            value(&f.slowest),
            value(&f.fastest)
        ));
    }
}

fn scaling(scaling: &Scaling, lines: &mut Vec<String>) {
    lines.push(format!("\nscaling, {}", material(&scaling.material)));
    let mut list = |name: &str, at: &str, all: &[Exponent]| {
        let line = |e: &Exponent| format!("  {name} at {at} = {}: {}", short(e.at), line(&e.fit));
        lines.extend(all.iter().map(line));
    };
    list("phi", "h", &scaling.phi);
    list("alpha", "D", &scaling.alpha);
    let mean = describe_finding(&scaling.alpha_mean, value);
    lines.push(format!("  alpha, mean over speeds: {mean}"));
    let both = |found: &Finding<Scaled>| {
        describe_finding(found, |s| {
            format!("{}; phi + alpha = {}", s.fit.line(), value(&s.sum))
        })
    };
    lines.push(format!("  both at once: {}", both(&scaling.both)));
    let slow = both(&scaling.slow);
    lines.push(format!(
        "  both from slow drags, if all grow alike with Fr up to 1.3: {slow}"
    ));
    let spread = |c: &Collapse| {
        format!(
            "spread {}, of which errors {}",
            short(c.spread),
            short(c.expected)
        )
    };
    lines.push(format!(
        "  collapse of sizes: {}",
        describe_finding(&scaling.by_size, spread)
    ));
    lines.push(format!(
        "  collapse of depths: {}",
        describe_finding(&scaling.by_depth, spread)
    ));
}

fn table_one(analysis: &Analysis, lines: &mut Vec<String>) {
    if analysis.table_one.is_empty() {
        return;
    }
    lines.push(
        "\nfrictionless drags over those of Kumar 2018, Table I, brought to its depth".into(),
    );
    for one in &analysis.table_one {
        let [least, most] = one.depths.map(short);
        let [shallow, deep] = one.at_depths.map(|v| value(&v));
        let points: Vec<String> = one
            .points
            .iter()
            .map(|(froude, _, ratio)| format!("{} at Fr = {}", value(ratio), short(*froude)))
            .collect();
        lines.push(format!(
            "  D = {}, {}, from h = {} by h^({}): {}; {shallow} if the paper's depth is {least} d, {deep} if {most} d \
             ({})",
            short(one.diameter),
            one.reading.words(),
            short(one.depth),
            value(&one.alpha),
            value(&one.ratio),
            points.join(", ")
        ));
    }
}

fn levels(group: &Stiffness, lines: &mut Vec<String>) {
    lines.push(format!(
        "\n{} varied, mu = {}, D = {}, h = {}",
        group.what,
        group.mu,
        short(group.diameter),
        short(group.depth_asked)
    ));
    for level in &group.levels {
        let fast = level.fast.as_ref().map_or("-".to_string(), value);
        lines.push(format!(
            "  K_n = {:e}, gamma_n = {}: yield force {}, drag beyond Fr = 5 over the first {fast}",
            level.kn,
            short(level.gamma_n),
            value(&level.slow)
        ));
    }
}
