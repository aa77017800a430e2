//! The keys of a scenario, as TOML names them, and their defaults.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::release::{IntruderMotion, Release};
use crate::series::Columns;
use bitgrain_sim::law::{HertzHistoryParameters, LawSpec};
use bitgrain_sim::motion::Moves;

/// A whole experiment: a bed poured round an intruder, and the two moved past each other.
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
    /// Several seeds instead of `seed`: each pours its own beds.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub seeds: Vec<u64>,
    /// Acceleration of gravity, along -z.
    #[serde(default = "one")]
    pub gravity: f64,
    /// The bed.
    pub bed: Bed,
    /// The contact law; Kumar's by default.
    #[serde(default = "kumar_law")]
    pub law: LawSpec,
    /// What the bed is moved past.
    pub intruder: Intruder,
    /// Heavy grains on the bed, for depths beyond its own (Guillard 2014, section III A).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lid: Option<Lid>,
    /// How they move.
    pub drag: Drag,
    /// What is written down.
    #[serde(default)]
    pub measure: Measure,
    /// Where the bed's file is, if the bed comes from one.
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
    /// An imported bed instead of pouring: a LAMMPS data file or dump, plain or gzip, relative to the
    /// scenario's file. Its box, grains and intruder give the values of the keys that are left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// BLAKE3 of that file's text, unpacked: another text under the same name is refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hash: Option<String>,
    /// Lengths along x and y (both periodic, unless a tank stands in it) and the height that the settled bed may fill.
    #[serde(rename = "box")]
    pub size: [f64; 3],
    /// What holds the bed at its sides.
    #[serde(default, skip_serializing_if = "is_default")]
    pub container: Container,
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
    /// Grains that settle with their centres below this height are frozen; 0 for none. In a tank those as near to its
    /// wall are frozen too.
    #[serde(default = "kumar_base")]
    pub base: f64,
    /// Whether a plane at z = 0 lies under the base, or a tank has its floor there.
    #[serde(default = "yes")]
    pub floor: bool,
    /// How the grains are released.
    #[serde(default, skip_serializing_if = "is_default")]
    pub pouring: PouringOrder,
    /// Friction coefficient while the grains are poured and come to rest with more damping; the last rest, a lid and
    /// the drag are under that of the law. Less friction makes a denser bed. By default that of the law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pouring_mu: Option<f64>,
    /// The bed is settled when the kinetic energy per free grain, over its mean weight times the
    /// mean diameter, falls below this.
    #[serde(default = "settled")]
    pub settled: f64,
    /// Whether all motion is stopped, while the bed settles under more damping, each time the kinetic
    /// energy passes a maximum: high beds without friction breathe for long. By default: round a
    /// cylinder, under a lid and if the bed moves.
    #[serde(rename = "halting", default, skip_serializing_if = "Option::is_none")]
    pub kinetic_damping: Option<bool>,
}

/// What holds a bed at its sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Container {
    /// Nothing: the box repeats along x and y.
    #[default]
    Periodic,
    /// A round tank about z, as wide as the box (Guillard 2014, section II A).
    Tank,
}

/// One value or several.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrMany {
    /// One.
    One(f64),
    /// Several, in order.
    Many(Vec<f64>),
}

impl<'de> Deserialize<'de> for OneOrMany {
    fn deserialize<D: serde::Deserializer<'de>>(from: D) -> std::result::Result<Self, D::Error> {
        struct Either;
        impl<'de> serde::de::Visitor<'de> for Either {
            type Value = OneOrMany;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number or a list of numbers")
            }
            fn visit_f64<E>(self, x: f64) -> std::result::Result<OneOrMany, E> {
                Ok(OneOrMany::One(x))
            }
            fn visit_i64<E>(self, x: i64) -> std::result::Result<OneOrMany, E> {
                Ok(OneOrMany::One(x as f64))
            }
            fn visit_u64<E>(self, x: u64) -> std::result::Result<OneOrMany, E> {
                Ok(OneOrMany::One(x as f64))
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(
                self,
                mut list: A,
            ) -> std::result::Result<OneOrMany, A::Error> {
                let mut values = Vec::new();
                while let Some(x) = list.next_element()? {
                    values.push(x);
                }
                Ok(OneOrMany::Many(values))
            }
        }
        from.deserialize_any(Either)
    }
}

impl OneOrMany {
    /// The values in order.
    pub fn values(&self) -> Vec<f64> {
        match self {
            OneOrMany::One(x) => vec![*x],
            OneOrMany::Many(xs) => xs.clone(),
        }
    }

    /// Whether there are none.
    pub fn is_none(&self) -> bool {
        matches!(self, OneOrMany::Many(xs) if xs.is_empty())
    }
}

/// The values of a list that may be left out.
pub(super) fn values(list: &Option<OneOrMany>) -> Vec<f64> {
    list.as_ref().map_or(vec![], OneOrMany::values)
}

/// How the grains of a poured bed are released.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PouringOrder {
    /// All at once, round the intruder in its place (Kumar 2018, section II).
    #[default]
    AtOnce,
    /// Up to the intruder's lowest point first; the intruder is put in when they lie still, and the rest
    /// poured over it (Guillard 2014, section III A).
    InTurn,
}

/// What the bed is moved past. It starts in the middle of the box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Intruder {
    /// A sphere, an endless cylinder along y, or a bar in a tank.
    #[serde(default, skip_serializing_if = "is_default")]
    pub shape: IntruderShape,
    /// Diameter; several make several beds.
    pub diameter: OneOrMany,
    /// Length of a bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<f64>,
    /// Mass density of a sphere, as it enters the effective mass of its contacts, and its mass if forces move it; a
    /// cylinder counts as a wall and has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<f64>,
    /// Height of its centre above z = 0; or give `depth`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<OneOrMany>,
    /// Depth of its centre below the free surface expected at a packing fraction of 0.6; the depth
    /// in the settled bed is measured. Each depth gets its own bed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub depth: Option<OneOrMany>,
    /// Speeds along x, of a bar those of its ends; or give `froude`. Beside forces, for comparison.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed: Option<OneOrMany>,
    /// Froude numbers 2 V sqrt(2 D/g)/(D + d).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub froude: Option<OneOrMany>,
    /// What moves it.
    #[serde(default, skip_serializing_if = "is_default")]
    pub motion: IntruderMotion,
    /// Of one that is dropped: heights of its lowest point above the free surface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drop_height: Option<OneOrMany>,
    /// Of one that is pulled: forces along x.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<OneOrMany>,
    /// Whether one that is pulled is free along z too.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rises: bool,
    /// Whether one that is pulled or floats spins freely; one that is dropped does.
    #[serde(default, skip_serializing_if = "is_default")]
    pub spins: bool,
}

/// What an intruder is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IntruderShape {
    /// A ball.
    #[default]
    Sphere,
    /// An endless round bar along y.
    Cylinder,
    /// A round bar with two ends, which lies in the middle of a tank and turns about z against it (Guillard 2014,
    /// section II A).
    Bar,
}

/// A monolayer of heavy grains, a square lattice of the mean diameter, on top of the settled bed: free
/// vertically, carried horizontally with the bed (Guillard 2014, section III A).
///
/// Give `effective_depth` or `density`; several make several beds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lid {
    /// Effective depths `h + (pi d/6)(rho_lid/rho)` of the intruder's centre; the density of the lid
    /// follows from what is measured on the poured bed. One that equals the bed's own depth, to half
    /// a grain, needs no lid.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub effective_depth: Option<OneOrMany>,
    /// Mass densities of the lid's grains.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<OneOrMany>,
    /// Whether the bed below the lid has weight.
    #[serde(default)]
    pub pressure_gradient: Gradient,
}

/// Whether gravity acts on the bed or on its lid alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Gradient {
    /// On all grains: the pressure grows with depth.
    #[default]
    With,
    /// On the lid alone, once the bed is poured: the same pressure everywhere.
    Without,
    /// A bed of each kind.
    Both,
}

/// The drag.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// Time step, also of the pouring.
    pub dt: f64,
    /// Which of the two moves along x.
    #[serde(default, skip_serializing_if = "is_default")]
    pub moves: Moves,
    /// Travel of the intruder through the bed, of a bar that of its ends: one for all speeds, or one for each.
    #[serde(default = "none", skip_serializing_if = "OneOrMany::is_none")]
    pub distance: OneOrMany,
    /// Time after which a drop or a pull ends: one for all, or one for each.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration: Option<OneOrMany>,
    /// Whether the travel may exceed one box length, of a bar half a turn, after which the intruder is in its own wake.
    #[serde(default, skip_serializing_if = "is_default")]
    pub own_wake: bool,
    /// Travel left out of the averages [default: the larger of D and a tenth of the distance; for a
    /// cylinder 2 D; for the ends of a bar 4 D, which are 2 D for the middle of each half].
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
    /// They are emptied, and the forces recomputed before the intruder takes on its speed: as
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
    /// Whether the energy of each drag is accounted for, at three times its cost.
    #[serde(default)]
    pub energy: bool,
    /// Whether LAMMPS files, the beds' and the snapshots', are packed with gzip.
    #[serde(default)]
    pub gzip: bool,
    /// Checkpoints that are kept of each drag, evenly spaced, the last at its end.
    #[serde(default = "four")]
    pub checkpoints: u64,
    /// Steps between links of each drag's chain of digests (a bed's has one every 1,000 steps).
    #[serde(default = "thousand")]
    pub digest_every: u64,
    /// Distances from the intruder's surface within which the coordination number is measured too, ascending, besides
    /// two mean diameters.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reaches: Vec<f64>,
    /// Fields of velocity and stress round the intruder, and the load on a cylinder by angle.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fields: Option<FieldsConfig>,
}

/// Continuous fields by coarse-graining, averaged over the steady state (Guillard 2014, appendix A).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FieldsConfig {
    /// Points along x, y and z, the paper's by default; each in the middle of its cell of `bed.box`.
    #[serde(default = "paper")]
    pub grid: [usize; 3],
    /// Radius R of the averaging window about each point [default: the mean diameter].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub window: Option<f64>,
    /// Steps between samples [default: those of a tenth of a mean diameter of travel].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub every: Option<u64>,
}

fn paper() -> [usize; 3] {
    [120, 3, 120]
}

impl Measure {
    /// Columns of the force series of a drag that is set going so.
    pub fn columns(&self, release: Release) -> Columns {
        Columns {
            torque: self.torque,
            contacts: self.contacts,
            body: release.is_free(),
        }
    }
}

impl Default for Measure {
    fn default() -> Self {
        Self {
            every: hundred(),
            torque: true,
            contacts: true,
            snapshots: two(),
            energy: false,
            gzip: false,
            checkpoints: four(),
            digest_every: thousand(),
            reaches: Vec::new(),
            fields: None,
        }
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
fn none() -> OneOrMany {
    OneOrMany::Many(Vec::new())
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
fn four() -> u64 {
    4
}
fn thousand() -> u64 {
    1000
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
pub(super) fn kumar_law() -> LawSpec {
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e8,
        kt: 2.45e8,
        gamma_n: 5e4,
        gamma_t: 5e4,
        mu: 0.5,
        rolling: None,
    })
}
