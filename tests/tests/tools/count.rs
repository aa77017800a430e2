//! Instructions of an operation and of a grain's step on a Cortex-M0, against `golden/instructions-m0.csv`.

use std::collections::BTreeMap;

use bitgrain_tests::golden;

use crate::machines::list::{Target, find};
use crate::machines::machine;

/// The board has a clock of 25 MHz, and the emulator takes 2^6 ns for an instruction.
const INSTRUCTIONS_PER_TICK: f64 = 40.0 / 64.0;

/// The board of a Cortex-M0 has no such clock; this one has.
const BOARD: &str = "mps2-an385";

/// Instructions by type and operation; code for a Cortex-M0 runs on the larger core of the board too.
fn counted(features: &'static str) -> BTreeMap<String, f64> {
    let m0 = find("cortex-m0").unwrap();
    let other = m0
        .run
        .0
        .iter()
        .map(|word| if *word == "microbit" { BOARD } else { word });
    let words: Vec<&str> = other.chain(["-icount", "shift=6"]).collect();
    let target = Target {
        features,
        run: (words.leak(), m0.run.1),
        ..*m0
    };
    let missing = machine::missing(&target);
    assert!(missing.is_empty(), "apt-get install {}", missing.join(" "));
    let program = machine::build(&target).unwrap_or_else(|why| panic!("{why}"));
    let ended = machine::run(&target, &program).unwrap();
    let row = |line: &str| {
        let words: Vec<&str> = line.strip_prefix("# count ")?.split_whitespace().collect();
        let [kind, what, ticks, times] = words[..] else {
            panic!("{line}");
        };
        let [ticks, times]: [f64; 2] = [ticks, times].map(|n| n.parse().unwrap());
        let count = (ticks * INSTRUCTIONS_PER_TICK / times).round();
        Some((format!("{kind},{what}"), count))
    };
    ended.output.lines().filter_map(row).collect()
}

/// `INSTA_UPDATE=always` writes the table anew. A twentieth and an instruction of difference are let pass: compilers
/// differ.
#[test]
#[ignore = "takes Debian's compiler and QEMU: `.ci/run machines`"]
fn operations_take_as_many_instructions_as_before() {
    let mut now = counted("count");
    now.extend(counted("count,no-floats"));
    let text: String = now.iter().map(|(k, n)| format!("{k},{n}\n")).collect();
    let text = format!("type,operation,instructions\n{text}");
    let path = golden("instructions-m0.csv");
    if std::env::var("INSTA_UPDATE").is_ok_and(|update| update == "always") {
        std::fs::write(&path, &text).unwrap();
    }
    let mut kept = BTreeMap::new();
    for line in std::fs::read_to_string(&path).unwrap().lines().skip(1) {
        let (key, count) = line.rsplit_once(',').unwrap();
        kept.insert(key.to_string(), count.parse::<f64>().unwrap());
    }
    assert_eq!(now.len(), 18, "{text}");
    assert!(now.keys().eq(kept.keys()), "{text}");
    for (key, count) in now {
        let before = kept[&key];
        assert!(
            (count - before).abs() <= 0.05 * before + 1.0,
            "{key}: {count}, not {before}"
        );
    }
}
