//! Grains as they are put into a simulation, and short names for what they do.

use crate::table::Word;

/// One grain as it is put into a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Name; names ascend in a simulation.
    pub id: u32,
    /// Place of its group in the simulation's table.
    pub group: u8,
    /// Diameter (length).
    pub diameter: f64,
    /// Mass density (mass / length^3).
    pub density: f64,
    /// Position of its centre (length), inside the box.
    pub position: [f64; 3],
    /// Velocity (length / time).
    pub velocity: [f64; 3],
    /// Spin (radians / time).
    pub spin: [f64; 3],
}

/// What a grain does in a bed, as its group says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Role {
    /// It moves as it is pushed.
    #[default]
    Free,
    /// It is fixed or carried, whatever pushes it.
    Base,
    /// It is carried along x and y and moves as it is pushed along z.
    Lid,
}

impl Word for Role {
    fn word(&self) -> &'static str {
        match self {
            Self::Free => "free",
            Self::Base => "base",
            Self::Lid => "lid",
        }
    }

    fn take(&mut self, word: &str) -> Option<()> {
        let known = [Self::Free, Self::Base, Self::Lid];
        *self = known.into_iter().find(|role| role.word() == word)?;
        Some(())
    }
}

/// Mass of a sphere: density times pi/6 times the diameter cubed.
pub fn sphere_mass(diameter: f64, density: f64) -> f64 {
    density * (std::f64::consts::PI / 6.0 * (diameter * diameter * diameter))
}

/// Lower-case hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
