//! Obstacles as a checkpoint spells them: what only bodies that turn or move freely have is left out of others, so that
//! their files are those of before there were such bodies.

use bitgrain_kernel::{Motion, Obstacle, Shape};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An obstacle in the file.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Obstacle<f64>", deny_unknown_fields)]
struct Body {
    shape: Shape<f64>,
    point: [f64; 3],
    image: [i32; 3],
    velocity: [f64; 3],
    inverse_mass: f64,
    force: [f64; 3],
    torque: [f64; 3],
    #[serde(default = "upright", skip_serializing_if = "is_upright")]
    orientation: [f64; 4],
    #[serde(default, skip_serializing_if = "is_zero")]
    angular_velocity: [f64; 3],
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    curved: bool,
    #[serde(default, skip_serializing_if = "is_first")]
    material: u8,
    #[serde(default = "prescribed", skip_serializing_if = "is_prescribed")]
    motion: Motion<f64>,
}

fn upright() -> [f64; 4] {
    [1.0, 0.0, 0.0, 0.0]
}

fn is_upright(orientation: &[f64; 4]) -> bool {
    *orientation == upright()
}

fn is_zero(spin: &[f64; 3]) -> bool {
    *spin == [0.0; 3]
}

pub(super) fn is_first(material: &u8) -> bool {
    *material == 0
}

fn prescribed() -> Motion<f64> {
    Motion::Prescribed
}

fn is_prescribed(motion: &Motion<f64>) -> bool {
    *motion == prescribed()
}

/// An obstacle that is spelled so.
#[derive(Serialize, Deserialize)]
struct Spelled(#[serde(with = "Body")] Obstacle<f64>);

pub(super) fn serialize<S: Serializer>(all: &[Obstacle<f64>], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(all.iter().copied().map(Spelled))
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Vec<Obstacle<f64>>, D::Error> {
    let all = Vec::<Spelled>::deserialize(from)?;
    Ok(all.into_iter().map(|Spelled(body)| body).collect())
}
