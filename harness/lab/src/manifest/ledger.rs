//! The manifest of a run or campaign in progress.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use super::record::{
    Departure, FileRecord, FolderKind, Manifest, NAME, RESULTS, StageRecord, is_marked, relative,
};
use bitgrain_sim::below::Below;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

/// The manifest of a folder that this process owns: files are written through it, and what lies in the folder
/// counts only if it vouches for it.
///
/// It is saved before each state that a stage is to go on from, so that it vouches for all that was written up
/// to that state, and before each file that has no entry on the disk yet: a file without one was not written here.
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
    /// Files that have an entry in the manifest on the disk.
    listed: BTreeSet<String>,
    /// What lies on the disk.
    saved: Option<String>,
    /// Whether there was a manifest that is lost.
    lost: bool,
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
            listed: BTreeSet::new(),
            saved: old.as_ref().map(Manifest::text),
            lost: damage.is_some(),
        };
        if let Some(old) = old {
            let manifest = &mut known.manifest;
            for stage in &mut manifest.stages {
                let before = old.stages.iter().find(|one| one.name == stage.name);
                *stage = before.unwrap_or(stage).clone();
            }
            manifest.finished = old.finished && manifest.stages == old.stages;
            known.entries = old.entries();
            known.listed = known.entries.keys().cloned().collect();
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

    /// Refuses a file of others in the place of one that will be written: something lies there, and the manifest has no
    /// entry of it. If the manifest was lost, what bears the mark of a result counts as written here, and as damaged.
    ///
    /// # Errors
    /// [`Error::Input`], also if it is no regular file or is reached through a link.
    pub fn refuse_foreign(&self, path: &Path) -> Result<()> {
        Below(&self.root).check_file(path)?;
        let (mut known, name) = (self.known(), self.name(path));
        if known.entries.contains_key(&name) || !disk::is_there(path) {
            return Ok(());
        }
        if known.lost && is_marked(&name, &disk::read(path)?) {
            known.entries.insert(name.clone(), FileRecord::lost(&name));
            return Ok(());
        }
        Err(known.manifest.of.foreign(path))
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

    /// Records that a stage is begun or gone on with, so that neither it nor the whole is finished. Files that begin as
    /// `doubted` does count as damaged until they are written again.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn begin_stage(&self, stage: &str, doubted: Option<&str>) -> Result<()> {
        let mut known = self.known();
        if let Some(doubted) = doubted {
            known.sound.retain(|name| !name.starts_with(doubted));
        }
        let manifest = &mut known.manifest;
        let mut own = manifest.stages.iter_mut();
        let own = own.find(|one| one.name == stage && one.finished);
        if own.is_none() && !manifest.finished {
            return Ok(());
        }
        manifest.finished = false;
        if let Some(own) = own {
            (own.finished, own.link) = (false, String::new());
        }
        self.save_known(known).map(drop)
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
    /// As [`Ledger::write_all`].
    pub fn write(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        self.write_all(&[(path, bytes)])
    }

    /// Writes files of results, but those that are there with these bytes.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Input`] if something lies in the place of one that is no file; [`Error::Unverified`]
    /// if one was listed with other bytes and is of a kind that always comes out the same: then somebody changed the
    /// manifest or what it was made from.
    pub fn write_all(&self, files: &[(impl AsRef<Path>, impl AsRef<[u8]>)]) -> Result<()> {
        let files = files.iter().map(|(path, bytes)| {
            let (path, bytes) = (path.as_ref(), bytes.as_ref());
            (path, bytes, FileRecord::of(&self.name(path), bytes))
        });
        let mut open: Vec<(&Path, &[u8], FileRecord)> = files.collect();
        let mut known = self.known();
        open.retain(|(_, _, entry)| {
            let same = known.entries.get(&entry.path) == Some(entry);
            !(same && known.sound.contains(&entry.path))
        });
        for (path, _, entry) in &open {
            match known.entries.get(&entry.path) {
                Some(before) if before.was_another(entry) && !may_change(&entry.path) => {
                    let problem = format!(
                        "{}, made again, does not match its entry in {NAME}",
                        path.display()
                    );
                    return Err(Error::Unverified {
                        problem,
                        hint: CONFLICT,
                    });
                }
                _ => {}
            }
            Below(&self.root).check_file(path)?;
        }
        let fresh = |entry: &FileRecord| !known.listed.contains(&entry.path);
        if open.iter().any(|(_, _, entry)| fresh(entry)) {
            for (_, _, entry) in &open {
                known.sound.remove(&entry.path);
                known.entries.insert(entry.path.clone(), entry.clone());
            }
            known = self.save_known(known)?;
        }
        drop(known);
        for (path, bytes, entry) in open {
            Below(&self.root).write(path, bytes)?;
            let mut known = self.known();
            known.sound.insert(entry.path.clone());
            known.entries.insert(entry.path.clone(), entry);
        }
        Ok(())
    }

    /// Writes a state to go on from, which the manifest does not list.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Input`] if something lies there that is no file.
    pub fn write_state(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        Below(&self.root).write(path, bytes)
    }

    /// Removes a file of results, if there is an entry of it.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn remove(&self, path: &Path) -> Result<()> {
        let name = self.name(path);
        let mut known = self.known();
        if known.entries.remove(&name).is_none() {
            return Ok(());
        }
        known.sound.remove(&name);
        drop(known);
        Below(&self.root).remove(path)
    }

    /// Removes a state to go on from; nothing happens if there is none.
    ///
    /// # Errors
    /// [`Error::Write`]; [`Error::Input`] if something lies there that is no file.
    pub fn remove_state(&self, path: &Path) -> Result<()> {
        Below(&self.root).remove(path)
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
        self.save_known(known).map(drop)
    }

    /// Records that all of it is finished, saves, and returns the closing hash.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn finish(&self) -> Result<String> {
        let mut known = self.known();
        known.manifest.finished = known.manifest.stages.iter().all(|stage| stage.finished);
        drop(self.save_known(known)?);
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
        self.save_known(self.known()).map(drop)
    }

    /// The same; nobody changes or saves it meanwhile.
    fn save_known<'a>(&self, mut known: MutexGuard<'a, Known>) -> Result<MutexGuard<'a, Known>> {
        let text = known.manifest().text();
        let path = self.root.join(NAME);
        if known.saved.as_ref() != Some(&text) || !disk::is_there(&path) {
            Below(&self.root).write(&path, text.as_bytes())?;
            known.saved = Some(text);
            known.listed = known.entries.keys().cloned().collect();
        }
        Ok(known)
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

#[cfg(test)]
mod tests {
    use super::*;

    fn open(root: &Path) -> Ledger {
        let stages = ["bed".to_string()];
        Ledger::open(root, FolderKind::Run, &stages).unwrap().0
    }

    #[test]
    fn a_file_is_listed_before_it_is_written_and_one_that_is_not_is_of_others() {
        let folder = tempfile::tempdir().unwrap();
        let [ours, others] = ["beds/a", "beds/b"].map(|name| folder.path().join(name));
        open(folder.path()).write(&ours, b"1").unwrap();
        std::fs::write(&others, "mine").unwrap();
        let ledger = open(folder.path());
        assert!(ledger.vouches(&ours));
        ledger.refuse_foreign(&ours).unwrap();
        let told = ledger.refuse_foreign(&others).unwrap_err().to_string();
        assert!(told.contains("no entry"), "{told}");
        ledger.remove(&others).unwrap();
        assert!(others.exists());
    }

    #[test]
    fn where_the_manifest_was_lost_marked_files_count_as_ours_and_damaged() {
        let folder = tempfile::tempdir().unwrap();
        let [path, other] = ["beds/a", "beds/b"].map(|name| folder.path().join(name));
        let (one, two) = (b"# BITS_VERSION 1\n1", b"# BITS_VERSION 1\n2");
        open(folder.path())
            .write_all(&[(&path, one), (&other, two)])
            .unwrap();
        std::fs::remove_file(folder.path().join(NAME)).unwrap();
        let ledger = open(folder.path());
        // What has no mark of ours is of others.
        std::fs::write(folder.path().join("beds/c"), "mine").unwrap();
        assert!(
            ledger
                .refuse_foreign(&folder.path().join("beds/c"))
                .is_err()
        );
        for path in [&path, &other] {
            ledger.refuse_foreign(path).unwrap();
        }
        ledger.save().unwrap();
        // Killed before it wrote the files again, and begun once more.
        let ledger = open(folder.path());
        ledger.refuse_foreign(&path).unwrap();
        assert_eq!(ledger.damaged("beds/"), ["beds/a", "beds/b"]);
        ledger.write(&path, one).unwrap();
        ledger.remove(&other).unwrap();
        assert!(ledger.vouches(&path) && !other.exists());
    }
}
