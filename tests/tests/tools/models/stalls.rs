//! The crew on real threads that stall at random, come late or die: the same sums, and nothing hangs.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread;
use std::time::Duration;

#[allow(dead_code)]
#[path = "../../../../harness/sim/src/parts/crew.rs"]
mod crew;
#[path = "../../../../harness/sim/src/parts/exchange.rs"]
mod exchange;
#[path = "letter.rs"]
mod letter;
#[path = "sums.rs"]
mod part;
#[path = "post.rs"]
mod post;
#[path = "../../../../harness/sim/src/parts/sync.rs"]
mod sync;

use crew::Crew;
use part::{Errand, Part, sums_in_turn};

/// Of the legs of all parts one in eight takes up to a millisecond, and a few take twenty.
fn stall(part: usize, leg: u64) {
    let key = (part as u64 * 1009 + leg).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
    if key.is_multiple_of(8) {
        let long = key.is_multiple_of(256);
        let most = if long { 20_000 } else { 1000 };
        thread::sleep(Duration::from_micros(key / 8 % most));
    }
}

/// Sends parts on two ways with so many helpers, each of which comes a little later than the one before.
fn go(parts: usize, helpers: usize, errand: Errand) -> Arc<Crew> {
    let crew = (0..parts).map(|number| Part::new(number, parts)).collect();
    let crew = Arc::new(Crew::new(crew, 0, parts, None));
    thread::scope(|scope| {
        for _ in 0..2 {
            crew.depart(&errand, false);
            for helper in 1..=helpers {
                let crew = &crew;
                scope.spawn(move || {
                    thread::sleep(Duration::from_micros(300 * helper as u64));
                    crew.help(helper % parts);
                });
            }
            crew.work(0);
        }
    });
    crew
}

#[test]
fn threads_that_stall_change_nothing() {
    for (parts, helpers) in [(1, 3), (2, 0), (2, 1), (3, 7), (8, 3), (8, 7), (5, 15)] {
        let errand = Errand {
            stall,
            ..Errand::of(60)
        };
        let crew = go(parts, helpers, errand);
        let sums: Vec<u64> = crew.parts().iter().map(|part| part.sum).collect();
        let wanted = sums_in_turn(parts as u64, 60, 2);
        assert_eq!(sums, wanted, "{parts} parts, {helpers} helpers");
    }
}

#[test]
fn a_thread_that_dies_ends_the_work_of_all() {
    for helpers in [0, 1, 7] {
        let errand = Errand {
            fatal: Some((2, 17)),
            stall,
            ..Errand::of(60)
        };
        let died = catch_unwind(AssertUnwindSafe(|| go(4, helpers, errand)));
        let said = died.err().expect("it does not go on");
        assert_eq!(said.downcast_ref::<&str>(), Some(&"fatal"), "{helpers}");
    }
}
