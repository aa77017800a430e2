//! Rewrites the notices of the crates that are linked into the command, from `Cargo.lock` and their sources.

use bitgrain_tests::{notices, root};

fn main() -> std::io::Result<()> {
    std::fs::write(root().join(notices::FILE), notices::text())
}
