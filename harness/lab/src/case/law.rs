//! The law of a case: the numbers of one material, or of each pair of several.

use bitgrain_sim::law::{
    AnyLaw, LawSpec, LawTable, WrongKey, check_rayleigh, material_number, rayleigh_time,
};
use serde::{Deserialize, Deserializer, Serialize, de::Error};

use super::keys::Case;

/// A contact law with the numbers of one material, or with `pairs` of several.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum CaseLaw {
    /// The same numbers for every contact.
    One(LawSpec),
    /// Those of each pair of materials.
    Pairs(LawTable),
}

impl From<LawSpec> for CaseLaw {
    fn from(law: LawSpec) -> Self {
        Self::One(law)
    }
}

impl From<LawTable> for CaseLaw {
    fn from(law: LawTable) -> Self {
        Self::Pairs(law)
    }
}

impl<'de> Deserialize<'de> for CaseLaw {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let law = serde_json::Value::deserialize(from)?;
        let read = match law.get("pairs").or(law.get("materials")) {
            Some(_) => serde_path_to_error::deserialize(law).map(Self::Pairs),
            None => serde_path_to_error::deserialize(law).map(Self::One),
        };
        read.map_err(|wrong| match wrong.path().to_string().as_str() {
            "." => D::Error::custom(wrong.inner()),
            key => D::Error::custom(format!("{key}: {}", wrong.inner())),
        })
    }
}

impl CaseLaw {
    /// The law as it is computed.
    ///
    /// # Errors
    /// The key and what was expected of it.
    pub fn build(&self) -> Result<AnyLaw, WrongKey> {
        match self {
            Self::One(law) => law.build().map_err(|(key, problem)| (key.into(), problem)),
            Self::Pairs(law) => law.build(),
        }
    }

    /// Names of its materials by number; none if all contacts have the same numbers.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::One(_) => Vec::new(),
            Self::Pairs(law) => law.names(),
        }
    }

    /// The number of the material with this name; of the only one, if none is named.
    ///
    /// # Errors
    /// What is wrong with the name, or that there is none.
    pub(super) fn material(&self, name: Option<&str>) -> Result<u8, String> {
        material_number(&self.names(), name)
    }

    /// How many materials there are.
    pub(super) fn materials(&self) -> u8 {
        match self {
            Self::One(_) => 1,
            Self::Pairs(law) => law.names().len() as u8,
        }
    }
}

/// Checks that the law has numbers for every two bodies of the case that can meet, and that the time step resolves
/// waves in the grains. The names of all materials are known to be right.
pub(super) fn check_law(case: &Case) -> Result<(), WrongKey> {
    let grains = case.grains.iter();
    let grains = grains.map(|g| (g, case.law.material(g.material.as_deref()).unwrap_or(0)));
    let grains: Vec<_> = grains.collect();
    let time = |g: &super::keys::GrainSpec, material| match &case.law {
        CaseLaw::One(law) => law.rayleigh_time(0.5 * g.diameter, g.density),
        CaseLaw::Pairs(law) => {
            let moduli = law.moduli(material);
            moduli.map_or(f64::INFINITY, |moduli| {
                rayleigh_time(moduli, 0.5 * g.diameter, g.density)
            })
        }
    };
    let times = grains.iter().map(|(g, material)| time(g, *material));
    check_rayleigh(case.dt, times).map_err(|problem| ("dt".to_string(), problem))?;
    let CaseLaw::Pairs(law) = &case.law else {
        return Ok(());
    };
    let mut counts = vec![0usize; usize::from(case.law.materials())];
    for (_, material) in &grains {
        counts[usize::from(*material)] += 1;
    }
    let names = law.names();
    let bodies = case.obstacles.iter();
    let bodies = bodies.map(|body| case.law.material(body.material.as_deref()).unwrap_or(0));
    let bodies: Vec<u8> = bodies.collect();
    for a in (0..case.law.materials()).filter(|a| counts[usize::from(*a)] > 0) {
        for b in 0..case.law.materials() {
            let least = if a == b { 2 } else { 1 };
            let meet = counts[usize::from(b)] >= least || bodies.contains(&b);
            if meet && !law.has([a, b]) {
                let [a, b] = [a, b].map(|material| names[usize::from(material)]);
                let problem = format!(
                    "has no numbers for \"{a}\" on \"{b}\", which can meet; add {{\"between\": [\"{a}\", \
                     \"{b}\"], ...}}"
                );
                return Err(("law.pairs".into(), problem));
            }
        }
    }
    Ok(())
}
