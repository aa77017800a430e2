//! What `--dry-run` says of work that was begun: the rest of it, at the speed so far.

use bitgrain_tests::wee::Room;
use serde_json::json;

use crate::PROGRAM;

/// Work of one kind that a folder wrote down: grain-steps and seconds.
fn done(room: &Room, file: &str, kind: &str) -> [f64; 2] {
    let kept: serde_json::Value = serde_json::from_slice(&room.read(file)).unwrap();
    ["grain_steps", "seconds"].map(|name| kept["pace"][kind][name].as_f64().unwrap())
}

/// A folder's file in which a thread did so many grain-steps a second, pouring and dragging.
fn paced(pouring: f64, dragging: f64) -> String {
    let work = |speed: f64| json!({"grain_steps": 100.0 * speed, "seconds": 100.0});
    let pace = json!({
        "pouring": work(pouring),
        "dragging": work(dragging),
        "settled": {"planned": 3.0, "taken": 2.0},
    });
    json!({"bits_version": 1, "pace": pace}).to_string()
}

/// The value of a line of a forecast.
fn value<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let mut lines = text.lines();
    lines.find_map(|line| line.strip_prefix(name).map(str::trim))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_run_tells_of_the_rest_at_the_speed_so_far() {
    let room = Room::new(PROGRAM);
    let plan = "run wee.toml --out run --threads 1 --dry-run";
    let before = room.done(plan);
    assert_eq!(value(&before, "drags that are done"), None, "{before}");
    assert!(value(&before, "time").unwrap().contains(" to "), "{before}");
    room.done("run wee.toml --out run --only run-1");
    // 130 grains, 1.5 d at a speed of 0.6 with steps of 6e-4: of 4167 steps the whole thousands are told.
    let [grain_steps, seconds] = done(&room, "run/performance.json", "dragging");
    assert_eq!(grain_steps, 130.0 * 4000.0);
    assert!(seconds > 0.0);
    let [poured, _] = done(&room, "run/performance.json", "pouring");
    assert!(poured > 130.0 * 1000.0);
    // Less than a minute of work tells nothing.
    let after = room.done(plan);
    assert_eq!(value(&after, "drags that are done"), Some("1"), "{after}");
    assert!(value(&after, "time").unwrap().contains(" to "), "{after}");
    assert_eq!(value(&after, "speed in this folder so far"), None);
    // 2083 steps are left, and no bed: 100 s at 2707.9 grain-steps a second.
    room.write("run/performance.json", paced(1.0, 2707.9));
    let slow = room.done(plan);
    assert_eq!(
        value(&slow, "time"),
        Some("about 100 s on 1 thread(s)"),
        "{slow}"
    );
    // Two threads for one drag bring half as much again.
    let two = room.done("run wee.toml --out run --threads 2 --dry-run");
    assert_eq!(
        value(&two, "time"),
        Some("about 67 s on 2 thread(s)"),
        "{two}"
    );
    // Another scenario learns nothing from the folder.
    let other = room.done("run wee.toml --out run --set law.mu=0.4 --threads 1 --dry-run");
    assert_eq!(value(&other, "drags that are done"), None, "{other}");
    // The next run goes on from what is there.
    room.done("run wee.toml --out run");
    let [grain_steps, seconds] = done(&room, "run/performance.json", "dragging");
    assert_eq!(grain_steps, 270_790.0 + 130.0 * 2000.0);
    assert!(seconds > 100.0);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_tells_of_the_rest_at_the_speed_of_its_tasks() {
    let room = Room::new(PROGRAM);
    let task = |name: &str| room.done(&format!("sweep weecamp.toml --out camp --task {name}"));
    task("mu0.3/bed");
    task("mu0.3/run-1");
    let place = "camp/tasks/mu0.3/run-1/performance.json";
    assert_eq!(done(&room, place, "dragging")[0], 130.0 * 4000.0);
    // A task that pours its bed itself tells of it in the bed's folder alone.
    room.done("sweep weecamp.toml --out own --beds own-beds --task mu0.3/run-1");
    let own = "own/tasks/mu0.3/run-1/performance.json";
    assert_eq!(done(&room, own, "pouring"), [0.0, 0.0]);
    assert!(done(&room, "own/tasks/mu0.3/bed/performance.json", "pouring")[0] > 0.0);
    let plan = "sweep weecamp.toml --out camp --threads 1 --dry-run";
    let text = room.done(plan);
    assert_eq!(value(&text, "runs"), Some("3 (1 are done)"), "{text}");
    assert_eq!(value(&text, "beds to pour"), Some("1"), "{text}");
    assert_eq!(value(&text, "speed in this folder so far"), None, "{text}");
    // 8333 steps of drags are left, 1083.29 thousand grain-steps: an hour. The bed takes no time.
    room.write(place, paced(1e12, 1_083_290.0 / 3600.0));
    let text = room.done(plan);
    let time = "about 60 minutes on 1 thread(s), 1 stages at a time";
    assert_eq!(value(&text, "time"), Some(time), "{text}");
    // So are the hours of the members: a quarter of those steps are the one's, the rest the other's.
    for (member, hours) in [("mu0.3", " 0.25"), ("mu0.5", " 0.75")] {
        assert!(value(&text, member).unwrap().ends_with(hours), "{text}");
    }
    // What was put together is not forgotten with the task.
    room.says("sweep weecamp.toml --out camp --merge", 3);
    assert!(!room.path(place).exists());
    assert_eq!(value(&room.done(plan), "time"), Some(time));
}
