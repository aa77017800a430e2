//! The command line: what each command takes, and how each ending is told.

use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::error::{Error, Result};
use crate::replay::{Replay, replay};

/// Granular beds whose every run is reproducible to the last bit.
#[derive(Parser)]
#[command(name = "bitgrain", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Replay a case file and print one JSON line for each sampled step.
    #[command(after_help = "Example: bitgrain replay case.json --steps 100 --every 10 --contacts")]
    Replay {
        /// The case: one JSON file with the whole state and law, plain or gzip.
        case: PathBuf,
        /// Steps to run.
        #[arg(long)]
        steps: u64,
        /// Steps between samples [default: only the first and the last].
        #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
        every: Option<u64>,
        /// List the contacts of each sample.
        #[arg(long)]
        contacts: bool,
    },
}

/// Runs the command that the process was called with.
pub fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        // A reader that has seen enough (`| head`) is not an error.
        Err(Error::Output(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "bitgrain: {error}");
            ExitCode::from(error.exit_status())
        }
    }
}

fn run(command: Command) -> Result<()> {
    match command {
        Command::Replay {
            case,
            steps,
            every,
            contacts,
        } => {
            let what = Replay {
                steps,
                every: every.unwrap_or(steps.max(1)),
                contacts,
            };
            replay(&case, &what, &mut BufWriter::new(std::io::stdout().lock()))
        }
    }
}
