//! What the exchange and the crew use of threads. Model checkers in the tests put their own in its place.

use std::time::Duration;

pub(super) use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
pub(super) use std::sync::{Mutex, MutexGuard, RwLock, RwLockReadGuard};

/// Looks without success after which a thread lets go of a part, and of its core.
pub(super) const PATIENCE: u32 = 4000;

/// Looks after which it looks whether it can help another part.
pub(super) const HELP: u32 = 64;

/// How long it then sleeps: with more threads than cores another one runs, and a system that has put two threads on one
/// core finds another core when it wakes them, which it does not while they only yield.
const NAP: Duration = Duration::from_micros(50);

/// Between two looks.
pub(super) fn spin() {
    std::hint::spin_loop();
}

/// After many looks in vain.
pub(super) fn nap() {
    std::thread::sleep(NAP);
}

/// Does something else that the pool of this thread has to do; `false` if there is nothing.
pub(super) fn do_other_work() -> bool {
    rayon::yield_now() == Some(rayon::Yield::Executed)
}
