//! What a call found of a campaign, executed again.

use super::folder::CampaignFolder;
use super::only::Only;
use super::plan::Plan;
use crate::bed::recipe::Recipe;
use crate::confirm;
use crate::folder::Folder;
use crate::manifest::Manifest;
use crate::progress::Progress;
use crate::rerun::RunArchive;
use crate::run::{Links, Taken};
use crate::scenario::{BedPlan, CheckedScenario};
use crate::verify::Job;
use bitgrain_sim::disk;
use bitgrain_sim::error::Result;

/// A member, by its place in the plan, and what a call did for its stages.
type Part = (usize, Vec<Taken>);

/// What the call that did `taken` for the members did for the runs that are wanted and done, and for their beds. A bed
/// that it executed for one member and took from the library for another one is executed.
///
/// # Errors
/// If a manifest or a bed cannot be read.
pub fn wanted(
    folder: &CampaignFolder<'_>,
    plan: &Plan,
    only: &Only,
    taken: &[Vec<Taken>],
) -> Result<Vec<Part>> {
    let (mut parts, mut poured) = (Vec::new(), Vec::new());
    for (k, (member, taken)) in plan.members.iter().zip(taken).enumerate() {
        let place = folder.member(&member.name);
        let manifest = Manifest::of(&place)?;
        let done = |run: &str| {
            let finished = manifest.as_ref().is_some_and(|own| own.has_finished(run));
            finished && only.wants(&member.name, run)
        };
        let scenario = &member.scenario;
        if !scenario.drags().iter().any(|run| done(&run.name)) {
            continue;
        }
        let mut own: Vec<Taken> = Vec::new();
        for bed in scenario.all_beds() {
            let mut one = Taken::of(taken, &bed.name);
            if let Some(which) = which_bed(scenario, &Folder(&place), bed)? {
                match poured.iter().find(|(other, _)| *other == which) {
                    Some((_, how)) => one.how = String::clone(how),
                    None if one.is_whole() => poured.push((which, one.how.clone())),
                    None => {}
                }
            }
            own.push(one);
        }
        let runs = scenario.drags().iter().filter(|run| done(&run.name));
        own.extend(runs.map(|run| Taken::of(taken, &run.name)));
        parts.push((k, own));
    }
    Ok(parts)
}

/// What distinguishes a settled bed from those of other members: its recipe, and its bytes. An imported bed has no
/// recipe that tells its file: it is executed for each member.
///
/// # Errors
/// [`bitgrain_sim::error::Error::Input`] if the bed cannot be read.
pub(super) fn which_bed(
    scenario: &CheckedScenario,
    folder: &Folder<'_>,
    bed: &BedPlan,
) -> Result<Option<String>> {
    if scenario.source.is_some() {
        return Ok(None);
    }
    let bytes = disk::read(&folder.bed(&bed.name))?;
    let recipe = Recipe::new(scenario, bed).digest();
    Ok(Some(format!("{recipe} {}", blake3::hash(&bytes))))
}

/// The links of these stages.
///
/// # Errors
/// If a chain cannot be read.
pub fn links(folder: &CampaignFolder<'_>, plan: &Plan, parts: &[Part]) -> Result<Links> {
    let mut links = Links::default();
    for (member, taken) in parts {
        links += confirm::links(&folder.member(&plan.members[*member].name), taken)?;
    }
    Ok(links)
}

/// Executes again what of these stages the call found, a bed that members share once. Nothing is written.
///
/// # Errors
/// [`bitgrain_sim::error::Error::Unverified`] if a piece does not hold, after all was reported.
pub fn execute(
    folder: &CampaignFolder<'_>,
    plan: &Plan,
    parts: &[Part],
    threads: usize,
    progress: &Progress,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let names = parts.iter().map(|(k, _)| &plan.members[*k].name);
    let places: Vec<_> = names.clone().map(|name| folder.member(name)).collect();
    let labels: Vec<String> = names.map(|name| format!("{name}: ")).collect();
    let folders: Vec<Folder<'_>> = places.iter().map(|place| Folder(place)).collect();
    let archives: Vec<RunArchive<'_>> = folders
        .iter()
        .map(RunArchive::open)
        .collect::<Result<_>>()?;
    let manifests = places.iter().map(|place| Manifest::of(place));
    let manifests: Vec<Option<Manifest>> = manifests.collect::<Result<_>>()?;
    let mut jobs: Vec<Job<'_>> = Vec::new();
    let mut beds = Vec::new();
    let members = archives.iter().zip(&manifests).zip(parts).zip(&labels);
    for (((archive, manifest), (_, taken)), label) in members {
        for job in confirm::found(archive, manifest.as_ref(), taken, label)? {
            if let Some(bed) = job.bed()
                && let Some(which) = which_bed(&archive.scenario, archive.folder, bed)?
            {
                if beds.contains(&which) {
                    continue;
                }
                beds.push(which);
            }
            jobs.push(job);
        }
    }
    confirm::execute_pieces(folder.0, &jobs, threads, progress, &mut say)
}
