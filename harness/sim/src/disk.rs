//! The file system in one place: every file and folder that the program reads, writes or removes goes
//! through here.
//!
//! What may be written and removed below a folder that a user named is decided by `below::Below` alone.
//!
//! Files are read whole, regular files alone, and never more of one than [`most`] allows. They are written
//! beside the old file, synced, renamed over it, and then their folder is synced: so a reader sees the old
//! file or the new one, and after a power loss there is one of them too. Of two files that were written one
//! after the other, a power loss never keeps the second alone.
//!
//! Tests [`watch`] the calls, fail them, and stop a process at any of them.

mod append;
mod folders;
mod lock;
mod watch;

pub use append::Appended;
use folders::{above, sync_folder};
pub use folders::{check_way, make_folder, make_new_folder, resolved};
pub(crate) use lock::is_being_written;
pub use lock::{open_folder, open_to_lock};
pub use watch::{Call, CallOutcome, Watch, watch};

use std::fs::{File, Metadata};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Error, Result};
pub(crate) use watch::before;

/// The ending of the name of a file that is being written: no other program uses it.
pub const PARTIAL: &str = ".bitgrain-partial";

/// Most bytes of a file that is read, unpacked, unless something else was set.
const MOST: u64 = 512 << 20;

static LIMIT: AtomicU64 = AtomicU64::new(MOST);

/// Files written so far by this process.
static WRITES: AtomicU64 = AtomicU64::new(0);

/// Sets how many bytes of a file are read at most, unpacked, by all of the process.
pub fn set_most(bytes: u64) {
    LIMIT.store(bytes, Ordering::Relaxed);
}

/// How many bytes of a file are read at most, unpacked.
pub fn most() -> u64 {
    LIMIT.load(Ordering::Relaxed)
}

/// What a name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// A regular file.
    File,
    /// A folder.
    Folder,
    /// A symbolic link.
    Link,
    /// A pipe, device or socket.
    Other,
    /// What cannot be looked at, for want of a permission or because its disk fails.
    Hidden,
    /// Whatever has a name that is not UTF-8, in a list of names.
    Unnamed,
}

impl Kind {
    fn of(data: &Metadata) -> Self {
        let kind = data.file_type();
        if kind.is_symlink() {
            Kind::Link
        } else if kind.is_dir() {
            Kind::Folder
        } else if kind.is_file() {
            Kind::File
        } else {
            Kind::Other
        }
    }

    /// In words.
    pub fn word(self) -> &'static str {
        match self {
            Kind::File => "a file",
            Kind::Folder => "a folder",
            Kind::Link => "a symbolic link",
            Kind::Other => "a pipe, device or socket",
            Kind::Hidden => "something that cannot be looked at: see that you may enter its folder",
            Kind::Unnamed => "something with a name that is not UTF-8",
        }
    }
}

/// What a path stands for itself, links not followed; `None` if there is nothing.
pub fn kind(path: &Path) -> Option<Kind> {
    match std::fs::symlink_metadata(path) {
        Ok(data) => Some(Kind::of(&data)),
        Err(e) if missing(&e) => None,
        Err(_) => Some(Kind::Hidden),
    }
}

/// Whether a path stands for nothing at all.
fn missing(e: &io::Error) -> bool {
    matches!(
        e.kind(),
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory
    )
}

/// Whether something has this name, even if it is a link to nothing.
pub fn is_there(path: &Path) -> bool {
    kind(path).is_some()
}

/// Whether a path, links followed, is a folder.
pub fn is_folder(path: &Path) -> bool {
    path.is_dir()
}

/// Whether a path, links followed, is a regular file.
pub fn is_file(path: &Path) -> bool {
    path.is_file()
}

/// Bytes of a file; 0 if there is none.
pub fn size(path: &Path) -> u64 {
    std::fs::symlink_metadata(path).map_or(0, |data| data.len())
}

/// Reads a whole file as it is, following a link.
///
/// # Errors
/// [`Error::Input`] if it cannot be read, is not a regular file, or is larger than [`most`].
pub fn read(path: &Path) -> Result<Vec<u8>> {
    read_if_there(path)?.ok_or_else(|| {
        // In the system's own words.
        let none = std::fs::metadata(path).err();
        Error::read(path, &none.unwrap_or(io::ErrorKind::NotFound.into()))
    })
}

/// The same; `None` if nothing has that name.
///
/// # Errors
/// As [`read`].
pub fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>> {
    let wrong = |e: &io::Error| Error::read(path, e);
    // Looked at before it is opened: opening a pipe waits for somebody to write into it.
    let data = match std::fs::metadata(path) {
        Ok(data) => data,
        Err(e) if missing(&e) => {
            return match kind(path) {
                None => Ok(None),
                // Another process made it meanwhile.
                Some(Kind::File) => read_if_there(path),
                Some(_) => Err(wrong(&e)),
            };
        }
        Err(e) => return Err(wrong(&e)),
    };
    if !data.is_file() {
        let what = Kind::of(&data).word();
        let problem = format!("is {what}, and a regular file was expected");
        return Err(Error::input(path.display().to_string(), problem));
    }
    let file = before(Call::Read(path)).and_then(|()| File::open(path));
    let file = file.map_err(|e| wrong(&e))?;
    let name = || path.display().to_string();
    all_of(file, data.len(), "cannot be read", &name).map(Some)
}

/// All that a source gives, of which `about` bytes are expected, but no more than [`most`]; `fails` is the
/// message if reading fails.
///
/// # Errors
/// [`Error::Input`] if it gives more, cannot be read, or memory is short.
pub(crate) fn all_of(
    source: impl Read,
    about: u64,
    fails: &str,
    name: &impl Fn() -> String,
) -> Result<Vec<u8>> {
    let most = most();
    let large = || {
        let problem = format!(
            "holds more than {} MiB, unpacked, which is the most that is read: see whether it is the right \
             file, or allow more with --max-input",
            most >> 20
        );
        Error::input(name(), problem)
    };
    if about > most {
        return Err(large());
    }
    let mut bytes = Vec::new();
    let short = |_| {
        let problem = "is larger than the memory available";
        Error::input(name(), problem)
    };
    bytes.try_reserve_exact(about as usize + 1).map_err(short)?;
    let mut source = source.take(most + 1);
    let mut piece = [0; 1 << 16];
    loop {
        let count = match source.read(&mut piece) {
            Ok(0) => break,
            Ok(count) => count,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(Error::input(name(), format!("{fails}: {e}"))),
        };
        bytes.try_reserve(count).map_err(short)?;
        bytes.extend_from_slice(&piece[..count]);
    }
    if bytes.len() as u64 > most {
        return Err(large());
    }
    Ok(bytes)
}

/// Names in a folder and what they stand for, by name; none if it is not there.
///
/// # Errors
/// [`Error::Input`] if it cannot be read.
pub fn list(folder: &Path) -> Result<Vec<(String, Kind)>> {
    let items = match before(Call::List(folder)).and_then(|()| std::fs::read_dir(folder)) {
        Ok(items) => items,
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(Error::read(folder, &e)),
    };
    let mut names = Vec::new();
    for item in items {
        let item = item.map_err(|e| Error::read(folder, &e))?;
        names.push(match item.file_name().into_string() {
            Ok(name) => (name, kind(&item.path()).unwrap_or(Kind::Hidden)),
            Err(name) => (name.to_string_lossy().into_owned(), Kind::Unnamed),
        });
    }
    names.sort();
    Ok(names)
}

/// The first name in a folder that is none of ours, before files are written there that replace others; `None` also of
/// a folder that is not there. Ours is a regular file whose name has a mark that its content has too.
///
/// # Errors
/// [`Error::Input`] if the folder or a file in it cannot be read.
pub fn other_than(
    folder: &Path,
    mark_of: impl Fn(&str) -> Option<&'static str>,
) -> Result<Option<String>> {
    if !is_folder(folder) {
        return Ok(None);
    }
    for (name, kind) in list(folder)? {
        let is_ours = match (kind, mark_of(&name)) {
            (Kind::File, Some(mark)) => bears(&read(&folder.join(&name))?, mark),
            _ => false,
        };
        if !is_ours {
            return Ok(Some(name));
        }
    }
    Ok(None)
}

/// Whether a file has a mark somewhere, or nothing that could be lost.
pub fn bears(bytes: &[u8], mark: &str) -> bool {
    let mark = mark.as_bytes();
    bytes.is_empty() || mark.is_empty() || bytes.windows(mark.len()).any(|part| part == mark)
}

/// Writes `bytes` to `path`, replacing a regular file there atomically. Missing folders are made.
///
/// # Errors
/// [`Error::Write`], and [`Error::Input`] for more bytes than [`most`], or if a link, a folder or a pipe has the name;
/// what was there is then still there.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    free_for(path, Kind::File)?;
    let (size, most) = (bytes.len() as u64, most());
    if size > most {
        let problem = format!(
            "would have {} MiB, and of a file at most {} MiB are read again: allow more with --max-input; \
             what was written before is kept, and the same command goes on from it",
            size.div_ceil(1 << 20),
            most >> 20
        );
        return Err(Error::input(path.display().to_string(), problem));
    }
    let folder = above(path);
    make_folder(folder)?;
    let (partial, created) = new_partial(path);
    let written = created.and_then(|mut file| {
        // Held until the file has its name: so others see that somebody writes it. Not every file system can lock.
        let _ = file.try_lock();
        before(Call::Write(&partial, bytes))?;
        file.write_all(bytes)?;
        before(Call::Sync(&partial))?;
        file.sync_all()?;
        before(Call::Rename(&partial, path))?;
        std::fs::rename(&partial, path)
    });
    if let Err(e) = written {
        // Half a file is of no use to anyone and may be what filled the disk.
        let _ = remove_raw(&partial);
        return Err(Error::write(path, e));
    }
    // Without this a power loss may undo the rename.
    sync_folder(folder).map_err(|e| Error::write(path, e))
}

/// Refuses a path where neither nothing nor a file or folder of this kind is.
pub(crate) fn free_for(path: &Path, expected: Kind) -> Result<()> {
    let found = match kind(path) {
        Some(found) if found != expected => found,
        _ => return Ok(()),
    };
    let problem = format!(
        "is {} in the place of {}, and stays as it is: move it away, or choose another folder",
        found.word(),
        expected.word()
    );
    Err(Error::input(path.display().to_string(), problem))
}

/// A new file beside `path`: no two threads write into one, nor do two processes, even of two machines.
fn new_partial(path: &Path) -> (PathBuf, io::Result<File>) {
    loop {
        let number = WRITES.fetch_add(1, Ordering::Relaxed);
        let mut name = path.file_name().unwrap_or_default().to_os_string();
        name.push(format!(".{}-{number}{PARTIAL}", std::process::id()));
        let partial = above(path).join(name);
        let created = before(Call::Create(&partial)).and_then(|()| File::create_new(&partial));
        let taken = |e: &io::Error| e.kind() == io::ErrorKind::AlreadyExists;
        if !created.as_ref().is_err_and(taken) {
            return (partial, created);
        }
    }
}

/// Makes sure that files can be written to a folder, which is made if it is missing.
///
/// # Errors
/// As [`make_folder`].
pub fn check_writable(folder: &Path) -> Result<()> {
    make_folder(folder)?;
    let (probe, created) = new_partial(&folder.join("probe"));
    let tried = created.and_then(|_| remove_raw(&probe));
    tried.map_err(|e| Error::write(folder, e))
}

pub(crate) fn remove_raw(path: &Path) -> io::Result<()> {
    before(Call::Remove(path))?;
    std::fs::remove_file(path)
}

/// Whether a name is that of a file which is being written: `NAME.PROCESS-NUMBER` and [`PARTIAL`].
pub fn is_partial(name: &str) -> bool {
    partial_of(name).is_some()
}

/// The name that a file which is being written will have; `None` of other files.
pub(crate) fn partial_of(name: &str) -> Option<&str> {
    let (name, writer) = name.strip_suffix(PARTIAL)?.rsplit_once('.')?;
    let (process, count) = writer.split_once('-')?;
    let number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    (!name.is_empty() && number(process) && number(count)).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_our_half_files_are_ours() {
        for ours in ["a.csv.12-0.bitgrain-partial", "b.1-23.bitgrain-partial"] {
            assert!(is_partial(ours), "{ours}");
        }
        for not in [
            "film.mkv.partial",
            "a.bitgrain-partial",
            "a.1.bitgrain-partial",
            ".1-2.bitgrain-partial",
            "a.x-2.bitgrain-partial",
            "a.1-2.partial",
        ] {
            assert!(!is_partial(not), "{not}");
        }
    }

    #[test]
    fn what_is_no_regular_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let told = read(folder.path()).unwrap_err().to_string();
        assert!(told.contains("is a folder, and a regular file"), "{told}");
        let none = folder.path().join("none");
        assert!(read_if_there(&none).unwrap().is_none());
        assert!(
            read(&none)
                .unwrap_err()
                .to_string()
                .contains("cannot be read")
        );
    }

    #[test]
    fn more_than_the_budget_is_refused_before_it_is_in_memory() {
        let endless = std::io::repeat(7);
        let told = all_of(endless, 0, "fails", &|| "a.gz".into()).unwrap_err();
        let told = told.to_string();
        assert!(told.contains("--max-input"), "{told}");
    }
}
