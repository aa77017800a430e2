//! Threads: how many there are, how grains are shared among them, and what keeps them at work. Any
//! cut into ranges gives the bits of one range, so nothing here can change a result.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

use bitgrain_kernel::{Error as KernelError, check_arithmetic};
use rayon::ThreadPoolBuilder;

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

/// Threads of the pool that this is called in; 1 outside of any.
pub(crate) fn threads() -> usize {
    if rayon::current_thread_index().is_some() {
        rayon::current_num_threads()
    } else {
        1
    }
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
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| ThreadsError::start(threads, &e))?;
    // Each thread has its own rounding mode.
    for checked in pool.broadcast(|_| check_arithmetic::<f64>()) {
        checked.map_err(ThreadsError::Arithmetic)?;
    }
    Ok(pool.install(job))
}

/// Does a job on one thread of a pool while the others keep looking for parts of it: a phase is so
/// short that a thread which fell asleep would come too late.
pub(crate) fn awake<T: Send>(job: impl FnOnce() -> T + Send) -> T {
    /// Stops the others from looking, also if the job panics.
    struct Done<'a>(&'a AtomicBool);
    impl Drop for Done<'_> {
        fn drop(&mut self) {
            self.0.store(true, Ordering::Release);
        }
    }
    let here = rayon::current_thread_index();
    let done = AtomicBool::new(false);
    rayon::scope(|scope| {
        let done = &done;
        scope.spawn_broadcast(move |_, context| {
            // A thread that waits here for a part of its own part would keep the job from ending if it looked on.
            if PARTS.get() > 0 {
                return;
            }
            let mut idle = 0u32;
            // The thread of the job comes here only when the job is over.
            while Some(context.index()) != here && !done.load(Ordering::Acquire) {
                if rayon::yield_now() == Some(rayon::Yield::Executed) {
                    idle = 0;
                } else if idle < PATIENCE {
                    idle += 1;
                    std::hint::spin_loop();
                } else {
                    // More threads than cores: let another one run.
                    std::thread::yield_now();
                }
            }
        });
        let _done = Done(done);
        job()
    })
}

thread_local! {
    /// Joins in progress on this thread, one within the other.
    static PARTS: Cell<u32> = const { Cell::new(0) };
}

/// A join in progress on this thread, also if it panics.
struct JoinMark;

impl JoinMark {
    fn begin() -> Self {
        PARTS.set(PARTS.get() + 1);
        Self
    }
}

impl Drop for JoinMark {
    fn drop(&mut self) {
        PARTS.set(PARTS.get() - 1);
    }
}

/// Looks without success after which a thread offers its core to others.
const PATIENCE: u32 = 1000;

/// Cuts the grains into ranges of about equal work, by where stretches of them end and how many pairs these have: the
/// places where ranges end, but for the last.
pub(crate) fn cut(
    grains: usize,
    stretches: impl Iterator<Item = (usize, usize)>,
    ranges: usize,
) -> Vec<u32> {
    // A grain costs about as much as a pair.
    let mut ends = vec![(0, 0)];
    for (end, pairs) in stretches {
        let (before, work) = ends[ends.len() - 1];
        ends.push((end, work + (end - before) + pairs));
    }
    let (last, work) = ends[ends.len() - 1];
    ends.push((grains, work + (grains - last)));
    let all = ends[ends.len() - 1].1;
    let mut range_bounds: Vec<u32> = Vec::new();
    for range in 1..ranges {
        let share = all * range / ranges;
        let next = ends.partition_point(|(_, work)| *work < share).max(1);
        let ((from, before), (to, after)) = (ends[next - 1], ends[next]);
        let place = from + (to - from) * (share - before) / (after - before).max(1);
        // No range is empty, however few the grains.
        let least = range_bounds.last().map_or(1, |&before| before as usize + 1);
        range_bounds.push(place.clamp(least, grains - (ranges - range)) as u32);
    }
    range_bounds
}

/// Something for a stretch of grains that splits into two stretches.
pub(crate) trait Split: Sized + Send {
    /// The first `grains` grains, and the others.
    fn split(self, grains: usize) -> (Self, Self);
}

/// Does `work` for each range of a stretch that starts at grain `begin`, side by side, and joins what it
/// returns, lower ranges left.
pub(crate) fn each<P: Split, T: Send>(
    piece: P,
    begin: u32,
    range_bounds: &[u32],
    work: &(impl Fn(P) -> T + Sync),
    join: &(impl Fn(T, T) -> T + Sync),
) -> T {
    let middle = range_bounds.len() / 2;
    let Some(&cut) = range_bounds.get(middle) else {
        return work(piece);
    };
    let (left, right) = piece.split((cut - begin) as usize);
    let (before, after) = (&range_bounds[..middle], &range_bounds[middle + 1..]);
    let _part = JoinMark::begin();
    let (left, right) = rayon::join(
        || each(left, begin, before, work, join),
        || each(right, cut, after, work, join),
    );
    join(left, right)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc;
    use std::thread;
    use std::time::Duration;

    use super::*;

    /// A stretch of this many grains.
    struct Stretch(usize);

    impl Split for Stretch {
        fn split(self, grains: usize) -> (Self, Self) {
            (Self(grains), Self(self.0 - grains))
        }
    }

    fn wait_for(event: &AtomicBool) {
        while !event.load(Ordering::Acquire) {
            thread::sleep(Duration::from_millis(1));
        }
    }

    /// Of three threads the second has begun a part in two halves when the first begins a job, which ends
    /// when the part has ended; the third does the other half. The second, which waits for the third, finds
    /// that it is to keep looking until the job has ended.
    fn a_part_begun_before_looking_on() {
        let [begun, job_begun, other_begun, ended] = [const { AtomicBool::new(false) }; 4];
        let half = |stretch: Stretch| {
            if stretch.0 == 1 {
                begun.store(true, Ordering::Release);
                wait_for(&job_begun);
                wait_for(&other_begun);
            } else {
                other_begun.store(true, Ordering::Release);
                wait_for(&job_begun);
                // Until the second thread has looked for something else to do.
                thread::sleep(Duration::from_millis(200));
            }
            stretch.0
        };
        rayon::scope(|scope| {
            scope.spawn(|_| {
                let grains = each(Stretch(3), 0, &[1], &half, &|left, right| left + right);
                ended.store(true, Ordering::Release);
                assert_eq!(grains, 3);
            });
            wait_for(&begun);
            awake(|| {
                job_begun.store(true, Ordering::Release);
                wait_for(&ended);
            });
        });
    }

    #[test]
    fn no_thread_waits_for_itself() {
        let (over, is_over) = mpsc::channel();
        // On a separate thread, since one that hangs cannot be stopped.
        thread::spawn(move || {
            let done = on_threads(3, a_part_begun_before_looking_on);
            over.send(done.is_ok()).expect("the test waits for it");
        });
        // It takes a fifth of a second if nothing hangs.
        let is_over = is_over.recv_timeout(Duration::from_secs(60));
        assert_eq!(is_over, Ok(true), "a thread waits for itself");
    }
}
