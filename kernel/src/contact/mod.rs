//! Contact laws, and their evaluation in blocks of pairs.

pub(crate) mod block;
mod hertz_history;
mod hertz_tsuji;
pub(crate) mod law;

pub use hertz_history::HertzHistory;
pub use hertz_tsuji::HertzTsuji;
pub use law::{
    Contact, Law, NormalForce, NormalState, Reaction, TangentialForce, TangentialState, react,
};
