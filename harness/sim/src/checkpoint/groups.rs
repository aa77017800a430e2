//! Groups as a checkpoint spells them: the material is left out where there is one only, so that files are those of
//! before there were several.

use bitgrain_kernel::Group;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::bodies::is_first;

/// A group in the file.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Group<f64>", deny_unknown_fields)]
struct Motion {
    integrates: [bool; 3],
    spins: bool,
    #[serde(rename = "heavy")]
    infinite_mass: bool,
    gravity: [f64; 3],
    #[serde(default, skip_serializing_if = "is_first")]
    material: u8,
}

/// A group that is spelled so.
#[derive(Serialize, Deserialize)]
struct Spelled(#[serde(with = "Motion")] Group<f64>);

pub(super) fn serialize<S: Serializer>(all: &[Group<f64>], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(all.iter().copied().map(Spelled))
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Group<f64>>, D::Error> {
    let all = Vec::<Spelled>::deserialize(from)?;
    Ok(all.into_iter().map(|Spelled(group)| group).collect())
}
