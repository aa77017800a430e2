//! Threads: how many there are, and work on rows that any of them may do.

use bitgrain_kernel::phases::GrainMotion;
use bitgrain_kernel::{Error as KernelError, check_arithmetic};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::LazyLock;

/// Why a job was not done on this many threads.
#[derive(Debug, thiserror::Error)]
pub enum ThreadsError {
    /// This many could not be started.
    #[error("{threads} threads cannot be started: {why}")]
    Start {
        /// How many were wanted.
        threads: usize,
        /// What the system says.
        why: String,
    },
    /// One of them does not compute by the bit contract.
    #[error("{0}")]
    Arithmetic(KernelError),
}

impl ThreadsError {
    /// That this many could not be started.
    pub fn start(threads: usize, why: &dyn std::error::Error) -> Self {
        let why = why.to_string();
        Self::Start { threads, why }
    }
}

/// Processors that this process may use, as they were when it first asked.
pub fn processors() -> usize {
    static COUNT: LazyLock<usize> =
        LazyLock::new(|| std::thread::available_parallelism().map_or(1, usize::from));
    *COUNT
}

/// Threads of the pool that this is called in; 1 outside of any.
pub fn threads() -> usize {
    if rayon::current_thread_index().is_some() {
        rayon::current_num_threads()
    } else {
        1
    }
}

/// Stack of a thread (bytes): said for each, so that no variable of the environment makes it too short.
pub(crate) const STACK: usize = 2 << 20;

/// What a thread is started by; its stack is long enough.
pub fn builder() -> std::thread::Builder {
    std::thread::Builder::new().stack_size(STACK)
}

/// Threads for jobs, all of which compute by the bit contract.
///
/// # Errors
/// [`ThreadsError`].
pub fn pool(threads: usize) -> Result<ThreadPool, ThreadsError> {
    let pool = ThreadPoolBuilder::new().num_threads(threads);
    let pool = pool.stack_size(STACK).build();
    let pool = pool.map_err(|e| ThreadsError::start(threads, &e))?;
    // Each thread has its own rounding mode.
    for checked in pool.broadcast(|_| check_arithmetic::<f64>()) {
        checked.map_err(ThreadsError::Arithmetic)?;
    }
    Ok(pool)
}

/// Does a job on this many threads: those of a pool round it, or, for one, where it is called.
///
/// # Errors
/// [`ThreadsError`].
pub fn on_threads<T: Send>(
    threads: usize,
    job: impl FnOnce() -> T + Send,
) -> Result<T, ThreadsError> {
    if threads <= 1 {
        return Ok(job());
    }
    Ok(pool(threads)?.install(job))
}

/// Something for grains one after the other that splits into two of the kind.
pub(crate) trait Split: Sized + Send {
    /// How many grains it is for.
    fn count(&self) -> usize;
    /// The first `grains` grains, and the others.
    fn split(self, grains: usize) -> (Self, Self);
}

/// What passes of motion read and write of some grains, and the place of the first of them.
pub(crate) struct RowsFrom<'a>(pub GrainMotion<'a, f64>, pub usize);

impl Split for RowsFrom<'_> {
    fn count(&self) -> usize {
        self.0.count()
    }

    fn split(self, grains: usize) -> (Self, Self) {
        let (left, right) = self.0.split(grains);
        (Self(left, self.1), Self(right, self.1 + grains))
    }
}

/// Does `work` for so many pieces of about alike many grains, side by side, and joins what it returns.
pub(crate) fn each<P: Split, T: Send>(
    piece: P,
    pieces: usize,
    work: &(impl Fn(P) -> T + Sync),
    join: &(impl Fn(T, T) -> T + Sync),
) -> T {
    if pieces <= 1 {
        return work(piece);
    }
    let lower = pieces / 2;
    let grains = piece.count() * lower / pieces;
    let (left, right) = piece.split(grains);
    let (left, right) = rayon::join(
        || each(left, lower, work, join),
        || each(right, pieces - lower, work, join),
    );
    join(left, right)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from one on.
    struct Numbers(usize, usize);

    impl Split for Numbers {
        fn count(&self) -> usize {
            self.1
        }

        fn split(self, grains: usize) -> (Self, Self) {
            (Self(self.0, grains), Self(self.0 + grains, self.1 - grains))
        }
    }

    #[test]
    fn each_number_comes_once_and_in_order() {
        for (count, pieces) in [(0, 3), (1, 1), (7, 3), (100, 8), (3, 8)] {
            let all = each(
                Numbers(0, count),
                pieces,
                &|Numbers(first, count)| (first..first + count).collect::<Vec<_>>(),
                &|left, right| [left, right].concat(),
            );
            assert_eq!(all, (0..count).collect::<Vec<_>>(), "{pieces} pieces");
        }
    }
}
