//! What needs a process of its own, a test at a time: calls to the file system that fail, processor modes,
//! and what is asked of the allocator.

use std::sync::{Mutex, MutexGuard};

mod allocations;
mod disk;
mod modes;

/// One test at a time holds this: what they look at is of the whole process.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(|broken| broken.into_inner())
}
