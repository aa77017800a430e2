//! The `bitgrain` command, for the tests that run it as a user would.

use std::process::ExitCode;

fn main() -> ExitCode {
    bitgrain::cli::main()
}
