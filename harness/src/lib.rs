//! bitgrain.
pub mod case; pub mod cli; pub mod error; pub mod lammps; pub mod law; pub mod order; pub mod replay; pub mod sim; pub mod summary;
