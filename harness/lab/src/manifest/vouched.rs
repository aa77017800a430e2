//! Reading what a manifest vouches for.

use std::path::{Path, PathBuf};

use super::record::{Departure, FolderKind, Manifest, NAME, relative};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::text_of;

/// A folder with its manifest: files are read only if they are as the manifest says.
#[derive(Clone, Debug)]
pub struct Vouched {
    root: PathBuf,
    /// The manifest.
    pub manifest: Manifest,
}

impl Vouched {
    /// The folder of a run or campaign.
    ///
    /// # Errors
    /// [`Error::Input`] if it has no manifest or that of something else, [`Error::Manifest`] if that is
    /// damaged.
    pub fn open(root: &Path, of: FolderKind) -> Result<Self> {
        let place = root.display().to_string();
        let manifest = Manifest::of(root)?.ok_or_else(|| {
            let problem = format!(
                "has no {NAME}: it is not a {}, or its files cannot be checked; `{}` makes it",
                of.word(),
                remedy(of)
            );
            Error::input(place.clone(), problem)
        })?;
        if manifest.of != of {
            let problem = format!(
                "holds a {}, but a {} was expected",
                manifest.of.word(),
                of.word()
            );
            return Err(Error::input(place, problem));
        }
        Ok(Self {
            root: root.to_path_buf(),
            manifest,
        })
    }

    /// Whether the manifest has this file.
    pub fn lists(&self, path: &Path) -> bool {
        relative(&self.root, path).is_some_and(|name| self.manifest.entry(&name).is_some())
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// [`Error::Input`] if it is missing, not in the manifest, not as the manifest says, or cannot be read.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>> {
        let name = relative(&self.root, path).unwrap_or_default();
        let departed = match self
            .manifest
            .entry(&name)
            .map(|entry| entry.read(&self.root))
        {
            Some(Ok(bytes)) => return Ok(bytes),
            Some(Err(Departure::Unreadable(e))) => return Err(e),
            Some(Err(Departure::Changed(how))) => how,
            None => format!("is not among the files of {NAME}"),
        };
        let again = remedy(self.manifest.of);
        let problem = format!("{departed}; `{again}` makes it again");
        Err(Error::input(path.display().to_string(), problem))
    }

    /// The text of a file, unpacked.
    ///
    /// # Errors
    /// As [`Vouched::read`], and if it is not text.
    pub fn text(&self, path: &Path) -> Result<String> {
        text_of(self.read(path)?, &path.display().to_string())
    }
}

/// The command that makes files again.
fn remedy(of: FolderKind) -> &'static str {
    match of {
        FolderKind::Run => "bitgrain run --resume FOLDER",
        FolderKind::Campaign => "bitgrain sweep CAMPAIGN --out FOLDER",
    }
}
