//! Laws with other numbers for each pair of materials, as files give them: names, the elasticity of each material, and
//! what belongs to a pair.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use bitgrain_kernel::contact::{Materials, PairLaws, RollingResistance};
use serde::{Deserialize, Serialize};

use super::hertz_history::HertzHistoryParameters;
use super::hertz_tsuji::{Elasticity, between};
use super::laws::AnyLaw;
use super::pairs::Pairs;
use super::parameters::{LawParameters, Wrong, WrongKey};
use super::rolling::RollingSpec;

/// Most materials of a world.
pub const MATERIALS_MAX: usize = 32;

/// The number of the material with this name among these, which are none if there is one material only.
///
/// # Errors
/// That the name is none of them, or is missing although there are several.
pub fn material_number(names: &[impl AsRef<str>], name: Option<&str>) -> Result<u8, String> {
    let place = name.and_then(|name| names.iter().position(|known| known.as_ref() == name));
    let list = || {
        let all: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
        all.join(", ")
    };
    match (name, place.and_then(|place| u8::try_from(place).ok())) {
        (_, Some(number)) => Ok(number),
        (None, None) if names.len() < 2 => Ok(0),
        (None, None) => Err(format!(
            "is missing; expected a material of the law: {}",
            list()
        )),
        (Some(name), None) if names.is_empty() => Err(format!(
            "is \"{name}\", and the law has the numbers of one material; leave it out, or give the law its `materials` \
             and `pairs`"
        )),
        (Some(name), None) => Err(format!(
            "is \"{name}\"; expected a material of the law: {}",
            list()
        )),
    }
}

/// A contact law with the numbers of several materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum LawTable {
    /// Kumar 2018, eqs. 1 and 2: all five numbers belong to pairs.
    HertzHistory(HertzHistoryTable),
    /// Guillard 2014, eq. A1: each material has an elasticity, each pair a restitution and a friction.
    HertzTsuji(HertzTsujiTable),
}

/// Keys of `kind = "hertz_history"` with several materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HertzHistoryTable {
    /// Names of the materials, which have no numbers of their own; those of the pairs if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub materials: Option<BTreeMap<String, NoNumbers>>,
    /// The pairs that can meet.
    pub pairs: Vec<HertzHistoryPair>,
}

/// A material whose numbers all belong to pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoNumbers {}

/// Two materials that can meet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HertzHistoryPair {
    /// Their names; twice the same for grains of one material.
    pub between: [String; 2],
    /// As [`HertzHistoryParameters::kn`].
    pub kn: f64,
    /// As [`HertzHistoryParameters::kt`].
    pub kt: f64,
    /// As [`HertzHistoryParameters::gamma_n`].
    pub gamma_n: f64,
    /// As [`HertzHistoryParameters::gamma_t`].
    pub gamma_t: f64,
    /// Friction coefficient.
    pub mu: f64,
    /// Resistance to rolling; none if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling: Option<RollingSpec>,
}

/// Keys of `kind = "hertz_tsuji"` with several materials.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HertzTsujiTable {
    /// The elasticity of each material, by name.
    pub materials: BTreeMap<String, Elasticity>,
    /// The pairs that can meet.
    pub pairs: Vec<HertzTsujiPair>,
}

/// Two materials that can meet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HertzTsujiPair {
    /// Their names; twice the same for grains of one material.
    pub between: [String; 2],
    /// Coefficient of restitution, above 0 and at most 1.
    pub restitution: f64,
    /// Friction coefficient, zero or more.
    pub mu: f64,
    /// Resistance to rolling; none if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling: Option<RollingSpec>,
}

impl HertzHistoryPair {
    fn parameters(&self) -> HertzHistoryParameters {
        HertzHistoryParameters {
            kn: self.kn,
            kt: self.kt,
            gamma_n: self.gamma_n,
            gamma_t: self.gamma_t,
            mu: self.mu,
            rolling: self.rolling,
        }
    }
}

impl LawTable {
    /// Names of the materials, by number: in the order of the alphabet.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::HertzHistory(table) => match &table.materials {
                Some(materials) => materials.keys().map(String::as_str).collect(),
                None => {
                    let named: BTreeSet<&str> = self
                        .between()
                        .into_iter()
                        .flat_map(|pair| pair.iter().map(String::as_str))
                        .collect();
                    named.into_iter().collect()
                }
            },
            Self::HertzTsuji(table) => table.materials.keys().map(String::as_str).collect(),
        }
    }

    /// The pairs that have numbers, by the names of their materials.
    fn between(&self) -> Vec<&[String; 2]> {
        match self {
            Self::HertzHistory(table) => table.pairs.iter().map(|pair| &pair.between).collect(),
            Self::HertzTsuji(table) => table.pairs.iter().map(|pair| &pair.between).collect(),
        }
    }

    /// The pairs that have numbers, by the numbers of their materials; names that do not exist are left out.
    pub fn pairs(&self) -> Vec<Materials> {
        let names = self.names();
        let number = |name: &String| {
            let place = names.iter().position(|known| known == name)?;
            u8::try_from(place).ok()
        };
        let numbers = |[a, b]: &[String; 2]| Some([number(a)?, number(b)?]);
        self.between().into_iter().filter_map(numbers).collect()
    }

    /// Shear modulus and Poisson's ratio of a material, for the speed of waves in it; where all numbers belong to
    /// pairs, those of the stiffest pair that it is in.
    pub fn moduli(&self, material: u8) -> Option<(f64, f64)> {
        let names = self.names();
        let name = *names.get(usize::from(material))?;
        match self {
            Self::HertzHistory(table) => {
                let own = |pair: &&HertzHistoryPair| pair.between.iter().any(|of| of == name);
                let moduli = table
                    .pairs
                    .iter()
                    .filter(own)
                    .map(|pair| pair.parameters().moduli());
                moduli.max_by(|a, b| a.0.total_cmp(&b.0))
            }
            Self::HertzTsuji(table) => table.materials.get(name).map(Elasticity::moduli),
        }
    }

    /// The law as it is computed.
    ///
    /// # Errors
    /// The key and what was expected of it.
    pub fn build(&self) -> Result<AnyLaw, WrongKey> {
        let count = self.check_names()?;
        match self {
            Self::HertzHistory(table) => {
                let laws = table.pairs.iter().map(|pair| pair.parameters().build());
                let laws = self.filled(count, laws)?;
                Ok(match self.rolling(count)? {
                    None => AnyLaw::HertzHistoryPairs(Arc::new(laws)),
                    Some(rolling) => AnyLaw::HertzHistoryRolling(Arc::new(laws.rolling(&rolling))),
                })
            }
            Self::HertzTsuji(table) => {
                for (name, elasticity) in &table.materials {
                    elasticity
                        .check()
                        .map_err(|(key, problem)| (format!("materials.{name}.{key}"), problem))?;
                }
                let laws = table.pairs.iter().map(|pair| {
                    let [a, b] = [0, 1].map(|k| table.materials[&pair.between[k]]);
                    between([a, b], pair.restitution, pair.mu)
                });
                let laws = self.filled(count, laws)?;
                Ok(match self.rolling(count)? {
                    None => AnyLaw::HertzTsujiPairs(Arc::new(laws)),
                    Some(rolling) => AnyLaw::HertzTsujiRolling(Arc::new(laws.rolling(&rolling))),
                })
            }
        }
    }

    /// How many materials there are, if their number and the names of all pairs make sense.
    fn check_names(&self) -> Result<u8, WrongKey> {
        let names = self.names();
        let count = u8::try_from(names.len()).unwrap_or(u8::MAX);
        if !(1..=MATERIALS_MAX).contains(&names.len()) {
            let problem = format!(
                "has {} materials; expected 1 to {MATERIALS_MAX}",
                names.len()
            );
            return Err(("materials".into(), problem));
        }
        let pairs = self.between();
        if pairs.is_empty() {
            let problem = "is empty; expected the numbers of each two materials that can meet";
            return Err(("pairs".into(), problem.into()));
        }
        for (k, pair) in pairs.iter().enumerate() {
            let at = format!("pairs[{k}].between");
            if let Some(unknown) = pair.iter().find(|name| !names.contains(&name.as_str())) {
                let known = names.join(", ");
                let problem = format!("names \"{unknown}\", which is not in `materials`: {known}");
                return Err((at, problem));
            }
            let [a, b] = pair;
            let is_same = |other: &&&[String; 2]| {
                let [c, d] = other;
                (a, b) == (c, d) || (a, b) == (d, c)
            };
            if pairs[..k].iter().any(|other| is_same(&other)) {
                let problem = format!("names \"{a}\" and \"{b}\" a second time; leave one out");
                return Err((at, problem));
            }
        }
        Ok(count)
    }

    /// The table of these laws, which come in the order of the file; pairs without numbers, which cannot meet, have
    /// those of its first.
    fn filled<L: Copy>(
        &self,
        count: u8,
        laws: impl Iterator<Item = Result<L, Wrong>>,
    ) -> Result<Pairs<L>, WrongKey> {
        let mut given = Vec::new();
        for (k, law) in laws.enumerate() {
            given.push(law.map_err(|(key, problem)| (format!("pairs[{k}].{key}"), problem))?);
        }
        let table = Pairs::new(count, self.in_order(count, &given).collect());
        Ok(table.expect("one law for each pair"))
    }

    /// What there is of each pair of so many materials in the order of [`PairLaws::pairs`], of what is given for those
    /// of the file.
    fn in_order<T: Copy>(&self, count: u8, given: &[T]) -> impl Iterator<Item = T> {
        let pairs = self.pairs();
        let place =
            move |[a, b]: Materials| pairs.iter().position(|p| *p == [a, b] || *p == [b, a]);
        PairLaws::<()>::pairs(count).map(move |pair| given[place(pair).unwrap_or(0)])
    }

    /// What resists rolling between each two materials, in the order of [`PairLaws::pairs`]; none if nothing does.
    fn rolling(&self, count: u8) -> Result<Option<Vec<RollingResistance<f64>>>, WrongKey> {
        let all: Vec<Option<RollingSpec>> = match self {
            Self::HertzHistory(table) => table.pairs.iter().map(|pair| pair.rolling).collect(),
            Self::HertzTsuji(table) => table.pairs.iter().map(|pair| pair.rolling).collect(),
        };
        if all.iter().all(Option::is_none) {
            return Ok(None);
        }
        let mut given = Vec::new();
        for (k, rolling) in all.iter().enumerate() {
            given.push(match rolling {
                None => RollingResistance::NONE,
                Some(rolling) => rolling
                    .build()
                    .map_err(|(key, problem)| (format!("pairs[{k}].{key}"), problem))?,
            });
        }
        Ok(Some(self.in_order(count, &given).collect()))
    }
}
