//! Files read whole, packed or plain, and written whole: beside the old one, then renamed, so that a
//! reader never sees half a file.

use std::io::{Read, Write};
use std::path::Path;

use crate::error::{Error, Result};

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
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    // Two processes never write into one file.
    name.push(format!(".{}.partial", std::process::id()));
    let partial = folder.join(name);
    let written = std::fs::File::create(&partial).and_then(|mut file| {
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

/// Makes a folder and those above it.
///
/// # Errors
/// [`Error::Write`].
pub fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|e| Error::write(folder, e))
}
