//! The `bitgrain` command, for the tests that run it as a user would. It keeps settled beds in `beds` if it
//! runs, not in the tester's cache, unless a test names a cache.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    match std::env::var_os("BITGRAIN_TEST_CACHE") {
        Some(_) => bitgrain::cli::main(),
        None => bitgrain::cli::main_with_beds(Path::new("beds")),
    }
}
