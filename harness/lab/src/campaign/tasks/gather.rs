//! From the folders of tasks to the run directories of their members.

use std::path::Path;

use super::ended::{Found, look};
use super::names::name_of;
use crate::campaign::folder::{CampaignFolder, FAILURE};
use crate::campaign::plan::{Member, Plan};
use crate::folder::{DirectoryLock, Folder, RUN, hold};
use crate::manifest::{Departure, Ledger, Manifest};
use crate::progress::Progress;
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
        let beds = scenario.all_beds().into_iter().map(|bed| &bed.name);
        let drags = scenario.drags().iter().map(|drag| &drag.name);
        for stage in beds.chain(drags) {
            let place = folder.task(&member.name, stage);
            if disk::kind(&place) != Some(Kind::Folder) {
                continue;
            }
            let Some(_held) = hold(&place, &RUN) else {
                taken.push(name_of(&member.name, stage));
                continue;
            };
            if scenario.drags().iter().any(|drag| drag.name == *stage) {
                take_in(folder, member, &claim.ledger, stage, progress)?;
            }
        }
    }
    Ok(taken)
}

/// Takes one drag into its member, and removes the folder of its task if the member has it.
fn take_in(
    folder: CampaignFolder<'_>,
    member: &Member,
    ledger: &Ledger,
    drag: &str,
    progress: &Progress,
) -> Result<()> {
    let (from, to) = (folder.task(&member.name, drag), folder.member(&member.name));
    let own = format!("runs/{drag}/");
    let sound = ledger.damaged(&own).is_empty() && ledger.damaged("beds/").is_empty();
    let failures = [to.join(FAILURE), Folder(&to).of_run(drag, FAILURE)];
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
            for path in &failures {
                ledger.remove(path)?;
            }
        }
        copy(&from, &to, ledger, &manifest, &own)?;
        for stage in manifest.stages.iter().filter(|stage| stage.finished) {
            ledger.finish_stage(&stage.name, &stage.link)?;
        }
        ledger.save()?;
    }
    progress.add_pace(&from);
    remove_all(&from)
}

/// Writes what the manifest of a task has into the folder of its member.
fn copy(from: &Path, to: &Path, ledger: &Ledger, manifest: &Manifest, own: &str) -> Result<()> {
    for entry in &manifest.files {
        let wanted = ["beds/", own]
            .iter()
            .any(|begin| entry.path.starts_with(begin));
        if !wanted && entry.path != FAILURE {
            continue;
        }
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

/// Removes a folder with all that is in it; links are not followed.
fn remove_all(folder: &Path) -> Result<()> {
    for (name, kind) in disk::list(folder)? {
        let path = folder.join(name);
        match kind {
            Kind::Folder => remove_all(&path)?,
            _ => disk::remove(&path)?,
        }
    }
    if disk::kind(folder) == Some(Kind::Folder) {
        disk::remove_if_empty(folder)?;
    }
    Ok(())
}

/// Removes what is left of tasks of a campaign whose drags have all ended, but for what a worker is at.
///
/// # Errors
/// [`Error::Write`].
pub(in crate::campaign) fn clear(folder: CampaignFolder<'_>, progress: &Progress) -> Result<()> {
    let tasks = folder.tasks();
    for (member, kind) in disk::list(&tasks)? {
        let member = tasks.join(member);
        let stages = match kind {
            Kind::Folder => disk::list(&member)?,
            _ => continue,
        };
        for (stage, kind) in stages {
            let place = member.join(stage);
            if kind == Kind::Folder
                && let Some(_held) = hold(&place, &RUN)
            {
                progress.add_pace(&place);
                remove_all(&place)?;
            }
        }
        disk::remove_if_empty(&member)?;
    }
    if disk::is_there(&tasks) {
        disk::remove_if_empty(&tasks)?;
    }
    Ok(())
}
