//! Recordings on a disk that fails.

use std::io::ErrorKind;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use bitgrain::disk::{self, Call, CallOutcome, Watch};
use bitgrain::recording::array::{Element, little_endian};
use bitgrain::recording::{ArrayRef, Keep, Recorder};
use bitgrain_tests::results;

use crate::alone;

/// Fails one call, once: whole, or in the middle of what is written.
struct Once {
    at: usize,
    calls: AtomicUsize,
}

impl Watch for Once {
    fn before(&self, call: &Call<'_>) -> CallOutcome {
        let now = self.calls.fetch_add(1, Ordering::Relaxed);
        match call {
            _ if now != self.at => CallOutcome::Go,
            Call::Append(_, bytes) | Call::Write(_, bytes) => CallOutcome::Short(bytes.len() / 2),
            _ => CallOutcome::Fail(ErrorKind::StorageFull),
        }
    }
}

/// What failed is done again, and the recording is what it would have been.
#[test]
fn a_recording_goes_on_after_any_call_that_fails() {
    let _alone = alone();
    // Not watched first: what it is to be, and how many calls that takes.
    let (mut want, mut failed) = (None, 0);
    for at in (0..).map(|k: usize| k.checked_sub(1)) {
        let room = tempfile::tempdir().unwrap();
        let folder = room.path().join("it");
        let at = at.unwrap_or(usize::MAX);
        let once = Arc::new(Once {
            at,
            calls: AtomicUsize::new(0),
        });
        disk::watch(Some(once.clone()));
        let mut failures = 0;
        let mut recorder = Recorder::create(&folder, Keep::Last(2)).or_else(|_| {
            failures += 1;
            Recorder::create(&folder, Keep::Last(2))
        });
        let recorder_ref = recorder.as_mut().unwrap();
        for step in 0..4 {
            let bytes = little_endian(&[step as f64]);
            let x = ArrayRef {
                element: Element::F64,
                shape: &[1],
                bytes: &bytes,
            };
            if let Err(e) = recorder_ref.record(step, &[("x", x)]) {
                assert_eq!(e.exit_status(), 1, "{e}");
                failures += 1;
                recorder_ref.record(step, &[("x", x)]).unwrap();
            }
        }
        let closed = recorder.unwrap().close();
        disk::watch(None);
        let calls = once.calls.load(Ordering::Relaxed);
        if closed.is_err() {
            // It is closed once: the end is there or not, and what comes before it is whole.
            failures += 1;
        }
        let files = results(&folder);
        let Some(want) = &want else {
            assert_eq!(failures, 0);
            want = Some(files);
            continue;
        };
        if at >= calls {
            assert!(failed > 30, "{failed}");
            return;
        }
        assert_eq!(failures, 1, "call {at}");
        failed += 1;
        let whole = closed.is_ok();
        for (name, bytes) in want {
            let got = &files[name];
            let begins = bytes.starts_with(got) && !whole && name == "recording.csv";
            assert!(got == bytes || begins, "call {at}: {name}");
        }
        assert_eq!(files.len(), want.len(), "call {at}");
    }
}
