//! Checks of a summary that was read: anything is refused that a run of its own inputs could not give.
//!
//! Numbers are finite already, for JSON has no others.

use bitgrain_kernel::PARTS;

use super::record::{BedSummary, DragRecord, DragSummary, Flow, Rig, Summary, Tank};
use crate::scenario::{BedPlan, CheckedScenario, DragPlan, Scenario};
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::coarse_graining::load::{self, Load, POINTS};
use bitgrain_sim::units::Units;

/// Nothing, or the key that is wrong and what is wrong with it.
type Check = Result<(), Wrong>;

/// The key that is wrong and what is wrong with it.
type Wrong = (String, String);

/// Largest relative difference at which two numbers are one: other programs may write fewer digits.
const SAME: f64 = 1e-9;

/// Longest name or version in a summary, in bytes.
const WORDS_MAX: usize = 1000;

/// Most numbers of contacts that shares are counted of: no grain has this many neighbours.
const SHARES_MAX: usize = 1000;

/// Digits of a digest in hex.
const DIGITS: usize = 64;

fn refuse(key: impl Into<String>, problem: impl Into<String>) -> Check {
    Err((key.into(), problem.into()))
}

impl Summary<Scenario> {
    /// The summary of a run of its own inputs, if it can be one.
    ///
    /// # Errors
    /// The key that is wrong, and what is wrong with it.
    pub(super) fn checked(self) -> Result<Summary, Wrong> {
        check_head(&self.version, &self.standard_error_method)?;
        let inputs = check_inputs(self.inputs, &self.units)?;
        if self.scenario != inputs.name {
            let problem = format!("is not `{}`, the value of the inputs", inputs.name);
            refuse("scenario", problem)?;
        }
        let (beds, runs) = (inputs.beds(), inputs.drags());
        // Longer lists hold something twice, and need not be compared.
        for (key, given, planned) in [
            ("beds", self.beds.len(), beds.len()),
            ("runs", self.runs.len(), runs.len()),
        ] {
            if given == 0 || given > planned {
                let problem = format!("holds {given}; the inputs plan {planned}");
                refuse(key, problem)?;
            }
        }
        for (k, bed) in self.beds.iter().enumerate() {
            let at = format!("beds[{k}]");
            if self.beds[..k].iter().any(|other| other.name == bed.name) {
                refuse(format!("{at}.name"), "is there twice")?;
            }
            check_bed(bed, beds, &inputs, &at)?;
        }
        for (k, run) in self.runs.iter().enumerate() {
            let at = format!("runs[{k}]");
            if self.runs[..k].iter().any(|other| other.name == run.name) {
                refuse(format!("{at}.name"), "is there twice")?;
            }
            let Some(bed) = self.beds.iter().find(|bed| bed.name == run.bed) else {
                let problem = "is not one of the beds in this file";
                return Err((format!("{at}.bed"), problem.into()));
            };
            check_run(run, bed, (beds, runs), &inputs, &at)?;
        }
        Ok(Summary {
            version: self.version,
            bits_version: self.bits_version,
            scenario: self.scenario,
            units: self.units,
            inputs,
            standard_error_method: self.standard_error_method,
            beds: self.beds,
            runs: self.runs,
        })
    }
}

impl DragRecord<Scenario> {
    /// The summary of a drag of its own inputs, if it can be one.
    ///
    /// # Errors
    /// As [`Summary::check`].
    pub(super) fn checked(self) -> Result<DragRecord, Wrong> {
        check_head(&self.version, &self.standard_error_method)?;
        let inputs = check_inputs(self.inputs, &self.units)?;
        let plans = (inputs.beds(), inputs.drags());
        check_bed(&self.bed, plans.0, &inputs, "bed")?;
        if self.run.bed != self.bed.name {
            let problem = format!("is not `{}`, the bed in this file", self.bed.name);
            return Err(("run.bed".into(), problem));
        }
        check_run(&self.run, &self.bed, plans, &inputs, "run")?;
        Ok(DragRecord {
            version: self.version,
            bits_version: self.bits_version,
            units: self.units,
            inputs,
            standard_error_method: self.standard_error_method,
            bed: self.bed,
            run: self.run,
        })
    }
}

fn check_head(version: &str, method: &str) -> Check {
    for (key, words) in [("version", version), ("standard_error_method", method)] {
        if words.len() > WORDS_MAX || words.chars().any(char::is_control) {
            let problem = format!("expected a line of at most {WORDS_MAX} bytes");
            return refuse(key, problem);
        }
    }
    Ok(())
}

fn check_inputs(inputs: Scenario, units: &Units) -> Result<CheckedScenario, Wrong> {
    let inputs = inputs
        .check_resolved()
        .map_err(|wrong| (format!("inputs.{}", wrong.key), wrong.problem))?;
    if *units != inputs.units() {
        refuse("units", "do not belong to the inputs")?;
    }
    Ok(inputs)
}

/// A number that is not the one that follows from the inputs.
fn same(key: String, given: f64, planned: f64) -> Check {
    if (given - planned).abs() <= SAME * planned.abs() {
        return Ok(());
    }
    refuse(
        key,
        format!("is {given}, but {planned} follows from the inputs"),
    )
}

/// A digest in hex; empty if the file is of a version without it.
fn digest(key: String, text: &str, may_be_empty: bool) -> Check {
    let digits =
        text.len() == DIGITS && text.bytes().all(|c| matches!(c, b'0'..=b'9' | b'a'..=b'f'));
    if digits || may_be_empty && text.is_empty() {
        return Ok(());
    }
    refuse(
        key,
        format!("is not a digest; expected {DIGITS} hex digits"),
    )
}

fn check_bed(bed: &BedSummary, plans: &[BedPlan], inputs: &CheckedScenario, at: &str) -> Check {
    let Some(plan) = plans.iter().find(|plan| plan.name == bed.name) else {
        return refuse(format!("{at}.name"), "is not a bed that the inputs plan");
    };
    if bed.frozen > bed.grains {
        let problem = format!("is {}, of {} grains", bed.frozen, bed.grains);
        return refuse(format!("{at}.frozen"), problem);
    }
    digest(format!("{at}.digest"), &bed.digest, false)?;
    digest(format!("{at}.chain"), &bed.chain, true)?;
    match (&bed.rig, inputs.has_rig()) {
        (Some(rig), true) => check_rig(rig, plan, &format!("{at}.rig")),
        (None, false) => Ok(()),
        (Some(_), false) => refuse(
            format!("{at}.rig"),
            "is there, but no bed of these inputs flows",
        ),
        (None, true) => refuse(format!("{at}.rig"), "is missing, and the bed flows"),
    }
}

fn check_rig(rig: &Rig, plan: &BedPlan, at: &str) -> Check {
    if rig.seed != plan.seed {
        let problem = format!("is {}, but the inputs come to {}", rig.seed, plan.seed);
        return refuse(format!("{at}.seed"), problem);
    }
    same(format!("{at}.diameter"), rig.diameter, plan.diameter)
}

fn check_run(
    run: &DragSummary,
    bed: &BedSummary,
    (beds, runs): (&[BedPlan], &[DragPlan]),
    inputs: &CheckedScenario,
    at: &str,
) -> Check {
    let key = |name: &str| format!("{at}.{name}");
    let Some(plan) = runs.iter().find(|plan| plan.name == run.name) else {
        return refuse(key("name"), "is not a drag that the inputs plan");
    };
    let planned = &beds[plan.bed];
    if run.bed != planned.name {
        let problem = format!("is not `{}`, which the inputs plan", planned.name);
        return refuse(key("bed"), problem);
    }
    for (name, given, planned) in [
        ("speed", run.speed, plan.motion.speed),
        ("froude", run.froude, plan.froude),
        ("diameter", run.diameter, planned.diameter),
        ("depth", run.depth, bed.depth),
        ("distance", run.distance, plan.distance),
        ("window_start", run.window_start, plan.discard),
        ("window_end", run.window_end, plan.window_end),
    ] {
        let is_measured = plan.release.is_timed() && !["diameter", "depth"].contains(&name);
        if !is_measured {
            same(key(name), given, planned)?;
        }
    }
    if run.released.is_some() != plan.release.is_free() {
        let problem = "is there if forces move the intruder, and only then";
        return refuse(key("released"), problem);
    }
    if run.steps != plan.steps() {
        let problem = format!("is {}, but the inputs come to {}", run.steps, plan.steps());
        return refuse(key("steps"), problem);
    }
    if run.window_steps > run.steps {
        let problem = format!("is {}, of {} steps", run.window_steps, run.steps);
        return refuse(key("window_steps"), problem);
    }
    check_means(run, at)?;
    check_reaches(run, inputs, key("reaches"))?;
    let diameters = plan.distance / inputs.mean_diameter() + 1.0;
    if run.drag_by_travel.len() as f64 > diameters {
        let problem = format!(
            "holds {} numbers, more than the distance has diameters",
            run.drag_by_travel.len()
        );
        return refuse(key("drag_by_travel"), problem);
    }
    if run.drag_uncut_error.is_some_and(|error| error < 0.0) {
        return refuse(key("drag_uncut_error"), "is below zero, which no error is");
    }
    let share = run.large_overlaps.as_slice();
    check_shares(share, key("large_overlaps"))?;
    check_shares(&run.coordination_shares, key("coordination_shares"))?;
    digest(key("digest"), &run.digest, false)?;
    digest(key("chain"), &run.chain, true)?;
    let parts = run.digest_parts.iter().map(|(name, _)| &name[..]);
    if !parts.eq(PARTS) {
        let problem = format!("expected one each of {}", PARTS.join(", "));
        return refuse(key("digest_parts"), problem);
    }
    for (name, part) in &run.digest_parts {
        digest(key(&format!("digest_parts.{name}")), part, false)?;
    }
    check_tank(run.tank.as_ref(), plan, inputs, &key("tank"))?;
    match &run.flow {
        Some(_) if !inputs.flows() => {
            refuse(key("flow"), "is there, but no bed of these inputs flows")
        }
        Some(flow) => check_flow(flow, &key("flow")),
        None => Ok(()),
    }
}

fn check_means(run: &DragSummary, at: &str) -> Check {
    let means: [(&str, Option<&Mean>); 10] = [
        ("drag", Some(&run.drag)),
        ("lift", Some(&run.lift)),
        ("side", Some(&run.side)),
        ("contacts", Some(&run.contacts)),
        ("contact_angle", run.contact_angle.as_ref()),
        ("coordination", run.coordination.as_ref()),
        ("new_contact_angle", run.new_contact_angle.as_ref()),
        ("floating", run.floating.as_ref()),
        ("moving", run.moving.as_ref()),
        ("drift", run.drift.as_ref()),
    ];
    for (name, mean) in means {
        if mean.is_some_and(|mean| mean.standard_error < 0.0) {
            return refuse(
                format!("{at}.{name}.standard_error"),
                "is below zero, which no error is",
            );
        }
    }
    Ok(())
}

fn check_reaches(run: &DragSummary, inputs: &CheckedScenario, key: String) -> Check {
    let asked = &inputs.measure.reaches;
    let mut after = asked.iter();
    for one in &run.reaches {
        if !after.any(|reach| *reach == one.reach) {
            let problem = format!("expected those of measure.reaches, {asked:?}, in their order");
            return refuse(key, problem);
        }
        let errors = [
            Some(one.coordination.standard_error),
            Some(one.floating.standard_error),
            one.kappa_error,
        ];
        if errors.iter().flatten().any(|error| *error < 0.0) {
            return refuse(key, "has an error below zero, which no error is");
        }
    }
    Ok(())
}

fn check_shares(shares: &[f64], key: String) -> Check {
    if shares.len() > SHARES_MAX || !shares.iter().all(|share| (0.0..=1.0).contains(share)) {
        let problem = format!("expected at most {SHARES_MAX} numbers between 0 and 1");
        return refuse(key, problem);
    }
    Ok(())
}

/// Half turns beyond those of the distance, for the one that is cut by a step.
const MORE: f64 = 1.0;

fn check_tank(tank: Option<&Tank>, plan: &DragPlan, inputs: &CheckedScenario, at: &str) -> Check {
    let (tank, half) = match (tank, plan.half_turn) {
        (None, None) => return Ok(()),
        (None, Some(_)) => return refuse(at, "is missing, and the bed is in a tank"),
        (Some(_), None) => return refuse(at, "is there, but the inputs have no tank"),
        (Some(tank), Some(half)) => (tank, half),
    };
    let (speed, length) = (plan.motion.speed, inputs.intruder.length.unwrap_or(0.0));
    for (name, given, planned) in [
        ("diameter", tank.diameter, inputs.bed.size[0]),
        ("length", tank.length, length),
        (
            "turning_rate",
            tank.turning_rate,
            inputs.turning_rate(speed),
        ),
        ("turns", tank.turns, 0.5 * plan.distance / half),
        ("centrifugal", tank.centrifugal, inputs.centrifugal(speed)),
    ] {
        same(format!("{at}.{name}"), given, planned)?;
    }
    if tank.half_turns.len() as f64 > plan.distance / half + MORE {
        let problem = format!("holds {} of {} turns", tank.half_turns.len(), tank.turns);
        return refuse(format!("{at}.half_turns"), problem);
    }
    let means = tank
        .half_turns
        .iter()
        .flat_map(|half| [half.drag, half.lift]);
    let errors = means.map(|mean| mean.standard_error);
    let errors = errors.chain([tank.drag_coefficient_error, tank.lift_over_buoyancy_error]);
    match errors.into_iter().any(|error| error < 0.0) {
        true => refuse(at, "holds an error below zero, which no error is"),
        false => Ok(()),
    }
}

fn check_flow(flow: &Flow, at: &str) -> Check {
    let Some(load) = &flow.load else {
        return Ok(());
    };
    let Load {
        normal,
        normal_error,
        tangential,
        tangential_error,
        parts,
    } = load;
    for (name, given, expected) in [
        ("normal", normal.len(), POINTS),
        ("normal_error", normal_error.len(), POINTS),
        ("tangential", tangential.len(), POINTS),
        ("tangential_error", tangential_error.len(), POINTS),
        ("parts", parts.len(), load::PARTS),
    ] {
        if given != expected {
            let problem = format!("holds {given} entries; expected {expected}");
            return refuse(format!("{at}.load.{name}"), problem);
        }
    }
    for (name, errors) in [("normal", normal_error), ("tangential", tangential_error)] {
        if errors.iter().any(|error| *error < 0.0) {
            let problem = "has an entry below zero, which no error is";
            return refuse(format!("{at}.load.{name}_error"), problem);
        }
    }
    Ok(())
}
