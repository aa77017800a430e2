//! How many random cases a property is tried on.

use proptest::prelude::ProptestConfig;

/// At most this many cases, or as many as `PROPTEST_CASES` asks for: proptest puts that in place of any number here.
///
/// A drawn world that shows nothing (no grain ever touches an obstacle) is drawn anew, by
/// `prop_assume`: what is drawn is not the kernel's fault. Where most worlds show nothing the
/// test fails, but a few cases may be unlucky.
pub fn cases(most: u32) -> ProptestConfig {
    let asked = ProptestConfig::default();
    ProptestConfig {
        cases: asked.cases.min(most),
        // One case steps a whole world, so a long shrinking would take minutes.
        max_shrink_iters: asked.max_shrink_iters.min(100),
        max_global_rejects: most.max(32),
        failure_persistence: None,
        ..asked
    }
}
