//! The library of settled beds: a folder with one folder a bed, named by the first sixteen digits of
//! its recipe's digest, in it the recipe and the checkpoint.

use std::path::{Path, PathBuf};

use super::prove;
use super::recipe::Recipe;
use bitgrain_sim::disk::{self, Kind, write_whole};
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
        let Some(bytes) = disk::read_if_there(&path)? else {
            return Ok(None);
        };
        let name = path.display().to_string();
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
        disk::is_there(&self.checkpoint(&recipe.digest()))
    }

    /// Keeps a settled bed: the bytes of its checkpoint.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn keep(&self, recipe: &Recipe, bytes: &[u8]) -> Result<()> {
        let path = self.checkpoint(&recipe.digest());
        write_whole(&path.with_file_name(RECIPE), recipe.text().as_bytes())?;
        write_whole(&path, bytes)
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
            if !ours || kind != Kind::Folder || !files.iter().any(|file| disk::is_there(file)) {
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

    /// Removes a bed: the files that were written for it, and its folder. Says whether the folder is gone: if it
    /// holds other files it stays with them.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn remove(&self, bed: &CachedBed) -> Result<bool> {
        let path = self.folder.join(&bed.name);
        disk::clear_partials(&path);
        for file in FILES {
            disk::remove(&path.join(file))?;
        }
        disk::remove_if_empty(&path)
    }
}
