//! What an analysis found, or why it found nothing.

use crate::fit::Refusal;
use serde::{Deserialize, Serialize};

/// What was found, or why it was not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Finding<T> {
    /// What was found.
    Found(T),
    /// Why the data cannot carry it.
    Refused(Refusal),
}

impl<T> Finding<T> {
    /// What was found, if it was.
    pub fn found(&self) -> Option<&T> {
        match self {
            Finding::Found(found) => Some(found),
            Finding::Refused(_) => None,
        }
    }

    /// Refused with a sentence.
    pub fn refused(why: impl Into<String>) -> Self {
        Finding::Refused(Refusal(why.into()))
    }
}

impl<T> From<Result<T, Refusal>> for Finding<T> {
    fn from(found: Result<T, Refusal>) -> Self {
        found.map_or_else(Finding::Refused, Finding::Found)
    }
}
