//! LAMMPS files, atom_style sphere: data files and dumps, read and written, so that beds come from
//! and go to others (LAMMPS, LIGGGHTS, OVITO, VMD).
//!
//! Numbers are written as the shortest decimal that reads back to the same bits, here and in
//! LAMMPS.

use std::path::Path;

use crate::error::Result;
use crate::files::read_text;

mod data;
mod dump;

pub use data::{data_text, parse_data, read_data};
pub use dump::{Frame, dump_text, parse_dump, read_dump};

/// One atom of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Atom {
    /// Name.
    pub id: u32,
    /// Type, from 1.
    pub kind: u32,
    /// Diameter (length).
    pub diameter: f64,
    /// Mass density.
    pub density: f64,
    /// Position (length).
    pub position: [f64; 3],
    /// Crossings of the periodic axes so far, zero where the file gives none.
    pub image: [i32; 3],
    /// Velocity, zero where the file gives none.
    pub velocity: [f64; 3],
    /// Spin, zero where the file gives none.
    pub spin: [f64; 3],
}

/// A data file: its box and its atoms by ascending id.
#[derive(Clone, Debug, PartialEq)]
pub struct DataFile {
    /// Lower edges.
    pub lo: [f64; 3],
    /// Upper edges.
    pub hi: [f64; 3],
    /// Which axes are periodic, where the file says so: a dump does, a data file does not.
    pub periodic: Option<[bool; 3]>,
    /// The atoms.
    pub atoms: Vec<Atom>,
}

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

/// What reading a part gave, or what is wrong with it; the place is told elsewhere.
type Read<T> = std::result::Result<T, String>;

fn number_of(word: &str) -> Read<f64> {
    match word.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{word}` is not a finite number")),
    }
}

fn numbers<const N: usize>(words: &[&str]) -> Read<[f64; N]> {
    let mut out = [0.0; N];
    for (k, word) in words.iter().enumerate() {
        out[k] = number_of(word)?;
    }
    Ok(out)
}

fn id_of(word: &str) -> Read<u32> {
    match word.parse::<u32>() {
        Ok(id) if id > 0 => Ok(id),
        _ => Err(format!("`{word}` is not a positive whole number")),
    }
}

fn image_of(word: &str) -> Read<i32> {
    let read = word.parse::<i32>();
    read.map_err(|_| format!("image count `{word}` is not a whole number"))
}

/// Checks the edges of one axis.
fn edges_of(lo: &str, hi: &str) -> Read<[f64; 2]> {
    let [lo, hi] = numbers::<2>(&[lo, hi])?;
    if lo >= hi {
        return Err("the lower edge must lie below the upper".into());
    }
    if !(hi - lo).is_finite() {
        return Err("the box is too long to compute with".into());
    }
    Ok([lo, hi])
}

/// Checks what a sphere is made of.
fn check_sphere(diameter: f64, density: f64) -> Read<()> {
    if diameter <= 0.0 || density <= 0.0 {
        return Err("diameter and density must be positive".into());
    }
    // Files give the radius or the diameter; from one to the other no bit may be lost.
    if !(0.5 * diameter).is_normal() {
        return Err(format!("the diameter {diameter:?} is too small to halve"));
    }
    Ok(())
}

/// Sorts atoms by id; an id that appears twice is refused.
fn sort_atoms(atoms: &mut [Atom]) -> Read<()> {
    atoms.sort_by_key(|a| a.id);
    match atoms.windows(2).find(|p| p[0].id == p[1].id) {
        Some(pair) => Err(format!("atom id {} appears twice", pair[0].id)),
        None => Ok(()),
    }
}

/// Words of a line: numbers as the shortest decimals that read back to the same bits. `{:?}` and
/// not `{}`: with an exponent a number has at most 24 characters, and LAMMPS' lines are limited.
fn push_numbers(line: &mut String, numbers: &[f64]) {
    for x in numbers {
        line.push(' ');
        line.push_str(&format!("{x:?}"));
    }
}
