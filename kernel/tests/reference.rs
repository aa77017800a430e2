//! The reference worlds: their text, their size, and that they hold what they are there for.

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::reference::{EVERY, LINE, Line, Room, last, run};

/// A line is fixed text, so that rigs without formatting print the same bytes.
#[test]
fn a_line_is_text_of_fixed_width() {
    let mut digest = [0x5a; 32];
    digest[0] = 0x0f;
    let line = Line {
        real: "f32",
        world: "bed",
        step: 120,
        digest,
    };
    let text = line.text();
    let expected = format!("f32 {:24}{:>6} 0f{}\n", "bed", 120, "5a".repeat(31));
    assert_eq!(std::str::from_utf8(&text).unwrap(), expected);
    assert_eq!(expected.len(), LINE);
}

/// Any room will do: also one in which other worlds have been.
#[test]
fn a_used_room_gives_the_same_lines() {
    let mut room = Box::new(Room::<f32>::vacant());
    let mut lists = Vec::new();
    for _ in 0..2 {
        let (mut all, mut lines) = (Hasher::new(), Vec::new());
        run(&mut room, &mut all, |line| lines.push(*line)).unwrap();
        lines.push(last(&all));
        lists.push(lines);
    }
    assert_eq!(lists[0], lists[1]);
    assert!(lists[0].iter().all(|line| line.step % EVERY == 0));
    // Two collapses of 600 steps, a bed of 1000, a rig of 800, each from step 0; and the last line.
    assert_eq!(lists[0].len(), 13 + 13 + 21 + 17 + 1);
    assert!(
        size_of::<Room<f64>>() <= 12 * 1024,
        "{}",
        size_of::<Room<f64>>()
    );
}
