//! How grains of a group move, by name.

use bitgrain_kernel::Group;

/// How the grains of a group move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// As they are pushed.
    Free,
    /// Not at all.
    Frozen,
    /// At the velocity that they have.
    Carried,
    /// So along x and y, and as they are pushed along z.
    Lid,
}

/// The kinds and their names in Python.
pub const KINDS: [(Kind, &str); 4] = [
    (Kind::Free, "free"),
    (Kind::Frozen, "frozen"),
    (Kind::Carried, "carried"),
    (Kind::Lid, "lid"),
];

impl Kind {
    /// The group of this kind under a gravity, of a material.
    pub fn group(self, gravity: [f64; 3], material: u8) -> Group<f64> {
        let group = match self {
            Self::Free => Group::free(gravity),
            Self::Frozen => Group::frozen(),
            Self::Carried => Group::prescribed_velocity(),
            Self::Lid => Group::free_along_z(gravity),
        };
        group.of_material(material)
    }
}
