//! Which tasks are left.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::ended::{Found, failure, look};
use super::names::{below, name_of};
use crate::bed::library::BedCache;
use crate::bed::recipe::Recipe;
use crate::campaign::folder::CampaignFolder;
use crate::campaign::only::Only;
use crate::campaign::plan::{Member, Plan};
use crate::folder::refuse_library;
use crate::manifest::FolderKind;
use bitgrain_sim::error::Result;

/// What is left to do of a campaign, by names of its tasks, in an order in which nothing waits for what comes later.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Missing {
    /// Beds to pour, each once; those that lie below lids come first.
    pub beds: Vec<String>,
    /// Drags.
    pub drags: Vec<String>,
}

/// The tasks of a campaign that are not done, of the drags that are wanted. What failed counts as done unless it is to
/// be tried again. Files are compared with their manifests; nothing is written, and nothing is locked.
///
/// # Errors
/// [`bitgrain_sim::error::Error::Input`] if the folder holds another campaign.
pub fn missing(
    plan: &Plan,
    only: &Only,
    out: &Path,
    library: &BedCache,
    retry: bool,
) -> Result<Missing> {
    let folder = CampaignFolder(out);
    refuse_library(library.folder(), out, FolderKind::Campaign)?;
    folder.refuse_others(plan)?;
    // Where each bed is poured for all members that have it.
    let mut owners: BTreeMap<String, (&str, &str)> = BTreeMap::new();
    for member in &plan.members {
        for bed in member.scenario.all_beds() {
            let digest = Recipe::new(&member.scenario, bed).digest();
            owners.entry(digest).or_insert((&member.name, &bed.name));
        }
    }
    let mut missing = Missing::default();
    let (mut seen, mut covered) = (BTreeSet::new(), Vec::new());
    for member in &plan.members {
        let scenario = &member.scenario;
        for drag in scenario.drags() {
            let wanted = only.wants(&member.name, &drag.name);
            if !wanted || has_ended(folder, member, &drag.name, retry) {
                continue;
            }
            missing.drags.push(name_of(&member.name, &drag.name));
            if scenario.source.is_some() {
                continue;
            }
            let bed = &scenario.beds()[drag.bed];
            let bare = below(scenario, bed).map(|bare| (bare, true));
            for (bed, first) in bare.into_iter().chain([(bed, bed.lid.is_none())]) {
                let recipe = Recipe::new(scenario, bed);
                let digest = recipe.digest();
                let (owner, stage) = owners[&digest];
                let failed = !retry && failure(&folder.task(owner, stage), None).is_some();
                if !seen.insert(digest) || failed || library.has(&recipe) {
                    continue;
                }
                let list = if first {
                    &mut missing.beds
                } else {
                    &mut covered
                };
                list.push(name_of(owner, stage));
            }
        }
    }
    missing.beds.append(&mut covered);
    Ok(missing)
}

/// Whether a drag has come to an end, in its member or in the folder of its task.
fn has_ended(folder: CampaignFolder<'_>, member: &Member, drag: &str, retry: bool) -> bool {
    let places = [folder.member(&member.name), folder.task(&member.name, drag)];
    let mut found = places
        .iter()
        .map(|place| look(place, &member.scenario, drag));
    found.any(|found| match found {
        Found::Done(..) => true,
        Found::Failed(..) => !retry,
        Found::Nothing | Found::Unsound(_) => false,
    })
}
