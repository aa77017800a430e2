//! A number that was measured of a claim, with what it rests on, and how several become one.

use serde::{Deserialize, Serialize};

use crate::analysis::Value;

/// How several numbers of a claim become one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Combine {
    /// Their mean, weighted by their errors.
    #[default]
    Mean,
    /// The one that speaks most against the claim, which must hold for each.
    Worst,
}

impl Combine {
    /// Whether this is what claims do that do not say.
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A number that was measured of a claim.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// The number with its standard error, in the units of the claim.
    pub value: Value,
    /// What it rests on.
    pub note: String,
    /// Of how many numbers it is the worst ([`Combine::Worst`]), at least 1.
    pub of: usize,
}

/// A number, or why there is none.
pub type Found = Result<Number, String>;

impl Number {
    /// The only number, or a mean.
    pub fn one(value: Value, note: impl Into<String>) -> Self {
        Self {
            value,
            note: note.into(),
            of: 1,
        }
    }
}
