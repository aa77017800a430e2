//! A step allocates nothing once it has run for a while, on one thread and on several.

use std::alloc::System;

use bitgrain::threads::on_threads;
use bitgrain_tests::settled_bed;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

use crate::alone;

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// What one call of this many steps asks of the allocator, after a warm-up. Counts are of the whole
/// process, so this is one test.
fn asked(threads: usize, steps: u64) -> usize {
    let mut sim = settled_bed();
    // A new cut makes new parts; when it comes depends on how busy the machine is.
    sim.stepping.tunes = threads == 1;
    on_threads(threads, || {
        // Lists and outboxes reach their sizes.
        sim.steps(3000).unwrap();
        let renewals = sim.prunes();
        let region = Region::new(COUNTED);
        sim.steps(steps).unwrap();
        let change = region.change();
        assert!(
            steps < 100 || sim.prunes() > renewals,
            "lists were renewed too"
        );
        change.allocations + change.reallocations
    })
    .unwrap()
}

/// The least of three counts: the test's own main thread may ask for memory at any time.
fn least(count: impl Fn() -> usize) -> usize {
    (0..3).map(|_| count()).min().expect("three counts")
}

#[test]
fn a_step_allocates_nothing() {
    let _alone = alone();
    let made = || {
        let before = Region::new(COUNTED);
        let made = vec![1u8; 1000];
        before.change().allocations * made.len() / 1000
    };
    assert_eq!(least(made), 1);
    assert_eq!(least(|| asked(1, 2000)), 0);
    // Helpers are asked and rows come home once in a call, however many steps that does. At a search lists of ghosts
    // may grow, by more than they need: that ends.
    let (few, many) = (least(|| asked(2, 10)), least(|| asked(2, 2000)));
    assert!(many <= few + 60, "{few} in 10 steps, {many} in 2000");
}
