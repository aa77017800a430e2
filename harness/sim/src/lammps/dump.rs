//! Dumps: text files of one frame after another, each with the columns that its writer chose.

use std::iter::{Enumerate, Peekable};
use std::path::Path;
use std::str::Lines;

use super::atom::{Atom, Read, check_sphere, edges_of, id_of, image_of, number_of};
use super::atom::{push_numbers, sort_atoms};
use crate::error::{Error, Result};
use crate::files::read_text;
use crate::simulation::sphere_mass;

/// One frame of a dump: its atoms by ascending id.
#[derive(Clone, Debug, PartialEq)]
pub struct DumpFrame {
    /// Time step.
    pub step: u64,
    /// Lower edges of the box (length).
    pub lo: [f64; 3],
    /// Upper edges.
    pub hi: [f64; 3],
    /// Which axes are periodic.
    pub periodic: [bool; 3],
    /// The atoms.
    pub atoms: Vec<Atom>,
}

/// Reads every frame of a dump, plain or gzip; see [`parse_dump`].
///
/// # Errors
/// As [`parse_dump`].
pub fn read_dump(path: &Path) -> Result<Vec<DumpFrame>> {
    parse_dump(&read_text(path)?, &path.display().to_string())
}

/// Reads every frame of the text of a dump; `name` is what errors call it.
///
/// Columns come in any order: `id`, `type`, `radius` or `diameter`, `density` or `mass`, a
/// position, and perhaps `ix iy iz`, `vx vy vz` and `omegax omegay omegaz`; others are passed over.
/// Positions are `x`, scaled `xs` (lo + xs (hi - lo)), unwrapped `xu` (brought back by the image
/// count, or into the box if there is none) or both, `xsu`. Only `x`, diameter, radius, density,
/// velocity and spin keep every bit: the others are computed with.
///
/// # Errors
/// [`Error::Input`] with the line, if it is not a dump of spheres in a rectangular box.
pub fn parse_dump(text: &str, name: &str) -> Result<Vec<DumpFrame>> {
    let mut frames = Vec::new();
    each_frame(text, name, |frame| frames.push(frame))?;
    if frames.is_empty() {
        return Err(no_frame(name));
    }
    Ok(frames)
}

/// The error of a dump that holds nothing.
pub(super) fn no_frame(name: &str) -> Error {
    Error::input(name, "holds no frame; expected `ITEM: TIMESTEP` and so on")
}

/// Reads a dump frame by frame.
pub(super) fn each_frame(text: &str, name: &str, mut take: impl FnMut(DumpFrame)) -> Result<()> {
    let mut source = Source {
        lines: text.lines().enumerate().peekable(),
        line: 0,
    };
    loop {
        match source.frame() {
            Ok(Some(frame)) => take(frame),
            Ok(None) => return Ok(()),
            Err(problem) => {
                return Err(Error::input(format!("{name}:{}", source.line), problem));
            }
        }
    }
}

/// The lines of a dump and how many were taken.
struct Source<'a> {
    lines: Peekable<Enumerate<Lines<'a>>>,
    line: usize,
}

impl<'a> Source<'a> {
    fn next(&mut self) -> Option<&'a str> {
        let (number, line) = self.lines.next()?;
        self.line = number + 1;
        Some(line)
    }

    /// The next line, which an item announced.
    fn value(&mut self) -> Read<&'a str> {
        let ends = self.lines.peek().is_none_or(|l| l.1.starts_with("ITEM:"));
        if ends {
            return Err("a line is missing after this one: is the file cut off?".into());
        }
        self.next().ok_or_else(String::new)
    }

    /// The next frame, or nothing at the end of the file.
    fn frame(&mut self) -> Read<Option<DumpFrame>> {
        let (mut step, mut count, mut bounds) = (None, None, None);
        while let Some(line) = self.next() {
            if line.trim().is_empty() {
                continue;
            }
            let item = line.strip_prefix("ITEM:").ok_or_else(|| {
                format!(
                    "expected an `ITEM:` line, found `{}`",
                    shortened(line.trim())
                )
            })?;
            let words: Vec<&str> = item.split_whitespace().collect();
            match words.as_slice() {
                ["UNITS"] | ["TIME"] => {
                    self.value()?;
                }
                ["TIMESTEP"] => step = Some(whole(self.value()?.trim())?),
                ["NUMBER", "OF", "ATOMS"] => count = Some(whole(self.value()?.trim())?),
                ["BOX", "BOUNDS", rest @ ..] => bounds = Some(self.bounds(rest)?),
                ["ATOMS", names @ ..] => {
                    let step = step.ok_or("the frame has no `ITEM: TIMESTEP` before its atoms")?;
                    let count =
                        count.ok_or("the frame has no `ITEM: NUMBER OF ATOMS` before its atoms")?;
                    let bounds =
                        bounds.ok_or("the frame has no `ITEM: BOX BOUNDS` before its atoms")?;
                    return self.atoms(step, count, bounds, names).map(Some);
                }
                _ => {
                    let item = shortened(item.trim());
                    return Err(format!(
                        "item `{item}` is not understood; TIMESTEP, NUMBER OF ATOMS, BOX BOUNDS, \
                         ATOMS, UNITS and TIME are"
                    ));
                }
            }
        }
        match (step, count) {
            (None, None) => Ok(None),
            _ => Err("the last frame has no `ITEM: ATOMS`: is the file cut off?".into()),
        }
    }

    fn bounds(&mut self, words: &[&str]) -> Read<Bounds> {
        if words.len() > 3 || words.contains(&"abc") {
            return Err("tilted boxes are not understood; dump a rectangular one".into());
        }
        let mut bounds = Bounds::default();
        for (a, word) in words.iter().enumerate() {
            bounds.periodic[a] = match *word {
                "pp" => true,
                // Fixed, shrink-wrapped and shrink-wrapped with a minimum.
                w if w.len() == 2 && w.bytes().all(|b| b"fsm".contains(&b)) => false,
                _ => return Err(format!("boundary `{}` is not understood", shortened(word))),
            };
        }
        if words.len() < 3 {
            return Err(
                "expected `BOX BOUNDS pp pp ff` or the like: say which axes are periodic".into(),
            );
        }
        for a in 0..3 {
            let words: Vec<&str> = self.value()?.split_whitespace().collect();
            let &[lo, hi] = words.as_slice() else {
                let found = words.len();
                return Err(format!(
                    "expected two edges of the box, found {found} words"
                ));
            };
            [bounds.lo[a], bounds.hi[a]] = edges_of(lo, hi)?;
        }
        Ok(bounds)
    }

    fn atoms(&mut self, step: u64, count: u64, bounds: Bounds, names: &[&str]) -> Read<DumpFrame> {
        let columns = Columns::find(names)?;
        let mut atoms = Vec::new();
        for found in 0..count {
            let ends = self.lines.peek().is_none_or(|l| l.1.starts_with("ITEM:"));
            if ends {
                return Err(format!(
                    "{found} atoms found, {count} announced: is the file cut off?"
                ));
            }
            let line = self.next().unwrap_or_default();
            let words: Vec<&str> = line.split_whitespace().collect();
            if words.len() != names.len() {
                let (want, found) = (names.len(), words.len());
                return Err(format!("expected {want} columns, found {found}"));
            }
            atoms.push(columns.atom(&words, &bounds)?);
        }
        sort_atoms(&mut atoms)?;
        Ok(DumpFrame {
            step,
            lo: bounds.lo,
            hi: bounds.hi,
            periodic: bounds.periodic,
            atoms,
        })
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Bounds {
    lo: [f64; 3],
    hi: [f64; 3],
    periodic: [bool; 3],
}

/// How a coordinate is given: which column, whether scaled, whether unwrapped.
#[derive(Clone, Copy)]
struct Coordinate {
    column: usize,
    scaled: bool,
    unwrapped: bool,
}

/// Which columns hold what.
struct Columns {
    id: usize,
    kind: usize,
    /// Column, and whether it holds the radius.
    size: (usize, bool),
    /// Column, and whether it holds the mass.
    weight: (usize, bool),
    position: [Coordinate; 3],
    image: [Option<usize>; 3],
    velocity: Option<[usize; 3]>,
    spin: Option<[usize; 3]>,
}

impl Columns {
    fn find(names: &[&str]) -> Read<Self> {
        let at = |name: &str| names.iter().position(|n| *n == name);
        let needed = |name: &str| at(name).ok_or_else(|| missing(name, ""));
        let either = |name: &str, other: &str| match (at(name), at(other)) {
            (Some(column), _) => Ok((column, false)),
            (None, Some(column)) => Ok((column, true)),
            (None, None) => Err(missing(name, &format!(" or `{other}`"))),
        };
        let triple = |names: [&str; 3]| match names.map(at) {
            [None, None, None] => Ok(None),
            [Some(x), Some(y), Some(z)] => Ok(Some([x, y, z])),
            columns => {
                let a = columns.iter().position(Option::is_none).unwrap_or(0);
                Err(missing(names[a], ", as the other two components are there"))
            }
        };
        let coordinate = |axis: &str| {
            let forms = [("", false, false), ("u", false, true), ("s", true, false)];
            let given = forms.into_iter().chain([("su", true, true)]);
            let mut found = given.filter_map(|(form, scaled, unwrapped)| {
                at(&format!("{axis}{form}")).map(|column| Coordinate {
                    column,
                    scaled,
                    unwrapped,
                })
            });
            let others = format!(", `{axis}u`, `{axis}s` or `{axis}su`");
            found.next().ok_or_else(|| missing(axis, &others))
        };
        Ok(Self {
            id: needed("id")?,
            kind: needed("type")?,
            size: either("diameter", "radius")?,
            weight: either("density", "mass")?,
            position: [coordinate("x")?, coordinate("y")?, coordinate("z")?],
            image: ["ix", "iy", "iz"].map(at),
            velocity: triple(["vx", "vy", "vz"])?,
            spin: triple(["omegax", "omegay", "omegaz"])?,
        })
    }

    fn atom(&self, words: &[&str], bounds: &Bounds) -> Read<Atom> {
        let given = number_of(words[self.size.0])?;
        let diameter = if self.size.1 { 2.0 * given } else { given };
        let weight = number_of(words[self.weight.0])?;
        let density = if self.weight.1 {
            weight / sphere_mass(diameter, 1.0)
        } else {
            weight
        };
        check_sphere(diameter, density)?;
        if !diameter.is_finite() || !density.is_finite() {
            return Err("diameter and density must be finite".into());
        }
        let (mut position, mut image) = ([0.0; 3], [0; 3]);
        for a in 0..3 {
            let counted = self.image[a].map(|column| image_of(words[column]));
            let raw = number_of(words[self.position[a].column])?;
            (position[a], image[a]) =
                self.position[a].place(raw, counted.transpose()?, bounds, a)?;
        }
        let vector = |columns: Option<[usize; 3]>| -> Read<[f64; 3]> {
            let mut out = [0.0; 3];
            for (x, column) in out.iter_mut().zip(columns.into_iter().flatten()) {
                *x = number_of(words[column])?;
            }
            Ok(out)
        };
        Ok(Atom {
            id: id_of(words[self.id])?,
            kind: id_of(words[self.kind])?,
            diameter,
            density,
            position,
            image,
            velocity: vector(self.velocity)?,
            spin: vector(self.spin)?,
        })
    }
}

impl Coordinate {
    /// Position along axis `a` and crossings of it.
    fn place(&self, raw: f64, counted: Option<i32>, bounds: &Bounds, a: usize) -> Read<(f64, i32)> {
        let (lo, length) = (bounds.lo[a], bounds.hi[a] - bounds.lo[a]);
        let far = || format!("coordinate {raw:?} is too far away to compute with");
        let x = if self.scaled { lo + raw * length } else { raw };
        let (x, image) = if self.unwrapped && bounds.periodic[a] {
            let crossed = counted.map_or_else(|| ((x - lo) / length).floor(), f64::from);
            if crossed.abs() > f64::from(i32::MAX) {
                return Err(far());
            }
            (x - crossed * length, crossed as i32)
        } else {
            (x, counted.unwrap_or(0))
        };
        if x.is_finite() {
            Ok((x, image))
        } else {
            Err(far())
        }
    }
}

fn missing(name: &str, others: &str) -> String {
    format!("there is no column `{name}`{others}; add it to the dump's columns")
}

fn whole(word: &str) -> Read<u64> {
    let read = word.parse::<u64>();
    read.map_err(|_| format!("`{}` is not a whole number", shortened(word)))
}

/// The beginning of a word or line that may be as long as a file.
fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}

/// The text of one frame, to be appended to others; a force for each atom if there is one.
///
/// Columns: id, type, radius, density, position, image counts, velocity, spin and perhaps force.
pub fn dump_text(frame: &DumpFrame, forces: Option<&[[f64; 3]]>) -> String {
    let boundary = frame.periodic.map(|p| if p { "pp" } else { "ff" });
    let mut out = format!(
        "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS {}\n",
        frame.step,
        frame.atoms.len(),
        boundary.join(" ")
    );
    for a in 0..3 {
        out.push_str(&format!("{:?} {:?}\n", frame.lo[a], frame.hi[a]));
    }
    out.push_str("ITEM: ATOMS id type radius density x y z ix iy iz vx vy vz omegax omegay omegaz");
    out.push_str(if forces.is_some() {
        " fx fy fz\n"
    } else {
        "\n"
    });
    for (k, atom) in frame.atoms.iter().enumerate() {
        out.push_str(&format!("{} {}", atom.id, atom.kind));
        push_numbers(&mut out, &[0.5 * atom.diameter, atom.density]);
        push_numbers(&mut out, &atom.position);
        let [ix, iy, iz] = atom.image;
        out.push_str(&format!(" {ix} {iy} {iz}"));
        push_numbers(&mut out, &atom.velocity);
        push_numbers(&mut out, &atom.spin);
        if let Some(forces) = forces {
            push_numbers(&mut out, &forces.get(k).copied().unwrap_or_default());
        }
        out.push('\n');
    }
    out
}
