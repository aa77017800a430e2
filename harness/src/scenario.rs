//! Scenarios: what a user asks for, as TOML, with the papers' values as defaults.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result, teach};
use crate::law::LawSpec;
use crate::summary::Units;

/// Names and texts of the scenarios that ship with the program.
pub const SHIPPED: [(&str, &str); 3] = [
    ("quick", include_str!("../scenarios/quick.toml")),
    (
        "kumar-system-1",
        include_str!("../scenarios/kumar-system-1.toml"),
    ),
    (
        "kumar-system-2",
        include_str!("../scenarios/kumar-system-2.toml"),
    ),
];

/// Most steps of one drag: a guard against a slip of the pen, a year on one core.
const STEPS_MAX: u64 = 1_000_000_000_000;

/// Fewest steps of an averaging window: ten for each block of the standard error.
const AVERAGED_MIN: u64 = 80;

/// Packing fraction that plans assume before a bed has been poured.
pub const PACKING_GUESS: f64 = 0.6;

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
    /// Whether it holds the number of grains that touch the intruder.
    #[serde(default = "yes")]
    pub contacts: bool,
}

impl Default for Measure {
    fn default() -> Self {
        Self {
            every: hundred(),
            torque: true,
            contacts: true,
        }
    }
}

fn one() -> f64 {
    1.0
}
fn yes() -> bool {
    true
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

/// A bed to pour: its intruder and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct BedPlan {
    /// Name of the bed and its files.
    pub name: String,
    /// Centre of the intruder.
    pub center: [f64; 3],
}

/// One drag to run in a bed.
#[derive(Clone, Debug, PartialEq)]
pub struct RunPlan {
    /// Name of the run and its folder.
    pub name: String,
    /// Place of its bed among the bed plans.
    pub bed: usize,
    /// Speed of the intruder.
    pub speed: f64,
    /// Its Froude number.
    pub froude: f64,
    /// Travel.
    pub distance: f64,
    /// Steps.
    pub steps: u64,
    /// Travel at which averaging begins.
    pub discard: f64,
}

impl RunPlan {
    /// The first step that is averaged: the first that ends beyond the discarded travel.
    pub fn first_averaged(&self, dt: f64) -> u64 {
        let travel = |n: u64| n as f64 * dt * self.speed;
        let mut first = (self.discard / (self.speed * dt)) as u64;
        while first > 0 && travel(first) > self.discard {
            first -= 1;
        }
        while travel(first) <= self.discard && first < self.steps {
            first += 1;
        }
        first.max(1)
    }
}

/// Loads a scenario by the name of a shipped one or the path of a file, changes keys as `sets` say
/// (`key.subkey=value`), and checks it.
///
/// # Errors
/// [`Error::Input`] with line or key, what was expected and the nearest valid key.
pub fn load(name: &str, sets: &[String]) -> Result<Scenario> {
    let shipped = SHIPPED.iter().find(|(key, _)| *key == name);
    let (text, place) = match shipped {
        Some((key, text)) => (text.to_string(), format!("{key} (shipped)")),
        None => {
            let path = Path::new(name);
            if !path.exists() && path.extension().is_none() {
                return Err(unknown_name(name));
            }
            (crate::lammps::read_text(path)?, path.display().to_string())
        }
    };
    parse(&text, &place, sets)
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

/// Parses and checks the text of a scenario; `place` is what errors call it.
///
/// # Errors
/// As [`load`].
pub fn parse(text: &str, place: &str, sets: &[String]) -> Result<Scenario> {
    let from_file = |e: toml::de::Error| {
        let line = e.span().map(|s| 1 + text[..s.start].matches('\n').count());
        let place = line.map_or(place.to_string(), |line| format!("{place}:{line}"));
        Error::input(place, teach(e.message()))
    };
    let alone = toml::from_str::<Scenario>(text);
    let scenario = if sets.is_empty() {
        alone.map_err(from_file)?
    } else {
        let mut table: toml::Table = toml::from_str(text).map_err(from_file)?;
        for set in sets {
            apply(&mut table, set)?;
        }
        let together = serde_path_to_error::deserialize(toml::Value::Table(table));
        match (together, alone) {
            (Ok(scenario), _) => scenario,
            // A file that is wrong by itself is told with its line.
            (Err(_), Err(own)) => return Err(from_file(own)),
            (Err(e), Ok(_)) => {
                let at = format!("{place} with --set: `{}`", e.path());
                return Err(Error::input(at, teach(e.inner().message())));
            }
        }
    };
    scenario
        .check()
        .map_err(|(key, problem)| Error::input(format!("{place}: `{key}`"), problem))?;
    Ok(scenario)
}

fn apply(table: &mut toml::Table, set: &str) -> Result<()> {
    let place = || format!("--set {set}");
    let Some((key, value)) = set.split_once('=') else {
        return Err(Error::input(
            place(),
            "expected key=value, as in law.mu=0.3",
        ));
    };
    let parsed: Option<toml::Table> = toml::from_str(&format!("value = {value}")).ok();
    let value = parsed
        .and_then(|mut t| t.remove("value"))
        .unwrap_or_else(|| toml::Value::String(value.to_string()));
    let words: Vec<&str> = key.split('.').map(str::trim).collect();
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

type Check = std::result::Result<(), (String, String)>;

fn refuse(key: &str, problem: impl Into<String>) -> Check {
    Err((key.to_string(), problem.into()))
}

fn positive(key: &str, value: f64) -> Check {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    refuse(key, format!("is {value}; expected a positive number"))
}

impl Scenario {
    /// The resolved scenario as TOML, every default written out.
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a scenario has only string keys and finite numbers")
    }

    /// Mean grain diameter.
    pub fn mean_diameter(&self) -> f64 {
        0.5 * (self.bed.diameters[0] + self.bed.diameters[1])
    }

    /// What one unit of each kind of number stands for.
    pub fn units(&self) -> Units {
        let names = match self.units {
            UnitSystem::Reduced => [
                "d",
                "sqrt(d/g)",
                "sqrt(g d)",
                "rho d^3 g",
                "rho d^4 g",
                "rho d^4 g",
            ],
            UnitSystem::Si => ["m", "s", "m/s", "N", "N m", "J"],
        };
        let [length, time, speed, force, torque, energy] = names.map(str::to_string);
        Units {
            length,
            time,
            speed,
            force,
            torque,
            energy,
        }
    }

    /// Mean volume of a grain: the mean of pi/6 diameter^3 over the uniform distribution.
    fn mean_volume(&self) -> f64 {
        let [a, b] = self.bed.diameters;
        std::f64::consts::PI / 6.0 * 0.25 * (a + b) * (a * a + b * b)
    }

    /// Number of grains, given or from the fill height.
    pub fn grain_count(&self) -> usize {
        let [x, y, _] = self.bed.size;
        match (self.bed.grains, self.bed.fill_height) {
            (Some(n), _) => n,
            (None, Some(height)) => {
                let ball = crate::sim::sphere_mass(self.intruder.diameter, 1.0);
                ((x * y * height - ball) * PACKING_GUESS / self.mean_volume()) as usize
            }
            (None, None) => 0,
        }
    }

    /// Height of the free surface expected at a packing fraction of 0.6.
    pub fn expected_surface(&self) -> f64 {
        let [x, y, _] = self.bed.size;
        let ball = crate::sim::sphere_mass(self.intruder.diameter, 1.0);
        (self.grain_count() as f64 * self.mean_volume() / PACKING_GUESS + ball) / (x * y)
    }

    /// Froude number of a speed: 2 V sqrt(2 D/g)/(D + d) (Kumar 2018, eq. 4).
    pub fn froude(&self, speed: f64) -> f64 {
        2.0 * speed * self.fall_time() / (self.intruder.diameter + self.mean_diameter())
    }

    fn fall_time(&self) -> f64 {
        (2.0 * self.intruder.diameter / self.gravity).sqrt()
    }

    fn heights(&self) -> Vec<f64> {
        match (&self.intruder.height, &self.intruder.depth) {
            (Some(heights), _) => heights.values(),
            (None, Some(depths)) => {
                let surface = self.expected_surface();
                depths.values().iter().map(|h| surface - h).collect()
            }
            (None, None) => vec![],
        }
    }

    /// Speeds with their Froude numbers, whichever of the two was given kept as it is.
    fn speeds(&self) -> Vec<(f64, f64)> {
        match (&self.intruder.speed, &self.intruder.froude) {
            (Some(speeds), _) => speeds
                .values()
                .iter()
                .map(|&v| (v, self.froude(v)))
                .collect(),
            (None, Some(numbers)) => {
                let width = self.intruder.diameter + self.mean_diameter();
                let per_froude = width / (2.0 * self.fall_time());
                numbers
                    .values()
                    .iter()
                    .map(|&fr| (fr * per_froude, fr))
                    .collect()
            }
            (None, None) => vec![],
        }
    }

    /// The beds to pour.
    pub fn beds(&self) -> Vec<BedPlan> {
        let heights = self.heights();
        let [x, y, _] = self.bed.size;
        heights
            .iter()
            .enumerate()
            .map(|(k, &z)| BedPlan {
                name: if heights.len() == 1 {
                    "bed".into()
                } else {
                    format!("bed-{}", k + 1)
                },
                center: [0.5 * x, 0.5 * y, z],
            })
            .collect()
    }

    /// The drags to run, by bed and then speed.
    pub fn runs(&self) -> Vec<RunPlan> {
        let (beds, speeds, distances) = (self.beds(), self.speeds(), self.drag.distance.values());
        let mut runs = Vec::new();
        for (bed, plan) in beds.iter().enumerate() {
            for (k, &(speed, froude)) in speeds.iter().enumerate() {
                let distance = distances[if distances.len() == 1 { 0 } else { k }];
                let run = format!("run-{}", k + 1);
                let name = if beds.len() == 1 {
                    run
                } else {
                    format!("{}-{run}", plan.name)
                };
                let default = if 0.1 * distance > self.intruder.diameter {
                    0.1 * distance
                } else {
                    self.intruder.diameter
                };
                runs.push(RunPlan {
                    name,
                    bed,
                    speed,
                    froude,
                    distance,
                    steps: (distance / (speed * self.drag.dt)).round() as u64,
                    discard: self.drag.discard.unwrap_or(default),
                });
            }
        }
        runs
    }

    fn check(&self) -> Check {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if self.name.is_empty() || !self.name.chars().all(plain) {
            return refuse(
                "name",
                "expected letters, digits, `-` and `_`: it names a folder",
            );
        }
        positive("gravity", self.gravity)?;
        self.check_bed()?;
        self.check_units()?;
        self.law
            .build()
            .map_err(|(key, problem)| (format!("law.{key}"), problem))?;
        self.check_intruder()?;
        self.check_box()?;
        self.check_drag()?;
        if self.measure.every == 0 {
            return refuse("measure.every", "is 0; expected at least 1 step");
        }
        Ok(())
    }

    fn check_units(&self) -> Check {
        if self.units == UnitSystem::Si {
            return Ok(());
        }
        let one = |key: &str, value: f64| {
            if (value - 1.0).abs() < 1e-12 {
                return Ok(());
            }
            refuse(
                key,
                format!("is {value}; in reduced units it is 1. For others set units = \"si\""),
            )
        };
        one("gravity", self.gravity)?;
        one("bed.density", self.bed.density)?;
        if (self.mean_diameter() - 1.0).abs() > 1e-12 {
            let mean = self.mean_diameter();
            return refuse(
                "bed.diameters",
                format!("have the mean {mean}; in reduced units it is 1"),
            );
        }
        Ok(())
    }

    fn check_bed(&self) -> Check {
        for length in self.bed.size {
            positive("bed.box", length)?;
        }
        let [least, most] = self.bed.diameters;
        positive("bed.diameters", least)?;
        if !(most >= least && most.is_finite()) {
            return refuse("bed.diameters", "expected the smaller first");
        }
        if most > 4.0 * least {
            return refuse(
                "bed.diameters",
                "expected the larger at most 4 times the smaller",
            );
        }
        positive("bed.density", self.bed.density)?;
        positive("bed.settled", self.bed.settled)?;
        if !(self.bed.base >= 0.0 && self.bed.base < self.bed.size[2]) {
            return refuse(
                "bed.base",
                "expected a height inside the box, or 0 for none",
            );
        }
        if self.bed.base == 0.0 && !self.bed.floor {
            return refuse("bed.floor", "without a base the grains need a floor");
        }
        match (self.bed.grains, self.bed.fill_height) {
            (Some(_), Some(_)) => {
                return refuse("bed.fill_height", "give grains or fill_height, not both");
            }
            (None, None) => return refuse("bed.grains", "give grains or fill_height"),
            (None, Some(height)) => positive("bed.fill_height", height)?,
            (Some(0), None) => return refuse("bed.grains", "is 0; expected at least 1"),
            (Some(n), None) if n > 100_000_000 => {
                return refuse("bed.grains", "expected at most 100,000,000");
            }
            _ => {}
        }
        Ok(())
    }

    fn check_intruder(&self) -> Check {
        let i = &self.intruder;
        positive("intruder.diameter", i.diameter)?;
        positive("intruder.density", i.density)?;
        match (&i.height, &i.depth) {
            (Some(_), Some(_)) => {
                return refuse("intruder.depth", "give height or depth, not both");
            }
            (None, None) => return refuse("intruder.height", "give height or depth"),
            _ => {}
        }
        match (&i.speed, &i.froude) {
            (Some(_), Some(_)) => {
                return refuse("intruder.speed", "give speed or froude, not both");
            }
            (None, None) => return refuse("intruder.speed", "give speed or froude"),
            _ => {}
        }
        let key = if i.speed.is_some() {
            "intruder.speed"
        } else {
            "intruder.froude"
        };
        let speeds = self.speeds();
        if speeds.is_empty() {
            return refuse(key, "is empty; expected at least one value");
        }
        speeds.iter().try_for_each(|&(v, _)| positive(key, v))
    }

    fn check_box(&self) -> Check {
        let [x, y, z] = self.bed.size;
        let most = self.bed.diameters[1];
        let diameter = self.intruder.diameter;
        let widest = if diameter > most {
            0.5 * (most + diameter)
        } else {
            most
        };
        for (length, axis) in [(x, "x"), (y, "y")] {
            if length <= diameter {
                return refuse(
                    "intruder.diameter",
                    format!("is {diameter}, no smaller than the box along {axis}, {length}"),
                );
            }
            if length <= 2.0 * widest {
                return refuse(
                    "bed.box",
                    format!(
                        "is {length} along {axis}; a periodic axis must be longer than {}, twice \
                         the largest contact distance",
                        2.0 * widest
                    ),
                );
            }
        }
        let surface = self.expected_surface();
        let thinnest = self.bed.base + self.mean_diameter();
        if surface < thinnest {
            let key = if self.bed.grains.is_some() {
                "bed.grains"
            } else {
                "bed.fill_height"
            };
            return refuse(
                key,
                format!(
                    "fills the box to a height of {surface:.3}; expected at least {thinnest}, a \
                     layer of grains above the base"
                ),
            );
        }
        if surface > 1.15 * z {
            return refuse(
                "bed.box",
                format!(
                    "has a height of {z}, but the grains would fill {surface:.1}: make it higher"
                ),
            );
        }
        let key = if self.intruder.height.is_some() {
            "intruder.height"
        } else {
            "intruder.depth"
        };
        let heights = self.heights();
        if heights.is_empty() {
            return refuse(key, "is empty; expected at least one value");
        }
        for height in heights {
            // Written so that NaN is refused too.
            let inside = height - 0.5 * diameter >= 0.0 && height + 0.5 * diameter <= z;
            let buried = height - 0.5 * diameter < surface;
            if inside && !buried {
                return refuse(
                    key,
                    format!(
                        "puts the intruder's centre at z = {height}, wholly above the bed, which \
                         is expected to reach {surface:.2}"
                    ),
                );
            }
            if !inside {
                return refuse(
                    key,
                    format!(
                        "puts the intruder's centre at z = {height}: outside the box, 0 to {z}"
                    ),
                );
            }
        }
        Ok(())
    }

    fn check_drag(&self) -> Check {
        let least = 0.5 * self.bed.diameters[0];
        let radius = 0.5 * self.intruder.diameter;
        let sizes = [(least, self.bed.density), (radius, self.intruder.density)];
        self.law
            .check_time_step(self.drag.dt, sizes.into_iter())
            .map_err(|p| ("drag.dt".to_string(), p))?;
        let (speeds, distances) = (self.speeds(), self.drag.distance.values());
        if distances.len() != 1 && distances.len() != speeds.len() {
            return refuse(
                "drag.distance",
                format!(
                    "has {} values for {} speeds; expected one, or one for each",
                    distances.len(),
                    speeds.len()
                ),
            );
        }
        for distance in &distances {
            positive("drag.distance", *distance)?;
            if *distance > self.bed.size[0] {
                return refuse(
                    "drag.distance",
                    format!(
                        "is {distance}, beyond one box length, {}: the intruder would meet its own \
                         wake",
                        self.bed.size[0]
                    ),
                );
            }
        }
        for run in self.runs() {
            if run.speed * self.drag.dt > least {
                return refuse("drag.dt", "lets the intruder jump over a grain in one step");
            }
            if !(run.discard >= 0.0 && run.discard < run.distance) {
                let (key, given) = match self.drag.discard {
                    Some(_) => ("drag.discard", run.discard),
                    None => ("drag.distance", run.distance),
                };
                return refuse(
                    key,
                    format!(
                        "is {given}: of a distance of {}, {} is discarded, and nothing is left",
                        run.distance, run.discard
                    ),
                );
            }
            if run.steps > STEPS_MAX {
                return refuse(
                    "drag.distance",
                    format!(
                        "takes {:.0e} steps; expected at most {STEPS_MAX:.0e}",
                        run.steps as f64
                    ),
                );
            }
            let averaged = run.steps + 1 - run.first_averaged(self.drag.dt);
            if averaged < AVERAGED_MIN {
                let key = if self.drag.discard.is_some() {
                    "drag.discard"
                } else {
                    "drag.distance"
                };
                return refuse(
                    key,
                    format!("leaves {averaged} steps to average; expected at least {AVERAGED_MIN}"),
                );
            }
        }
        Ok(())
    }
}
