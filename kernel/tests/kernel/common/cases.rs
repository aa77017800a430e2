//! How many random cases a property is tried on.

use proptest::prelude::ProptestConfig;

/// At most this many cases, and fewer where `PROPTEST_CASES` asks for fewer.
pub fn cases(most: u32) -> ProptestConfig {
    let asked = ProptestConfig::default();
    ProptestConfig {
        cases: asked.cases.min(most),
        // One case steps a whole world, so a long shrinking would take minutes.
        max_shrink_iters: asked.max_shrink_iters.min(100),
        failure_persistence: None,
        ..asked
    }
}
