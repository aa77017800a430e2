//! What the manifest of a folder says of it, and the verdict on a folder.

use std::path::Path;

use crate::error::{Error, Result};
use crate::manifest::audit::audit;
use crate::manifest::{Manifest, NAME};

/// The verdict on a folder.
pub(crate) fn conclude(root: &Path, problems: Vec<String>) -> Result<()> {
    if problems.is_empty() {
        return Ok(());
    }
    let problem = format!("{}: {}", root.display(), problems.join("; "));
    Err(Error::Unverified { problem })
}

/// Compares a folder with its manifest, tells what was found, and returns what does not hold.
///
/// # Errors
/// Where a folder cannot be read, and what `say` returns.
pub(crate) fn check_manifest(
    root: &Path,
    planned: &[String],
    expect: &[String],
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<Vec<String>> {
    let manifest = match Manifest::of(root) {
        Ok(Some(manifest)) => manifest,
        Ok(None) => {
            say(&format!(
                "{NAME}: missing: nothing says what belongs to the folder"
            ))?;
            return Ok(vec![format!("it has no {NAME}")]);
        }
        Err(damage @ Error::Manifest { .. }) => {
            say(&damage.to_string())?;
            return Ok(vec![format!("its {NAME} is damaged")]);
        }
        Err(other) => return Err(other),
    };
    let found = audit(root, &manifest, planned)?;
    let mut problems = Vec::new();
    for line in &found.wrong {
        say(&format!("{NAME}: {line}"))?;
    }
    match found.wrong.len() {
        0 => {}
        n => problems.push(format!("its folder departs from {NAME} in {n} places")),
    }
    if !found.unfinished.is_empty() {
        let names = found.unfinished.join(", ");
        say(&format!("unfinished: {names}"))?;
        problems.push("it is not finished".into());
    }
    if !found.uncovered.is_empty() {
        let names = found.uncovered.join(", ");
        say(&format!("not covered by {NAME}: {names}"))?;
    }
    let (count, closing) = (found.sound, &manifest.closing);
    say(&format!(
        "{NAME}: {count} files are as they were written; closing hash {closing}"
    ))?;
    for link in expect {
        if !manifest.has_link(link) {
            problems.push(format!(
                "{link} is neither its closing hash nor the last link of a stage"
            ));
        }
    }
    Ok(problems)
}
