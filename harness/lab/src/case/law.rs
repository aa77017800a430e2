//! The law of a case: the numbers of one material, or of each pair of several.

use bitgrain_sim::law::{AnyLaw, LawSpec, LawTable, WrongKey};
use serde::{Deserialize, Deserializer, Serialize, de::Error};

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
            Self::One(law) => law.build(),
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

    /// How many materials there are.
    pub(super) fn materials(&self) -> u8 {
        match self {
            Self::One(_) => 1,
            Self::Pairs(law) => law.names().len() as u8,
        }
    }
}
