//! A processor mode that something in the process switches on during a run is found at the
//! next step, save or digest, on whichever thread it is, and nothing is written from then on.
#![cfg(target_arch = "x86_64")]
#![allow(unsafe_code)]

use std::arch::asm;
use std::path::Path;
use std::sync::Arc;

use bitgrain::chain::Link;
use bitgrain::checkpoint::{self, StageState};
use bitgrain::disk::{self, Call, CallOutcome, Watch};
use bitgrain::drag::drag;
use bitgrain::error::{Error, Result};
use bitgrain::folder::Folder;
use bitgrain::observer::Observer;
use bitgrain::progress::Progress;
use bitgrain::run;
use bitgrain::scenario;
use bitgrain::simulation::Simulation;
use bitgrain::threads::on_threads;
use bitgrain_kernel::{ArithmeticDefect, ContactForce, Digest, Error as KernelError};
use bitgrain_tests::wee::WEE;
use bitgrain_tests::{results, settled_bed};

use crate::alone;

/// Bits of the control word, and what is found under them.
const MODES: [(u32, ArithmeticDefect); 3] = [
    (1 << 15, ArithmeticDefect::FlushToZero),
    (1 << 13, ArithmeticDefect::Rounding),
    (3 << 13, ArithmeticDefect::Rounding),
];

/// As a processor wakes up: every exception masked, to nearest, no mode on.
const PLAIN: u32 = 0x1f80;

/// Sets the control word of this thread.
fn set(word: u32) {
    // SAFETY: a valid control word with every exception masked; it is put back before a test ends.
    unsafe { asm!("ldmxcsr [{}]", in(reg) &word) };
}

/// Puts the control word of this thread back, also if a test fails.
struct Restored;

impl Drop for Restored {
    fn drop(&mut self) {
        set(PLAIN);
    }
}

/// Ten seconds to pour the bed that all tests of this file share, because nothing else may run in the process.
#[test]
fn a_mode_between_two_calls_is_found_by_whichever_comes_first() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    for (k, (bits, flaw)) in MODES.into_iter().enumerate() {
        let mut sim = settled_bed();
        sim.steps(3).unwrap();
        let path = folder.path().join(k.to_string());
        let (digest, written, stepped, watched) = {
            let _restored = Restored;
            set(PLAIN | bits);
            let digest = sim.digest();
            let written = checkpoint::write(&path, &mut sim);
            let (mut one, mut other) = (sim.clone(), sim.clone());
            (digest, written, one.steps(1), other.step_watched(|_| {}))
        };
        let fault = KernelError::Arithmetic { flaw };
        assert_eq!(digest, Err(fault));
        assert!(matches!(written, Err(Error::Contract { .. })), "{flaw:?}");
        assert!(!path.exists());
        assert_eq!((stepped, watched), (Err(fault), Err(fault)));
        // The state itself was computed before.
        assert!(sim.digest().is_ok());
    }
}

/// Switches a mode on when it is shown a step, and keeps what it is shown after that.
struct BedCache {
    bits: u32,
    at: u64,
    looked: Vec<u64>,
    packed: Vec<(u64, bool)>,
    linked: Vec<u64>,
}

impl Observer for BedCache {
    fn wants_step(&self, step: u64) -> bool {
        step >= self.at
    }

    fn on_step(
        &mut self,
        step: u64,
        _sim: &mut Simulation,
        _contacts: &[ContactForce<f64>],
    ) -> Result<()> {
        self.looked.push(step);
        set(PLAIN | self.bits);
        Ok(())
    }

    fn on_digest(&mut self, link: &Link) -> Result<()> {
        self.linked.push(link.step);
        Ok(())
    }

    fn wants_checkpoint(&self, _step: u64) -> bool {
        true
    }

    fn on_checkpoint(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        note: &dyn Fn() -> StageState,
    ) -> Result<()> {
        // Like a saver that ignores a full disk.
        let packed = checkpoint::pack(sim, &note());
        let refused = matches!(packed, Err(Error::Contract { .. }));
        self.packed.push((step, refused));
        assert_eq!(packed.is_err(), refused);
        Ok(())
    }
}

#[test]
fn a_mode_switched_on_by_who_looks_on_ends_the_drag_before_anything_is_written() {
    let _alone = alone();
    let quick = scenario::load("quick", &[]).unwrap();
    let scenario = quick.changed(|s| s.measure.digest_every = 2).unwrap();
    let plan = &scenario.drags()[0];
    for (bits, _) in MODES {
        let mut library = BedCache {
            bits,
            at: 6,
            looked: Vec::new(),
            packed: Vec::new(),
            linked: Vec::new(),
        };
        let mut sim = settled_bed();
        let _restored = Restored;
        let ended = drag(&mut sim, plan, &mut library);
        set(PLAIN);
        assert!(matches!(ended, Err(Error::Contract { .. })));
        let packed = (1..=6).map(|step| (step, step == 6)).collect::<Vec<_>>();
        assert_eq!(library.packed, packed);
        // Step 7 was computed under the mode: it is not shown.
        assert_eq!(library.looked, [6]);
        assert_eq!(library.linked, [2, 4, 6]);
    }
}

/// Switches a mode on in the thread that writes the first snapshot.
struct Driver(u32);

impl Watch for Driver {
    fn before(&self, call: &Call<'_>) -> CallOutcome {
        if matches!(call, Call::SyncFolder(path) if path.ends_with("snapshots")) {
            set(PLAIN | self.0);
        }
        CallOutcome::Go
    }
}

/// A run whose thread gets a mode while it writes ends with nothing on the disk that was computed under it.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_under_a_mode_writes_nothing_and_goes_on_after_it() {
    let _alone = alone();
    let text = WEE.replace("digest_every = 200", "digest_every = 100000");
    let scenario = scenario::parse(&text, "wee", &[], Path::new("")).unwrap();
    let go = |room: &Path| {
        let setting = run::Setting {
            scenario: &scenario,
            folder: &Folder(&room.join("out")),
            library: &bitgrain::bed::library::BedCache::new(room.join("beds")),
            threads: 1,
            save: run::SaveEvery::Steps(900),
            frames: true,
            only: &[],
            write_report: bitgrain::present::write_report,
            progress: &Progress::new(false),
        };
        run::run_in(setting).map(|_| ())
    };
    let plain = tempfile::tempdir().unwrap();
    go(plain.path()).unwrap();
    let want = results(&plain.path().join("out"));
    for (bits, _) in MODES {
        let room = tempfile::tempdir().unwrap();
        disk::watch(Some(Arc::new(Driver(bits))));
        let ended = on_threads(1, || {
            let _restored = Restored;
            go(room.path())
        });
        disk::watch(None);
        let ended = ended.unwrap();
        assert!(matches!(ended, Err(Error::Contract { .. })), "{ended:?}");
        let written = results(&room.path().join("out"));
        let own = ["manifest.json", "latest.safetensors"];
        let others = written
            .iter()
            .filter(|(name, _)| own.iter().all(|own| !name.ends_with(own)));
        for (name, bytes) in others {
            assert!(want.get(name) == Some(bytes), "{name}");
        }
        go(room.path()).unwrap();
        assert!(results(&room.path().join("out")) == want);
    }
}

/// Stretches on three threads, with a mode on all but the one that calls: the steps that end well have the
/// bits they should have, until a thread that computes otherwise gets a share. That is in the first drift of
/// a stretch as often as in its forces if each stretch is of one step.
#[test]
fn a_mode_of_another_thread_is_found_in_the_stretch_in_which_it_has_a_part() {
    let _alone = alone();
    for steps in [1, 10] {
        let mut plain = settled_bed();
        let wanted: Vec<Digest> = (0..300)
            .map(|_| {
                plain.steps(steps).unwrap();
                plain.digest().unwrap()
            })
            .collect();
        for (bits, flaw) in MODES {
            for _ in 0..4 {
                // On a machine with other work the thread that calls may do every part itself for a while.
                let found = (0..20).find_map(|_| {
                    on_threads(3, || steps_beside(PLAIN | bits, steps, &wanted)).unwrap()
                });
                let (fault, again) = found.expect("another thread has a share");
                assert_eq!(fault, KernelError::Arithmetic { flaw });
                assert_eq!(again, Err(KernelError::NotStarted));
            }
        }
    }
}

/// The fault of the first stretch that ends in one, and what the steps after it end in.
fn steps_beside(
    word: u32,
    steps: u64,
    wanted: &[Digest],
) -> Option<(KernelError, std::result::Result<(), KernelError>)> {
    let here = rayon::current_thread_index();
    let mut sim = settled_bed();
    sim.stepping.divide_always();
    sim.steps(steps).unwrap();
    assert_eq!(sim.stepping.parts(), 3);
    rayon::broadcast(|context| {
        if Some(context.index()) != here {
            set(word);
        }
    });
    wanted[1..]
        .iter()
        .find_map(|wanted| match sim.steps(steps) {
            Ok(()) => {
                assert_eq!(sim.digest().as_ref(), Ok(wanted), "a step is wrong unseen");
                None
            }
            Err(fault) => Some((fault, sim.steps(steps))),
        })
}
