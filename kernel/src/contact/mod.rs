//! Contact laws, and their evaluation in blocks of pairs.

pub(crate) mod block;
mod columns;
mod hertz_history;
mod hertz_tsuji;
pub(crate) mod kept;
pub(crate) mod law;
mod pair_laws;
pub(crate) mod react;
mod rolling;
pub(crate) mod slide;

pub use hertz_history::HertzHistory;
pub use hertz_tsuji::HertzTsuji;
pub use kept::{ContactMemory, Kept, MEMORY_MAX};
pub use law::{
    Law, Materials, NormalForce, NormalState, TangentialForce, TangentialState, Torque,
    TurningState,
};
pub use pair_laws::PairLaws;
pub use react::{Contact, Reaction, react};
pub use rolling::{Rolling, RollingResistance, RollingSpring, SpringInPlane};
