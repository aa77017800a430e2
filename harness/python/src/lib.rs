//! The native part of the Python package `bitgrain`: worlds, laws, and the laboratory's commands as functions.
//!
//! A call goes from Python's arrays (`arrays`, `grains`) to `simulated`, which owns a simulation and knows no Python,
//! and back through views (`views`, `readings`), handles (`obstacles`, `several`) and exceptions (`errors`). The
//! laboratory's functions are in `laboratory`, recordings of any arrays in `recordings`.

mod arrays;
mod changes;
mod drives;
mod edits;
mod errors;
mod geometry;
mod grains;
mod kinds;
mod laboratory;
mod laws;
mod obstacles;
mod readings;
mod recordings;
mod saved;
mod settings;
mod several;
mod simulated;
mod steps;
mod stiffness;
mod threads;
mod views;
mod watch;
mod world;

/// The native part of `bitgrain`.
#[pyo3::pymodule]
mod _native {
    #[pymodule_export]
    use super::edits::Edit;
    #[pymodule_export]
    use super::grains::{Departed, Group};
    #[pymodule_export]
    use super::laboratory::{bisect, check, command, run, text, verify};
    #[pymodule_export]
    use super::laws::{HertzHistory, HertzTsuji};
    #[pymodule_export]
    use super::obstacles::Obstacle;
    #[pymodule_export]
    use super::recordings::{Writer, is_recording, part_recordings};
    #[pymodule_export]
    use super::several::Obstacles;
    #[pymodule_export]
    use super::stiffness::contact_duration;
    #[pymodule_export]
    use super::views::Window;
    #[pymodule_export]
    use super::world::World;
    #[pymodule_export]
    const BITS_VERSION: u32 = bitgrain_kernel::BITS_VERSION;
}
