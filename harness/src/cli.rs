//! The command line: what each command takes, and how each ending is told.

use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::Ordering;

use clap::{Args, Parser, Subcommand};

use crate::bed::library::Library;
use crate::bench::{Timing, bench};
use crate::error::{Error, Result};
use crate::folder::Folder;
use crate::progress::Progress;
use crate::replay::{Replay, replay};
use crate::selftest::selftest;
use crate::{forecast, present, scenario, shelf};

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
    Run(Run),
    /// Write the report of a run directory anew from the files in it.
    #[command(after_help = "Example:\n  bitgrain report out/quick")]
    Report {
        /// The folder with the results.
        folder: PathBuf,
    },
    /// List, show and remove the settled beds that runs reuse.
    #[command(subcommand, after_help = BED_HELP)]
    Bed(Bed),
    /// Time steps of a settled bed on this machine.
    #[command(after_help = BENCH_HELP)]
    Bench(Bench),
    /// Run the reference worlds on this machine and say whether it keeps the bit contract.
    #[command(after_help = SELFTEST_HELP)]
    Selftest,
    /// Replay a case file and print one JSON line for each sampled step.
    #[command(after_help = REPLAY_HELP)]
    Replay(Case),
}

#[derive(Args)]
struct Run {
    /// A TOML file, or the name of a shipped scenario: quick, kumar-system-1, kumar-system-2,
    /// guillard-small, guillard-medium, guillard-2014.
    scenario: String,
    /// Folder for the results [default: out/NAME, NAME the scenario's name].
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    beds: Beds,
    /// Threads, for beds and speeds side by side and for each where there are fewer [default: one
    /// for each processor].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Change a key of the scenario, as in --set law.mu=0.3; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Print what it would take (steps, memory, disk, time, dimensionless groups), and run nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print a line as each stage ends also where standard error is no terminal.
    #[arg(long, short)]
    verbose: bool,
}

/// Where settled beds are kept.
#[derive(Args)]
struct Beds {
    /// Folder of the settled beds that runs share.
    #[arg(long = "beds", value_name = "DIR", default_value = "beds")]
    folder: PathBuf,
}

#[derive(Subcommand)]
enum Bed {
    /// List the beds: name, what is in them, and the disk they use.
    #[command(after_help = "Example:\n  bitgrain bed list")]
    List {
        #[command(flatten)]
        beds: Beds,
    },
    /// Show a bed: its recipe, and what is measured on it.
    #[command(after_help = "Example:\n  bitgrain bed show 4f1c")]
    Show {
        /// Its name, or as much of the beginning as no other shares.
        name: String,
        #[command(flatten)]
        beds: Beds,
    },
    /// Remove beds.
    #[command(after_help = "Examples:\n  bitgrain bed remove 4f1c\n  bitgrain bed remove --all")]
    Remove {
        /// Names, or as much of the beginning of each as no other shares.
        #[arg(required_unless_present = "all")]
        names: Vec<String>,
        /// Remove every bed of the folder.
        #[arg(long, conflicts_with = "names")]
        all: bool,
        #[command(flatten)]
        beds: Beds,
    },
}

#[derive(Args)]
struct Bench {
    /// A LAMMPS data file or dump, plain or gzip: type 2 the intruder, driven at V = 1 along x, type
    /// 3 frozen [default: the bed of the quick scenario, poured first].
    #[arg(long)]
    bed: Option<PathBuf>,
    /// Steps to time, after 500 to warm up.
    #[arg(long, default_value_t = 4000, value_parser = clap::value_parser!(u64).range(1..))]
    steps: u64,
    /// Threads that step the bed.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Repeat the bed so many times along x and along y, without its obstacles: larger beds of one kind.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=200))]
    tiles: u16,
    /// Copies of the bed to step side by side, each on so many threads.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    copies: u16,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct Case {
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
    /// Account for the energy: in each sample what there is, and since step 0 the work done, what was
    /// dissipated, and the residual.
    #[arg(long)]
    energy: bool,
}

const RUN_HELP: &str = "\
Examples:
  bitgrain run quick
  bitgrain run kumar-system-1 --dry-run
  bitgrain run quick --out out/thick --set intruder.diameter=3 --set 'intruder.froude=[1, 4]' \\
      --set drag.distance=12

Results depend neither on --threads nor on whether a bed was poured or reused. Exit status: 0 done,
2 the scenario was refused, 3 a run went wrong, 1 results could not be written, 130 interrupted.";

const BED_HELP: &str = "\
Examples:
  bitgrain bed list
  bitgrain bed show 4f1c
  bitgrain bed remove --all";

const BENCH_HELP: &str = "\
Examples:
  bitgrain bench --steps 2000
  bitgrain bench --bed golden/peers/bed200.data --steps 4000 --json
  bitgrain bench --bed golden/peers/bed200.data --tiles 8 --steps 100";

const SELFTEST_HELP: &str = "\
Example:
  bitgrain selftest

It takes seconds. Every way of stepping that this machine has (instruction sets, one thread and several)
must give the published digests. Exit status: 0 it keeps the contract, 3 it does not.";

const REPLAY_HELP: &str = "\
Examples:
  bitgrain replay golden/cases/collapse.json --steps 100 --every 10 --contacts
  bitgrain replay golden/cases/rig.json --steps 1000 --energy

A grain's motion in a case is \"free\", \"weightless\", \"frozen\", {\"carried\": [vx, vy, vz]} or, as a grain of
a lid, {\"lid\": [vx, vy]}; the README shows a whole case, and what the terms of --energy are.";

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
        Command::Run(run) => run_scenario(run),
        Command::Report { folder } => {
            let folder = Folder(&folder);
            present::write_report(&folder)?;
            print(&format!("report: {}\n", folder.report().display()))
        }
        Command::Bed(bed) => run_bed(bed),
        Command::Bench(what) => run_bench(&what),
        Command::Selftest => selftest(|line| print(&format!("{line}\n"))),
        Command::Replay(case) => {
            let what = Replay {
                steps: case.steps,
                every: case.every.unwrap_or(case.steps.max(1)),
                contacts: case.contacts,
                energy: case.energy,
            };
            replay(
                &case.case,
                &what,
                &mut BufWriter::new(std::io::stdout().lock()),
            )
        }
    }
}

fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(Error::Output)
}

/// Progress of a command whose stages stop at Ctrl-C or a polite kill.
fn stoppable(verbose: bool) -> Progress {
    let progress = Progress::new(verbose);
    let stop = progress.stop_flag();
    // Without a handler the signal ends the process at once, which loses no file either.
    let _ = ctrlc::set_handler(move || {
        if stop.swap(true, Ordering::Relaxed) {
            // Asked twice: now.
            std::process::exit(130);
        }
    });
    progress
}

fn run_scenario(run: Run) -> Result<()> {
    let scenario = scenario::load(&run.scenario, &run.sets)?;
    let library = Library::new(run.beds.folder);
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = run.threads.map_or_else(processors, usize::from);
    if run.dry_run {
        return print(&forecast::forecast(&scenario, &library, threads)?);
    }
    let out = run
        .out
        .unwrap_or_else(|| PathBuf::from("out").join(&scenario.name));
    let progress = stoppable(run.verbose);
    let report = crate::run::run(&scenario, &out, &library, threads, &progress)?;
    print(&format!("report: {}\n", report.display()))
}

fn run_bed(bed: Bed) -> Result<()> {
    match bed {
        Bed::List { beds } => print(&shelf::list(&Library::new(beds.folder))?),
        Bed::Show { name, beds } => print(&shelf::show(&Library::new(beds.folder), &name)?),
        Bed::Remove { names, all, beds } => {
            print(&shelf::remove(&Library::new(beds.folder), &names, all)?)
        }
    }
}

fn run_bench(what: &Bench) -> Result<()> {
    let timing = Timing {
        bed: what.bed.as_deref(),
        steps: what.steps,
        threads: usize::from(what.threads),
        copies: usize::from(what.copies),
        tiles: usize::from(what.tiles),
    };
    let speed = bench(&timing, &stoppable(false))?;
    let tree = serde_json::to_value(&speed).map_err(|e| Error::Output(e.into()))?;
    if what.json {
        return print(&format!("{tree}\n"));
    }
    let lines = tree.as_object().into_iter().flatten();
    let text: String = lines
        .map(|(key, value)| format!("{key:<24}{value}\n"))
        .collect();
    print(&text)
}
