//! The command line: what each command takes, and how each ending is told.

use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::bench::bench;
use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::replay::{Replay, replay};
use crate::scenario;

/// Granular beds whose every run is reproducible to the last bit.
#[derive(Parser)]
#[command(name = "bitgrain", version, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scenario: pour its beds, drag its intruder, write the results and a report.
    #[command(after_help = RUN_HELP)]
    Run {
        /// A TOML file, or the name of a shipped scenario: quick, kumar-system-1, kumar-system-2.
        scenario: String,
        /// Folder for the results [default: out/NAME, NAME the scenario's name].
        #[arg(long)]
        out: Option<PathBuf>,
        /// Beds and speeds to run side by side [default: one for each processor].
        #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: Option<u16>,
        /// Change a key of the scenario, as in --set law.mu=0.3; may be given several times.
        #[arg(long = "set", value_name = "KEY=VALUE")]
        sets: Vec<String>,
    },
    /// Time steps of a settled bed on this machine.
    #[command(after_help = "Example: bitgrain bench --bed bedA_D4.data.gz --steps 4000 --json")]
    Bench {
        /// A LAMMPS data file, plain or gzip: type 2 the intruder, driven at V = 1 along x, type 3
        /// frozen [default: the bed of the quick scenario, poured first].
        #[arg(long)]
        bed: Option<PathBuf>,
        /// Steps to time, after 500 to warm up.
        #[arg(long, default_value_t = 4000, value_parser = clap::value_parser!(u64).range(1..))]
        steps: u64,
        /// Threads, each stepping a copy of the bed.
        #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: u16,
        /// Print one JSON object.
        #[arg(long)]
        json: bool,
    },
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

const RUN_HELP: &str = "\
Examples:
  bitgrain run quick
  bitgrain run quick --out thick --set intruder.diameter=3 --set 'intruder.froude=[1, 4]' \\
      --set drag.distance=12
  bitgrain run my-bed.toml --threads 2

Results do not depend on --threads. Exit status: 0 done, 2 the scenario was refused, 3 a run went
wrong, 1 results could not be written.";

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
        Command::Run {
            scenario,
            out,
            threads,
            sets,
        } => {
            let scenario = scenario::load(&scenario, &sets)?;
            let out = out.unwrap_or_else(|| PathBuf::from("out").join(&scenario.name));
            let processors = || std::thread::available_parallelism().map_or(1, usize::from);
            let threads = threads.map_or_else(processors, usize::from);
            let report = crate::run::run(&scenario, &out, threads, &Progress::new())?;
            writeln!(std::io::stdout(), "report: {}", report.display()).map_err(Error::Output)
        }
        Command::Bench {
            bed,
            steps,
            threads,
            json,
        } => {
            let speed = bench(
                bed.as_deref(),
                steps,
                usize::from(threads),
                &Progress::new(),
            )?;
            let mut out = std::io::stdout();
            let text = serde_json::to_value(&speed).map_err(|e| Error::Output(e.into()))?;
            if json {
                return writeln!(out, "{text}").map_err(Error::Output);
            }
            for (key, value) in text.as_object().into_iter().flatten() {
                writeln!(out, "{key:<24}{value}").map_err(Error::Output)?;
            }
            Ok(())
        }
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
