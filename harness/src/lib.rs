//! bitgrain.
pub mod bed; pub mod bench; pub mod case; pub mod checkpoint; pub mod cli; pub mod drag; pub mod error; pub mod files; pub mod lammps; pub mod law; pub mod observe; pub mod order; pub mod progress; pub mod random; pub mod replay; pub mod report; pub mod run; pub mod scenario; pub mod sim; pub mod summary;
