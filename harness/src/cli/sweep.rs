//! `bitgrain sweep`.

use std::path::PathBuf;

use clap::Args;

use super::{Beds, print, processors, stoppable};
use crate::bed::library::Library;
use crate::campaign::{self, forecast, sweep};
use crate::error::{Error, Result};
use crate::run::SaveEvery;

/// What the command takes.
#[derive(Args)]
pub(super) struct Sweep {
    /// A campaign's TOML file, or the name of a shipped one: kumar-small, kumar-middle, kumar-2018.
    campaign: String,
    /// Folder for the results [default: out/NAME, NAME the campaign's name].
    #[arg(long)]
    out: Option<PathBuf>,
    #[command(flatten)]
    beds: Beds,
    /// Threads, shared by the stages under way [default: one for each processor].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Most stages under way at a time: fewer take less memory, and more threads each [default: as
    /// many as threads].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Save stages under way so often, in minutes (5m) or in steps (20000) [default: 5m].
    #[arg(long, value_name = "INTERVAL")]
    save_every: Option<SaveEvery>,
    /// Change a key of the base scenario, as in --set bed.settled=1e-5; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    sets: Vec<String>,
    /// Try again what failed before.
    #[arg(long)]
    retry: bool,
    /// Print the plan with its cost in grain-steps and hours, and run nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print lines where standard error is no terminal: each minute, and as each stage ends.
    #[arg(long, short)]
    verbose: bool,
}

/// Runs it.
pub(super) fn run(what: Sweep) -> Result<()> {
    let plan = campaign::load(&what.campaign, &what.sets)?;
    let library = Library::new(what.beds.folder);
    let threads = processors(what.threads);
    let jobs = what.jobs.map_or(threads, usize::from);
    if what.dry_run {
        return print(&forecast::forecast(&plan, &library, threads, jobs)?);
    }
    let own = PathBuf::from("out").join(&plan.campaign.name);
    let out = what.out.unwrap_or(own);
    let outcome = sweep::sweep(&sweep::Sweep {
        plan: &plan,
        out: &out,
        library: &library,
        threads,
        jobs,
        save: what.save_every.unwrap_or_default(),
        retry: what.retry,
        progress: &stoppable(what.verbose),
    })?;
    print(&format!("table: {}\n", outcome.table.display()))?;
    match outcome.failed {
        0 => Ok(()),
        failed => Err(Error::Failed {
            failed,
            done: outcome.done,
            table: outcome.table,
        }),
    }
}
