//! The fuzzer's committed corpus, replayed: seeds and every find since.

use std::collections::BTreeSet;

use bitgrain_kernel::BITS_VERSION;
use bitgrain_tests::{fuzzing, root};

type Target = fn(&[u8]) -> bool;

/// Targets, and how many of their files at least must be sound: the others are refused, as they
/// should be.
const TARGETS: [(&str, Target, usize); 17] = [
    ("contact", fuzzing::contact, 60),
    ("search", fuzzing::search, 30),
    ("world", fuzzing::world, 30),
    ("case", fuzzing::case, 20),
    ("checkpoint", fuzzing::checkpoint, 20),
    ("scenario", fuzzing::scenario, 6),
    ("lammps", fuzzing::lammps, 6),
    ("series", fuzzing::series, 6),
    ("summary", fuzzing::summary, 6),
    ("campaign", fuzzing::campaign, 6),
    ("table", fuzzing::table, 6),
    ("book", fuzzing::book, 6),
    ("manifest", fuzzing::manifest, 6),
    ("edits", fuzzing::edits, 20),
    ("saved", fuzzing::saved, 5),
    ("capi", fuzzing::capi, 1),
    ("recording", fuzzing::recording, 6),
];

#[test]
fn the_corpus_is_replayed() {
    for (name, target, least) in TARGETS {
        let folder = format!("{}/../fuzz/corpus/{name}", env!("CARGO_MANIFEST_DIR"));
        let files = std::fs::read_dir(&folder).expect("every target has a corpus");
        let mut paths: Vec<_> = files.map(|f| f.unwrap().path()).collect();
        paths.sort();
        let (mut sound, mut total) = (0, 0);
        for path in &paths {
            let bytes = std::fs::read(path).unwrap();
            assert!(bytes.len() < 10_000, "{} is too large", path.display());
            total += bytes.len();
            sound += usize::from(target(&bytes));
        }
        // The repository stays small.
        assert!(total < 250_000, "the corpus of {name} is {total} bytes");
        let count = paths.len();
        assert!(sound >= least, "{name}: {sound} of {count} are sound");
    }
}

/// `fuzz/log.csv` has a row for each target, of a run of half an hour at least that found nothing, and
/// each target is replayed here.
#[test]
fn every_target_has_run_for_half_an_hour() {
    let read = |name: &str| std::fs::read_to_string(root().join(name)).unwrap();
    let manifest = read("fuzz/Cargo.toml");
    let bins = manifest.split("[[bin]]\nname = \"").skip(1);
    let bins: BTreeSet<&str> = bins.map(|rest| rest.split('"').next().unwrap()).collect();
    assert_eq!(bins, TARGETS.iter().map(|(name, ..)| *name).collect());
    let log = read("fuzz/log.csv");
    let mut rows = log.lines();
    let heading = "target,seconds,executions,features,edges,corpus,finds,bits_version";
    assert_eq!(rows.next(), Some(heading));
    let mut logged: BTreeSet<&str> = BTreeSet::new();
    for row in rows {
        let (target, numbers) = row.split_once(',').unwrap();
        let numbers: Vec<u64> = numbers.split(',').map(|n| n.parse().unwrap()).collect();
        let [seconds, executions, features, edges, corpus, finds, bits] = numbers[..] else {
            panic!("{row}");
        };
        assert!(seconds >= 1800 && finds == 0, "{row}");
        assert!(
            executions > 10_000 && features > edges && edges > 100 && corpus > 10,
            "{row}"
        );
        assert_eq!(bits, u64::from(BITS_VERSION), "{row}");
        assert!(logged.insert(target), "{target} twice");
    }
    assert_eq!(logged, bins);
}

/// The corpus grew from worlds in floats: those in fixed point are drawn here as well.
#[test]
fn worlds_in_fixed_point_are_drawn() {
    let mut word = 0x9e37_79b9_7f4a_7c15u64;
    let mut sound = 0;
    for _ in 0..400 {
        let mut bytes: Vec<u8> = (0..600)
            .map(|_| {
                word = word
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (word >> 56) as u8
            })
            .collect();
        bytes[0] = 5;
        sound += usize::from(fuzzing::world(&bytes));
    }
    assert!(sound >= 20, "{sound} of 400 are sound");
}
