//! LAMMPS files, atom_style sphere: data files and dumps, read and written, so that beds come from
//! and go to others (LAMMPS, LIGGGHTS, OVITO, VMD).
//!
//! Numbers are written as the shortest decimal that reads back to the same bits, here and in
//! LAMMPS.

use std::path::Path;

use crate::error::Result;
use crate::files::read_text;

mod atom;
mod data;
mod dump;

pub use atom::{Atom, DataFile};
pub use data::{data_text, parse_data, read_data};
pub use dump::{DumpFrame, dump_text, parse_dump, read_dump};

/// Reads a data file, or the last frame of a dump, plain or gzip: the first line says which it is.
///
/// # Errors
/// [`crate::error::Error::Input`] with the line, as [`read_data`] and [`read_dump`].
pub fn read_atoms(path: &Path) -> Result<DataFile> {
    parse_atoms(&read_text(path)?, &path.display().to_string())
}

/// Reads the text of a data file, or the last frame of that of a dump; `name` is what errors call
/// it.
///
/// # Errors
/// As [`read_atoms`].
pub fn parse_atoms(text: &str, name: &str) -> Result<DataFile> {
    // A data file begins with a title, a dump with an item.
    if !text.starts_with("ITEM:") {
        return parse_data(text, name);
    }
    // A long dump is read frame by frame, so that two of them are in memory at most.
    let mut last = None;
    dump::each_frame(text, name, |frame| last = Some(frame))?;
    let frame = last.ok_or_else(|| dump::no_frame(name))?;
    Ok(DataFile {
        lo: frame.lo,
        hi: frame.hi,
        periodic: Some(frame.periodic),
        atoms: frame.atoms,
    })
}
