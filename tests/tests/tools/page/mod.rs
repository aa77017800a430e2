//! The live page: made of its sources, with the digests of the command (`made`), and used as visitors use it (`used`).
//!
//! Most of it needs a Chromium: `cargo test -p bitgrain-tests --release --test tools page:: -- --ignored`.

use std::path::{Path, PathBuf};

use bitgrain::progress::Progress;
use bitgrain::replay::{Digests, Replay, replay};
use bitgrain_tests::page::PAGE;
use bitgrain_tests::root;

mod made;
mod used;

fn page() -> PathBuf {
    root().join(PAGE)
}

/// What the command prints of a case: each sampled step and its digest.
fn command(case: &Path, steps: u64, every: u64) -> Vec<(u64, String)> {
    let what = Replay {
        steps,
        every,
        contacts: false,
        energy: false,
        digests: true,
        vtk: None,
        beyond_rayleigh: false,
    };
    let mut out = Vec::new();
    replay(case, &what, &Progress::new(false), &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    let read = |line| serde_json::from_str::<Digests>(line).unwrap();
    text.lines()
        .map(read)
        .map(|of| (of.step, of.digest))
        .collect()
}
