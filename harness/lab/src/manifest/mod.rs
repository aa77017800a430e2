//! The manifest of a run or a campaign, `manifest.json`: what its folder holds and how far it has come.
//!
//! It has every file of results with its length and hash, every stage with the last link of its chain of
//! digests, what is finished, and a closing hash over all of that; no time and nothing of the machine, so
//! that two runs of one scenario have the same. It guards against accidents: if somebody changes a file and
//! rebuilds the manifest, only executing the run again finds it, or a closing hash that was
//! kept elsewhere.
//!
//! [`Ledger`] is the manifest in progress, [`Vouched`] reads what a manifest vouches for, and
//! [`audit`] says how a folder departs from it.

pub mod audit;
mod ledger;
mod record;
mod vouched;

pub use audit::{Planned, When};
pub use ledger::Ledger;
pub use record::{
    Departure, FORMAT, FileRecord, FolderKind, Manifest, NAME, StageRecord, relative,
};
pub(crate) use record::{FAILURE, is_marked};
pub use vouched::Vouched;
