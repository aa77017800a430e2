//! From the folders of tasks to the run directories of their members.

use std::path::{Path, PathBuf};

use super::ended::{Found, look};
use super::names::name_of;
use crate::beside::refuse_foreign;
use crate::campaign::folder::CampaignFolder;
use crate::campaign::plan::{Member, Plan};
use crate::folder::{DirectoryLock, FAILURE, Folder, Held, RUN, hold};
use crate::manifest::{self, Departure, Ledger, Manifest};
use crate::progress::Progress;
use crate::run::{names, stages};
use bitgrain_sim::below::Below;
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk::{self, Kind};
use bitgrain_sim::error::{Error, Result};

/// Takes the drags that have ended in folders of tasks into their members, whose folders this process owns, and returns
/// the tasks that workers are at. What does not hold is reported and left; so is what is not finished.
///
/// # Errors
/// [`Error::Write`]; [`Error::Unverified`] if a member already holds other bytes than a task.
pub(in crate::campaign) fn gather(
    folder: CampaignFolder<'_>,
    plan: &Plan,
    claims: &[DirectoryLock],
    progress: &Progress,
) -> Result<Vec<String>> {
    let mut taken = Vec::new();
    for (member, claim) in plan.members.iter().zip(claims) {
        let scenario = &member.scenario;
        for stage in stages(scenario) {
            let place = folder.task(&member.name, &stage);
            if disk::kind(&place) != Some(Kind::Folder) {
                continue;
            }
            let Some(held) = hold(&place, &RUN) else {
                taken.push(name_of(&member.name, &stage));
                continue;
            };
            if scenario.drags().iter().any(|drag| drag.name == stage) {
                take_in(folder, (member, &stage), &claim.ledger, &held, progress)?;
            }
        }
    }
    Ok(taken)
}

/// Takes one drag into its member, and removes the folder of its task if the member has it.
fn take_in(
    folder: CampaignFolder<'_>,
    (member, drag): (&Member, &str),
    ledger: &Ledger,
    held: &Held,
    progress: &Progress,
) -> Result<()> {
    let (from, to) = (folder.task(&member.name, drag), folder.member(&member.name));
    let own = format!("runs/{drag}/");
    let sound = ledger.damaged(&own).is_empty() && ledger.damaged("beds/").is_empty();
    if !(ledger.is_finished(drag) && sound) {
        let (manifest, done) = match look(&from, &member.scenario, drag) {
            Found::Nothing => return Ok(()),
            Found::Unsound(problem) => {
                progress.warn(&format!(
                    "{problem}: {}/{drag} counts as missing",
                    member.name
                ));
                return Ok(());
            }
            Found::Done(manifest) => (manifest, true),
            Found::Failed(manifest, _) => (manifest, false),
        };
        if done {
            let to = Folder(&to);
            for of_a_failure in [to.of_run(drag, FAILURE), to.partial_series(drag)] {
                ledger.remove(&of_a_failure)?;
            }
        }
        let planned = names(&member.scenario);
        let wanted = |name: &str| {
            let own = ["beds/", &own].iter().any(|begin| name.starts_with(begin));
            name == FAILURE || own && planned.contains_key(name)
        };
        copy(&from, &to, ledger, &manifest, wanted)?;
        for stage in manifest.stages.iter().filter(|stage| stage.finished) {
            ledger.finish_stage(&stage.name, &stage.link)?;
        }
        ledger.save()?;
    }
    progress.add_pace(&from);
    discard(folder, (member, drag), held, progress)
}

/// Writes what is wanted of what the manifest of a task has into the folder of its member.
fn copy(
    from: &Path,
    to: &Path,
    ledger: &Ledger,
    manifest: &Manifest,
    wanted: impl Fn(&str) -> bool,
) -> Result<()> {
    for entry in manifest.files.iter().filter(|entry| wanted(&entry.path)) {
        let bytes = entry.read(from).map_err(|departure| match departure {
            Departure::Changed(how) => {
                let place = from.join(&entry.path).display().to_string();
                Error::input(place, format!("{how}; give the same command again"))
            }
            Departure::Unreadable(error) => error,
        })?;
        ledger.write(&to.join(&entry.path), &bytes)?;
    }
    Ok(())
}

/// Removes the folder of a task: what its manifest lists and bears the mark of a result or is as it was written, states
/// to go on from, its manifest, and folders that are empty then. Anything else stays, and is told.
fn discard(
    folder: CampaignFolder<'_>,
    (member, stage): (&Member, &str),
    held: &Held,
    progress: &Progress,
) -> Result<()> {
    let place = folder.task(&member.name, stage);
    if let Some(path) = other_file(folder, (member, stage)) {
        let told = "is not the file that its member has already: the folder of the task stays";
        progress.warn(&format!("{} {told}", path.display()));
        return Ok(());
    }
    let below = Below(folder.0);
    let (own, scenario) = (Folder(&place), &member.scenario);
    let text = own.scenario_text(scenario);
    let is_own = |manifest: &Manifest| {
        let marker = manifest.entry(RUN.of.marker());
        marker.is_some_and(|entry| entry.is_of(text.as_bytes()))
    };
    if let Some(manifest) = Manifest::of(&place).ok().flatten().filter(is_own) {
        let listed = manifest.files.iter().filter(|entry| entry.is_ours(&place));
        let listed = listed.map(|entry| place.join(&entry.path));
        let states = own
            .states(scenario)
            .into_iter()
            .filter(|path| is_state(path));
        let pace = Some(own.performance()).filter(|path| refuse_foreign(path).is_ok());
        // The manifest goes last: a process that is killed here leaves a folder that the next one knows.
        let last = [place.join(manifest::NAME)];
        for path in listed.chain(states).chain(pace).chain(last) {
            if below.check_file(&path).is_ok() {
                below.remove(&path)?;
            }
        }
    }
    let mut folders = own.own_folders(scenario);
    folders.push(place.join("runs"));
    folders.sort();
    for own in folders.iter().rev() {
        below.clear_partials(own, |_| held.is_sure());
        if disk::kind(own) == Some(Kind::Folder) {
            below.remove_if_empty(own)?;
        }
    }
    if disk::is_there(&place) {
        let place = place.display();
        progress.warn(&format!("{place} holds other files and stays"));
    }
    Ok(())
}

/// A file of a drag that a task and its member have, by their manifests, with other bytes each.
fn other_file(folder: CampaignFolder<'_>, (member, drag): (&Member, &str)) -> Option<PathBuf> {
    let (task, member) = (folder.task(&member.name, drag), folder.member(&member.name));
    let [own, taken] = [&task, &member].map(|place| Manifest::of(place).ok().flatten());
    let (own, taken) = (own?, taken?);
    let begin = format!("runs/{drag}/");
    let mut files = own
        .files
        .iter()
        .filter(|entry| entry.path.starts_with(&begin));
    let other = files.find(|entry| taken.entry(&entry.path).is_some_and(|one| one != *entry))?;
    // Of a drag that ended in both.
    (own.has_finished(drag) && taken.has_finished(drag)).then(|| task.join(&other.path))
}

/// Whether a file is a state to go on from.
fn is_state(path: &Path) -> bool {
    disk::kind(path) == Some(Kind::File)
        && disk::read(path).is_ok_and(|bytes| checkpoint::begins(&bytes))
}

/// Removes what is left of tasks of a campaign whose drags have all ended, but for what a worker is at.
///
/// # Errors
/// [`Error::Write`].
pub(in crate::campaign) fn clear(
    folder: CampaignFolder<'_>,
    plan: &Plan,
    progress: &Progress,
) -> Result<()> {
    for member in &plan.members {
        for stage in stages(&member.scenario) {
            let place = folder.task(&member.name, &stage);
            if disk::kind(&place) == Some(Kind::Folder)
                && let Some(held) = hold(&place, &RUN)
            {
                progress.add_pace(&place);
                discard(folder, (member, &stage), &held, progress)?;
            }
        }
        remove_empty(folder, &folder.tasks().join(&member.name))?;
    }
    remove_empty(folder, &folder.tasks())
}

fn remove_empty(folder: CampaignFolder<'_>, place: &Path) -> Result<()> {
    match disk::kind(place) {
        Some(Kind::Folder) => Below(folder.0).remove_if_empty(place).map(drop),
        _ => Ok(()),
    }
}
