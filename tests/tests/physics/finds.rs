//! Bugs found by fuzzing, each as its own case.

use bitgrain::checkpoint;
use bitgrain::claims::book::Book;
use bitgrain::claims::evidence::Evidence;
use bitgrain::simulation::Simulation;
use bitgrain::threads::on_threads;
use bitgrain_tests::{golden, golden_case};

fn started(name: &str) -> Simulation {
    let sim = golden_case(name).start(name, |_| {});
    sim.expect("a sound case")
}

/// A list with no entry to spare lost pairs of two ranges: one that is near was overwritten by the next
/// one that is not.
#[test]
fn a_list_that_is_just_long_enough_loses_no_pair() {
    let mut plain = started("full-list.json");
    for _ in 0..60 {
        plain.step_watched(|_| {}).expect("sound steps");
    }
    let wanted = plain.digest();
    for (threads, entries) in (0..24).flat_map(|entries| [(2, entries), (3, entries), (8, entries)])
    {
        let mut sim = started("full-list.json");
        sim.stepping.divide_always();
        sim.stepping.tunes = false;
        sim.lend(entries);
        sim.start().expect("a sound case");
        let stepped = on_threads(threads, || sim.steps(60));
        stepped.expect("so many threads").expect("sound steps");
        assert_eq!(
            sim.digest(),
            wanted,
            "{threads} threads, lists of {entries}"
        );
    }
}

/// An obstacle may leave through a closed edge, and a state in which it has was refused.
#[test]
fn a_state_with_an_obstacle_beyond_the_edge_is_read_back() {
    let mut sim = started("beyond-the-edge.json");
    sim.steps(40).expect("sound steps");
    assert!(sim.obstacles[1].point[2] > sim.domain.hi()[2]);
    let written = checkpoint::bytes(&mut sim, "").unwrap();
    let mut again = checkpoint::parse(&written, "find", None).expect("a whole checkpoint");
    for sim in [&mut sim, &mut again] {
        sim.steps(40).expect("sound steps");
    }
    assert_eq!(sim.digest(), again.digest());
    // A start there is still refused.
    assert!(again.start().is_err());
}

/// A state that says it has done as many steps as can be counted has no step left, and no sum overflows.
#[test]
fn a_count_of_steps_does_not_turn_over() {
    let mut sim = started("full-list.json");
    sim.set_step_count(u64::MAX - 1);
    for _ in 0..3 {
        sim.steps(2).expect("sound steps");
        assert_eq!(sim.step_count(), u64::MAX);
    }
    sim.step_watched(|_| {}).expect("a sound step");
    assert_eq!(sim.step_count(), u64::MAX);
}

/// A drag below zero had a negative error, of which a book of claims was written that could not be read again.
#[test]
fn an_error_is_not_below_zero() {
    let text = std::fs::read_to_string(golden("guillard-small/summary.json")).unwrap();
    let mut tree: serde_json::Value = serde_json::from_str(&text).unwrap();
    for run in tree["runs"].as_array_mut().unwrap() {
        let mean = run["drag"]["mean"].as_f64().unwrap();
        run["drag"]["mean"] = serde_json::Value::from(-mean);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("summary.json");
    std::fs::write(&path, tree.to_string()).unwrap();
    let mut book = Book::shipped();
    let evidence = Evidence::read(&path, false).expect("a sound summary");
    evidence.record(&mut book);
    assert_eq!(Book::parse(&book.text(""), "find").unwrap(), book);
}

/// A saved force row's unused word went into the grain's mass with the next kick.
#[test]
fn a_word_that_is_unused_changes_no_mass() {
    let mut sim = started("full-list.json");
    let histories = sim.contact_histories();
    let masses: Vec<f64> = sim.velocity.iter().map(|v| v[3]).collect();
    let world = &mut *sim;
    for row in world.force.iter_mut().chain(&mut world.torque) {
        row[3] = 1e6;
    }
    sim.resume(&histories).expect("a sound state");
    sim.steps(3).expect("sound steps");
    assert!(sim.velocity.iter().map(|v| v[3]).eq(masses));
}
