//! The manifest of a run or campaign in progress.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use super::record::{
    Departure, FileRecord, FolderKind, Manifest, NAME, RESULTS, StageRecord, relative,
};
use bitgrain_sim::disk::{self, write_whole};
use bitgrain_sim::error::{Error, Result};

/// The manifest of a folder that this process owns: files are written through it, and what lies in the folder
/// counts only if it vouches for it.
///
/// It is saved before each state that a stage is to go on from, so that it vouches for all that was written up
/// to that state.
#[derive(Debug)]
pub struct Ledger {
    root: PathBuf,
    known: Mutex<Known>,
}

#[derive(Debug)]
struct Known {
    manifest: Manifest,
    entries: BTreeMap<String, FileRecord>,
    /// Files that are as their entries say.
    sound: BTreeSet<String>,
    /// What lies on the disk.
    saved: Option<String>,
}

impl Known {
    /// The manifest as it stands.
    fn manifest(&self) -> Manifest {
        Manifest {
            files: self.entries.values().cloned().collect(),
            ..self.manifest.clone()
        }
    }
}

impl Ledger {
    /// The manifest of a folder as it was left, or a new one, for these stages. Every file in it is read and
    /// compared. Nothing is written.
    ///
    /// # Errors
    /// [`Error::Input`] if it belongs to something else, or it or a file in it cannot be read. A damaged one counts
    /// as none, and is returned as a warning; so is one that is missing although there are results.
    pub fn open(root: &Path, of: FolderKind, stages: &[String]) -> Result<(Self, Option<Error>)> {
        let (old, damage) = match Manifest::of(root) {
            Ok(None) if RESULTS.iter().any(|name| disk::is_there(&root.join(name))) => {
                let missing = Error::Manifest {
                    place: root.join(NAME).display().to_string(),
                    problem: "it is missing".into(),
                };
                (None, Some(missing))
            }
            Ok(old) => (old, None),
            Err(damage @ Error::Manifest { .. }) => (None, Some(damage)),
            Err(other) => return Err(other),
        };
        if old.as_ref().is_some_and(|old| old.of != of) {
            let problem = format!("holds no {}; choose another --out", of.word());
            return Err(Error::input(root.display().to_string(), problem));
        }
        let mut known = Known {
            manifest: Manifest::new(of, stages),
            entries: BTreeMap::new(),
            sound: BTreeSet::new(),
            saved: old.as_ref().map(Manifest::text),
        };
        if let Some(old) = old {
            let manifest = &mut known.manifest;
            for stage in &mut manifest.stages {
                let before = old.stages.iter().find(|one| one.name == stage.name);
                *stage = before.unwrap_or(stage).clone();
            }
            manifest.finished = old.finished && manifest.stages == old.stages;
            known.entries = old.entries();
        }
        for (path, entry) in &known.entries {
            match entry.read(root) {
                Ok(_) => {
                    known.sound.insert(path.clone());
                }
                Err(Departure::Changed(_)) => {}
                Err(Departure::Unreadable(e)) => return Err(e),
            }
        }
        let ledger = Self {
            root: root.to_path_buf(),
            known: Mutex::new(known),
        };
        Ok((ledger, damage))
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().expect("nobody panics with it")
    }

    fn name(&self, path: &Path) -> String {
        relative(&self.root, path).expect("what a run writes lies in its folder")
    }

    /// Whether a file is there and as it was written.
    pub fn vouches(&self, path: &Path) -> bool {
        self.known().sound.contains(&self.name(path))
    }

    /// Whether there is an entry of a file, in whatever state it is.
    pub fn lists(&self, path: &Path) -> bool {
        self.known().entries.contains_key(&self.name(path))
    }

    /// Whether these would be the bytes of a file that is listed; `None` if it is not.
    pub fn expects(&self, path: &Path, bytes: &[u8]) -> Option<bool> {
        let known = self.known();
        known
            .entries
            .get(&self.name(path))
            .map(|entry| entry.is_of(bytes))
    }

    /// Files that are listed, begin so, and are not as they were written.
    pub fn damaged(&self, begin: &str) -> Vec<String> {
        let known = self.known();
        let names = known.entries.keys().filter(|name| name.starts_with(begin));
        names
            .filter(|name| !known.sound.contains(*name))
            .cloned()
            .collect()
    }

    /// Whether a stage is finished.
    pub fn is_finished(&self, stage: &str) -> bool {
        self.known().manifest.has_finished(stage)
    }

    /// Whether all of it is finished and every file is as it was written.
    pub fn is_whole(&self) -> bool {
        let known = self.known();
        known.manifest.finished && known.sound.len() == known.entries.len()
    }

    /// Writes a file of results, unless it is there with these bytes.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Unverified`] if it was listed with other bytes and is of a kind that always
    /// comes out the same: then somebody changed the manifest or what it was made from.
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        let name = self.name(path);
        let entry = FileRecord::of(&name, bytes);
        let before = self.known().entries.get(&name).cloned();
        if before.as_ref() == Some(&entry) {
            if self.known().sound.contains(&name) {
                return Ok(());
            }
        } else if before.is_some() && !may_change(&name) {
            let problem = format!(
                "{}, made again, does not match its entry in {NAME}",
                path.display()
            );
            return Err(Error::Unverified {
                problem,
                hint: CONFLICT,
            });
        }
        write_whole(path, bytes)?;
        let mut known = self.known();
        known.entries.insert(name.clone(), entry);
        known.sound.insert(name);
        Ok(())
    }

    /// Removes a file of results.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn remove(&self, path: &Path) -> Result<()> {
        let name = self.name(path);
        let mut known = self.known();
        if known.entries.remove(&name).is_some() {
            known.sound.remove(&name);
        }
        drop(known);
        disk::remove(path)
    }

    /// Records that a stage is finished with this link, and saves.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn finish_stage(&self, stage: &str, link: &str) -> Result<()> {
        let mut known = self.known();
        if let Some(one) = known
            .manifest
            .stages
            .iter_mut()
            .find(|one| one.name == stage)
        {
            *one = StageRecord {
                name: stage.into(),
                finished: true,
                link: link.into(),
            };
        }
        self.save_known(known)
    }

    /// Records that all of it is finished, saves, and returns the closing hash.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn finish(&self) -> Result<String> {
        let mut known = self.known();
        known.manifest.finished = known.manifest.stages.iter().all(|stage| stage.finished);
        self.save_known(known)?;
        Ok(self.closing())
    }

    /// The closing hash as it stands.
    pub fn closing(&self) -> String {
        self.known().manifest().closed()
    }

    /// Writes the manifest, if it differs from the one on the disk.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn save(&self) -> Result<()> {
        self.save_known(self.known())
    }

    /// The same; nobody changes or saves it meanwhile.
    fn save_known(&self, mut known: MutexGuard<'_, Known>) -> Result<()> {
        let text = known.manifest().text();
        let path = self.root.join(NAME);
        if known.saved.as_ref() != Some(&text) || !disk::is_there(&path) {
            write_whole(&path, text.as_bytes())?;
            known.saved = Some(text);
        }
        Ok(())
    }
}

/// If a file cannot be both what the manifest says and what the run gives.
const CONFLICT: &str = "manifest.json or the input of the file was changed, or another build or machine \
                        that does not keep the bit contract wrote it; it was left as it was. To have all of it made \
                        again from the scenario, move manifest.json away and give the same command";

/// Files that grow with a run or hold the program's version.
fn may_change(name: &str) -> bool {
    let file = name.rsplit('/').next().unwrap_or(name);
    [
        "chain.csv",
        "forces.partial.csv",
        "scenario.toml",
        "campaign.toml",
        "summary.json",
        "failure.json",
        "results.csv",
        "results.parquet",
        "analysis.json",
    ]
    .contains(&file)
}
