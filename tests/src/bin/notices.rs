//! Rewrites the notices of the crates that are linked into the command, or with the argument `python` into the Python
//! package, from `Cargo.lock` and their sources.

use bitgrain_tests::notices::{COMMAND, PYTHON, text};
use bitgrain_tests::root;

fn main() -> std::io::Result<()> {
    let product = match std::env::args().nth(1).as_deref() {
        Some("python") => PYTHON,
        _ => COMMAND,
    };
    std::fs::write(root().join(product.file), text(&product))
}
