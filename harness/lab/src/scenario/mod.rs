//! Scenarios: what a user asks for, as TOML, with the papers' values as defaults.

use std::path::Path;

mod check;
mod checked;
mod extent;
mod fields;
mod guard;
mod keys;
mod limits;
mod passages;
mod plan;
mod refusal;
mod release;
mod rig;
pub mod source;
mod tank;

pub use checked::{CheckedScenario, Refusal};
pub use keys::{
    Bed, Container, Drag, FieldsConfig, Gradient, History, Intruder, IntruderShape, Lid, Measure,
    OneOrMany, PouringOrder, Scenario, UnitSystem,
};
pub use plan::{BedPlan, DragPlan, LidPlan, PACKING_GUESS};
pub use release::{IntruderMotion, Release};
pub use rig::{BULK_FRICTION, DRAG_COEFFICIENT};

use crate::parse_errors::{teach, wrong_toml};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::bits;
use keys::kumar_law;
pub(crate) use source::BedFile;

/// Names and texts of the scenarios that ship with the program.
pub const SHIPPED: [(&str, &str); 16] = [
    ("quick", include_str!("../../scenarios/quick.toml")),
    (
        "kumar-system-1",
        include_str!("../../scenarios/kumar-system-1.toml"),
    ),
    (
        "kumar-system-2",
        include_str!("../../scenarios/kumar-system-2.toml"),
    ),
    (
        "guillard-small",
        include_str!("../../scenarios/guillard-small.toml"),
    ),
    (
        "guillard-medium",
        include_str!("../../scenarios/guillard-medium.toml"),
    ),
    (
        "guillard-axis",
        include_str!("../../scenarios/guillard-axis.toml"),
    ),
    (
        "guillard-wake",
        include_str!("../../scenarios/guillard-wake.toml"),
    ),
    (
        "guillard-deep",
        include_str!("../../scenarios/guillard-deep.toml"),
    ),
    (
        "guillard-cover",
        include_str!("../../scenarios/guillard-cover.toml"),
    ),
    (
        "guillard-centred",
        include_str!("../../scenarios/guillard-centred.toml"),
    ),
    (
        "guillard-2014",
        include_str!("../../scenarios/guillard-2014.toml"),
    ),
    (
        "guillard-tank-small",
        include_str!("../../scenarios/guillard-tank-small.toml"),
    ),
    (
        "guillard-tank",
        include_str!("../../scenarios/guillard-tank.toml"),
    ),
    (
        "impact-quick",
        include_str!("../../scenarios/impact-quick.toml"),
    ),
    (
        "pull-quick",
        include_str!("../../scenarios/pull-quick.toml"),
    ),
    (
        "float-quick",
        include_str!("../../scenarios/float-quick.toml"),
    ),
];

/// Loads a scenario by the name of a shipped one or the path of a file, changes keys as `sets` say
/// (`key.subkey=value`), and checks it.
///
/// # Errors
/// [`Error::Input`] with line or key, what was expected and the nearest valid key.
pub fn load(name: &str, sets: &[String]) -> Result<CheckedScenario> {
    if let Some((key, text)) = SHIPPED.iter().find(|(key, _)| *key == name) {
        return parse(text, &format!("{key} (shipped)"), sets, Path::new(""));
    }
    let path = Path::new(name);
    if !disk::is_there(path) && path.extension().is_none() {
        return Err(unknown_name(name));
    }
    let text = bitgrain_sim::files::read_text(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(&text, &path.display().to_string(), sets, folder)
}

/// The text of a new scenario of this name: the quick one, with every key and a comment on it.
pub fn template(name: &str) -> String {
    let (_, quick) = SHIPPED[0];
    let from = quick.find("name = ").expect("a scenario has a name");
    let rest = quick[from..].replacen("\"quick\"", &format!("\"{name}\""), 1);
    format!(
        "# A bed of soft grains and a sphere that is dragged through it. Lines that begin with `##` show the\n\
         # other keys and their defaults; the guide says more of each in its chapter Scenarios.\n\n{rest}"
    )
}

fn unknown_name(name: &str) -> Error {
    let names: Vec<&str> = SHIPPED.iter().map(|(key, _)| *key).collect();
    let nearest = names
        .iter()
        .min_by_key(|key| strsim::damerau_levenshtein(key, name))
        .filter(|key| strsim::damerau_levenshtein(key, name) <= 1 + name.len() / 3);
    let ask = nearest.map_or(String::new(), |key| format!("; did you mean `{key}`?"));
    Error::input(
        name,
        format!(
            "no such scenario; shipped are {}, or give a TOML file{ask}",
            names.join(", ")
        ),
    )
}

/// Parses and checks the text of a scenario; `place` is what errors call it, and `folder` is where a
/// bed's file is looked for.
///
/// # Errors
/// As [`load`].
pub fn parse(text: &str, place: &str, sets: &[String], folder: &Path) -> Result<CheckedScenario> {
    let from = BedFile::From(bed_folder(sets, folder));
    parse_from(text, place, sets, from)
}

/// Where a bed's file is looked for: one that the command line names lies where the command was given.
pub(crate) fn bed_folder<'a>(sets: &[String], folder: &'a Path) -> &'a Path {
    let names_file = |set: &String| {
        let mut alone = toml::Table::new();
        let read = apply(&mut alone, set);
        read.is_ok() && alone.get("bed").and_then(|bed| bed.get("file")).is_some()
    };
    match sets.iter().any(names_file) {
        true => Path::new(""),
        false => folder,
    }
}

/// The same; `from` is where a bed's file is looked for, whoever names it.
pub(crate) fn parse_from(
    text: &str,
    place: &str,
    sets: &[String],
    from: BedFile<'_>,
) -> Result<CheckedScenario> {
    let from_file = |e: toml::de::Error| wrong_toml(place, text, &e);
    let alone = toml::from_str::<Scenario>(text);
    let mut table: toml::Table = toml::from_str(text).map_err(from_file)?;
    for set in sets {
        apply(&mut table, set)?;
    }
    let source = source::fill_in(&mut table, place, from)?;
    refuse_reduced_defaults(&table, place)?;
    let mut scenario = if sets.is_empty() && source.is_none() {
        alone.map_err(from_file)?
    } else {
        let together = serde_path_to_error::deserialize(toml::Value::Table(table));
        match (together, alone) {
            (Ok(scenario), _) => scenario,
            // An error of the file alone is reported with its line.
            (Err(_), Err(own)) if source.is_none() => return Err(from_file(own)),
            (Err(e), _) => {
                let with = if sets.is_empty() { "" } else { " with --set" };
                let at = format!("{place}{with}: `{}`", e.path());
                return Err(Error::input(at, teach(e.inner().message())));
            }
        }
    };
    let (file, grains) = source.unzip();
    scenario.source = file;
    if scenario.intruder.shape == IntruderShape::Sphere && scenario.intruder.density.is_none() {
        scenario.intruder.density = Some(1.0);
    }
    let checked = scenario.check().map_err(|wrong| refused(place, wrong))?;
    if let (Some(file), Some(grains)) = (&checked.source, &grains) {
        let wrong = |what| Error::input(file.display().to_string(), what);
        source::check_grains(&checked, grains).map_err(wrong)?;
    }
    Ok(checked)
}

/// The text that a run writes of the scenario of these bytes, if they are one.
pub(crate) fn as_made(bytes: &[u8]) -> Option<String> {
    let scenario: Scenario = toml::from_str(std::str::from_utf8(bytes).ok()?).ok()?;
    Some(format!("# {}\n{}", bits(), scenario.to_toml()))
}

/// What is wrong with the scenario of a file as an error.
pub fn refused(place: &str, wrong: Refusal) -> Error {
    Error::input(format!("{place}: `{}`", wrong.key), wrong.problem)
}

/// The defaults are the paper's, in reduced units: in SI units every one of them must be given.
fn refuse_reduced_defaults(table: &toml::Table, place: &str) -> Result<()> {
    if table.get("units").and_then(toml::Value::as_str) != Some("si") {
        return Ok(());
    }
    let shape = table.get("intruder").and_then(|i| i.get("shape"));
    let sphere = shape.is_none_or(|shape| shape.as_str() == Some("sphere"));
    let needed = [
        "gravity",
        "law",
        "bed.density",
        "bed.diameters",
        "bed.base",
        "intruder.density",
    ];
    // A cylinder has no density; what is neither is refused later.
    let needed = &needed[..needed.len() - usize::from(!sphere)];
    for &key in needed {
        let found = match key.split_once('.') {
            None => table.get(key),
            Some((outer, inner)) => table.get(outer).and_then(|t| t.get(inner)),
        };
        if found.is_none() {
            return Err(Error::input(
                format!("{place}: `{key}`"),
                "is missing; its default is in reduced units, so with units = \"si\" give it",
            ));
        }
    }
    Ok(())
}

/// Most parts of a key: endlessly nested tables could not be dropped again.
const DEEPEST: usize = 8;

/// Changes a key of a scenario, as `key.subkey=value` says.
///
/// # Errors
/// [`Error::Input`] if it is not such a pair.
pub(crate) fn apply(table: &mut toml::Table, set: &str) -> Result<()> {
    let place = || format!("--set {set}");
    let Some((key, text)) = set.split_once('=') else {
        return Err(Error::input(
            place(),
            "expected key=value, as in law.mu=0.3",
        ));
    };
    let parsed: Option<toml::Table> = toml::from_str(&format!("value = {text}")).ok();
    let value = parsed
        .and_then(|mut t| t.remove("value"))
        .unwrap_or_else(|| toml::Value::String(text.to_string()));
    let words: Vec<&str> = key.split('.').map(str::trim).collect();
    if words.len() > DEEPEST {
        let problem = format!("names a key of {} parts; expected key.subkey", words.len());
        return Err(Error::input(place(), problem));
    }
    if text.contains('\n') {
        return Err(Error::input(
            place(),
            "holds more than one line; expected one value",
        ));
    }
    if words == ["law", "kind"]
        && let Some(toml::Value::Table(law)) = table.get_mut("law")
        && law.get("kind") != Some(&value)
    {
        // Another law has other keys: only friction is common to all.
        law.retain(|key, _| key == "mu");
    }
    if words[0] == "law" && !table.contains_key("law") {
        // One key of the law that is the default: the others come with it.
        let law = toml::Table::try_from(kumar_law()).expect("a law is a table of numbers");
        table.insert("law".into(), toml::Value::Table(law));
    }
    let mut at = table;
    for word in &words[..words.len() - 1] {
        let next = at
            .entry(word.to_string())
            .or_insert_with(|| toml::Value::Table(toml::Table::new()));
        let toml::Value::Table(inner) = next else {
            return Err(Error::input(place(), format!("`{word}` is not a table")));
        };
        at = inner;
    }
    let last = words[words.len() - 1];
    // One of two alternatives replaces the other: giving speeds drops the Froude numbers.
    for (a, b) in [
        ("speed", "froude"),
        ("height", "depth"),
        ("grains", "fill_height"),
        ("seed", "seeds"),
        ("effective_depth", "density"),
    ] {
        if last == a {
            at.remove(b);
        } else if last == b {
            at.remove(a);
        }
    }
    at.insert(last.to_string(), value);
    Ok(())
}
