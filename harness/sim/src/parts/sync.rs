//! What the exchange and the crew use of threads. Model checkers in the tests put their own in its place.

use std::sync::{Condvar, PoisonError};
use std::time::Duration;

pub(super) use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
pub(super) use std::sync::{Mutex, MutexGuard, RwLock, RwLockReadGuard};

/// Looks without success after which a thread lets go of a part, and sleeps.
pub(super) const PATIENCE: u32 = 1000;

/// Looks after which it looks whether it can help another part.
pub(super) const HELP: u32 = 16;

/// Looks after which it lends its core to others between two of them: a few microseconds.
const BUSY: u32 = 50;

/// How long a thread sleeps that looks for letters of other processes, which wake nobody.
const NAP: Duration = Duration::from_micros(50);

/// How long one sleeps at most that is woken when there is something to do.
const SLEEP: Duration = Duration::from_millis(1);

/// After so many looks in vain, before the next one.
pub(super) fn pause(looks: u32) {
    match looks < BUSY {
        true => std::hint::spin_loop(),
        false => std::thread::yield_now(),
    }
}

/// After many looks in vain, where letters of other processes are waited for.
pub(super) fn nap() {
    std::thread::sleep(NAP);
}

/// Does something else that the pool of this thread has to do; `false` if there is nothing.
pub(super) fn do_other_work() -> bool {
    rayon::yield_now() == Some(rayon::Yield::Executed)
}

/// Where threads sleep that have nothing to do: their cores are free for others, and a system that has put two threads
/// on one core finds another core when it wakes them, which it does not while they only yield.
#[derive(Default)]
pub(super) struct Bell {
    asleep: AtomicUsize,
    door: Mutex<()>,
    rung: Condvar,
}

impl Bell {
    /// Sleeps until it is rung, or for a while, unless there is something to do already.
    pub fn wait(&self, ready: impl Fn() -> bool) {
        let door = self.door.lock().unwrap_or_else(PoisonError::into_inner);
        self.asleep.fetch_add(1, Ordering::SeqCst);
        if !ready() {
            let _ = self.rung.wait_timeout(door, SLEEP);
        }
        self.asleep.fetch_sub(1, Ordering::SeqCst);
    }

    /// Wakes one thread if any sleeps, after there is something to do.
    pub fn ring(&self) {
        std::sync::atomic::fence(Ordering::SeqCst);
        if self.asleep.load(Ordering::SeqCst) > 0 {
            drop(self.door.lock());
            self.rung.notify_one();
        }
    }

    /// Wakes all.
    pub fn ring_for_all(&self) {
        drop(self.door.lock());
        self.rung.notify_all();
    }
}
