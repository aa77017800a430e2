//! bitgrain.
pub mod error; pub mod lammps; pub mod order; pub mod sim; pub mod summary;
