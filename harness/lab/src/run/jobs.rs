//! Jobs side by side: beds to pour, drags to do. How many threads there are changes no result.

use std::io;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use bitgrain_sim::error::Result;
use bitgrain_sim::parts::Ranks;
use bitgrain_sim::threads::{ThreadsError, builder, on_threads};

/// Does `count` jobs, the longest first, at most `most` at a time, and returns their results in order.
///
/// Each job has a thread while there are at least as many jobs as threads. If there are fewer, the
/// threads are shared out as each job begins, and it steps on those of its own pool.
///
/// # Errors
/// [`bitgrain_sim::error::Error::Input`] if this many threads cannot be started.
pub(crate) fn side_by_side<T: Send>(
    threads: usize,
    most: usize,
    count: usize,
    length: impl Fn(usize) -> u64,
    job: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>> {
    // Ranks do one thing at a time, all together.
    let most = if Ranks::joined().is_some() { 1 } else { most };
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&k| (u64::MAX - length(k), k));
    let results: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    let (next, unfinished) = (AtomicUsize::new(0), AtomicUsize::new(count));
    let worker = || -> Result<()> {
        loop {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let Some(&k) = order.get(place) else {
                return Ok(());
            };
            let side = most.min(unfinished.load(Ordering::Relaxed));
            let share = share(threads, side, place);
            let done = on_threads(share, || job(k))?;
            *results[k].lock().expect("no job panics with it") = Some(done);
            unfinished.fetch_sub(1, Ordering::Relaxed);
        }
    };
    thread::scope(|scope| {
        let start = |_| builder().spawn_scoped(scope, worker);
        let started: Vec<io::Result<_>> = (0..threads.min(most).min(count)).map(start).collect();
        let mut outcome = Ok(());
        for handle in started {
            let ended = handle
                .map_err(|e| ThreadsError::start(threads, &e).into())
                .and_then(|handle| {
                    handle
                        .join()
                        .unwrap_or_else(|panic| std::panic::resume_unwind(panic))
                });
            outcome = outcome.and(ended);
        }
        outcome
    })?;
    let taken = |slot: Mutex<Option<T>>| {
        let result = slot.into_inner().expect("no job panics with it");
        result.expect("every job was given out")
    };
    Ok(results.into_iter().map(taken).collect())
}

/// Threads for a job that begins while `unfinished` are to be done side by side, itself among them.
fn share(threads: usize, unfinished: usize, place: usize) -> usize {
    let jobs = threads.min(unfinished).max(1);
    threads / jobs + usize::from(place % jobs < threads % jobs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_come_back_in_order_and_share_the_threads() {
        for (threads, count) in [(1, 3), (3, 3), (8, 3), (4, 1), (2, 0), (3, 40)] {
            let done = side_by_side(
                threads,
                threads,
                count,
                |k| (k * 7 % 5) as u64,
                |k| {
                    let within =
                        rayon::current_thread_index().map(|_| rayon::current_num_threads());
                    (k, within.unwrap_or(1))
                },
            );
            let done = done.unwrap();
            assert!(done.iter().enumerate().all(|(k, job)| job.0 == k));
            assert_eq!(done.len(), count);
            let most = done.iter().map(|job| job.1).max().unwrap_or(1);
            assert!(most <= threads && (count == 0 || count > threads || most >= threads / count));
        }
        assert_eq!([0, 1, 2].map(|place| share(8, 3, place)), [3, 3, 2]);
        assert_eq!(share(2, 40, 0), 1);
        assert_eq!(share(2, 1, 39), 2);
    }
}
