//! Contact laws, and their evaluation in blocks of pairs.

pub(crate) mod block;
mod hertz_history;
mod hertz_tsuji;
pub(crate) mod law;
mod pair_laws;
mod rolling;
pub(crate) mod slide;

pub use hertz_history::HertzHistory;
pub use hertz_tsuji::HertzTsuji;
pub use law::{
    Contact, ContactMemory, Kept, Law, MEMORY_MAX, Materials, NormalForce, NormalState, Reaction,
    TangentialForce, TangentialState, Torque, TurningState, react,
};
pub use pair_laws::PairLaws;
pub use rolling::{Rolling, RollingResistance, RollingSpring, SpringInPlane};
