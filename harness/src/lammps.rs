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
    let mut parts = Parts::default();
    let mut section = Section::Header;
    let mut last = 0;
    for (number, raw) in text.lines().enumerate() {
        last = number + 1;
        let content = raw.split('#').next().unwrap_or("").trim();
        // The first line is a title whatever it says.
        if number == 0 || content.is_empty() {
            continue;
        }
        let words: Vec<&str> = content.split_whitespace().collect();
        let read = match (Section::begin(&words, raw), section) {
            (Some(begun), _) => begun.map(|begun| section = begun),
            (None, Section::Header) => parts.header(&words),
            (None, Section::Atoms) => parts.atom(&words),
            (None, Section::Velocities) => parts.velocity(&words, last),
        };
        read.map_err(|problem| Error::input(format!("{name}:{last}"), problem))?;
    }
    parts
        .finish(last)
        .map_err(|(line, problem)| Error::input(format!("{name}:{line}"), problem))
}

type Read<T> = std::result::Result<T, String>;

/// Part of a data file.
#[derive(Clone, Copy)]
enum Section {
    Header,
    Atoms,
    Velocities,
}

impl Section {
    /// The section that a line begins, if it begins one.
    fn begin(words: &[&str], raw: &str) -> Option<Read<Self>> {
        if !words[0].starts_with(|c: char| c.is_ascii_alphabetic()) {
            return None;
        }
        let style = raw.split('#').nth(1).map(str::trim);
        Some(match words[0] {
            "Atoms" if style.is_some_and(|s| s != "sphere") => {
                Err("expected `Atoms # sphere`".into())
            }
            "Atoms" => Ok(Section::Atoms),
            "Velocities" => Ok(Section::Velocities),
            _ => Err(format!(
                "section `{}` is not understood; Atoms (sphere) and Velocities are",
                words.join(" ")
            )),
        })
    }
}

/// What has been read so far.
#[derive(Default)]
struct Parts {
    expected: Option<usize>,
    lo: [f64; 3],
    hi: [f64; 3],
    edges: [bool; 3],
    atoms: Vec<Atom>,
    /// Id, velocity and spin, line.
    velocities: Vec<(u32, [f64; 6], usize)>,
}

impl Parts {
    fn header(&mut self, words: &[&str]) -> Read<()> {
        let strange = || format!("`{}` is not understood", words.join(" "));
        if words.len() == 2 && words[1] == "atoms" {
            let count = words[0].parse::<usize>();
            self.expected = Some(count.map_err(|_| format!("`{}` is not a count", words[0]))?);
        } else if words.len() == 4 {
            let axis = ["xlo", "ylo", "zlo"].iter().position(|w| *w == words[2]);
            let a = axis.ok_or_else(strange)?;
            if words[3] != ["xhi", "yhi", "zhi"][a] {
                return Err(strange());
            }
            self.lo[a] = number_of(words[0])?;
            self.hi[a] = number_of(words[1])?;
            self.edges[a] = true;
            if self.lo[a] >= self.hi[a] {
                return Err("the lower edge must lie below the upper".into());
            }
        } else if words.len() == 6 {
            return Err("tilted boxes are not understood".into());
        }
        Ok(())
    }

    fn atom(&mut self, words: &[&str]) -> Read<()> {
        if words.len() != 7 && words.len() != 10 {
            return Err(format!(
                "expected id, type, diameter, density, x, y, z (and perhaps three image counts), \
                 found {} words",
                words.len()
            ));
        }
        if words[7..].iter().any(|w| w.parse::<i32>().is_err()) {
            return Err("image counts must be whole numbers".into());
        }
        let [diameter, density, x, y, z] = numbers::<5>(&words[2..7])?;
        if diameter <= 0.0 || density <= 0.0 {
            return Err("diameter and density must be positive".into());
        }
        self.atoms.push(Atom {
            id: id_of(words[0])?,
            kind: id_of(words[1])?,
            diameter,
            density,
            position: [x, y, z],
            velocity: [0.0; 3],
            spin: [0.0; 3],
        });
        Ok(())
    }

    fn velocity(&mut self, words: &[&str], line: usize) -> Read<()> {
        if words.len() != 7 {
            let found = words.len();
            return Err(format!(
                "expected id, velocity and spin (7 words), found {found}"
            ));
        }
        let numbers = numbers::<6>(&words[1..])?;
        self.velocities.push((id_of(words[0])?, numbers, line));
        Ok(())
    }

    /// Puts the parts together; an error comes with its line.
    fn finish(mut self, last: usize) -> std::result::Result<DataFile, (usize, String)> {
        if let Some(a) = self.edges.iter().position(|e| !e) {
            let axis = ["x", "y", "z"][a];
            return Err((last, format!("the box has no `{axis}lo {axis}hi` line")));
        }
        let found = self.atoms.len();
        if self.expected != Some(found) {
            let want = self
                .expected
                .map_or("no `atoms` line".into(), |n| format!("{n} announced"));
            return Err((
                last,
                format!("{found} atoms found, {want}: is the file cut off?"),
            ));
        }
        self.atoms.sort_by_key(|a| a.id);
        if let Some(pair) = self.atoms.windows(2).find(|p| p[0].id == p[1].id) {
            return Err((last, format!("atom id {} appears twice", pair[0].id)));
        }
        self.velocities.sort_by_key(|(id, _, line)| (*id, *line));
        if let Some(pair) = self.velocities.windows(2).find(|p| p[0].0 == p[1].0) {
            let (id, _, line) = pair[1];
            return Err((line, format!("the velocity of atom {id} appears twice")));
        }
        let given = self.velocities.len();
        if given != 0 && given != found {
            let problem = format!("{given} velocities for {found} atoms: is the file cut off?");
            return Err((last, problem));
        }
        for (atom, (id, v, line)) in self.atoms.iter_mut().zip(self.velocities) {
            if atom.id != id {
                let problem = format!("velocity of atom {id}, which is not among the atoms");
                return Err((line, problem));
            }
            atom.velocity = [v[0], v[1], v[2]];
            atom.spin = [v[3], v[4], v[5]];
        }
        Ok(DataFile {
            lo: self.lo,
            hi: self.hi,
            atoms: self.atoms,
        })
    }
}

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
