//! The beds of a run: from the library, made and kept there, or imported.

use std::path::Path;

use super::{StagePerformance, timed};
use crate::bed::library::Library;
use crate::bed::recipe::Recipe;
use crate::error::{Error, Result};
use crate::files::{bits, write_text, write_whole};
use crate::folder::Folder;
use crate::progress::{Progress, Stage};
use crate::scenario::{BedPlan, Scenario};
use crate::summary::BedSummary;
use crate::{bed, checkpoint, export, lammps, report};

use super::summarise::rig;

/// The beds to pour, each once: those without a lid, and what lies below the lids of the others. A
/// bed that only lies below lids is named after them.
pub fn bare_beds(scenario: &Scenario) -> Vec<BedPlan> {
    let mut bare: Vec<BedPlan> = Vec::new();
    let plans = scenario.beds();
    let (plain, covered): (Vec<&BedPlan>, Vec<&BedPlan>) =
        plans.iter().partition(|plan| plan.lid.is_none());
    bare.extend(plain.into_iter().cloned());
    for plan in covered {
        let below = bare_of(plan);
        let same = |other: &BedPlan| {
            let named = BedPlan {
                name: below.name.clone(),
                ..other.clone()
            };
            named == below
        };
        if !bare.iter().any(same) {
            bare.push(below);
        }
    }
    bare
}

/// The bed below the lid of another.
fn bare_of(plan: &BedPlan) -> BedPlan {
    BedPlan {
        name: format!("{}-bare", plan.name),
        lid: None,
        ..plan.clone()
    }
}

/// Where the bed below a lid is in the run directory.
fn below(scenario: &Scenario, plan: &BedPlan) -> BedPlan {
    let wanted = Recipe::new(scenario, &bare_of(plan));
    let mut bare = bare_beds(scenario).into_iter();
    let found = bare.find(|other| Recipe::new(scenario, other) == wanted);
    found.expect("every lid lies on one of the bare beds")
}

/// Pours a bed that lies below others' lids, unless it is at hand.
pub(super) fn pour_bare(
    scenario: &Scenario,
    plan: &BedPlan,
    folder: &Folder<'_>,
    library: &Library,
    progress: &Progress,
) -> Result<StagePerformance> {
    let mut stage = progress.stage(
        &format!("bed {}", plan.name),
        bed::pouring_steps(scenario, plan),
    );
    let path = folder.bed(&plan.name);
    let from = fetch_bed(scenario, plan, folder, library, &mut stage)?;
    let sim = checkpoint::read(&path)?;
    let steps = if from == "poured" {
        sim.step_count()
    } else {
        0
    };
    let performance = timed(stage, from, &sim, steps);
    progress.line(&format!(
        "{}: {} grains {from} ({:.1} s)",
        plan.name,
        sim.count(),
        performance.seconds
    ));
    Ok(performance)
}

/// A settled bed in the run directory: from the library, poured and kept there, or imported.
pub(super) fn settle_one(
    scenario: &Scenario,
    plan: &BedPlan,
    folder: &Folder<'_>,
    library: &Library,
    progress: &Progress,
) -> Result<(BedSummary, StagePerformance)> {
    let name = format!("bed {}", plan.name);
    let steps = match plan.lid {
        Some(_) => bed::covering_steps(scenario, plan),
        None => bed::pouring_steps(scenario, plan),
    };
    let mut stage = progress.stage(&name, steps);
    let path = folder.bed(&plan.name);
    let from = fetch_bed(scenario, plan, folder, library, &mut stage)?;
    let mut sim = checkpoint::read(&path)?;
    let covered_from = match (from, &plan.lid) {
        ("covered", Some(_)) => {
            checkpoint::read(&folder.bed(&below(scenario, plan).name))?.step_count()
        }
        _ => 0,
    };
    let title = format!(
        "{} of {}: atom_style sphere; {}",
        plan.name,
        scenario.name,
        bits()
    );
    let data = lammps::data_text(&export::atoms(&sim, true), &title);
    write_text(&folder.bed_data(&plan.name), &data, scenario.measure.gzip)?;
    let steps = match from {
        "poured" => sim.step_count(),
        "covered" => sim.step_count() - covered_from,
        _ => 0,
    };
    let performance = timed(stage, from, &sim, steps);
    let mut summary = bed::survey(&plan.name, &scenario.measures(), &mut sim);
    summary.rig = scenario
        .flows()
        .then(|| rig(scenario, plan, &summary, &sim));
    progress.line(&format!(
        "{}: {} grains {from} ({} steps, {:.1} s); surface at {}, depth {}, packing fraction {:.3}, \
         coordination number {:.2}, weight carried {:.4}",
        plan.name,
        summary.grains,
        summary.steps,
        performance.seconds,
        report::short(summary.surface),
        report::short(summary.depth),
        summary.packing_fraction,
        summary.coordination_number,
        summary.support / summary.weight,
    ));
    if let Some(rig) = &summary.rig {
        progress.line(&format!(
            "{}: effective depth {} ({:.1} D), lid of density {}, upward force on the intruder {:.1} \
             buoyancies",
            plan.name,
            report::short(rig.effective_depth),
            rig.effective_depth / rig.diameter,
            report::short(rig.lid_density),
            rig.reaction_over_buoyancy
        ));
    }
    Ok((summary, performance))
}

/// Puts the checkpoint of a settled bed where the run wants it, and says where it came from.
fn fetch_bed(
    scenario: &Scenario,
    plan: &BedPlan,
    folder: &Folder<'_>,
    library: &Library,
    stage: &mut Stage,
) -> Result<&'static str> {
    let path: &Path = &folder.bed(&plan.name);
    if let Some(source) = &scenario.source {
        let mut sim = bed::import::bed(scenario, source)?;
        write_whole(path, &checkpoint::bytes(&mut sim, ""))?;
        return Ok("imported");
    }
    let recipe = Recipe::new(scenario, plan);
    if let Some(bytes) = library.find(&recipe)? {
        write_whole(path, &bytes)?;
        return Ok("reused");
    }
    // An earlier run may have poured it and then found no room in the library.
    let digest = recipe.digest();
    let here = std::fs::read(path).ok();
    if let Some(bytes) = here {
        match checkpoint::parse(&bytes, "", Some(&digest)) {
            Ok(_) => {
                library.keep(&recipe, &bytes)?;
                return Ok("reused");
            }
            Err(broken @ Error::Contract { .. }) => return Err(broken),
            // Another recipe's, or damaged: it is made anew.
            Err(_) => {}
        }
    }
    let (mut sim, how) = match plan.lid {
        None => (bed::pour(scenario, plan, stage)?, "poured"),
        Some(_) => {
            let mut bare = checkpoint::read(&folder.bed(&below(scenario, plan).name))?;
            (bed::cover(&mut bare, scenario, plan, stage)?, "covered")
        }
    };
    let bytes = checkpoint::bytes(&mut sim, &digest);
    // First where it is used: what was poured for days is not lost for want of a library.
    write_whole(path, &bytes)?;
    library.keep(&recipe, &bytes)?;
    Ok(how)
}
