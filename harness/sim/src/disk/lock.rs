//! Files and folders as locks.

use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;

use super::{Call, before};

/// Whether a process is writing a file; not if the file system cannot lock.
pub(crate) fn is_being_written(path: &Path) -> bool {
    let tried = File::open(path).map(|file| file.try_lock());
    matches!(tried, Ok(Err(TryLockError::WouldBlock)))
}

/// Opens a folder to lock it.
///
/// # Errors
/// The system's.
pub fn open_folder(folder: &Path) -> io::Result<File> {
    before(Call::Lock(folder))?;
    File::open(folder)
}

/// Opens a regular file to lock it; nothing is written to it.
///
/// # Errors
/// The system's, and [`io::ErrorKind::InvalidInput`] for what is not a regular file.
pub fn open_to_lock(path: &Path) -> io::Result<File> {
    if !std::fs::metadata(path)?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    before(Call::Lock(path))?;
    File::options().append(true).open(path)
}
