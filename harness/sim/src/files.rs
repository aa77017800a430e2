//! Texts in files, packed or plain, on top of [`crate::disk`].

use std::io::Write;
use std::path::{Path, PathBuf};

use bitgrain_kernel::BITS_VERSION;
use flate2::Compression;
use flate2::write::GzEncoder;

use crate::disk::{all_of, read, write_whole};
use crate::error::{Error, Result};
use crate::memory::room;

/// Most bytes of memory that a byte of text takes once read: for a case in JSON 11 were measured.
const MEMORY_OF_TEXT: f64 = 12.0;

/// What every file of results says somewhere: the arithmetic that it was made with.
pub fn bits() -> String {
    format!("BITS_VERSION {BITS_VERSION}")
}

/// Reads a whole file, unpacking gzip if its first bytes say so.
///
/// # Errors
/// [`Error::Input`] if it cannot be read or unpacked, or is larger than [`crate::disk::most`]; [`Error::Memory`].
pub fn read_text(path: &Path) -> Result<String> {
    text_of(read(path)?, &path.display().to_string())
}

/// The bytes of a file as text, unpacked if their first bytes say that they are gzip; `name`
/// is what errors call it.
///
/// # Errors
/// [`Error::Input`] if they cannot be unpacked, are too many, or are not text; [`Error::Memory`] if there is no
/// room for what is read from them.
pub fn text_of(bytes: Vec<u8>, name: &str) -> Result<String> {
    let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
        let place = || name.to_string();
        let gzip = flate2::read::MultiGzDecoder::new(bytes.as_slice());
        all_of(gzip, 0, "the gzip data is damaged or cut off", &place)?
    } else {
        bytes
    };
    let what = format!("{name}, read into numbers");
    room(bytes.len() as f64 * MEMORY_OF_TEXT, &what)?;
    String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        let problem = format!("byte {at} is not text (UTF-8 was expected)");
        Error::input(name, problem)
    })
}

/// The file that a text is kept in: its path and its bytes; if `packed` with `.gz` at its end, packed with
/// gzip: the same bytes every time, without a date or a name in them.
///
/// # Errors
/// [`Error::Write`] if packing fails.
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

/// Writes text to `path`, or if `packed` to the name that [`text_file`] gives it.
///
/// # Errors
/// As [`write_whole`].
pub fn write_text(path: &Path, text: &str, packed: bool) -> Result<()> {
    let (path, bytes) = text_file(path, text, packed)?;
    write_whole(&path, &bytes)
}

/// The path with `.gz` at its end.
pub fn packed_name(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_os_string();
    name.push(".gz");
    PathBuf::from(name)
}

/// A number of a table; `None` if it is not a finite number.
pub fn finite(word: &str) -> Option<f64> {
    word.parse().ok().filter(|x: &f64| x.is_finite())
}
