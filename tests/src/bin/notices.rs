//! Rewrites the notices of the crates that are linked into the command, or with the argument `python` into the Python
//! package, with `page` into the live page, from `Cargo.lock` and their sources.

use bitgrain_tests::notices::{COMMAND, PAGE, PYTHON, text};
use bitgrain_tests::root;

fn main() -> std::io::Result<()> {
    let product = match std::env::args().nth(1).as_deref() {
        Some("python") => PYTHON,
        Some("page") => PAGE,
        _ => COMMAND,
    };
    std::fs::write(root().join(product.file), text(&product))
}
