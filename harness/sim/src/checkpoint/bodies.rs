//! Obstacles as a checkpoint spells them: what only bodies that turn or move freely have is left out of others, so that
//! their files are those of before there were such bodies.

use bitgrain_kernel::{Motion, Obstacle, Shape};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// An obstacle in the file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
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
    #[serde(default, skip_serializing_if = "is_false")]
    curved: bool,
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
    spin.iter().all(|x| x.to_bits() == 0)
}

fn is_false(flag: &bool) -> bool {
    !flag
}

fn prescribed() -> Motion<f64> {
    Motion::Prescribed
}

fn is_prescribed(motion: &Motion<f64>) -> bool {
    *motion == Motion::Prescribed
}

/// Whether a file of the third layout could say it.
pub(super) fn is_plain(body: &Obstacle<f64>) -> bool {
    let is_old = matches!(
        body.shape,
        Shape::Sphere { .. } | Shape::Cylinder { .. } | Shape::Plane { .. }
    );
    is_old
        && is_upright(&body.orientation)
        && is_zero(&body.angular_velocity)
        && is_prescribed(&body.motion)
        && !body.curved
}

pub(super) fn serialize<S: Serializer>(all: &[Obstacle<f64>], to: S) -> Result<S::Ok, S::Error> {
    to.collect_seq(all.iter().map(|body| Body {
        shape: body.shape,
        point: body.point,
        image: body.image,
        velocity: body.velocity,
        inverse_mass: body.inverse_mass,
        force: body.force,
        torque: body.torque,
        orientation: body.orientation,
        angular_velocity: body.angular_velocity,
        curved: body.curved,
        motion: body.motion,
    }))
}

pub(super) fn deserialize<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<Vec<Obstacle<f64>>, D::Error> {
    let all = Vec::<Body>::deserialize(from)?;
    let body = |body: Body| Obstacle {
        image: body.image,
        velocity: body.velocity,
        inverse_mass: body.inverse_mass,
        force: body.force,
        torque: body.torque,
        orientation: body.orientation,
        angular_velocity: body.angular_velocity,
        curved: body.curved,
        motion: body.motion,
        ..Obstacle::new(body.shape, body.point)
    };
    Ok(all.into_iter().map(body).collect())
}
