//! Digests: one BLAKE3 hash for each part of a state and one over the parts.
//!
//! A digest reads the numbers' words, little-endian, by ascending id, so it is the same on machines
//! of either byte order, and its parts say what differs when two runs differ.

use crate::blake3::Hasher;
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::{get_or_default, prefix};
use crate::math::vec3::head;
use crate::neighbors::pair_list::ContactHistory;
use crate::state::shape::Shape;
use crate::world::World;

/// BLAKE3 hashes of a state, 32 bytes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Digest {
    /// Ids, positions, radii and crossings of periodic axes.
    pub positions: [u8; 32],
    /// Velocities and masses.
    pub velocities: [u8; 32],
    /// Spins.
    pub spins: [u8; 32],
    /// Tangential springs of the touching contacts, with the ids of their bodies; of a law that keeps words of
    /// contacts those too, up to the last one that is not zero.
    pub histories: [u8; 32],
    /// Contact forces and torques on the grains.
    pub forces: [u8; 32],
    /// Obstacles: place, crossings, velocity, force and torque; of those that turn or have turned, orientation and
    /// angular velocity too; of meshes, what tells their triangles from others.
    pub obstacles: [u8; 32],
    /// The hash of the six above, in this order.
    pub whole: [u8; 32],
}

/// The word before the orientation of a body.
const TURNED: u32 = u32::from_le_bytes(*b"turn");

/// The word before the number of words that a law keeps of a contact.
const MEMORY: u32 = u32::from_le_bytes(*b"kept");

/// The word before the name of a mesh.
const MESH: u32 = u32::from_le_bytes(*b"mesh");

/// Names of a digest's parts, in order.
pub const PARTS: [&str; 6] = [
    "positions",
    "velocities",
    "spins",
    "histories",
    "forces",
    "obstacles",
];

impl Digest {
    /// The parts in the order of [`PARTS`].
    pub fn parts(&self) -> [&[u8; 32]; 6] {
        [
            &self.positions,
            &self.velocities,
            &self.spins,
            &self.histories,
            &self.forces,
            &self.obstacles,
        ]
    }
}

/// Digests a state. Forces and histories are those of the last evaluation.
///
/// # Errors
/// [`Error::NotStarted`] of a world in the middle of a step, or that a fault has stopped there: it has no state.
pub fn digest<R: Real>(world: &World<'_, R>) -> Result<Digest, Error> {
    match world.clock.has_state() {
        true => Ok(digest_rows(world)),
        false => Err(Error::NotStarted),
    }
}

/// Digests what stands in the rows.
pub(crate) fn digest_rows<R: Real>(world: &World<'_, R>) -> Digest {
    let g = &world.grains;
    let id = |place: u32| get_or_default(g.id, place as usize);
    let positions = hash(|h| {
        for ((id, position), image) in g.id.iter().zip(&*g.position).zip(&*g.image) {
            h.word(*id);
            numbers(h, position);
            images(h, image);
        }
    });
    let velocities = hash(|h| g.velocity.iter().for_each(|v| numbers(h, v)));
    let spins = hash(|h| g.spin.iter().for_each(|w| numbers(h, &head(*w))));
    let histories = hash(|h| {
        for contact in world.kept_contacts() {
            let (kind, i, partner) = match contact.history {
                ContactHistory::Pair { i, j, .. } => (0, i, id(j)),
                ContactHistory::Obstacle { i, obstacle, .. } => (1, i, obstacle),
            };
            for word in [kind, id(i), partner] {
                h.word(word);
            }
            let kept = contact.kept();
            numbers(h, &kept.spring);
            // Only then, so that laws without words have the digests that they had before there were any.
            let words = kept.words();
            if words > 0 {
                h.word(MEMORY);
                h.word(words as u32);
                numbers(h, prefix(&kept.memory, words));
            }
        }
    });
    let forces = hash(|h| {
        for (force, torque) in g.force.iter().zip(&*g.torque) {
            numbers(h, &head(*force));
            numbers(h, &head(*torque));
        }
    });
    let obstacles = hash(|h| {
        for body in world.obstacles.iter() {
            numbers(h, &body.point);
            images(h, &body.image);
            for v in [&body.velocity, &body.force, &body.torque] {
                numbers(h, v);
            }
            // Only then, so that a body that never turns has the digest that it had before bodies turned.
            if body.has_turned() {
                h.word(TURNED);
                numbers(h, &body.orientation);
                numbers(h, &body.angular_velocity);
            }
            if let Shape::Mesh { name, .. } = body.shape {
                h.word(MESH);
                h.word(name as u32);
                h.word((name >> 32) as u32);
            }
        }
    });
    let whole = hash(|h| {
        for part in [
            &positions,
            &velocities,
            &spins,
            &histories,
            &forces,
            &obstacles,
        ] {
            h.hash(part);
        }
    });
    Digest {
        positions,
        velocities,
        spins,
        histories,
        forces,
        obstacles,
        whole,
    }
}

// One after the other in the same memory: inlined, several hashers would lie on the stack side by side.
#[inline(never)]
fn hash(feed: impl FnOnce(&mut Hasher)) -> [u8; 32] {
    let mut hasher = Hasher::new();
    feed(&mut hasher);
    hasher.finish()
}

fn numbers<R: Real>(h: &mut Hasher, values: &[R]) {
    for value in values {
        let (low, high) = value.to_words();
        h.word(low);
        if let Some(high) = high {
            h.word(high);
        }
    }
}

fn images(h: &mut Hasher, image: &[i32; 3]) {
    for k in image {
        h.word(*k as u32);
    }
}
