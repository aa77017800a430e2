//! A campaign in pieces that many processes do, on any number of machines that share its folder and the cache of beds.
//!
//! 1. [`missing`] lists the tasks: beds that the cache does not have, and drags that have not ended. A task is a stage
//!    of a member, `MEMBER/STAGE`.
//! 2. A worker does one task ([`perform`]) in a run directory of its own, `tasks/MEMBER/STAGE`, which it locks, which
//!    has its own manifest, and in which a later worker goes on if it is killed.
//! 3. Beds pass through the cache. Who needs one that another worker pours waits for it.
//! 4. `gather`, at the begin of a sweep, reads each ended drag by the manifest of its task, writes it through the
//!    manifest of its member, and only then removes the folder of the task.
//! 5. From there on the campaign is one that a single process has run so far.
//!
//! No result hangs on a lock: two workers that do one task write the same bytes, and each file replaces the old one
//! as a whole. Locks only save time.

mod ended;
mod gather;
mod list;
mod names;
mod work;

pub(super) use gather::{clear, gather};
pub use list::{Missing, missing};
pub use work::{Ended, Worker, perform};
