//! A file that grows at its end, whole pieces at a time.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::watch::{Call, before};
use crate::error::{Error, Result};

/// A new file to which pieces are appended. A piece that could not be written whole is taken back.
#[derive(Debug)]
pub struct Appended {
    path: PathBuf,
    file: File,
    length: u64,
    most: u64,
}

impl Appended {
    /// Makes the file, which must not be there yet; it may grow to `most` bytes.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn create(path: &Path, most: u64) -> Result<Self> {
        // Writing always at the end, so that a piece that was taken back leaves no gap.
        let file = before(Call::Create(path))
            .and_then(|()| File::options().append(true).create_new(true).open(path));
        Ok(Self {
            file: file.map_err(|e| Error::write(path, e))?,
            path: path.to_path_buf(),
            length: 0,
            most,
        })
    }

    /// Appends a piece.
    ///
    /// # Errors
    /// [`Error::Input`] if the file would have more bytes than it may; [`Error::Write`]. The file then ends as it did
    /// before, if the system still shortens it.
    pub fn append(&mut self, bytes: &[u8]) -> Result<()> {
        if self.length + bytes.len() as u64 > self.most {
            let problem = format!(
                "would have more than {} MiB, which is the most that is read again: allow more with \
                 --max-input, or write less; what was written before is kept",
                self.most >> 20
            );
            return Err(Error::input(self.path.display().to_string(), problem));
        }
        let written =
            before(Call::Append(&self.path, bytes)).and_then(|()| self.file.write_all(bytes));
        match written {
            Ok(()) => {
                self.length += bytes.len() as u64;
                Ok(())
            }
            Err(e) => {
                let _ = self.file.set_len(self.length);
                Err(Error::write(&self.path, e))
            }
        }
    }

    /// Makes what was appended last.
    ///
    /// # Errors
    /// [`Error::Write`].
    pub fn sync(&mut self) -> Result<()> {
        let synced = before(Call::Sync(&self.path)).and_then(|()| self.file.sync_all());
        synced.map_err(|e| Error::write(&self.path, e))
    }
}
