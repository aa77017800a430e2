//! Data files: the beds that other programs exchange.

use std::path::Path;

use super::atom::{Atom, DataFile, Read, check_sphere, edges_of, id_of, image_of, numbers};
use super::atom::{push_numbers, sort_atoms};
use crate::error::{Error, Result};
use crate::files::read_text;

/// Reads a LAMMPS data file, plain or gzip.
///
/// What LAMMPS' own `write_data` writes is read too, coefficients and type labels passed over.
/// LAMMPS keeps mass and radius and writes mass over volume as the density, so only a density of 1
/// (or another power of two) comes back from it to the bit; 2500, say, may come back as its
/// neighbour.
///
/// # Errors
/// [`Error::Input`] with the line, if it is not a data file of `atom_style sphere`.
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
            (None, Section::PassedOver) => Ok(()),
        };
        read.map_err(|problem| Error::input(format!("{name}:{last}"), problem))?;
    }
    parts
        .finish(last)
        .map_err(|(line, problem)| Error::input(format!("{name}:{line}"), problem))
}

/// Part of a data file.
#[derive(Clone, Copy)]
enum Section {
    Header,
    Atoms,
    Velocities,
    /// Coefficients of force fields and names of types: no part of a bed.
    PassedOver,
}

impl Section {
    /// The section that a line begins, if it begins one.
    fn begin(words: &[&str], raw: &str) -> Option<Read<Self>> {
        if !words[0].starts_with(|c: char| c.is_ascii_alphabetic()) {
            return None;
        }
        let style = raw.split('#').nth(1).map(str::trim);
        Some(match (words.join(" ").as_str(), style) {
            ("Atoms", Some(style)) if style != "sphere" => Err(format!(
                "expected `Atoms # sphere`, found style `{style}`; write the file with \
                 `atom_style sphere`"
            )),
            ("Atoms", _) => Ok(Section::Atoms),
            ("Velocities", _) => Ok(Section::Velocities),
            ("Pair Coeffs" | "PairIJ Coeffs" | "Atom Type Labels", _) => Ok(Section::PassedOver),
            ("Masses", _) => Err(
                "section `Masses` gives a mass to each type, but spheres need a \
                 diameter and density each; write the file with `atom_style sphere`"
                    .into(),
            ),
            (other, _) => Err(format!(
                "section `{other}` is not understood; Atoms (sphere) and Velocities are"
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
            [self.lo[a], self.hi[a]] = edges_of(words[0], words[1])?;
            self.edges[a] = true;
        } else if words.len() == 6 {
            return Err("tilted boxes are not understood; leave `xy xz yz` out".into());
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
        let [diameter, density, x, y, z] = numbers::<5>(&words[2..7])?;
        check_sphere(diameter, density)?;
        let mut image = [0; 3];
        for (count, word) in image.iter_mut().zip(&words[7..]) {
            *count = image_of(word)?;
        }
        self.atoms.push(Atom {
            id: id_of(words[0])?,
            kind: id_of(words[1])?,
            diameter,
            density,
            position: [x, y, z],
            image,
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
        sort_atoms(&mut self.atoms).map_err(|problem| (last, problem))?;
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
            periodic: None,
            atoms: self.atoms,
        })
    }
}

/// The longest title that LAMMPS reads whole is somewhat longer.
const TITLE: usize = 200;

/// The text of a data file that LAMMPS reads with `atom_style sphere`: the atoms with their image
/// counts, their velocities and spins.
///
/// It holds no word on periodic axes (`boundary p p f` says that to LAMMPS), and LAMMPS as it is
/// usually built keeps image counts from -512 to 511 only.
pub fn data_text(data: &DataFile, title: &str) -> String {
    let title: String = title
        .chars()
        .map(|c| if c.is_ascii_graphic() { c } else { ' ' })
        .take(TITLE)
        .collect();
    let types = data.atoms.iter().map(|a| a.kind).max().unwrap_or(1);
    let count = data.atoms.len();
    // A title that looks like a dump's first line would be taken for one.
    let mut out = format!("# {title}\n\n{count} atoms\n{types} atom types\n\n");
    for (a, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let (lo, hi) = (data.lo[a], data.hi[a]);
        out.push_str(&format!("{lo:?} {hi:?} {axis}lo {axis}hi\n"));
    }
    if count == 0 {
        return out;
    }
    out.push_str("\nAtoms # sphere\n\n");
    for atom in &data.atoms {
        out.push_str(&format!("{} {}", atom.id, atom.kind));
        push_numbers(&mut out, &[atom.diameter, atom.density]);
        push_numbers(&mut out, &atom.position);
        let [ix, iy, iz] = atom.image;
        out.push_str(&format!(" {ix} {iy} {iz}\n"));
    }
    out.push_str("\nVelocities\n\n");
    for atom in &data.atoms {
        out.push_str(&atom.id.to_string());
        push_numbers(&mut out, &atom.velocity);
        push_numbers(&mut out, &atom.spin);
        out.push('\n');
    }
    out
}
