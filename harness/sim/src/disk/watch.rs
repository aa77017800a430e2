//! The calls to the file system, watched by tests of what happens to files if they fail.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, RwLock};

/// A call to the file system, as it is about to be made. Checks whether a file exists do not count.
#[derive(Clone, Copy, Debug)]
pub enum Call<'a> {
    /// A file that is there is read.
    Read(&'a Path),
    /// The names in a folder that is there are read.
    List(&'a Path),
    /// A folder or file is opened to be locked.
    Lock(&'a Path),
    /// A folder is made; the one above it is there.
    MakeFolder(&'a Path),
    /// A new file is made, empty.
    Create(&'a Path),
    /// All its bytes are written to a file that was just made.
    Write(&'a Path, &'a [u8]),
    /// Bytes are written at the end of a file.
    Append(&'a Path, &'a [u8]),
    /// A file's bytes are made to last.
    Sync(&'a Path),
    /// A file gets another name, in place of the file that had it.
    Rename(&'a Path, &'a Path),
    /// The names in a folder are made to last.
    SyncFolder(&'a Path),
    /// A file is removed.
    Remove(&'a Path),
    /// An empty folder is removed.
    RemoveFolder(&'a Path),
}

/// What happens to a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CallOutcome {
    /// It is made.
    Go,
    /// It fails without having been made.
    Fail(io::ErrorKind),
    /// Of the bytes that it writes only this many arrive, and it fails.
    Short(usize),
}

/// What is asked before each call.
pub trait Watch: Send + Sync {
    /// What is to happen to it.
    fn before(&self, call: &Call<'_>) -> CallOutcome;
}

static WATCHED: AtomicBool = AtomicBool::new(false);
static WATCHER: RwLock<Option<Arc<dyn Watch>>> = RwLock::new(None);

/// Has every call of this process watched from now on, or none: for tests of what happens to files
/// if calls fail.
pub fn watch(watcher: Option<Arc<dyn Watch>>) {
    WATCHED.store(watcher.is_some(), Ordering::Release);
    let mut place = WATCHER.write().unwrap_or_else(|broken| broken.into_inner());
    *place = watcher;
}

/// Asks whether a call is to be made, and makes half of it if it is to be cut short.
///
/// # Errors
/// The one that it is to fail with.
pub(crate) fn before(call: Call<'_>) -> io::Result<()> {
    if !WATCHED.load(Ordering::Acquire) {
        return Ok(());
    }
    let watcher = WATCHER.read().unwrap_or_else(|broken| broken.into_inner());
    let verdict = watcher
        .as_ref()
        .map_or(CallOutcome::Go, |w| w.before(&call));
    match (verdict, call) {
        (CallOutcome::Go, _) => Ok(()),
        (CallOutcome::Fail(kind), _) => Err(io::Error::new(kind, "made to fail")),
        (CallOutcome::Short(count), Call::Write(path, bytes) | Call::Append(path, bytes)) => {
            let mut file = File::options().append(true).open(path)?;
            file.write_all(&bytes[..count.min(bytes.len())])?;
            Err(io::Error::new(io::ErrorKind::StorageFull, "made to fail"))
        }
        (CallOutcome::Short(_), _) => {
            Err(io::Error::new(io::ErrorKind::StorageFull, "made to fail"))
        }
    }
}
