//! Scenarios: what a user asks for, as TOML, with the papers' values as defaults.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

mod check;
mod plan;
pub(crate) mod source;

pub use plan::{BedPlan, PACKING_GUESS, RunPlan};

use crate::error::{Error, Result, teach};
use crate::law::LawSpec;

/// Names and texts of the scenarios that ship with the program.
pub const SHIPPED: [(&str, &str); 3] = [
    ("quick", include_str!("../../scenarios/quick.toml")),
    (
        "kumar-system-1",
        include_str!("../../scenarios/kumar-system-1.toml"),
    ),
    (
        "kumar-system-2",
        include_str!("../../scenarios/kumar-system-2.toml"),
    ),
];

/// A whole experiment: a bed poured round a sphere, and the sphere dragged through it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// What the run directory is called.
    pub name: String,
    /// Which units the numbers are in.
    pub units: UnitSystem,
    /// Seed of every random number.
    #[serde(default)]
    pub seed: u64,
    /// Acceleration of gravity, along -z.
    #[serde(default = "one")]
    pub gravity: f64,
    /// The bed.
    pub bed: Bed,
    /// The contact law; Kumar's by default.
    #[serde(default = "kumar_law")]
    pub law: LawSpec,
    /// The sphere.
    pub intruder: Intruder,
    /// How it is dragged.
    pub drag: Drag,
    /// What is written down.
    #[serde(default)]
    pub measure: Measure,
    /// Where the bed's file is, where the bed comes from one.
    #[serde(skip)]
    pub source: Option<PathBuf>,
}

/// Systems of units.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum UnitSystem {
    /// Density, mean grain diameter and gravity are 1.
    Reduced,
    /// Metres, kilograms, seconds.
    Si,
}

/// The bed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bed {
    /// A bed of others instead of pouring: a LAMMPS data file or dump, plain or gzip, relative to the
    /// scenario's file. Its box, grains and intruder give the values of the keys that are left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// BLAKE3 of that file's text, unpacked: another text under the same name is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hash: Option<String>,
    /// Lengths along x and y (both periodic) and the height that the settled bed may fill.
    #[serde(rename = "box")]
    pub size: [f64; 3],
    /// Number of grains, the intruder not counted; or give `fill_height`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grains: Option<usize>,
    /// Height to fill, from which the number of grains follows at a packing fraction of 0.6.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fill_height: Option<f64>,
    /// Diameters are uniform between these two.
    #[serde(default = "kumar_diameters")]
    pub diameters: [f64; 2],
    /// Mass density of the grains.
    #[serde(default = "one")]
    pub density: f64,
    /// Grains that settle with their centres below this height are frozen; 0 for none.
    #[serde(default = "kumar_base")]
    pub base: f64,
    /// Whether a plane at z = 0 lies under the base.
    #[serde(default = "yes")]
    pub floor: bool,
    /// The bed is settled when the kinetic energy per free grain, over its mean weight times the
    /// mean diameter, falls below this.
    #[serde(default = "settled")]
    pub settled: f64,
}

/// One value or several.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Several {
    /// One.
    One(f64),
    /// Several, in order.
    Many(Vec<f64>),
}

impl<'de> Deserialize<'de> for Several {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        struct Either;
        impl<'de> serde::de::Visitor<'de> for Either {
            type Value = Several;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number or a list of numbers")
            }
            fn visit_f64<E>(self, x: f64) -> std::result::Result<Several, E> {
                Ok(Several::One(x))
            }
            fn visit_i64<E>(self, x: i64) -> std::result::Result<Several, E> {
                Ok(Several::One(x as f64))
            }
            fn visit_u64<E>(self, x: u64) -> std::result::Result<Several, E> {
                Ok(Several::One(x as f64))
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(
                self,
                mut list: A,
            ) -> std::result::Result<Several, A::Error> {
                let mut values = Vec::new();
                while let Some(x) = list.next_element()? {
                    values.push(x);
                }
                Ok(Several::Many(values))
            }
        }
        from.deserialize_any(Either)
    }
}

impl Several {
    /// The values in order.
    pub fn values(&self) -> Vec<f64> {
        match self {
            Several::One(x) => vec![*x],
            Several::Many(xs) => xs.clone(),
        }
    }
}

/// The sphere that is dragged. It starts in the middle of the box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intruder {
    /// Diameter.
    pub diameter: f64,
    /// Mass density, as it enters the effective mass of its contacts.
    #[serde(default = "one")]
    pub density: f64,
    /// Height of its centre above z = 0; or give `depth`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Several>,
    /// Depth of its centre below the free surface expected at a packing fraction of 0.6; the depth
    /// in the settled bed is measured. Each depth gets a bed of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<Several>,
    /// Speeds along x; or give `froude`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed: Option<Several>,
    /// Froude numbers 2 V sqrt(2 D/g)/(D + d).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub froude: Option<Several>,
}

/// The drag.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// Time step, also of the pouring.
    pub dt: f64,
    /// Travel of the intruder: one for all speeds, or one for each.
    pub distance: Several,
    /// Travel left out of the averages [default: the larger of D and a tenth of the distance].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub discard: Option<f64>,
    /// Whether the contacts keep their histories as the drag begins; those of a bed from a file have
    /// none.
    #[serde(default)]
    pub history: History,
}

/// Tangential springs of the settled bed as the drag begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum History {
    /// They stay.
    #[default]
    Kept,
    /// They are emptied, and the forces evaluated anew before the intruder takes on its speed: how
    /// LAMMPS begins a run from a data file.
    Empty,
}

/// What is written down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Measure {
    /// Steps between rows of the force series.
    #[serde(default = "hundred")]
    pub every: u64,
    /// Whether the series holds the torque on the intruder.
    #[serde(default = "yes")]
    pub torque: bool,
    /// Whether it holds the number of grains that touch the intruder, their mean angle and the
    /// coordination number near it.
    #[serde(default = "yes")]
    pub contacts: bool,
    /// Snapshots of each drag, evenly spaced, the last at its end; 0 for none.
    #[serde(default = "two")]
    pub snapshots: u64,
    /// Whether LAMMPS files, the beds' and the snapshots', are packed with gzip.
    #[serde(default)]
    pub gzip: bool,
}

impl Default for Measure {
    fn default() -> Self {
        Self {
            every: hundred(),
            torque: true,
            contacts: true,
            snapshots: two(),
            gzip: false,
        }
    }
}

fn one() -> f64 {
    1.0
}
fn yes() -> bool {
    true
}
fn two() -> u64 {
    2
}
fn hundred() -> u64 {
    100
}
fn settled() -> f64 {
    1e-6
}
fn kumar_diameters() -> [f64; 2] {
    [0.9, 1.1]
}
fn kumar_base() -> f64 {
    0.6
}
fn kumar_law() -> LawSpec {
    LawSpec::HertzHistory {
        kn: 2e8,
        kt: 2.45e8,
        gamma_n: 5e4,
        gamma_t: 5e4,
        mu: 0.5,
    }
}

/// Loads a scenario by the name of a shipped one or the path of a file, changes keys as `sets` say
/// (`key.subkey=value`), and checks it.
///
/// # Errors
/// [`Error::Input`] with line or key, what was expected and the nearest valid key.
pub fn load(name: &str, sets: &[String]) -> Result<Scenario> {
    if let Some((key, text)) = SHIPPED.iter().find(|(key, _)| *key == name) {
        return parse(text, &format!("{key} (shipped)"), sets, Path::new(""));
    }
    let path = Path::new(name);
    if !path.exists() && path.extension().is_none() {
        return Err(unknown_name(name));
    }
    let text = crate::files::read_text(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    parse(&text, &path.display().to_string(), sets, folder)
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
pub fn parse(text: &str, place: &str, sets: &[String], folder: &Path) -> Result<Scenario> {
    let from_file = |e: toml::de::Error| {
        let line = e.span().map(|s| 1 + text[..s.start].matches('\n').count());
        let place = line.map_or(place.to_string(), |line| format!("{place}:{line}"));
        Error::input(place, teach(e.message()))
    };
    let alone = toml::from_str::<Scenario>(text);
    let mut table: toml::Table = toml::from_str(text).map_err(from_file)?;
    for set in sets {
        apply(&mut table, set)?;
    }
    // A file named on the command line lies where the command was given.
    let key = |set: &String| {
        set.split('=')
            .next()
            .is_some_and(|key| key.trim() == "bed.file")
    };
    let named = sets.iter().any(key);
    let folder = if named { Path::new("") } else { folder };
    let source = source::fill_in(&mut table, place, folder)?;
    refuse_reduced_defaults(&table, place)?;
    let mut scenario = if sets.is_empty() && source.is_none() {
        alone.map_err(from_file)?
    } else {
        let together = serde_path_to_error::deserialize(toml::Value::Table(table));
        match (together, alone) {
            (Ok(scenario), _) => scenario,
            // A file that is wrong by itself is told with its line.
            (Err(_), Err(own)) if source.is_none() => return Err(from_file(own)),
            (Err(e), _) => {
                let with = if sets.is_empty() { "" } else { " with --set" };
                let at = format!("{place}{with}: `{}`", e.path());
                return Err(Error::input(at, teach(e.inner().message())));
            }
        }
    };
    scenario.source = source;
    scenario
        .check()
        .map_err(|(key, problem)| Error::input(format!("{place}: `{key}`"), problem))?;
    Ok(scenario)
}

/// The defaults are the paper's, in reduced units: in SI units every one of them must be given.
fn refuse_reduced_defaults(table: &toml::Table, place: &str) -> Result<()> {
    if table.get("units").and_then(toml::Value::as_str) != Some("si") {
        return Ok(());
    }
    let needed = [
        "gravity",
        "law",
        "bed.density",
        "bed.diameters",
        "bed.base",
        "intruder.density",
    ];
    for key in needed {
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

fn apply(table: &mut toml::Table, set: &str) -> Result<()> {
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
    // One of two spellings replaces the other: asking for speeds drops the Froude numbers.
    for (a, b) in [
        ("speed", "froude"),
        ("height", "depth"),
        ("grains", "fill_height"),
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
