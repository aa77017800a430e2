//! How a folder departs from its manifest.

use std::path::Path;

use crate::pace;

use super::record::{Departure, FolderKind, Manifest, NAME, RESULTS};
use bitgrain_sim::disk::{self, Kind, is_partial};
use bitgrain_sim::error::Result;

/// Files beside the results: they can be rebuilt at any time, or hold facts of the machine.
const BESIDE: [&str; 4] = [NAME, pace::NAME, "report.html", "analysis.json"];

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

/// Compares a folder with its manifest, and that with the stages that are planned.
///
/// # Errors
/// If the folder or a file in it cannot be read.
pub fn audit(root: &Path, manifest: &Manifest, planned: &[String]) -> Result<FolderAudit> {
    let mut found = FolderAudit::default();
    for name in planned {
        let stage = manifest.stages.iter().find(|stage| stage.name == *name);
        match stage {
            Some(stage) if stage.finished => {}
            Some(_) => found.unfinished.push(name.clone()),
            None => found.wrong.push(format!("{name} is missing in {NAME}")),
        }
    }
    for stage in &manifest.stages {
        if !planned.contains(&stage.name) {
            let line = format!("{} in {NAME} is not planned", stage.name);
            found.wrong.push(line);
        }
    }
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
            let member = manifest.of == FolderKind::Campaign && below == "members";
            if member && kind == Kind::Folder {
                if !planned.contains(&name) {
                    found
                        .wrong
                        .push(format!("{path} is extra: no member has this name"));
                }
                continue;
            }
            let covered = manifest.entry(&path).is_some();
            match kind {
                Kind::Folder if !covered => open.push(path),
                _ if covered => {}
                _ if below.is_empty() && BESIDE.contains(&&name[..]) => found.uncovered.push(path),
                _ if is_working(&path) || is_partial(&name) => found.uncovered.push(path),
                // A file among results is taken for one.
                _ if path
                    .split('/')
                    .next()
                    .is_some_and(|top| RESULTS.contains(&top)) =>
                {
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

/// States that stages go on from.
fn is_working(path: &str) -> bool {
    ["/latest.safetensors", ".pouring.safetensors"]
        .iter()
        .any(|end| path.ends_with(end))
}
