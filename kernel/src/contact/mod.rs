//! Contact laws, and their evaluation in blocks of pairs.

pub(crate) mod block;
mod hertz_history;
mod hertz_tsuji;
pub(crate) mod law;
mod pair_laws;
pub(crate) mod slide;

pub use hertz_history::HertzHistory;
pub use hertz_tsuji::HertzTsuji;
pub use law::{
    Contact, Law, Materials, NormalForce, NormalState, Reaction, TangentialForce, TangentialState,
    react,
};
pub use pair_laws::PairLaws;
