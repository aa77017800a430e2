//! The `bitgrain` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    bitgrain::cli::main()
}
