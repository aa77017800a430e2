//! Files read whole, packed or plain, and written whole: beside the old one, then renamed, so that a
//! reader never sees half a file.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use bitgrain_kernel::BITS_VERSION;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::error::{Error, Result};

/// Files written so far by this process.
static WRITES: AtomicU64 = AtomicU64::new(0);

/// What every file of results says somewhere: the arithmetic that it was made with.
pub fn bits() -> String {
    format!("BITS_VERSION {BITS_VERSION}")
}

/// Reads a whole file, unpacking gzip where its first bytes say so.
///
/// # Errors
/// [`Error::Input`] where it cannot be read or unpacked.
pub fn read_text(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).map_err(|e| Error::read(path, &e))?;
    let place = || path.display().to_string();
    let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
        let mut plain = Vec::new();
        flate2::read::MultiGzDecoder::new(bytes.as_slice())
            .read_to_end(&mut plain)
            .map_err(|e| {
                Error::input(place(), format!("the gzip data is damaged or cut off: {e}"))
            })?;
        plain
    } else {
        bytes
    };
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        Error::input(
            place(),
            format!("byte {at} is not text (UTF-8 was expected)"),
        )
    })
}

/// Writes `bytes` to `path`, replacing what was there in one go. Folders on the way are made.
///
/// # Errors
/// [`Error::Write`]; the old file is then still there.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    make_folder(folder)?;
    let name = path.file_name().unwrap_or_default();
    // Two threads never write into one file, nor do two processes, also of two machines.
    let (partial, created) = loop {
        let number = WRITES.fetch_add(1, Ordering::Relaxed);
        let mut name = name.to_os_string();
        name.push(format!(".{}-{number}.partial", std::process::id()));
        let partial = folder.join(name);
        let created = std::fs::File::create_new(&partial);
        let taken = |e: &std::io::Error| e.kind() == std::io::ErrorKind::AlreadyExists;
        if !created.as_ref().is_err_and(taken) {
            break (partial, created);
        }
    };
    let written = created.and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written
        .and_then(|()| std::fs::rename(&partial, path))
        .map_err(|e| {
            // Half a file is of no use to anyone and may be what filled the disk.
            let _ = std::fs::remove_file(&partial);
            Error::write(path, e)
        })
}

/// Removes the half files that killed processes left in a folder and those below it; whatever cannot be
/// removed stays.
pub fn clear_partials(folder: &Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            clear_partials(&path);
        } else if path.extension().is_some_and(|ending| ending == "partial") {
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Writes text to `path`, or where `packed` to `path` with `.gz` at its end, packed with gzip: the same
/// bytes every time, without a date or a name in them.
///
/// # Errors
/// As [`write_whole`].
pub fn write_text(path: &Path, text: &str, packed: bool) -> Result<()> {
    let (path, bytes) = text_file(path, text, packed)?;
    write_whole(&path, &bytes)
}

/// The file that [`write_text`] writes: its path and its bytes.
///
/// # Errors
/// [`Error::Write`] where packing goes wrong.
pub fn text_file(path: &Path, text: &str, packed: bool) -> Result<(PathBuf, Vec<u8>)> {
    if !packed {
        return Ok((path.to_path_buf(), text.as_bytes().to_vec()));
    }
    let path = packed_name(path);
    let mut gzip = GzEncoder::new(Vec::new(), Compression::default());
    let bytes = gzip
        .write_all(text.as_bytes())
        .and_then(|()| gzip.finish())
        .map_err(|e| Error::write(&path, e))?;
    Ok((path, bytes))
}

/// The path with `.gz` at its end.
pub fn packed_name(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_os_string();
    name.push(".gz");
    PathBuf::from(name)
}

/// Makes sure that files can be written to a folder, which is made where it is missing.
///
/// # Errors
/// [`Error::Write`].
pub fn check_writable(folder: &Path) -> Result<()> {
    make_folder(folder)?;
    let probe = folder.join(format!(".{}.partial", std::process::id()));
    std::fs::write(&probe, b"").map_err(|e| Error::write(folder, e))?;
    std::fs::remove_file(&probe).map_err(|e| Error::write(folder, e))
}

/// Makes a folder and those above it.
///
/// # Errors
/// [`Error::Write`].
pub fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))
}
