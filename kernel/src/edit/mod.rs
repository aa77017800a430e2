//! Changes of a world at rest that need no new start: all contact histories stay, but those of grains that are gone.
//!
//! [`nudge()`] costs nothing to speak of. [`remove()`] and [`take_out`](losses::take_out) go over all rows and lists
//! once. [`insert()`] and [`regroup()`] also search for the neighbours of their grains, once for all grains of a call.
//! Each is refused before it changes anything, or puts back what it changed.

mod depths;
mod insert;
mod losses;
mod nudge;
mod regroup;
mod remove;
pub(crate) mod renumber;
pub(crate) mod settle;

pub use insert::{NewGrains, insert};
pub use losses::take_out;
pub use nudge::nudge;
pub use regroup::regroup;
pub use remove::remove;
