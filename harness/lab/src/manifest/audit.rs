//! How a folder departs from its manifest, and that from what is planned.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::record::{Departure, FolderKind, Manifest, NAME, RESULTS};
use bitgrain_sim::disk::{self, Kind, is_partial};
use bitgrain_sim::error::Result;

/// When the folder of a run or a campaign has a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum When {
    /// Always.
    Always,
    /// Once this stage is finished; before that perhaps.
    Finished(String),
    /// Once everything is finished.
    Whole,
    /// Perhaps.
    Perhaps,
    /// Perhaps, as long as one of these stages is unfinished.
    Unfinished(Vec<String>),
    /// Perhaps, beside the results and never in the manifest: it can be rebuilt at any time, is a state that a stage
    /// goes on from, or holds facts of the machine.
    Beside,
}

/// What the folder of a run or a campaign is to hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Planned {
    /// What it belongs to.
    pub of: FolderKind,
    /// Names of its stages, in order.
    pub stages: Vec<String>,
    /// Its files, by their paths from the folder on, with `/`.
    pub files: BTreeMap<String, When>,
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FolderAudit {
    /// What does not hold, a line each.
    pub wrong: Vec<String>,
    /// Stages that are unfinished.
    pub unfinished: Vec<String>,
    /// Files that the manifest does not cover and that are not results.
    pub uncovered: Vec<String>,
    /// Files that it covers and that are as it says.
    pub sound: usize,
}

impl FolderAudit {
    /// Whether all is finished and as the manifest says.
    pub fn holds(&self) -> bool {
        self.wrong.is_empty() && self.unfinished.is_empty()
    }
}

/// Compares a folder with its manifest, and that with what is planned.
///
/// # Errors
/// If the folder or a file in it cannot be read.
pub fn audit(root: &Path, manifest: &Manifest, planned: &Planned) -> Result<FolderAudit> {
    let mut found = FolderAudit {
        wrong: unplanned(manifest, planned),
        ..FolderAudit::default()
    };
    let unfinished = |name: &&String| !manifest.has_finished(name);
    found.unfinished = planned.stages.iter().filter(unfinished).cloned().collect();
    if found.unfinished.is_empty() && !manifest.finished {
        found.unfinished.push("its summary".into());
    }
    for entry in &manifest.files {
        match entry.read(root) {
            Ok(_) => found.sound += 1,
            Err(Departure::Changed(how)) => found.wrong.push(format!("{} {how}", entry.path)),
            Err(Departure::Unreadable(e)) => return Err(e),
        }
    }
    let mut open = vec![String::new()];
    while let Some(below) = open.pop() {
        for (name, kind) in disk::list(&root.join(&below))? {
            let path = match below.is_empty() {
                true => name.clone(),
                false => format!("{below}/{name}"),
            };
            // A member is a run with its own manifest.
            let member = planned.of == FolderKind::Campaign && below == "members";
            if member && kind == Kind::Folder {
                if !planned.stages.contains(&name) {
                    found
                        .wrong
                        .push(format!("{path} is extra: no member has this name"));
                }
                continue;
            }
            // Another file may have the name as it is shown here.
            let named = kind != Kind::Unnamed;
            let covered = named && manifest.entry(&path).is_some();
            let beside = planned.files.get(&path) == Some(&When::Beside) || is_partial(&name);
            // A file among results is taken for one.
            let top = path.split('/').next().unwrap_or_default();
            match kind {
                Kind::Folder if !covered => open.push(path),
                _ if covered => {}
                _ if RESULTS.contains(&top) && !(named && beside) => {
                    let line = format!("{path} is extra: it is not among the files of {NAME}");
                    found.wrong.push(line);
                }
                _ => found.uncovered.push(path),
            }
        }
    }
    found.uncovered.retain(|path| path != NAME);
    found.uncovered.sort();
    found.wrong.sort();
    Ok(found)
}

/// What a manifest says that no run or campaign of the plan says, a line each.
fn unplanned(manifest: &Manifest, planned: &Planned) -> Vec<String> {
    let mut wrong = Vec::new();
    if manifest.of != planned.of {
        let [of, not] = [manifest.of, planned.of].map(FolderKind::word);
        wrong.push(format!("it is that of a {of}, not of a {not}"));
    }
    let listed: Vec<&String> = manifest.stages.iter().map(|stage| &stage.name).collect();
    let missing = planned.stages.iter().filter(|name| !listed.contains(name));
    wrong.extend(missing.map(|name| format!("{name} is missing in {NAME}")));
    let more = listed.iter().filter(|name| !planned.stages.contains(name));
    wrong.extend(more.map(|name| format!("{name} in {NAME} is not planned")));
    if wrong.is_empty() && !listed.into_iter().eq(&planned.stages) {
        wrong.push("its stages are not in the order in which they are run, each once".into());
    }
    let finished = manifest.stages.iter().filter(|stage| stage.finished);
    let finished: BTreeSet<&String> = finished.map(|stage| &stage.name).collect();
    for entry in &manifest.files {
        let path = &entry.path;
        match planned.files.get(path) {
            None | Some(When::Beside) => {
                wrong.push(format!(
                    "{path} in {NAME} is no file that its scenario gives"
                ));
            }
            Some(When::Unfinished(stages)) if stages.iter().all(|s| finished.contains(s)) => {
                let stages = stages.join(", ");
                wrong.push(format!(
                    "{path} in {NAME} is of a stage that has not ended well: {stages}"
                ));
            }
            Some(_) => {}
        }
    }
    for (path, when) in &planned.files {
        let due = match when {
            When::Always => true,
            When::Finished(stage) => finished.contains(stage),
            When::Whole => manifest.finished,
            When::Perhaps | When::Unfinished(_) | When::Beside => false,
        };
        if due && manifest.entry(path).is_none() {
            wrong.push(format!("{path} is missing in {NAME}"));
        }
    }
    wrong
}
