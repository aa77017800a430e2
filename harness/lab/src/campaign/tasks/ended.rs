//! How a drag ended in a run directory, as far as the manifest there vouches for it.

use std::path::Path;

use crate::campaign::folder::Failure;
use crate::folder::{FAILURE, Folder};
use crate::manifest::{Departure, FolderKind, Manifest, NAME};
use crate::scenario::CheckedScenario;
use crate::summary::parse_record;
use bitgrain_sim::disk;
use bitgrain_sim::files::text_of;

/// What was found of a drag.
pub(super) enum Found {
    /// It has not ended.
    Nothing,
    /// It has ended, and not everything of it is as it was written: in words.
    Unsound(String),
    /// It has ended well.
    Done(Manifest),
    /// It failed, or its bed did, for this reason.
    Failed(Manifest, String),
}

/// Looks for a drag in a run directory, and reads every file of it and of its bed that the manifest has.
pub(super) fn look(place: &Path, scenario: &CheckedScenario, drag: &str) -> Found {
    let manifest = match Manifest::of(place) {
        Ok(Some(manifest)) if manifest.of == FolderKind::Run => manifest,
        Ok(None) if disk::is_there(&Folder(place).of_run(drag, "summary.json")) => {
            return Found::Unsound(format!("{} has no {NAME}", place.display()));
        }
        Ok(_) => return Found::Nothing,
        Err(damage) => return Found::Unsound(damage.to_string()),
    };
    // What has come to a good end did not fail.
    let finished = manifest.has_finished(drag);
    let failed = (!finished).then(|| failure(place, Some(drag))).flatten();
    if failed.is_none() && !finished {
        return Found::Nothing;
    }
    let problem = damage(place, &manifest, drag);
    match (problem, failed) {
        (Some(problem), _) => Found::Unsound(problem),
        (None, Some(reason)) => Found::Failed(manifest, reason),
        (None, None) => match wrong(place, &manifest, scenario, drag) {
            Some(problem) => Found::Unsound(problem),
            None => Found::Done(manifest),
        },
    }
}

/// Why the beds in a run directory failed, or a drag, if the manifest vouches for that.
pub(super) fn failure(place: &Path, drag: Option<&str>) -> Option<String> {
    let manifest = Manifest::of(place).ok().flatten()?;
    let of_drag = drag.map(|drag| format!("runs/{drag}/{FAILURE}"));
    let mut names = [Some(FAILURE.to_string()), of_drag].into_iter().flatten();
    names.find_map(|name| {
        let bytes = manifest.entry(&name)?.read(place).ok()?;
        let failure: Failure = serde_json::from_slice(&bytes).ok()?;
        Some(failure.reason)
    })
}

/// The first file of a drag or its bed that is not as it was written.
fn damage(place: &Path, manifest: &Manifest, drag: &str) -> Option<String> {
    let own = format!("runs/{drag}/");
    let of_it = |path: &str| path.starts_with(&own) || path.starts_with("beds/");
    let mut files = manifest.files.iter().filter(|entry| of_it(&entry.path));
    files.find_map(|entry| match entry.read(place) {
        Ok(_) => None,
        Err(Departure::Changed(how)) => {
            Some(format!("{} {how}", place.join(&entry.path).display()))
        }
        Err(Departure::Unreadable(error)) => Some(error.to_string()),
    })
}

/// What is wrong with the summary of a drag that is finished.
fn wrong(
    place: &Path,
    manifest: &Manifest,
    scenario: &CheckedScenario,
    drag: &str,
) -> Option<String> {
    let folder = Folder(place);
    let path = folder.of_run(drag, "summary.json");
    let Some(entry) = manifest.entry(&format!("runs/{drag}/summary.json")) else {
        return Some(format!("{} is not in {NAME}", path.display()));
    };
    let text = match entry.read(place) {
        Ok(bytes) => text_of(bytes, &path.display().to_string()),
        Err(_) => return Some(format!("{} was changed", path.display())),
    };
    let record = match text.and_then(|text| parse_record(&text, &path)) {
        Ok(record) => record,
        Err(error) => return Some(error.to_string()),
    };
    let stage = manifest.stages.iter().find(|stage| stage.name == drag);
    let of_it = record.inputs == folder.inputs(scenario)
        && record.run.name == drag
        && !record.run.plug.is_unknown()
        && stage.is_some_and(|stage| stage.link == record.run.chain);
    (!of_it).then(|| format!("{} is of another drag", path.display()))
}
