//! Contact laws as files name them, with the time step that they allow.
//!
//! Each law has its own file; [`laws`] alone names them all.

mod hertz_history;
mod hertz_tsuji;
pub mod laws;
mod pairs;
mod parameters;
mod rolling;
mod table;
mod time_step;

pub use hertz_history::HertzHistoryParameters;
pub use hertz_tsuji::{Elasticity, HertzTsujiParameters};
pub use laws::{AnyLaw, LawSpec, WithLaw};
pub use pairs::Pairs;
pub use parameters::{LawParameters, Springs, Sprung, Wrong, WrongKey};
pub use rolling::RollingSpec;
pub use table::{
    HertzHistoryPair, HertzHistoryTable, HertzTsujiPair, HertzTsujiTable, LawTable, MATERIALS_MAX,
    NoNumbers, material_number,
};
pub use time_step::{CONTACT_FRACTION_MAX, RAYLEIGH_FRACTION_MAX, check_rayleigh, rayleigh_time};
