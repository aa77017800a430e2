//! Atoms and the words that they are written in.

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
    /// Crossings of the periodic axes so far, zero if the file gives none.
    pub image: [i32; 3],
    /// Velocity, zero if the file gives none.
    pub velocity: [f64; 3],
    /// Spin, zero if the file gives none.
    pub spin: [f64; 3],
}

/// A data file: its box and its atoms by ascending id.
#[derive(Clone, Debug, PartialEq)]
pub struct DataFile {
    /// Lower edges.
    pub lo: [f64; 3],
    /// Upper edges.
    pub hi: [f64; 3],
    /// Which axes are periodic, if the file says so: a dump does, a data file does not.
    pub periodic: Option<[bool; 3]>,
    /// The atoms.
    pub atoms: Vec<Atom>,
}

/// What reading a part gave, or what is wrong with it; the place is added by the caller.
pub(super) type Read<T> = std::result::Result<T, String>;

pub(super) fn number_of(word: &str) -> Read<f64> {
    match word.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{word}` is not a finite number")),
    }
}

pub(super) fn numbers<const N: usize>(words: &[&str]) -> Read<[f64; N]> {
    let mut out = [0.0; N];
    for (k, word) in words.iter().enumerate() {
        out[k] = number_of(word)?;
    }
    Ok(out)
}

pub(super) fn id_of(word: &str) -> Read<u32> {
    match word.parse::<u32>() {
        Ok(id) if id > 0 => Ok(id),
        _ => Err(format!("`{word}` is not a positive whole number")),
    }
}

pub(super) fn image_of(word: &str) -> Read<i32> {
    let read = word.parse::<i32>();
    read.map_err(|_| format!("image count `{word}` is not a whole number"))
}

/// Checks the edges of one axis.
pub(super) fn edges_of(lo: &str, hi: &str) -> Read<[f64; 2]> {
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
pub(super) fn check_sphere(diameter: f64, density: f64) -> Read<()> {
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
pub(super) fn sort_atoms(atoms: &mut [Atom]) -> Read<()> {
    atoms.sort_by_key(|a| a.id);
    match atoms.windows(2).find(|p| p[0].id == p[1].id) {
        Some(pair) => Err(format!("atom id {} appears twice", pair[0].id)),
        None => Ok(()),
    }
}

/// Words of a line: numbers as the shortest decimals that read back to the same bits. `{:?}` and
/// not `{}`: with an exponent a number has at most 24 characters, and LAMMPS' lines are limited.
pub(super) fn push_numbers(line: &mut String, numbers: &[f64]) {
    for x in numbers {
        line.push(' ');
        line.push_str(&format!("{x:?}"));
    }
}
