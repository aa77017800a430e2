//! What a bed's file says of the scenario that names it: box, grains and intruder.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::Scenario;
use crate::manifest::FAILURE;
use bitgrain_sim::below::Below;
use bitgrain_sim::disk::{self, PARTIAL};
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::export::{LID_TYPE, OBSTACLE_TYPE as INTRUDER_TYPE};
use bitgrain_sim::files::read_text;
use bitgrain_sim::lammps::{Atom, DataFile, parse_atoms};
use bitgrain_sim::simulation::hex;

/// Largest relative difference between a number of the file and of the scenario that still counts as
/// the same: programs that store a mass give a density back with its last digits changed.
const SAME: f64 = 1e-9;

/// Where the file of an imported bed is looked for.
#[derive(Clone, Copy)]
pub(crate) enum BedFile<'a> {
    /// Where `bed.file` says, from this folder on.
    From(&'a Path),
    /// Nowhere but below this folder of a run, which has a copy of that name in `beds/imported`.
    CopiedIn(&'a Path),
}

impl BedFile<'_> {
    /// The path of a file that a scenario names.
    fn path(self, file: &str) -> Result<PathBuf> {
        match self {
            BedFile::From(folder) => Ok(folder.join(file)),
            BedFile::CopiedIn(run) => {
                let name = Path::new(file).file_name().unwrap_or_default();
                let path = run.join("beds/imported").join(name);
                Below(run).check_file(&path)?;
                Ok(path)
            }
        }
    }
}

/// If `bed.file` names a file, fills in the keys that the file knows and the scenario leaves out,
/// and refuses those that it contradicts. Returns where the file is, and its grains.
///
/// # Errors
/// [`Error::Input`] if the file cannot be read, is not a bed, or is not what the scenario says.
pub(super) fn fill_in(
    table: &mut Table,
    place: &str,
    from: BedFile<'_>,
) -> Result<Option<(PathBuf, Vec<Atom>)>> {
    let Some(Value::String(file)) = table.get("bed").and_then(|bed| bed.get("file")) else {
        return Ok(None);
    };
    let path = from.path(file)?;
    check_name(&path).map_err(|problem| Error::input(format!("{place}: `bed.file`"), problem))?;
    if matches!(from, BedFile::CopiedIn(_)) && !disk::is_there(&path) {
        let problem = format!(
            "{} is not there: of the file that a scenario names the folder of its run has a copy, and no other is \
             read; the command that began the run makes it",
            path.display()
        );
        return Err(Error::input(format!("{place}: `bed.file`"), problem));
    }
    if !disk::is_file(&path) {
        let problem = format!(
            "{} does not exist or is not a file; paths are relative to the folder of the \
             scenario's file, with --set to the current folder",
            path.display()
        );
        return Err(Error::input(format!("{place}: `bed.file`"), problem));
    }
    let text = read_text(&path)?;
    let name = path.display().to_string();
    let data = parse_atoms(&text, &name)?;
    let wrong = |what: String| Error::input(name.clone(), what);
    let (intruder, grains) = split(&data).map_err(wrong)?;
    let mut keys = Keys { table, place };
    if keys.get("intruder", "depth").is_some() {
        let problem = "the intruder's place comes with the bed's file; leave it out";
        return Err(Error::input(format!("{place}: `intruder.depth`"), problem));
    }
    keys.same("bed", "hash", Value::from(hash(&text)))?;
    let size = [0, 1, 2].map(|a| Value::from(data.hi[a] - data.lo[a]));
    keys.same("bed", "box", Value::Array(size.into()))?;
    keys.same("bed", "grains", Value::from(grains.len() as i64))?;
    // What is frozen is of type 3, wherever it lies.
    keys.same("bed", "base", Value::from(0.0))?;
    keys.set("bed", "floor", Value::from(false));
    keys.set("drag", "history", Value::from("empty"));
    keys.same("intruder", "diameter", Value::from(intruder.diameter))?;
    keys.same("intruder", "density", Value::from(intruder.density))?;
    keys.same("intruder", "height", Value::from(intruder.position[2]))?;
    Ok(Some((path, grains)))
}

/// Refuses a name that a run, which has a copy of the file, gives to files of its own, or that no manifest can list.
fn check_name(path: &Path) -> std::result::Result<(), String> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    if name != FAILURE && !disk::is_partial(&name) && !name.contains('\\') {
        return Ok(());
    }
    Err(format!(
        "{} has a name that a run cannot give to its copy: give the file one that is not `{FAILURE}`, does not end \
         in `{PARTIAL}`, and has no backslash",
        path.display()
    ))
}

/// The scenario's table as it is filled in.
struct Keys<'a> {
    table: &'a mut Table,
    place: &'a str,
}

impl Keys<'_> {
    /// Sets a key that is left out.
    fn set(&mut self, outer: &str, inner: &str, value: Value) {
        let outer = self
            .table
            .entry(outer)
            .or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(outer) = outer {
            outer.entry(inner).or_insert(value);
        }
    }

    fn get(&self, outer: &str, inner: &str) -> Option<&Value> {
        self.table.get(outer)?.get(inner)
    }

    fn refuse(&self, outer: &str, inner: &str, given: &Value, found: &Value) -> Error {
        Error::input(
            format!("{}: `{outer}.{inner}`", self.place),
            format!(
                "is {given}, but the bed's file has {found}; leave it out, or check which is right"
            ),
        )
    }

    /// Sets a key that is left out, or checks that it says the same.
    fn same(&mut self, outer: &str, inner: &str, value: Value) -> Result<()> {
        if let Some(given) = self.get(outer, inner).filter(|given| !alike(given, &value)) {
            return Err(self.refuse(outer, inner, given, &value));
        }
        self.set(outer, inner, value);
        Ok(())
    }
}

/// Whether two values say the same: numbers to [`SAME`], lists one by one.
fn alike(a: &Value, b: &Value) -> bool {
    let number = |v: &Value| v.as_float().or(v.as_integer().map(|n| n as f64));
    match (a, b) {
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| alike(a, b))
        }
        _ => match (number(a), number(b)) {
            (Some(a), Some(b)) => (a - b).abs() <= SAME * b.abs(),
            _ => a == b,
        },
    }
}

/// BLAKE3 of a text, in hex.
pub fn hash(text: &str) -> String {
    hex(blake3::hash(text.as_bytes()).as_bytes())
}

/// The one intruder and the grains.
pub(crate) fn split(data: &DataFile) -> std::result::Result<(Atom, Vec<Atom>), String> {
    let (balls, grains): (Vec<Atom>, Vec<Atom>) =
        data.atoms.iter().partition(|a| a.kind == INTRUDER_TYPE);
    if balls.len() != 1 {
        return Err(format!(
            "holds {} atoms of type {INTRUDER_TYPE}; expected one, the sphere to drag: give it that \
             type, and no other",
            balls.len()
        ));
    }
    Ok((balls[0], grains))
}

/// Diameters and densities must be those of the scenario.
pub(crate) fn check_grains(
    scenario: &Scenario,
    grains: &[Atom],
) -> std::result::Result<(), String> {
    let [least, most] = scenario.bed.diameters;
    for a in grains {
        let sized = a.diameter >= least * (1.0 - SAME) && a.diameter <= most * (1.0 + SAME);
        if !sized {
            return Err(format!(
                "atom {} has the diameter {}; expected {least} to {most}: see bed.diameters",
                a.id, a.diameter
            ));
        }
        let density = scenario.bed.density;
        if (a.density - density).abs() > SAME * density {
            // Other programs may give this type to any grain, but ours gives it to a lid's, which are heavy.
            let lid = if a.kind == LID_TYPE {
                format!(
                    "; type {LID_TYPE} is a lid's, and a bed from a file gets no lid: leave it out"
                )
            } else {
                String::new()
            };
            return Err(format!(
                "atom {} has the density {}; expected {density}: see bed.density{lid}",
                a.id, a.density
            ));
        }
    }
    Ok(())
}
