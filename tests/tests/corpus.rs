//! The fuzzer's committed corpus, replayed: seeds and every find since.

use bitgrain_tests::fuzzing;

type Target = fn(&[u8]) -> bool;

/// Targets, and how many of their files at least must be sound: the others are refused, as they
/// should be.
const TARGETS: [(&str, Target, usize); 5] = [
    ("contact", fuzzing::contact, 60),
    ("case", fuzzing::case, 20),
    ("scenario", fuzzing::scenario, 6),
    ("lammps", fuzzing::lammps, 6),
    ("series", fuzzing::series, 6),
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
