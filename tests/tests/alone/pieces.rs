//! A campaign in pieces ends with the bytes of an undisturbed one if calls to the file system fail, if a worker or the
//! merge is killed at one or loses power, and if there are no locks.

use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use bitgrain::bed::library::BedCache;
use bitgrain::campaign::only::Only;
use bitgrain::campaign::plan::Plan;
use bitgrain::campaign::sweep::{Outcome, Sweep, sweep};
use bitgrain::campaign::tasks::{Worker, missing, perform};
use bitgrain::disk::{self, Call, CallOutcome, Watch};
use bitgrain::error::Result;
use bitgrain::progress::Progress;
use bitgrain::run::SaveEvery;
use bitgrain_tests::results;
use bitgrain_tests::wee::copy_all;

use crate::alone;
use crate::disk::{Spoil, Work, campaign, spoil_all, spoilt};

/// A campaign in pieces, one after the other, and put together.
struct Pieces(Plan);

impl Pieces {
    /// Does the tasks that are left.
    fn tasks(&self, room: &Path) -> Result<()> {
        let library = BedCache::new(room.join("beds"));
        let (out, all) = (room.join("out"), Only::new(vec![], &self.0)?);
        let left = missing(&self.0, &all, &out, &library, true)?;
        for task in left.beds.iter().chain(&left.drags) {
            let worker = Worker {
                plan: &self.0,
                out: &out,
                library: &library,
                threads: 1,
                save: SaveEvery::Steps(900),
                retry: true,
                progress: &Progress::new(false),
            };
            perform(&worker, task)?;
        }
        Ok(())
    }

    fn merge(&self, room: &Path) -> Result<Outcome> {
        sweep(&Sweep {
            plan: &self.0,
            only: &Only::new(vec![], &self.0)?,
            out: &room.join("out"),
            library: &BedCache::new(room.join("beds")),
            threads: 1,
            jobs: 1,
            save: SaveEvery::default(),
            retry: false,
            merge: true,
            write_report: bitgrain::present::write_report,
            progress: &Progress::new(false),
        })
    }
}

impl Work for Pieces {
    fn go(&self, room: &Path) -> Result<()> {
        self.tasks(room)?;
        self.merge(room).map(|_| ())
    }
}

/// Ten seconds, because all tasks are begun anew for each call that is failed.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_in_pieces_survives_a_call_that_fails() {
    spoil_all(&Pieces(campaign().0), 1009);
}

#[test]
#[ignore = "half an hour"]
fn a_campaign_in_pieces_survives_every_call_that_fails() {
    spoil_all(&Pieces(campaign().0), 1);
}

/// Calls of a process that is killed at one of them: it and those after it are not made.
struct Killed {
    at: usize,
    calls: AtomicUsize,
}

impl Watch for Killed {
    fn before(&self, _: &Call<'_>) -> CallOutcome {
        match self.calls.fetch_add(1, Ordering::Relaxed) >= self.at {
            true => CallOutcome::Fail(ErrorKind::StorageFull),
            false => CallOutcome::Go,
        }
    }
}

/// Ten seconds, because the merge is begun anew for each call that it is killed at.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_merge_that_is_killed_loses_no_row() {
    kill_a_merge(61);
}

#[test]
#[ignore = "half an hour"]
fn a_merge_that_is_killed_at_any_call_loses_no_row() {
    kill_a_merge(1);
}

/// A merge is killed at every `nth` of its calls: the next one finds every row, and computes none.
fn kill_a_merge(nth: usize) {
    let _alone = alone();
    let pieces = Pieces(campaign().0);
    let made = tempfile::tempdir().unwrap();
    pieces.tasks(made.path()).unwrap();
    let mut want = None;
    let mut at = usize::MAX;
    loop {
        let folder = tempfile::tempdir().unwrap();
        let room = folder.path();
        copy_all(made.path(), room);
        let killed = Arc::new(Killed {
            at,
            calls: AtomicUsize::new(0),
        });
        disk::watch(Some(killed.clone()));
        let _ = pieces.merge(room);
        disk::watch(None);
        let outcome = pieces.merge(room).unwrap();
        assert_eq!((outcome.done, outcome.missing), (4, 0), "call {at}");
        let files = results(&room.join("out"));
        assert!(
            *want.get_or_insert_with(|| files.clone()) == files,
            "call {at}"
        );
        let calls = killed.calls.load(Ordering::Relaxed);
        // First all of it, then from the last call to the first.
        at = match at {
            usize::MAX => calls - 1,
            at if at < nth => return,
            at => at - nth,
        };
    }
}

/// A file system that cannot lock.
struct Lockless;

impl Watch for Lockless {
    fn before(&self, call: &Call<'_>) -> CallOutcome {
        match call {
            Call::Lock(_) => CallOutcome::Fail(ErrorKind::Unsupported),
            _ => CallOutcome::Go,
        }
    }
}

/// Without locks workers that do all tasks twice, side by side, write the same bytes.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn no_result_hangs_on_a_lock() {
    let _alone = alone();
    let pieces = Pieces(campaign().0);
    let (_, want) = spoilt(&campaign(), usize::MAX, Spoil::Kill, None);
    for _ in 0..5 {
        let folder = tempfile::tempdir().unwrap();
        let room = folder.path();
        disk::watch(Some(Arc::new(Lockless)));
        let ends = std::thread::scope(|scope| {
            let worker = || scope.spawn(|| pieces.tasks(room));
            let workers = [worker(), worker(), worker()];
            workers.map(|worker| worker.join().unwrap())
        });
        disk::watch(None);
        // One may have found a file that another was about to replace; what is missing is done then.
        assert!(ends.iter().any(std::result::Result::is_ok), "{ends:?}");
        pieces.go(room).unwrap();
        assert!(results(&room.join("out")) == want);
    }
}
