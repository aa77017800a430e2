//! The library of settled beds: a folder with one folder a bed, named by the first sixteen digits of
//! its recipe's digest, in it the recipe and the checkpoint.

use std::fs::TryLockError;
use std::path::{Path, PathBuf};

use super::prove;
use super::recipe::Recipe;
use bitgrain_sim::below::Below;
use bitgrain_sim::checkpoint;
use bitgrain_sim::disk::{self, Kind};
use bitgrain_sim::error::{Error, Result};

/// Digits of a digest that name a bed.
const NAME: usize = 16;

/// The settled state of a bed.
const BED: &str = "bed.safetensors";

/// What it was made by.
const RECIPE: &str = "recipe.toml";

/// All files of a bed.
const FILES: [&str; 2] = [BED, RECIPE];

/// A folder of settled beds.
#[derive(Clone, Debug)]
pub struct BedCache {
    folder: PathBuf,
}

/// A bed of the library.
#[derive(Clone, Debug)]
pub struct CachedBed {
    /// Its name: the first digits of its recipe's digest.
    pub name: String,
    /// Its recipe; `None` if that is missing or not one.
    pub recipe: Option<Recipe>,
    /// Bytes of all its files.
    pub bytes: u64,
    /// The settled state.
    pub checkpoint: PathBuf,
}

impl BedCache {
    /// The library in this folder, which need not be there yet.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self {
            folder: folder.into(),
        }
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    fn checkpoint(&self, digest: &str) -> PathBuf {
        self.folder.join(&digest[..NAME]).join(BED)
    }

    /// The bytes of the checkpoint made from this recipe, or `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Input`] if the bed is there but cannot be read, is damaged or is another bed; the
    /// message says how to remove it.
    pub fn find(&self, recipe: &Recipe) -> Result<Option<Vec<u8>>> {
        let digest = recipe.digest();
        let path = self.checkpoint(&digest);
        Below(&self.folder).check_file(&path)?;
        let Some(bytes) = disk::read_if_there(&path)? else {
            return Ok(None);
        };
        let name = path.display().to_string();
        if !checkpoint::begins(&bytes) {
            return Err(foreign(&path));
        }
        match prove(&bytes, &name, recipe) {
            Ok(()) => Ok(Some(bytes)),
            Err(Error::Contract { problem }) => Err(Error::Contract { problem }),
            Err(other) => Err(Error::input(
                path.display().to_string(),
                format!(
                    "{}; `bitgrain bed remove {}` removes it, and the next run pours it again",
                    other.describe_at(&name),
                    &digest[..NAME]
                ),
            )),
        }
    }

    /// Whether there is a bed made from this recipe, sound or not.
    pub fn has(&self, recipe: &Recipe) -> bool {
        let path = self.checkpoint(&recipe.digest());
        disk::is_there(&path) && Below(&self.folder).check_file(&path).is_ok()
    }

    /// Keeps a settled bed: the bytes of its checkpoint.
    ///
    /// # Errors
    /// As [`BedCache::prepare`].
    pub fn keep(&self, recipe: &Recipe, bytes: &[u8]) -> Result<()> {
        self.check_place(recipe)?;
        let path = self.checkpoint(&recipe.digest());
        let place = path.parent().unwrap_or(&self.folder);
        disk::make_folder(place)?;
        // Who removes the bed meanwhile is told that it is being written.
        let writing = disk::open_folder(place).ok();
        let _locked = writing.as_ref().map(std::fs::File::try_lock_shared);
        let below = Below(&self.folder);
        below.write(&path.with_file_name(RECIPE), recipe.text().as_bytes())?;
        below.write(&path, bytes)
    }

    /// Makes sure, before days of pouring, that these beds can be kept.
    ///
    /// # Errors
    /// [`Error::Write`] if nothing can be written; [`Error::Input`] if something of others has the place of a bed.
    pub fn prepare(&self, recipes: &[Recipe]) -> Result<()> {
        if recipes.is_empty() {
            return Ok(());
        }
        recipes
            .iter()
            .try_for_each(|recipe| self.check_place(recipe))?;
        disk::check_writable(&self.folder)
    }

    /// Refuses a link or another kind of thing in the place of a bed's file, and a file there that is none of a bed.
    fn check_place(&self, recipe: &Recipe) -> Result<()> {
        let bed = self.checkpoint(&recipe.digest());
        for path in [bed.with_file_name(RECIPE), bed] {
            Below(&self.folder).check_file(&path)?;
            if disk::is_there(&path) && !is_ours(&path)? {
                return Err(foreign(&path));
            }
        }
        Ok(())
    }

    /// The beds, by name.
    ///
    /// # Errors
    /// [`Error::Input`] if the folder cannot be read; a library that is not there is empty.
    pub fn list(&self) -> Result<Vec<CachedBed>> {
        let mut beds = Vec::new();
        for (name, kind) in disk::list(&self.folder)? {
            // Other folders may lie here too; they are not ours to list or to remove.
            let ours = name.len() == NAME && name.bytes().all(|b| b.is_ascii_hexdigit());
            let path = self.folder.join(&name);
            let files = FILES.map(|file| path.join(file));
            // One that cannot be read may be a damaged bed.
            let holds = |file: &PathBuf| disk::is_there(file) && is_ours(file).unwrap_or(true);
            if !ours || kind != Kind::Folder || !files.iter().rev().any(holds) {
                continue;
            }
            let text = disk::read(&path.join(RECIPE)).unwrap_or_default();
            let text = String::from_utf8(text).unwrap_or_default();
            // A recipe that was changed is not the one that the bed is named after.
            let whole =
                |recipe: &Recipe| recipe.text() == text && recipe.digest().starts_with(&name);
            beds.push(CachedBed {
                recipe: toml::from_str(&text).ok().filter(whole),
                name,
                bytes: files.iter().map(|file| disk::size(file)).sum(),
                checkpoint: path.join(BED),
            });
        }
        beds.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(beds)
    }

    /// The one bed whose name begins so.
    ///
    /// # Errors
    /// [`Error::Input`] if there is none or more than one.
    pub fn entry(&self, begin: &str) -> Result<CachedBed> {
        if begin.is_empty() {
            return Err(Error::input(
                "the name of a bed",
                "is empty; `bitgrain bed list` shows them",
            ));
        }
        let beds = self.list()?;
        let mut found: Vec<CachedBed> = beds
            .into_iter()
            .filter(|bed| bed.name.starts_with(begin))
            .collect();
        match found.len() {
            1 => Ok(found.remove(0)),
            0 => Err(Error::input(
                begin,
                format!(
                    "no bed in {} has a name that begins like this; `bitgrain bed list` shows them",
                    self.folder.display()
                ),
            )),
            n => Err(Error::input(
                begin,
                format!("{n} beds have names that begin like this; give more of it"),
            )),
        }
    }

    /// Removes a bed: the files that were written for it, and its folder. Returns how many bytes they had, `None` if
    /// there was no such file, and whether the folder is gone: if it holds other files it stays with them.
    ///
    /// # Errors
    /// [`Error::Input`] if another process is writing the bed; [`Error::Write`].
    pub fn remove(&self, bed: &CachedBed) -> Result<(Option<u64>, bool)> {
        let (path, below) = (self.folder.join(&bed.name), Below(&self.folder));
        below.check_folder(&path)?;
        let folder = disk::open_folder(&path).map_err(|e| Error::read(&path, &e))?;
        match folder.try_lock() {
            Ok(()) => below.clear_partials(&path, |_| true),
            Err(TryLockError::WouldBlock) => {
                let problem = "is being written by another process: give the command again once that has ended";
                return Err(Error::input(path.display().to_string(), problem));
            }
            // The file system has no locks: what is half written may be in use.
            Err(TryLockError::Error(_)) => {}
        }
        let mut removed = None;
        for path in FILES.map(|file| path.join(file)) {
            if disk::kind(&path) == Some(Kind::File) && is_ours(&path)? {
                removed = Some(removed.unwrap_or(0) + disk::size(&path));
                below.remove(&path)?;
            }
        }
        Ok((removed, below.remove_if_empty(&path)?))
    }
}

/// A file in the place of a bed's.
fn foreign(path: &Path) -> Error {
    let problem = "has the name of a bed's file and is none: it is not replaced; move it away, or choose another \
                   --beds";
    Error::input(path.display().to_string(), problem)
}

/// Whether a file of a bed's folder is one that was written for a bed, damaged or not, and not something of others.
fn is_ours(path: &Path) -> Result<bool> {
    let held = disk::read(path)?;
    let text = || std::str::from_utf8(&held).unwrap_or_default();
    Ok(match path.ends_with(RECIPE) {
        true => held.is_empty() || toml::from_str::<Recipe>(text()).is_ok(),
        false => checkpoint::begins(&held),
    })
}
