//! Checkpoints: a whole state in one safetensors file, from which a run goes on with the same bits.

mod arrays;
mod bodies;
mod groups;
mod head;

pub use head::StageState;
use head::{FACETS, FIELDS, FRAMES, Head, Made, PartSeal, WORDS};

use std::collections::HashMap;
use std::path::Path;

use arrays::Arrays;
use bitgrain_kernel::{BITS_VERSION, ContactHistory, Error as KernelError, Obstacle, Row};
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};

use crate::disk::{self, write_whole};
use crate::error::{Error, Result};
use crate::mesh::corners;
use crate::simulation::{Simulation, hex};

/// Version of the file's layout.
pub const FORMAT: u32 = 3;

/// That of a file with obstacles that turn, move freely, or have a shape that the other one does not know.
const BODIES_FORMAT: u32 = 4;

/// That of a file with words that the law keeps of contacts, as one that resists rolling does.
const WORDS_FORMAT: u32 = 5;

const KEY: &str = "bitgrain";

/// Writes the state of a simulation.
///
/// # Errors
/// [`Error::Write`], and as [`pack`].
pub fn write(path: &Path, sim: &mut Simulation) -> Result<()> {
    write_whole(path, &bytes(sim, "")?)
}

/// The bytes of a checkpoint; `recipe` is the digest of the recipe the bed was poured by, or empty.
///
/// # Errors
/// As [`pack`].
pub fn bytes(sim: &mut Simulation, recipe: &str) -> Result<Vec<u8>> {
    let note = StageState {
        recipe: recipe.to_string(),
        ..StageState::default()
    };
    pack(sim, &note)
}

/// The bytes of a checkpoint of a state and a note.
///
/// # Errors
/// [`Error::Contract`] if the processor's modes were changed since the last step: what the note says may
/// be wrong, and none of it may be kept.
pub fn pack(sim: &mut Simulation, note: &StageState) -> Result<Vec<u8>> {
    let step = sim.step_count();
    let digest = sim.digest();
    let digest = digest.map_err(|fault| Error::run("a checkpoint", step, fault))?;
    let arrays = arrays(sim, note);
    let part = |(name, (_, _, bytes)): &Array| PartSeal::of(name, bytes);
    let mut head = Head {
        format: format_of(sim),
        bits_version: BITS_VERSION,
        step,
        dt: sim.dt,
        law: sim.law.clone(),
        domain: sim.domain,
        groups: sim.groups.clone(),
        obstacles: sim.obstacles.clone(),
        recipe: note.recipe.clone(),
        link: note.link.clone(),
        digest: hex(&digest.whole),
        parts: arrays.iter().map(part).collect(),
        seal: String::new(),
    };
    head.seal = head.sealed();
    let views = arrays.iter().map(|(name, (dtype, shape, bytes))| {
        let view =
            TensorView::new(*dtype, shape.clone(), bytes).expect("sizes match by construction");
        (*name, view)
    });
    let metadata = HashMap::from([(KEY.to_string(), head.text())]);
    Ok(serialize(views, Some(metadata)).expect("views match by construction"))
}

/// The version of the layout that a state needs.
fn format_of(sim: &Simulation) -> u32 {
    let is_plain = sim.obstacles.iter().all(Obstacle::is_plain) && sim.facets.is_empty();
    match (sim.law.words(), is_plain) {
        (0, true) => FORMAT,
        (0, false) => BODIES_FORMAT,
        _ => WORDS_FORMAT,
    }
}

/// A named array: its type, shape and little-endian bytes.
type Array = (&'static str, (Dtype, Vec<usize>, Vec<u8>));

/// Grains, contacts and the unfinished stage as arrays, by name.
fn arrays(sim: &mut Simulation, note: &StageState) -> Vec<Array> {
    let (mut bodies, mut springs, mut kinds) = (Vec::new(), Vec::new(), Vec::new());
    let (mut memory, words) = (Vec::new(), sim.law.words());
    for contact in sim.contact_histories().iter() {
        let (kind, i, partner) = match contact.history {
            ContactHistory::Pair { i, j, .. } => (0u8, i, j),
            ContactHistory::Obstacle { i, obstacle, .. } => (1u8, i, obstacle),
        };
        kinds.push(kind);
        bodies.extend([i, partner]);
        let kept = contact.kept();
        springs.extend(kept.spring);
        memory.extend_from_slice(&kept.memory[..words]);
    }
    let (n, m) = (sim.count(), kinds.len());
    let reals = |x: &[f64]| -> Vec<u8> { x.iter().flat_map(|x| x.to_le_bytes()).collect() };
    let numbers = |x: &[u32]| -> Vec<u8> { x.iter().flat_map(|x| x.to_le_bytes()).collect() };
    let rows = |rows: &[Row<f64>]| (Dtype::F64, vec![n, 4], reals(rows.as_flattened()));
    // What a simulation keeps in the last word is no part of a state.
    let torques: Vec<Row<f64>> = sim
        .torque
        .iter()
        .map(|&[x, y, z, _]| [x, y, z, 0.0])
        .collect();
    let image = sim.image.as_flattened().iter();
    let image: Vec<u8> = image.flat_map(|x| x.to_le_bytes()).collect();
    let course = note.course.clone().into_bytes();
    let mut all = vec![
        ("bond_bodies", (Dtype::U32, vec![m, 2], numbers(&bodies))),
        ("bond_kind", (Dtype::U8, vec![m], kinds)),
        ("bond_spring", (Dtype::F64, vec![m, 3], reals(&springs))),
        ("course", (Dtype::U8, vec![course.len()], course)),
        ("force", rows(&sim.force)),
        ("group", (Dtype::U8, vec![n], sim.group.clone())),
        ("id", (Dtype::U32, vec![n], numbers(&sim.id))),
        ("image", (Dtype::I32, vec![n, 3], image)),
        ("position", rows(&sim.position)),
        ("spin", rows(&sim.spin)),
        ("torque", rows(&torques)),
        ("velocity", rows(&sim.velocity)),
    ];
    let corners = corners(&sim.facets);
    let facets = reals(corners.as_flattened().as_flattened());
    let text = |bytes: &[u8]| (Dtype::U8, vec![bytes.len()], bytes.to_vec());
    for (name, array) in [
        (WORDS, (Dtype::F64, vec![m, words], reals(&memory))),
        (FACETS, (Dtype::F64, vec![corners.len(), 3, 3], facets)),
        (FIELDS, text(&note.fields)),
        (FRAMES, text(note.frames.as_bytes())),
    ] {
        if !array.2.is_empty() {
            // They go by name.
            let place = all.partition_point(|(other, _)| *other < name);
            all.insert(place, (name, array));
        }
    }
    all
}

/// Reads a state back, ready to step on, and verifies it by its digest.
///
/// # Errors
/// [`Error::Damaged`] if the file was changed or cut off, [`Error::Input`] if it is missing or of
/// another format or arithmetic.
pub fn read(path: &Path) -> Result<Simulation> {
    Ok(read_noted(path)?.0)
}

/// A state and what its checkpoint holds besides.
///
/// # Errors
/// As [`read`].
pub fn read_noted(path: &Path) -> Result<(Simulation, StageState)> {
    unpack(&disk::read(path)?, &path.display().to_string())
}

/// What the bytes of a checkpoint hold besides the state, with their seal and digests checked; the state itself
/// is not verified.
///
/// # Errors
/// As [`read`].
pub fn note(bytes: &[u8], name: &str) -> Result<StageState> {
    let head = head(bytes, name)?;
    if head.bits_version != BITS_VERSION {
        return Err(other_versions(name, [head.format, head.bits_version]));
    }
    let damaged = damaged(name);
    let file = SafeTensors::deserialize(bytes).map_err(|e| damaged(e.to_string()))?;
    Arrays { file: &file }.note(&head).map_err(damaged)
}

/// Whether bytes begin as those of a checkpoint do, damaged behind that or not; so do none at all.
pub fn begins(bytes: &[u8]) -> bool {
    let begin = format!("{{\"__metadata__\":{{\"{KEY}\":");
    bytes.is_empty()
        || bytes
            .get(8..)
            .is_some_and(|rest| rest.starts_with(begin.as_bytes()))
}

/// The state that the bytes of a checkpoint hold; `name` is what errors call it. If a `recipe` is
/// given, its digest must be the one that the bed was poured by.
///
/// # Errors
/// As [`read`].
pub fn parse(bytes: &[u8], name: &str, recipe: Option<&str>) -> Result<Simulation> {
    let (sim, note) = unpack(bytes, name)?;
    if recipe.is_some_and(|digest| digest != note.recipe) {
        let problem = "holds a bed that was poured by another recipe";
        return Err(Error::input(name, problem));
    }
    Ok(sim)
}

/// The state that the bytes of a checkpoint hold, and its note; `name` is what errors call it.
///
/// # Errors
/// As [`read`].
pub fn unpack(bytes: &[u8], name: &str) -> Result<(Simulation, StageState)> {
    let head = head(bytes, name)?;
    if head.bits_version != BITS_VERSION {
        return Err(other_versions(name, [head.format, head.bits_version]));
    }
    restore(bytes, &head, name)
}

/// [`unpack`] to inspect a state that another arithmetic made: it must not step on.
///
/// # Errors
/// As [`read`], but for the arithmetic.
pub fn unpack_foreign(bytes: &[u8], name: &str) -> Result<Simulation> {
    let head = head(bytes, name)?;
    Ok(restore(bytes, &head, name)?.0)
}

fn other_versions(name: &str, [format, bits]: [u32; 2]) -> Error {
    let problem = format!(
        "written in format {format} with arithmetic {bits}; this program reads formats {FORMAT} \
         to {WORDS_FORMAT} with arithmetic {BITS_VERSION}: make it again, or use the program that wrote it"
    );
    Error::input(name, problem)
}

fn damaged(name: &str) -> impl Fn(String) -> Error {
    move |problem| Error::Damaged {
        place: name.to_string(),
        problem,
    }
}

/// The head of a file, with its seal and every array's length and digest checked.
fn head(bytes: &[u8], name: &str) -> Result<Head> {
    let damaged = damaged(name);
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(|e| damaged(e.to_string()))?;
    let file = SafeTensors::deserialize(bytes).map_err(|e| damaged(e.to_string()))?;
    let text = metadata.metadata().as_ref().and_then(|m| m.get(KEY));
    let text = text.ok_or_else(|| damaged(format!("no `{KEY}` entry in its metadata")))?;
    // The versions first: another format may have other fields.
    let made: Made = serde_json::from_str(text).map_err(|e| damaged(e.to_string()))?;
    if !(FORMAT..=WORDS_FORMAT).contains(&made.format) {
        return Err(other_versions(name, [made.format, made.bits_version]));
    }
    let head: Head = serde_json::from_str(text).map_err(|e| damaged(e.to_string()))?;
    if head.text() != *text || head.sealed() != head.seal {
        return Err(damaged(
            "the seal of its head does not fit what is in it".into(),
        ));
    }
    let mut names = file.names();
    names.sort_unstable();
    let listed: Vec<&str> = head.parts.iter().map(|part| &part.name[..]).collect();
    if names != listed {
        return Err(damaged(
            "its arrays are not those that its head lists".into(),
        ));
    }
    for part in &head.parts {
        let view = file.tensor(&part.name);
        let view = view.map_err(|e| damaged(e.to_string()))?;
        if PartSeal::of(&part.name, view.data()) != *part {
            let name = &part.name;
            return Err(damaged(format!(
                "`{name}` does not have the length and digest in its head"
            )));
        }
    }
    Ok(head)
}

/// The state and the note, verified by the digest.
fn restore(bytes: &[u8], head: &Head, name: &str) -> Result<(Simulation, StageState)> {
    let damaged = damaged(name);
    let file = SafeTensors::deserialize(bytes).map_err(|e| damaged(e.to_string()))?;
    let arrays = Arrays { file: &file };
    let mut sim = arrays.sim(head).map_err(&damaged)?;
    let histories = arrays
        .contact_histories(head.law.words())
        .map_err(&damaged)?;
    sim.set_step_count(head.step);
    sim.resume(&histories).map_err(|fault| match fault {
        // The machine's fault, not the file's.
        KernelError::Arithmetic { .. } => Error::run(name, head.step, fault),
        _ => damaged(fault.to_string()),
    })?;
    let digest = sim.digest();
    let digest = digest.map_err(|fault| Error::run(name, head.step, fault))?;
    let digest = hex(&digest.whole);
    if digest != head.digest {
        return Err(damaged(format!(
            "its digest is {digest}, not {}",
            head.digest
        )));
    }
    let note = arrays.note(head).map_err(&damaged)?;
    Ok((sim, note))
}
