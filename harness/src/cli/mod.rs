//! The command line: what each command takes, and how each ending is reported.

mod analyse;
mod bed;
mod benchmark;
mod channels;
mod checks;
mod ending;
mod help;
mod record;
mod run;
mod slurm;
mod start;
mod sweep;
mod tasks;

use std::ffi::OsString;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::bench::{Timing, bench};
use crate::ranks;
pub use bed::own_beds;
use bed::{Bed, run_bed};
use bitgrain_analysis::present;
use bitgrain_lab::folder::Folder;
use bitgrain_lab::plain::plain;
use bitgrain_lab::progress::Progress;
use bitgrain_lab::replay::{Replay, Stretch, replay, replay_run};
use bitgrain_lab::rerun::RunArchive;
use bitgrain_lab::selftest::selftest;
use bitgrain_sim::disk::{check_way, is_folder, set_most};
use bitgrain_sim::error::{Error, Result};
use channels::{MAX_INPUT, heed_full_files, print, shown, stoppable};
use help::{
    ANALYSE_HELP, BED_HELP, BENCH_HELP, BENCHMARK_HELP, BISECT_HELP, CLAIMS_HELP, RECORD_HELP,
    REPLAY_HELP, RUN_HELP, SELFTEST_HELP, SWEEP_HELP, VERIFY_HELP, grouped,
};

/// Granular beds whose every run is reproducible to the last bit.
#[derive(Parser)]
#[command(
    name = "bitgrain",
    version,
    arg_required_else_help = true,
    after_help = "Begin with\n  bitgrain run quick\nand see `bitgrain COMMAND --help` for examples."
)]
struct Cli {
    /// Largest file that is read, unpacked, in MiB.
    #[arg(long, global = true, value_name = "MIB", default_value_t = MAX_INPUT,
        value_parser = clap::value_parser!(u64).range(1..=1 << 40))]
    max_input: u64,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scenario: pour its beds, drag its intruder, write the results and a report.
    #[command(after_help = RUN_HELP)]
    Run(run::Run),
    /// Run a campaign: a base scenario over the values of its grids, into one table.
    #[command(after_help = SWEEP_HELP)]
    Sweep(sweep::Sweep),
    /// Say what the runs of a campaign, or of one run, have in common: regimes, yield forces, exponents.
    #[command(after_help = ANALYSE_HELP)]
    Analyse(analyse::Analyse),
    /// Say what two papers claim in numbers, what was measured of it, and whether they agree.
    #[command(after_help = CLAIMS_HELP)]
    Claims(analyse::Claims),
    /// Write the report of a run directory again from the files in it.
    #[command(after_help = "Example:\n  bitgrain report out/quick")]
    Report {
        /// The folder with the results.
        folder: PathBuf,
    },
    /// List, show and remove the settled beds that runs reuse.
    #[command(subcommand, after_help = BED_HELP)]
    Bed(Bed),
    /// Time steps of a settled bed on this machine (speed; for known results see `benchmark`).
    #[command(after_help = BENCH_HELP)]
    Bench(Bench),
    /// Run a published benchmark of impacts and compare it with theory and the published points.
    #[command(after_help = BENCHMARK_HELP)]
    Benchmark(benchmark::Benchmark),
    /// Run the reference worlds on this machine and say whether it keeps the bit contract.
    #[command(after_help = SELFTEST_HELP)]
    Selftest,
    /// Replay a case file, or a stretch of a run, and print one JSON line for each sampled step.
    #[command(after_help = REPLAY_HELP)]
    Replay(Case),
    /// Execute a run again, whole or in pieces, and say whether it gives what was written.
    #[command(after_help = VERIFY_HELP)]
    Verify(checks::Verify),
    /// Find the first step and number at which two runs, builds, recordings or commands differ.
    #[command(after_help = BISECT_HELP)]
    Bisect(checks::Bisect),
    /// Record the arrays that any program writes to standard input, step by step, as a chain of digests.
    #[command(after_help = RECORD_HELP)]
    Record(record::Record),
    /// Write a scenario file to begin from, with a comment on every key.
    #[command(after_help = "Example:\n  bitgrain new my-drag")]
    New(start::New),
    /// Print the completion script of a shell for commands and options.
    #[command(after_help = "Example:\n  bitgrain completions bash")]
    Completions(start::Completions),
    /// Write manual pages, one for the program and one for each command.
    #[command(after_help = "Example:\n  bitgrain man man")]
    Man(start::Man),
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
    /// Repeat the bed this many times along x and along y, without its obstacles: larger beds of one kind.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=200))]
    tiles: u16,
    /// Copies of the bed to step side by side, each on --threads threads.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    copies: u16,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
struct Case {
    /// The case: one JSON file with the whole state and law, plain or gzip; or a checkpoint, to go on from; or the
    /// folder of a run.
    case: PathBuf,
    /// Steps to run.
    #[arg(long)]
    steps: u64,
    /// Of a run: which stage, as in run-1 or bed.
    #[arg(long)]
    stage: Option<String>,
    /// Of a run: the step of the first sample; it is reached from the last checkpoint kept before it.
    #[arg(long, default_value_t = 0, requires = "stage")]
    from: u64,
    /// Of a run: write the last state into this file, as a checkpoint.
    #[arg(long, value_name = "FILE", requires = "stage")]
    save: Option<PathBuf>,
    /// Print the digests of states alone, part by part.
    #[arg(long, conflicts_with = "contacts")]
    digests: bool,
    /// Steps between samples [default: only the first and the last].
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    every: Option<u64>,
    /// List the contacts of each sample.
    #[arg(long)]
    contacts: bool,
    /// Write each sample into this folder for ParaView too: grains.STEP.vtk, bodies.STEP.vtk and, with --contacts,
    /// contacts.STEP.vtk.
    #[arg(long, value_name = "FOLDER")]
    vtk: Option<PathBuf>,
    /// Account for the energy: in each sample the energy, and since step 0 the work done, what was
    /// dissipated, and the residual.
    #[arg(long, conflicts_with_all = ["stage", "digests"])]
    energy: bool,
    /// Of a case: take a time step above the shortest Rayleigh time too, which is refused otherwise; one above a fifth
    /// of it, or a tenth of the shortest collision, is warned of.
    #[arg(long, conflicts_with = "stage")]
    beyond_rayleigh: bool,
}

/// Runs the command that the process was called with.
pub fn main() -> ExitCode {
    main_with_beds(&own_beds())
}

/// The same with settled beds at `home` unless `--beds` says otherwise.
pub fn main_with_beds(home: &Path) -> ExitCode {
    // Few commands need it, and those say that nothing is to be found there.
    let this = std::env::current_exe().unwrap_or_default();
    let command = || main_of(std::env::args_os(), home, &this);
    ExitCode::from(ranks::once(command))
}

/// The same with these words, the first of which is the program's name; `this` is the program that is run when work is
/// to be done again in a process of its own. Returns the exit status.
pub fn main_of(words: impl IntoIterator<Item = OsString>, home: &Path, this: &Path) -> u8 {
    let told_of_full_files = heed_full_files();
    let words: Vec<OsString> = words.into_iter().collect();
    let program = words
        .first()
        .map(|word| word.to_string_lossy().into_owned());
    let words = grouped(Cli::command()).try_get_matches_from(words);
    let ways = words.as_ref().map_or(Ok(()), check_ways);
    let command = match words.and_then(|found| Cli::from_arg_matches(&found)) {
        Ok(cli) => {
            set_most(cli.max_input << 20);
            cli.command
        }
        Err(wrong) if wrong.use_stderr() => {
            let _ = write!(std::io::stderr(), "{}", plain(&wrong.render().to_string()));
            return 2;
        }
        // What --help and --version print.
        Err(asked) => {
            let _ = asked.print();
            return 0;
        }
    };
    let begun = told_of_full_files.and(ways);
    match begun.and_then(|()| run(command, home, this, &program.unwrap_or_default())) {
        Ok(()) => 0,
        // A reader that has seen enough of a replay (`| head`) is not an error.
        Err(Error::Output(e)) if e.kind() == std::io::ErrorKind::BrokenPipe => 0,
        Err(error) => {
            let text = plain(&error.to_string());
            let _ = writeln!(std::io::stderr(), "bitgrain: {text}");
            error.exit_status()
        }
    }
}

/// Refuses a path among the words of a command that leads elsewhere once a folder is made.
fn check_ways(found: &ArgMatches) -> Result<()> {
    let named = |id: &clap::Id| found.try_get_many::<PathBuf>(id.as_str()).ok()?;
    let mut paths = found.ids().filter_map(named).flatten();
    paths.try_for_each(|path| check_way(path))?;
    let below = found.subcommand();
    below.map_or(Ok(()), |(_, found)| check_ways(found))
}

fn run(command: Command, home: &Path, this: &Path, program: &str) -> Result<()> {
    match command {
        Command::Run(what) => run::run_scenario(what, home, this, program),
        Command::Sweep(what) => sweep::run(what, home, program),
        Command::Analyse(what) => analyse::run(what),
        Command::Claims(what) => analyse::run_claims(what),
        Command::Report { folder } => {
            let folder = Folder(&folder);
            present::write_report(&folder)?;
            print(&format!("report: {}\n", shown(&folder.report())))
        }
        Command::Bed(bed) => run_bed(bed, home),
        Command::Bench(what) => run_bench(&what),
        Command::Benchmark(what) => benchmark::run(what),
        Command::Selftest => selftest(|line| print(&format!("{line}\n"))),
        Command::Replay(case) => run_replay(case),
        Command::Verify(what) => checks::run_verify(what),
        Command::Bisect(what) => checks::run_bisect(what, this),
        Command::Record(what) => record::run(&what),
        Command::New(what) => start::new(&what),
        Command::Completions(what) => start::completions(&what, Cli::command()),
        Command::Man(what) => start::man(&what, Cli::command()),
    }
}

fn run_replay(case: Case) -> Result<()> {
    let what = Replay {
        steps: case.steps,
        every: case.every.unwrap_or(case.steps.max(1)),
        contacts: case.contacts,
        digests: case.digests,
        energy: case.energy,
        vtk: case.vtk,
        beyond_rayleigh: case.beyond_rayleigh,
    };
    let out = &mut BufWriter::new(std::io::stdout().lock());
    match (is_folder(&case.case), case.stage) {
        (false, None) => replay(&case.case, &what, &Progress::new(false), out),
        (true, Some(stage)) => {
            let stretch = Stretch {
                stage,
                from: case.from,
                save: case.save,
            };
            let folder = Folder(&case.case);
            replay_run(&folder, &stretch, &what, &stoppable(false), out)
        }
        (true, None) => {
            let past = RunArchive::open(&Folder(&case.case)).map(|past| past.names())?;
            let problem = format!("is a run: name its --stage; there are {past}");
            Err(Error::input(case.case.display().to_string(), problem))
        }
        (false, Some(_)) => Err(Error::input(
            case.case.display().to_string(),
            "is not a folder; --stage needs the folder of a run",
        )),
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
