//! The threads of a world.

use bitgrain::threads::{ThreadsError, pool};
use rayon::ThreadPool;

use crate::simulated::Core;

/// Fewest grains of a thread: with fewer grains than twice this, a simulation steps on one thread.
const GRAINS_OF_A_THREAD: usize = 500;

/// Threads that were started.
pub struct Pool {
    /// The threads.
    pub threads: ThreadPool,
    /// The process that they are of: one that is forked from it has none of them.
    process: u32,
}

impl Core {
    /// Starts the threads of this world, if they are wanted and this process has none.
    ///
    /// # Errors
    /// [`ThreadsError`].
    pub fn start_threads(&mut self) -> Result<(), ThreadsError> {
        let process = std::process::id();
        if let Some(left_behind) = self.pool.take_if(|pool| pool.process != process) {
            // Ending them would wait for locks that they may have held as the process was forked.
            std::mem::forget(left_behind);
        }
        let wanted = self.threads > 1 && self.sim.count() >= 2 * GRAINS_OF_A_THREAD;
        if wanted && self.pool.is_none() {
            let threads = pool(self.threads)?;
            self.pool = Some(Pool { threads, process });
        }
        Ok(())
    }
}
