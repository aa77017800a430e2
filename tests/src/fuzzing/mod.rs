//! Bodies of the fuzz targets: no input bytes may cause a panic or a hang, sound input
//! is written and read back unchanged, and every state of a run is finite.
//!
//! Each returns whether the bytes were sound (something was read, or at least one step done), so
//! that the replay of the committed corpus cannot pass by refusing everything.

mod bytes;
mod capi;
mod checkpoint;
mod contact;
mod drawn;
mod edits;
mod exact;
mod finite;
mod hostile;
mod lent;
mod manifest;
#[path = "../../../kernel/tests/kernel/common/part.rs"]
mod part;
// Fuzz bodies step parts themselves.
#[allow(dead_code)]
#[path = "../../../kernel/tests/kernel/common/parts.rs"]
mod parts;
mod recording;
mod records;
mod saved;
mod search;
mod texts;
mod world;

pub use capi::capi;
pub use checkpoint::checkpoint;
pub use contact::contact;
pub use edits::edits;
pub use manifest::manifest;
pub use recording::recording;
pub use records::{book, campaign, summary, table};
pub use saved::saved;
pub use search::search;
pub use texts::{assert_same_bits, case, lammps, scenario, series};
pub use world::world;
