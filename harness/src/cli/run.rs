//! `bitgrain run`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::bed::Beds;
use super::channels::{print, processors, stoppable};
use super::checks::check_link;
use super::ending;
use super::slurm::{Submission, Work, check_scheduler, quoted, utf8};
use super::start;
use super::tasks::{interval, max_input, shared_words};
use bitgrain_analysis::present;
use bitgrain_lab::against::{self, Reference};
use bitgrain_lab::folder::Folder;
use bitgrain_lab::run::{self, SaveEvery, Setting};
use bitgrain_lab::scenario::CheckedScenario;
use bitgrain_lab::{confirm, forecast, published, scenario};
use bitgrain_sim::error::{Error, Result};

/// If the bits are not those that were published.
const OTHER_BITS: &str = "`bitgrain selftest` tells whether this machine keeps the contract; a changed program or a \
                          damaged file has other bits too";

/// If what was found was not to be executed again.
pub(super) const FOUND: &str =
    "without --found-is-enough the others are executed again and compared";

/// What `bitgrain run` takes.
#[derive(Args)]
pub(super) struct Run {
    /// A TOML file, or the name of a shipped scenario; without it those are listed, with sizes and times.
    scenario: Option<String>,
    /// Folder for the results [default: out/NAME, NAME the scenario's name].
    #[arg(long)]
    out: Option<PathBuf>,
    /// Go on with the run in this folder from where it was stopped; its scenario is in it.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["scenario", "out", "sets"])]
    resume: Option<PathBuf>,
    /// Save unfinished stages this often, in minutes (5m) or in steps (20000) [default: 5m].
    #[arg(long, value_name = "INTERVAL")]
    save_every: Option<SaveEvery>,
    #[command(flatten)]
    beds: Beds,
    /// Threads, for beds and speeds side by side, and several for each if there are fewer of them [default: one
    /// for each processor].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Change a key of the scenario, as in --set law.mu=0.3; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Do only this drag, as run-1 or bed-2-run-1, and its bed; may be given several times. The same command
    /// without it does the others, and writes summary and report
    #[arg(long, value_name = "RUN", conflicts_with = "dry_run")]
    only: Vec<String>,
    /// Print what it would take (steps, memory, disk, time, dimensionless groups), and run nothing.
    #[arg(long)]
    dry_run: bool,
    /// A closing hash or the last link of a stage that was kept elsewhere: the run ends with status 3 if it
    /// does not arrive at it; may be given several times.
    #[arg(long, value_name = "LINK", conflicts_with_all = ["only", "dry_run"])]
    expect: Vec<String>,
    /// Another run's folder, the chain.csv of one of its stages, or a link: the run ends with status 3 if a
    /// link differs, and says at which step, body and number, here and in difference.json.
    #[arg(long, value_name = "DIR|CHAIN|LINK", conflicts_with_all = ["only", "dry_run"])]
    against: Option<String>,
    /// With --expect or --against: do not execute again what was found, in the folder or in the library of beds. The
    /// command then ends with status 3 and says how many links it executed, unless it executed all.
    #[arg(long)]
    found_is_enough: bool,
    /// Write a job script into OUT/slurm and submit it; the job goes on after its time limit, as often as needed.
    /// SCHEDULER is slurm. With --dry-run it is only written.
    #[arg(long, value_name = "SCHEDULER")]
    submit: Option<String>,
    /// Options for sbatch, as in -- --time=2:00:00 --cpus-per-task=8.
    #[arg(last = true, requires = "submit", value_name = "SBATCH OPTION")]
    sbatch: Vec<String>,
    /// Print lines if standard error is not a terminal: each minute, and as each stage ends.
    #[arg(long, short)]
    verbose: bool,
}

/// Runs it; `program` is what it was called by.
pub(super) fn run_scenario(run: Run, home: &Path, this: &Path, program: &str) -> Result<()> {
    if let Some(scheduler) = &run.submit {
        check_scheduler(scheduler)?;
    }
    if run.scenario.is_none() && run.resume.is_none() {
        if run.against.is_some() || !run.expect.is_empty() {
            let problem = "has nothing to compare: name a scenario, or give --resume with the folder of a run";
            return Err(Error::input("run", problem));
        }
        return start::list();
    }
    // A wrong word is reported before hours of work.
    let against = run.against.as_deref().map(Reference::of).transpose()?;
    run.expect.iter().try_for_each(|word| check_link(word))?;
    let (scenario, out) = match (&run.resume, &run.scenario) {
        (Some(folder), _) => (Folder(folder).saved_scenario()?, folder.clone()),
        (None, name) => {
            let scenario = scenario::load(name.as_deref().unwrap_or_default(), &run.sets)?;
            let own = PathBuf::from("out").join(&scenario.name);
            (scenario, run.out.clone().unwrap_or(own))
        }
    };
    if let Some(against) = &against {
        against::check_before(&out, against)?;
    }
    if run.submit.is_some() {
        return submit(&run, &scenario, &out, program);
    }
    let hint = run.beds.hint(home);
    let library = run.beds.library(home);
    let threads = processors(run.threads);
    if run.dry_run {
        let named = match (&run.resume, &run.scenario) {
            (Some(folder), _) => format!("--resume {}", folder.display()),
            (None, name) => name.clone().unwrap_or_default(),
        };
        let sets = run.sets.iter().map(|set| format!(" --set '{set}'"));
        let words = named + &sets.collect::<String>();
        let folder = Folder(&out);
        return print(&forecast::forecast(
            &scenario, &words, &library, folder, threads,
        )?);
    }
    let progress = stoppable(run.verbose);
    hint.iter().for_each(|hint| progress.warn(hint));
    let done = bitgrain_lab::run::run_in(Setting {
        scenario: &scenario,
        folder: &Folder(&out),
        library: &library,
        threads,
        save: run.save_every.unwrap_or_default(),
        frames: true,
        only: &run.only,
        write_report: present::write_report,
        progress: &progress,
    })?;
    let Some(done) = done else {
        return print(&format!(
            "done: {}; the same command without --only does the others\n",
            run.only.join(", ")
        ));
    };
    let published = published::compare(&Folder(&out), &scenario, &done.executed)?;
    let text = ending::describe(&out, library.folder(), published.as_ref(), &done.executed)?;
    print(&text)?;
    if let Some(found) = published
        && !found.differing.is_empty()
    {
        return Err(Error::Unverified {
            problem: format!(
                "{}: {} of the shipped scenario {} differ from what was published of it",
                out.display(),
                found.differing.join(", "),
                scenario.name
            ),
            hint: OTHER_BITS,
        });
    }
    if against.is_none() && run.expect.is_empty() {
        return Ok(());
    }
    let mut say = |line: &str| print(&format!("{line}\n"));
    confirm::check_folder(&out, &mut say)?;
    if let Some(against) = &against {
        against::check(&out, against, this, &progress, say)?;
    }
    confirm::check_expected(&out, &run.expect)?;
    if confirm::is_whole(&done.executed) {
        return Ok(());
    }
    let links = confirm::links(&out, &done.executed)?;
    if run.found_is_enough {
        return Err(Error::Unverified {
            problem: format!("{}: {links}", out.display()),
            hint: FOUND,
        });
    }
    say(&links.to_string())?;
    confirm::execute_found(&out, &done.executed, threads, &progress, say)
}

/// Writes a job script for a run, and submits it. The scenario goes into the folder now, so that what runs is what was
/// submitted.
fn submit(run: &Run, scenario: &CheckedScenario, out: &Path, program: &str) -> Result<()> {
    drop(run::claim(&Folder(out), scenario)?);
    let beds = run.beds.folder.as_deref().map(utf8).transpose()?;
    let mut options = vec![
        ("--beds", beds),
        ("--save-every", run.save_every.map(interval)),
        ("--max-input", max_input()),
        ("--against", run.against.clone()),
    ];
    options.extend(run.only.iter().map(|name| ("--only", Some(name.clone()))));
    options.extend(
        run.expect
            .iter()
            .map(|link| ("--expect", Some(link.clone()))),
    );
    let folder = utf8(out)?;
    let mut words = vec!["run", "--resume", &folder];
    words.extend(run.found_is_enough.then_some("--found-is-enough"));
    let mut submission = Submission::new(out, &run.sbatch)?;
    submission.one(&Work {
        kind: "run",
        name: &scenario.name,
        command: &shared_words(program, &words, &options),
        folder: Some(&quoted(&folder)),
        threads: run.threads.unwrap_or(1),
    })?;
    submission.submit(run.dry_run)
}
