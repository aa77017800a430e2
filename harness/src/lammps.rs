//! LAMMPS data files, atom_style sphere: the beds that others hand around.

use std::path::Path;

use crate::error::{Error, Result};
use crate::files::read_text;

/// One atom of a data file.
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
    /// The atoms.
    pub atoms: Vec<Atom>,
}

/// Reads a LAMMPS data file, plain or gzip.
///
/// # Errors
/// [`Error::Input`] with the line, where it is not a data file of `atom_style sphere`.
pub fn read_data(path: &Path) -> Result<DataFile> {
    parse_data(&read_text(path)?, &path.display().to_string())
}

/// Reads the text of a data file; `name` is what errors call it.
///
/// # Errors
/// As [`read_data`].
pub fn parse_data(text: &str, name: &str) -> Result<DataFile> {
    let fail = |line: usize, problem: String| Error::input(format!("{name}:{line}"), problem);
    let mut expected = None;
    let (mut lo, mut hi) = ([0.0; 3], [0.0; 3]);
    let mut edges = [false; 3];
    let mut atoms: Vec<Atom> = Vec::new();
    let mut section = String::new();
    let mut velocities: Vec<(u32, [f64; 6], usize)> = Vec::new();
    let mut last = 0;
    for (number, raw) in text.lines().enumerate() {
        let line = number + 1;
        last = line;
        let content = raw.split('#').next().unwrap_or("").trim();
        // The first line is a title whatever it says.
        if line == 1 || content.is_empty() {
            continue;
        }
        let words: Vec<&str> = content.split_whitespace().collect();
        if words[0].starts_with(|c: char| c.is_ascii_alphabetic()) {
            if !matches!(words[0], "Atoms" | "Velocities") {
                return Err(fail(
                    line,
                    format!(
                        "section `{content}` is not understood; Atoms (sphere) and Velocities are"
                    ),
                ));
            }
            let style = raw.split('#').nth(1).map(str::trim);
            if words[0] == "Atoms" && style.is_some_and(|s| s != "sphere") {
                return Err(fail(line, "expected `Atoms # sphere`".into()));
            }
            section = words[0].to_string();
            continue;
        }
        match section.as_str() {
            "" => {
                if words.len() == 2 && words[1] == "atoms" {
                    let n = words[0].parse::<usize>();
                    expected =
                        Some(n.map_err(|_| fail(line, format!("`{}` is not a count", words[0])))?);
                } else if words.len() == 4 {
                    let axis = ["xlo", "ylo", "zlo"].iter().position(|w| *w == words[2]);
                    let Some(a) = axis else {
                        return Err(fail(line, format!("`{content}` is not understood")));
                    };
                    if words[3] != ["xhi", "yhi", "zhi"][a] {
                        return Err(fail(line, format!("`{content}` is not understood")));
                    }
                    lo[a] = number_of(words[0]).map_err(|p| fail(line, p))?;
                    hi[a] = number_of(words[1]).map_err(|p| fail(line, p))?;
                    if lo[a] >= hi[a] {
                        return Err(fail(line, "the lower edge must lie below the upper".into()));
                    }
                    edges[a] = true;
                } else if words.len() == 6 {
                    return Err(fail(line, "tilted boxes are not understood".into()));
                }
            }
            "Atoms" => {
                if words.len() != 7 && words.len() != 10 {
                    return Err(fail(
                        line,
                        format!(
                            "expected id, type, diameter, density, x, y, z (and perhaps three image counts), found {} words",
                            words.len()
                        ),
                    ));
                }
                if words[7..].iter().any(|w| w.parse::<i32>().is_err()) {
                    return Err(fail(line, "image counts must be whole numbers".into()));
                }
                let v = numbers::<5>(&words[2..7]).map_err(|p| fail(line, p))?;
                if v[0] <= 0.0 || v[1] <= 0.0 {
                    return Err(fail(line, "diameter and density must be positive".into()));
                }
                atoms.push(Atom {
                    id: id_of(words[0]).map_err(|p| fail(line, p))?,
                    kind: id_of(words[1]).map_err(|p| fail(line, p))?,
                    diameter: v[0],
                    density: v[1],
                    position: [v[2], v[3], v[4]],
                    velocity: [0.0; 3],
                    spin: [0.0; 3],
                });
            }
            _ => {
                if words.len() != 7 {
                    return Err(fail(
                        line,
                        format!(
                            "expected id, velocity and spin (7 words), found {}",
                            words.len()
                        ),
                    ));
                }
                let id = id_of(words[0]).map_err(|p| fail(line, p))?;
                velocities.push((
                    id,
                    numbers::<6>(&words[1..]).map_err(|p| fail(line, p))?,
                    line,
                ));
            }
        }
    }
    if let Some(a) = edges.iter().position(|e| !e) {
        let axis = ["x", "y", "z"][a];
        return Err(fail(
            last,
            format!("the box has no `{axis}lo {axis}hi` line"),
        ));
    }
    if expected != Some(atoms.len()) {
        let want = expected.map_or("no `atoms` line".into(), |n| format!("{n} announced"));
        return Err(fail(
            last,
            format!("{} atoms found, {want}: is the file cut off?", atoms.len()),
        ));
    }
    atoms.sort_by_key(|a| a.id);
    if let Some(pair) = atoms.windows(2).find(|p| p[0].id == p[1].id) {
        return Err(fail(last, format!("atom id {} appears twice", pair[0].id)));
    }
    if !velocities.is_empty() && velocities.len() != atoms.len() {
        return Err(fail(
            last,
            format!(
                "{} velocities for {} atoms: is the file cut off?",
                velocities.len(),
                atoms.len()
            ),
        ));
    }
    let mut seen: Vec<u32> = velocities.iter().map(|(id, ..)| *id).collect();
    seen.sort_unstable();
    if let Some(pair) = seen.windows(2).find(|p| p[0] == p[1]) {
        return Err(fail(
            last,
            format!("the velocity of atom {} appears twice", pair[0]),
        ));
    }
    for (id, v, line) in velocities {
        let Ok(at) = atoms.binary_search_by_key(&id, |a| a.id) else {
            return Err(fail(
                line,
                format!("velocity of atom {id}, which is not among the atoms"),
            ));
        };
        atoms[at].velocity = [v[0], v[1], v[2]];
        atoms[at].spin = [v[3], v[4], v[5]];
    }
    Ok(DataFile { lo, hi, atoms })
}

fn number_of(word: &str) -> std::result::Result<f64, String> {
    match word.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("`{word}` is not a finite number")),
    }
}

fn numbers<const N: usize>(words: &[&str]) -> std::result::Result<[f64; N], String> {
    let mut out = [0.0; N];
    for (k, word) in words.iter().enumerate() {
        out[k] = number_of(word)?;
    }
    Ok(out)
}

fn id_of(word: &str) -> std::result::Result<u32, String> {
    match word.parse::<u32>() {
        Ok(id) if id > 0 => Ok(id),
        _ => Err(format!("`{word}` is not a positive whole number")),
    }
}
