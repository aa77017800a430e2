//! The crew that drives parts in Shuttle, which runs its threads in thousands of random orders: all parts come to their
//! end with the same result whoever drives them, one thread alone is enough, and a panic reaches who waits for it.

use shuttle::sync::Arc;
use shuttle::thread;

mod sync {
    pub(super) use shuttle::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
    pub(super) use shuttle::sync::{Mutex, MutexGuard, RwLock, RwLockReadGuard};

    pub(super) const PATIENCE: u32 = 3;
    pub(super) const HELP: u32 = 2;

    pub(super) fn pause(_: u32) {
        shuttle::hint::spin_loop();
    }

    pub(super) fn nap() {
        shuttle::thread::yield_now();
    }

    pub(super) fn do_other_work() -> bool {
        false
    }

    /// Who sleeps may wake at any time.
    #[derive(Default)]
    pub(super) struct Bell;

    impl Bell {
        pub fn wait(&self, ready: impl Fn() -> bool) {
            if !ready() {
                nap();
            }
        }

        pub fn ring(&self) {}

        pub fn ring_for_all(&self) {}
    }
}

#[allow(dead_code)]
#[path = "../../../../harness/sim/src/parts/crew.rs"]
mod crew;
#[path = "../../../../harness/sim/src/parts/exchange.rs"]
mod exchange;
#[path = "../../../tests/tools/models/letter.rs"]
mod letter;
#[path = "../../../tests/tools/models/sums.rs"]
mod part;
#[path = "../../../tests/tools/models/post.rs"]
mod post;

use crew::Crew;
use part::{Errand, Part};

/// Three parts with so many helpers, twice the way; the sums of all parts.
fn sums(helpers: usize) -> Vec<u64> {
    let parts = (0..3).map(|number| Part::new(number, 3)).collect();
    let crew = Arc::new(Crew::new(parts, 0, 3, None));
    for _ in 0..2 {
        let errand = Errand::of(3);
        crew.depart(&errand, false);
        let others = (1..=helpers).map(|first| {
            let crew = Arc::clone(&crew);
            thread::spawn(move || crew.help(first % 3))
        });
        let others: Vec<_> = others.collect();
        crew.work(0);
        // Those who come late find nothing to do, or help on the next way.
        drop(others);
    }
    let parts = crew.parts();
    parts.iter().map(|part| part.sum).collect()
}

#[test]
fn parts_come_to_the_same_end_in_any_order() {
    let wanted = part::sums_in_turn(3, 3, 2);
    for helpers in [0, 1, 2, 4] {
        let (random, unfair) = (wanted.clone(), wanted.clone());
        shuttle::check_random(move || assert_eq!(sums(helpers), random), 300);
        // A few threads are kept from running for long.
        if helpers > 0 {
            shuttle::check_pct(move || assert_eq!(sums(helpers), unfair), 300, 3);
        }
    }
}

#[test]
fn a_panic_reaches_the_thread_that_waits() {
    for leg in 0..3 {
        shuttle::check_random(
            move || {
                let parts = (0..3).map(|number| Part::new(number, 3)).collect();
                let crew = Arc::new(Crew::new(parts, 0, 3, None));
                let errand = Errand {
                    fatal: Some((1, leg)),
                    ..Errand::of(3)
                };
                crew.depart(&errand, false);
                let helper = Arc::clone(&crew);
                let helper = thread::spawn(move || helper.help(1));
                let worked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                    crew.work(0);
                }));
                let panic = worked.expect_err("a part panicked");
                assert!(format!("{:?}", panic.downcast_ref::<&str>()).contains("fatal"));
                helper.join().expect("it kept the panic");
            },
            300,
        );
    }
}
