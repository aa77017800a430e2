//! The reference worlds: their text, their size, and that they hold what they are there for.

use std::collections::BTreeMap;

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::{
    EVERY, LINE, Line, MATERIALS, Room, StageLaw, World, history, last, materials, run, tsuji,
};
use bitgrain_kernel::contact::{HertzTsuji, PairLaws};
use bitgrain_kernel::vec3::{dot, head};
use bitgrain_kernel::{ContactForce, Partner, start, step_watched};

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
    // Three collapses of 600 steps, a bed of 1300, a rig of 800, each from step 0; and the last line.
    assert_eq!(lists[0].len(), 13 + 13 + 27 + 17 + 13 + 1);
    assert!(
        size_of::<Room<f64>>() <= 16 * 1024,
        "{}",
        size_of::<Room<f64>>()
    );
}

/// What a contact is between, as words that sort.
fn kinds(one: World, world: &bitgrain_kernel::World<'_, f64>, seen: &ContactForce<f64>) -> String {
    let group = |i: u32| format!("group {}", world.grains.group[i as usize]);
    let mut both = [group(seen.i), String::new()];
    both[1] = match seen.partner {
        Partner::Grain(j) => group(j),
        Partner::Obstacle(k) => format!("{:?}", world.obstacles[k as usize].shape),
    };
    both.sort();
    let both = both.map(|word| word.split(' ').take(2).collect::<Vec<_>>().join(" "));
    format!("{}: {}", one.name(), both.join(", ").replace(" {", ""))
}

/// Steps a world as `run` does and counts the contacts between what and what; returns them with the
/// number of grains that went round the box.
fn contacts(one: World) -> (BTreeMap<String, usize>, usize) {
    let mut room = Box::new(Room::<f64>::vacant());
    one.lay(&mut room).unwrap();
    let mut seen = BTreeMap::new();
    let laws = materials();
    let table = PairLaws::new(MATERIALS, &laws).unwrap();
    for stage in one.stages() {
        let mut world = room.world();
        if let Some(speed) = stage.speed {
            world.obstacles[0].velocity[0] = speed;
        }
        if world.clock.step == 0 {
            let begun = match one {
                World::Materials => start(&mut world, &table),
                _ => start(&mut world, &tsuji()),
            };
            begun.unwrap();
        }
        while world.clock.step < stage.last {
            let mut pushes = Vec::new();
            let see = |p| pushes.push(p);
            match stage.law {
                StageLaw::History(gamma) => step_watched(&mut world, &history(gamma), see),
                StageLaw::Tsuji => step_watched(&mut world, &tsuji(), see),
                StageLaw::Materials => step_watched(&mut world, &table, see),
            }
            .unwrap();
            for push in &pushes {
                *seen.entry(kinds(one, &world, push)).or_insert(0) += 1;
            }
        }
        if one == World::Bed {
            let g = &world.grains;
            let fastest = g.velocity.iter().map(|v| dot(head(*v), head(*v)).sqrt());
            let fastest = fastest.fold(0.0, f64::max);
            // At rest after the first stage, and in motion after the second.
            let still = stage.speed.is_none();
            assert_eq!(fastest < 0.02, still, "fastest {fastest} at {}", stage.last);
        }
    }
    let world = room.world();
    let round = world.grains.image.iter().filter(|i| **i != [0; 3]);
    (seen, round.count())
}

/// Every law, obstacle and group is in them, and pushes what it should.
#[test]
fn the_worlds_hold_what_they_are_there_for() {
    let (mut seen, mut round) = (BTreeMap::new(), 0);
    for one in World::ALL {
        let (contacts, across) = contacts(one);
        seen.extend(contacts);
        round += across;
    }
    let free = [
        "group 0", "group 1", "group 2", "group 3", "group 4", "Plane", "Sphere", "Cylinder",
    ];
    for (one, kinds, others) in [
        (World::CollapseHistory, "group 0", &free[..]),
        (World::CollapseTsuji, "group 0", &free[..]),
        (World::Materials, "group 0", &free[..]),
        (World::Bed, "group 0", &["group 0", "group 1", "Sphere"][..]),
        (
            World::Rig,
            "group 3",
            &["group 2", "group 3", "group 4", "Cylinder"][..],
        ),
    ] {
        for other in others {
            let mut both = [kinds, *other];
            both.sort_unstable();
            let name = format!("{}: {}", one.name(), both.join(", "));
            assert!(seen.get(&name) > Some(&20), "{name} among {seen:#?}");
        }
    }
    assert!(round > 10, "{round} grains went round the box");
}

/// The law without damping is written down as numbers, so that to make it takes no logarithm.
#[test]
fn the_other_law_is_that_of_its_parameters() {
    assert_eq!(tsuji::<f64>(), HertzTsuji::new(4e3, 0.3, 0.6, 0.5));
    assert_eq!(tsuji::<f32>(), HertzTsuji::new(4e3, 0.3, 0.6, 0.5));
}
