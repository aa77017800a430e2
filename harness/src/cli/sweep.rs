//! `bitgrain sweep`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::bed::Beds;
use super::channels::{print, processors, shown, stoppable};
use super::run::FOUND;
use super::slurm::{check_scheduler, utf8};
use super::tasks::{Pieces, interval, max_input, shared_words, told};
use bitgrain_analysis::claims::evidence::Evidence;
use bitgrain_analysis::report::campaign_page;
use bitgrain_lab::beside::write_beside;
use bitgrain_lab::campaign::folder::CampaignFolder;
use bitgrain_lab::campaign::only::Only;
use bitgrain_lab::campaign::table::CampaignTable;
use bitgrain_lab::campaign::tasks::{Worker, perform};
use bitgrain_lab::campaign::{self, forecast, found, sweep};
use bitgrain_lab::confirm;
use bitgrain_lab::run::SaveEvery;
use bitgrain_sim::error::{Error, Result};

/// What the command takes.
#[derive(Args)]
pub(super) struct Sweep {
    /// A campaign's TOML file, or the name of a shipped one: kumar-small, kumar-middle, kumar-yield, kumar-table-1,
    /// kumar-fig-5, kumar-depth, kumar-deep, kumar-2018, guillard-tanks.
    campaign: String,
    /// Folder for the results [default: out/NAME, NAME the campaign's name].
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    beds: Beds,
    /// Threads, shared by the running stages [default: one for each processor].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Most stages at a time: fewer take less memory, and more threads each [default: as
    /// many as threads].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Save unfinished stages this often, in minutes (5m) or in steps (20000) [default: 5m].
    #[arg(long, value_name = "INTERVAL")]
    save_every: Option<SaveEvery>,
    /// Change a key of the base scenario, as in --set bed.settled=1e-5; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Do only this member, or this run of one as MEMBER/RUN, as --dry-run and the table name them; may be
    /// given several times. The others can be done later.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// Compare each run that is asked for with its row in this table of the same campaign, such as one of those under
    /// golden/, and end with status 3 if a digit differs. Runs and beds that were found are executed again.
    #[arg(long, value_name = "TABLE", conflicts_with_all = ["task", "tasks", "submit"])]
    against: Option<PathBuf>,
    /// With --against: do not execute again what was found, in the folder or in the library of beds. The command then
    /// ends with status 3 and says how many links it executed, unless it executed all.
    #[arg(long, requires = "against")]
    found_is_enough: bool,
    /// Try runs again that failed before.
    #[arg(long)]
    retry: bool,
    /// Print the plan with its cost in grain-steps and hours, and run nothing. In a folder where some of it was done
    /// before, the time is by the speed of that, for the rest.
    #[arg(long)]
    dry_run: bool,
    /// Print a command for each bed and each drag that is left, a line each, beds first: for any scheduler, on machines
    /// that share --out and --beds. KIND prints only `beds` or only `drags`.
    #[arg(long, value_name = "KIND", num_args = 0..=1, require_equals = true, default_missing_value = "all",
        value_parser = ["all", "beds", "drags"], group = "pieces")]
    tasks: Option<String>,
    /// Do one bed or one drag, as --tasks names them, in a folder of its own; other processes may do others at the
    /// same time.
    #[arg(long, value_name = "MEMBER/STAGE", group = "pieces", conflicts_with_all = ["only", "jobs", "dry_run"])]
    task: Option<String>,
    /// Put together what was done with --task, and compute nothing: the table, or which rows are missing and the
    /// commands for them, with status 3.
    #[arg(long, group = "pieces", conflicts_with_all = ["retry", "dry_run"])]
    merge: bool,
    /// Write job scripts of what is left into OUT/slurm and submit them: an array of beds, one of drags, and the merge
    /// after them. SCHEDULER is slurm. With --dry-run they are only written.
    #[arg(long, value_name = "SCHEDULER", group = "pieces")]
    submit: Option<String>,
    /// Options for each sbatch, as in -- --time=2:00:00 --partition=long; --array=%4 runs at most 4 at a time.
    #[arg(last = true, requires = "submit", value_name = "SBATCH OPTION")]
    sbatch: Vec<String>,
    /// Print lines if standard error is not a terminal: each minute, and as each stage ends.
    #[arg(long, short)]
    verbose: bool,
}

/// Runs it; `program` is what it was called by.
pub(super) fn run(what: Sweep, home: &Path, program: &str) -> Result<()> {
    if let Some(scheduler) = &what.submit {
        check_scheduler(scheduler)?;
    }
    let plan = campaign::load(&what.campaign, &what.sets)?;
    let command = command(&what, program)?;
    let only = Only::new(what.only.clone(), &plan)?;
    let against = what
        .against
        .map(|path| Ok::<_, Error>((CampaignTable::read(&path)?, path)))
        .transpose()?;
    let hint = what.beds.hint(home);
    let library = what.beds.library(home);
    let own = PathBuf::from("out").join(&plan.campaign.name);
    let out = what.out.unwrap_or(own);
    let pieces = Pieces {
        plan: &plan,
        only: &only,
        out: &out,
        library: &library,
        retry: what.retry,
        threads: what.threads.unwrap_or(1),
        command,
        names: what.only,
    };
    if what.submit.is_some() {
        return pieces.submit(&what.sbatch, what.dry_run);
    }
    if let Some(kind) = &what.tasks {
        return pieces.list(kind);
    }
    let threads = processors(what.threads);
    let jobs = what.jobs.map_or(threads, usize::from);
    if what.dry_run {
        let text = forecast::forecast(&plan, &only, &out, &library, threads, jobs)?;
        return print(&text);
    }
    let progress = stoppable(what.verbose);
    hint.iter().for_each(|hint| progress.warn(hint));
    let save = what.save_every.unwrap_or_default();
    if let Some(task) = &what.task {
        let worker = Worker {
            plan: &plan,
            out: &out,
            library: &library,
            threads,
            save,
            retry: what.retry,
            progress: &progress,
        };
        return told(task, perform(&worker, task)?);
    }
    let outcome = sweep::sweep(&sweep::Sweep {
        plan: &plan,
        only: &only,
        out: &out,
        library: &library,
        threads,
        jobs,
        save,
        retry: what.retry,
        merge: what.merge,
        write_report: bitgrain_analysis::present::write_report,
        progress: &progress,
    })?;
    if outcome.missing > 0 {
        let there = outcome.done + outcome.failed;
        return pieces.lacking(outcome.missing, outcome.missing + there);
    }
    let folder = CampaignFolder(&out);
    let evidence = conclude(&folder, &outcome)?;
    if let Some((table, path)) = against {
        let place = path.display().to_string();
        let wants = |member: &str, run: &str| only.wants(member, run);
        let same = evidence.table.check_against(&table, &place, wants)?;
        print(&format!("{same} runs agree with {place} digit by digit\n"))?;
        let parts = found::wanted(&folder, &plan, &only, &outcome.taken)?;
        let mut say = |line: &str| print(&format!("{line}\n"));
        for (member, _) in &parts {
            confirm::check_folder(&folder.member(&plan.members[*member].name), &mut say)?;
        }
        if !parts.iter().all(|(_, taken)| confirm::is_whole(taken)) {
            let links = found::links(&folder, &plan, &parts)?;
            if what.found_is_enough {
                let problem = format!("{}: {links}", out.display());
                return Err(Error::Unverified {
                    problem,
                    hint: FOUND,
                });
            }
            say(&links.to_string())?;
            found::execute(&folder, &plan, &parts, threads, &progress, say)?;
        }
    }
    match outcome.failed {
        0 => Ok(()),
        failed => Err(Error::Failed {
            failed,
            done: outcome.done,
            table: outcome.table,
        }),
    }
}

/// The words that every process of a campaign in pieces is called with.
fn command(what: &Sweep, program: &str) -> Result<String> {
    let path = |path: Option<&Path>| path.map(utf8).transpose();
    let sets = what.sets.iter().map(|set| ("--set", Some(set.clone())));
    let mut options: Vec<(&str, Option<String>)> = sets.collect();
    options.extend([
        ("--out", path(what.out.as_deref())?),
        ("--beds", path(what.beds.folder.as_deref())?),
        ("--save-every", what.save_every.map(interval)),
        ("--max-input", max_input()),
    ]);
    let campaign = utf8(Path::new(&what.campaign))?;
    Ok(shared_words(program, &["sweep", &campaign], &options))
}

/// Writes what the table says.
fn conclude(folder: &CampaignFolder<'_>, outcome: &sweep::Outcome) -> Result<Evidence> {
    let evidence = Evidence::read(folder.0, false)?;
    write_beside(&folder.analysis(), evidence.text().as_bytes())?;
    write_beside(&folder.report(), campaign_page(&evidence).as_bytes())?;
    print(&format!(
        "table: {}\nreport: {}\n",
        shown(&outcome.table),
        shown(&folder.report())
    ))?;
    Ok(evidence)
}
