//! What a checkpoint says beside its arrays.

use crate::simulation::{AnyLaw, hex};
use bitgrain_kernel::{Domain, Group, Obstacle};
use serde::{Deserialize, Serialize};

use super::{bodies, groups};

/// What a checkpoint holds besides the state.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StageState {
    /// Digest of the recipe a bed was poured by; empty for other states.
    pub recipe: String,
    /// The last link of the chain of digests up to this state; empty if there is none.
    pub link: String,
    /// The unfinished stage, as JSON: its accumulators, series and chain so far; empty for a bare state.
    pub course: String,
    /// The sums of its fields, little-endian words; empty if there are none.
    pub fields: Vec<u8>,
    /// Frames that no file holds yet; empty in a checkpoint that is kept.
    pub frames: String,
}

/// What is not an array of grains or contacts. One text under one key, so that a file's bytes do
/// not depend on the order of a map.
#[derive(Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Head {
    pub(super) format: u32,
    pub(super) bits_version: u32,
    pub(super) step: u64,
    pub(super) dt: f64,
    pub(super) law: AnyLaw,
    pub(super) domain: Domain<f64>,
    #[serde(with = "groups")]
    pub(super) groups: Vec<Group<f64>>,
    #[serde(with = "bodies")]
    pub(super) obstacles: Vec<Obstacle<f64>>,
    pub(super) recipe: String,
    pub(super) link: String,
    /// Digest of the state; reading recomputes it.
    pub(super) digest: String,
    /// The arrays, by name.
    pub(super) parts: Vec<PartSeal>,
    /// BLAKE3 over this text with the seal empty.
    pub(super) seal: String,
}

/// An array of the file: its length and its digest.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PartSeal {
    pub(super) name: String,
    pub(super) bytes: usize,
    blake3: String,
}

impl PartSeal {
    pub(super) fn of(name: &str, bytes: &[u8]) -> Self {
        Self {
            name: name.to_string(),
            bytes: bytes.len(),
            blake3: hex(blake3::hash(bytes).as_bytes()),
        }
    }
}

/// The versions that wrote a checkpoint.
#[derive(Deserialize)]
pub(super) struct Made {
    pub(super) format: u32,
    pub(super) bits_version: u32,
}

impl Head {
    pub(super) fn text(&self) -> String {
        serde_json::to_string(self).expect("a finite state is JSON")
    }

    /// The seal that belongs to this head.
    pub(super) fn sealed(&self) -> String {
        let open = Self {
            seal: String::new(),
            ..self.clone()
        };
        hex(blake3::hash(open.text().as_bytes()).as_bytes())
    }
}

/// The arrays that only states of drags with fields have, worlds with meshes, and states saved between two kept ones.
pub(super) const FIELDS: &str = "fields";

/// Words that the law keeps of each contact.
pub(super) const WORDS: &str = "bond_words";

pub(super) const FACETS: &str = "facets";

pub(super) const FRAMES: &str = "frames";
