//! Tests that need their own process, one at a time: calls to the file system that fail, processor modes,
//! and calls to the allocator.

use std::sync::{Mutex, MutexGuard};

mod allocations;
mod disk;
mod joints;
mod modes;
mod pieces;
mod recordings;

/// One test at a time holds this: they examine the whole process.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(|broken| broken.into_inner())
}
