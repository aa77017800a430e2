//! What the manifest of a folder says of it, and the verdict on a folder.

use std::path::Path;

use crate::folder::FAILURE;
use crate::manifest::audit::audit;
use crate::manifest::{FolderKind, Manifest, NAME, Planned, When};
use bitgrain_sim::error::{CHANGED, Error, Result, UNEXPECTED};

/// Why a folder is not verified; the last that was found says what to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Cause {
    /// It is unfinished.
    Unfinished(FolderKind),
    /// What was expected was not executed.
    Unconfirmed,
    /// It is not the one that was expected.
    Unexpected,
    /// What lies in it is not what its scenario gives, or nothing says what belongs to it.
    Changed,
}

impl Cause {
    fn hint(self) -> &'static str {
        match self {
            Cause::Unfinished(FolderKind::Run) => "`bitgrain run --resume FOLDER` finishes it",
            Cause::Unfinished(FolderKind::Campaign) => {
                "`bitgrain sweep CAMPAIGN --out FOLDER` finishes it, and tries again with --retry what failed"
            }
            Cause::Unconfirmed => {
                "a closing hash takes a whole `verify`; the last link of a stage that, or `--segment STAGE` with \
                 this stage"
            }
            Cause::Unexpected => UNEXPECTED,
            Cause::Changed => CHANGED,
        }
    }
}

/// What does not hold in a folder, each with its cause.
#[derive(Debug, Default)]
pub(crate) struct Problems(Vec<(Cause, String)>);

impl Problems {
    pub(crate) fn add(&mut self, cause: Cause, problem: impl Into<String>) {
        self.0.push((cause, problem.into()));
    }

    /// Adds and reports a change, if there is one.
    pub(crate) fn tell(
        &mut self,
        changed: Option<String>,
        say: &mut impl FnMut(&str) -> Result<()>,
    ) -> Result<()> {
        let Some(problem) = changed else {
            return Ok(());
        };
        say(&problem)?;
        self.add(Cause::Changed, problem);
        Ok(())
    }

    /// Adds and reports where a folder is not as its manifest says.
    pub(crate) fn tell_audit(
        &mut self,
        wrong: &[String],
        say: &mut impl FnMut(&str) -> Result<()>,
    ) -> Result<()> {
        for line in wrong {
            say(&format!("{NAME}: {line}"))?;
        }
        match wrong.len() {
            0 => {}
            n => self.add(
                Cause::Changed,
                format!("its folder differs from {NAME} in {n} places"),
            ),
        }
        Ok(())
    }

    /// Takes those of a part, each with the part's name before it.
    pub(crate) fn take(&mut self, label: &str, part: Problems) {
        let named = |(cause, problem)| (cause, format!("{label}{problem}"));
        self.0.extend(part.0.into_iter().map(named));
    }

    /// The verdict on the folder.
    pub(crate) fn conclude(self, root: &Path) -> Result<()> {
        let Some(worst) = self.0.iter().map(|(cause, _)| *cause).max() else {
            return Ok(());
        };
        let words: Vec<String> = self.0.into_iter().map(|(_, problem)| problem).collect();
        Err(Error::Unverified {
            problem: format!("{}: {}", root.display(), words.join("; ")),
            hint: worst.hint(),
        })
    }
}

/// Compares a folder with its manifest, reports what was found, and returns the manifest, if it is sound, and what
/// does not hold.
///
/// # Errors
/// If a folder cannot be read, and what `say` returns.
pub(crate) fn check_manifest(
    root: &Path,
    planned: &Planned,
    expect: &[String],
    say: &mut impl FnMut(&str) -> Result<()>,
) -> Result<(Option<Manifest>, Problems)> {
    let mut problems = Problems::default();
    let manifest = match Manifest::of(root) {
        Ok(Some(manifest)) => manifest,
        Ok(None) => {
            say(&format!(
                "{NAME}: missing: nothing says what belongs to the folder"
            ))?;
            problems.add(Cause::Changed, format!("it has no {NAME}"));
            return Ok((None, problems));
        }
        Err(damage @ Error::Manifest { .. }) => {
            say(&damage.to_string())?;
            problems.add(Cause::Changed, format!("its {NAME} is damaged"));
            return Ok((None, problems));
        }
        Err(other) => return Err(other),
    };
    let found = audit(root, &manifest, planned)?;
    problems.tell_audit(&found.wrong, say)?;
    if !found.unfinished.is_empty() {
        let names = found.unfinished.join(", ");
        say(&format!("unfinished: {names}"))?;
        problems.add(Cause::Unfinished(manifest.of), "it is not finished");
    }
    for path in manifest.files.iter().map(|entry| &entry.path) {
        let failed = matches!(planned.files.get(path), Some(When::Unfinished(_)));
        if failed && path.split('/').next_back() == Some(FAILURE) {
            say(&format!(
                "{path}: a stage failed; that is not executed again, and unverified"
            ))?;
            problems.add(
                Cause::Unfinished(manifest.of),
                format!("{path} is not verified"),
            );
        }
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
            problems.add(
                Cause::Unexpected,
                format!("{link} is neither its closing hash nor the last link of a stage"),
            );
        }
    }
    Ok((Some(manifest), problems))
}

/// What was expected and is in the manifest, but is not what was executed: `ends` says what was.
pub(crate) fn check_expected(
    expect: &[String],
    manifest: Option<&Manifest>,
    ends: impl Fn(&str) -> bool,
) -> Problems {
    let mut problems = Problems::default();
    let listed = |link: &&String| manifest.is_some_and(|manifest| manifest.has_link(link));
    for link in expect.iter().filter(listed).filter(|link| !ends(link)) {
        let problem = format!("{link} is in {NAME}, but nothing that was executed ends with it");
        problems.add(Cause::Unconfirmed, problem);
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::{FileRecord, When};

    /// A file of this name that is planned otherwise says nothing of a stage.
    #[test]
    fn a_failure_is_known_by_its_place() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["beds/imported/failure.json", "failure.json"];
        let beds = When::Unfinished(vec!["bed".into()]);
        let stages = vec!["bed".to_string()];
        let planned = Planned {
            of: FolderKind::Run,
            stages: stages.clone(),
            files: [
                (names[0].into(), When::Always),
                (names[1].into(), beds),
                (NAME.into(), When::Beside),
            ]
            .into(),
        };
        for (count, told) in [(1, 0), (2, 1)] {
            let mut manifest = Manifest::new(FolderKind::Run, &stages);
            for name in &names[..count] {
                let path = folder.path().join(name);
                bitgrain_sim::disk::write_whole(&path, b"a").unwrap();
                manifest.files.push(FileRecord::of(name, b"a"));
            }
            std::fs::write(folder.path().join(NAME), manifest.text()).unwrap();
            let mut lines = Vec::new();
            let mut say = |line: &str| {
                lines.push(line.to_string());
                Ok(())
            };
            check_manifest(folder.path(), &planned, &[], &mut say).unwrap();
            let failed = lines.iter().filter(|line| line.contains("a stage failed"));
            assert_eq!(failed.count(), told, "{lines:?}");
        }
    }
}
