//! `bitgrain verify` and `bitgrain bisect`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use clap::{Args, ValueHint};

use super::channels::{print, processors, stoppable};
use bitgrain_lab::against::is_link;
use bitgrain_lab::bisect::{Side, bisect, run_both};
use bitgrain_lab::campaign;
use bitgrain_lab::campaign::folder::CampaignFolder;
use bitgrain_lab::folder::{Folder, is_of};
use bitgrain_lab::manifest::FolderKind;
use bitgrain_lab::recording::command::Patience;
use bitgrain_lab::recording::parting::Parting;
use bitgrain_lab::recording::read::{Recorded, is_recording};
use bitgrain_lab::recording::search::Commands;
use bitgrain_lab::recording::{part, search};
use bitgrain_lab::rerun::RunArchive;
use bitgrain_lab::verify::{Scope, Segment, verify};
use bitgrain_sim::error::{Error, Result};

/// What `bitgrain verify` takes.
#[derive(Args)]
pub(super) struct Verify {
    /// The folder of a run or a campaign.
    folder: PathBuf,
    /// A closing hash or the last link of a stage that was kept elsewhere, and to which what is executed must come: a
    /// closing hash takes all of it; may be given several times.
    #[arg(long, value_name = "LINK")]
    expect: Vec<String>,
    /// A stage, or the pieces between its checkpoints that share steps with FROM-TO; may be given
    /// several times [default: all].
    #[arg(long = "segment", value_name = "STAGE[:FROM-TO]")]
    segments: Vec<Segment>,
    /// Only this many pieces, chosen at random.
    #[arg(long, value_name = "PIECES", value_parser = clap::value_parser!(u16).range(1..))]
    sample: Option<u16>,
    /// Seed of the choice [default: the time].
    #[arg(long, requires = "sample")]
    seed: Option<u64>,
    /// Threads [default: one for each processor].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// What `bitgrain bisect` takes.
#[derive(Args)]
pub(super) struct Bisect {
    /// The folder of a run or of a recording; with --scenario a `bitgrain` program, with --commands a command line.
    #[arg(value_hint = ValueHint::AnyPath)]
    a: OsString,
    /// The other.
    #[arg(value_hint = ValueHint::AnyPath)]
    b: OsString,
    /// Run this scenario with the two programs first.
    #[arg(long, conflicts_with_all = ["program_a", "program_b"])]
    scenario: Option<String>,
    /// Folder for those two runs [default: out/bisect].
    #[arg(
        long,
        requires = "scenario",
        default_value = "out/bisect",
        hide_default_value = true
    )]
    out: PathBuf,
    /// Change a key of that scenario; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE", requires = "scenario")]
    sets: Vec<String>,
    /// The program that executes the first run again [default: this one].
    #[arg(long, value_name = "PROGRAM")]
    program_a: Option<PathBuf>,
    /// The program that executes the second run again [default: this one].
    #[arg(long, value_name = "PROGRAM")]
    program_b: Option<PathBuf>,
    /// The two are command lines for the shell: run them, and ask them for their arrays (the guide's page
    /// Recordings says how they answer).
    #[arg(long, conflicts_with_all = ["scenario", "program_a", "program_b"])]
    commands: bool,
    /// One of the two may be the beginning of the other: a stage or a step that only one has at its end is no
    /// difference, nor is a missing end.
    #[arg(long)]
    prefix: bool,
    /// Of two commands: the last step to compare [default: until both end].
    #[arg(long, value_name = "STEP", requires = "commands")]
    to: Option<u64>,
    /// Of two commands: compare them only every so many steps, and execute them again for those between. Faster; a
    /// difference that goes away again is not seen.
    #[arg(long, value_name = "STEPS", requires = "commands", default_value_t = 1,
        value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Of two commands: seconds without an answer after which one is given up.
    #[arg(long, value_name = "SECONDS", requires = "commands", default_value_t = 600,
        value_parser = clap::value_parser!(u64).range(1..))]
    limit: u64,
}

/// Runs `bitgrain verify`.
pub(super) fn run_verify(what: Verify) -> Result<()> {
    let time = || {
        let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        since.map_or(0, |time| time.as_nanos() as u64)
    };
    let seed = what.seed.unwrap_or_else(time);
    let scope = Scope {
        segments: what.segments,
        sample: what.sample.map(|count| (usize::from(count), seed)),
    };
    if scope.sample.is_some() {
        print(&format!("seed {seed}\n"))?;
    }
    let (threads, progress) = (processors(what.threads), stoppable(false));
    let say = |line: &str| print(&format!("{line}\n"));
    if is_of(&what.folder, FolderKind::Campaign) {
        let folder = CampaignFolder(&what.folder);
        let expect = &what.expect[..];
        return campaign::verify::verify(&folder, &scope, expect, threads, &progress, say);
    }
    let folder = Folder(&what.folder);
    let archive = RunArchive::open(&folder)?;
    verify(&archive, &scope, &what.expect, threads, &progress, say)
}

/// Runs `bitgrain bisect`.
pub(super) fn run_bisect(what: Bisect, this: &Path) -> Result<()> {
    let say = |line: &str| print(&format!("{line}\n"));
    if what.commands {
        return verdict(search(&commands(&what)?, say)?);
    }
    let [a, b] = [PathBuf::from(&what.a), PathBuf::from(&what.b)];
    if what.scenario.is_none() && [is_recording(&a)?, is_recording(&b)?].contains(&true) {
        let sides = [Recorded::open(&a)?, Recorded::open(&b)?];
        return verdict(part(&sides, what.prefix, say)?);
    }
    let [a, b] = match &what.scenario {
        None => {
            let own = |program: Option<PathBuf>| program.unwrap_or_else(|| this.to_path_buf());
            [(a, own(what.program_a)), (b, own(what.program_b))]
        }
        Some(scenario) => {
            let [one, other] = run_both([&a, &b], scenario, &what.sets, &what.out)?;
            [(one, a), (other, b)]
        }
    };
    let sides = [a, b].map(|(folder, program)| Side { folder, program });
    match bisect(&sides, what.prefix, say)? {
        None => say(
            "no difference: the same at every link that both have; records were compared, and `bitgrain verify` \
             executes what they say",
        ),
        Some(parting) => {
            say(&parting.to_string())?;
            Err(Error::Parted)
        }
    }
}

/// The two command lines to be searched.
fn commands(what: &Bisect) -> Result<Commands> {
    let text = |line: &OsString| {
        let text = line.to_str().map(String::from);
        text.ok_or_else(|| Error::input(line.display().to_string(), "is no command line in UTF-8"))
    };
    Ok(Commands {
        texts: [text(&what.a)?, text(&what.b)?],
        to: what.to,
        every: what.every,
        prefix: what.prefix,
        patience: Patience {
            limit: what.limit,
            stop: stoppable(false).stop_flag(),
        },
    })
}

/// Refuses a word that is no link.
pub(super) fn check_link(word: &str) -> Result<()> {
    if is_link(word) {
        return Ok(());
    }
    let problem = format!("`{word}` is no link: expected 64 hexadecimal digits, 0 to 9 and a to f");
    Err(Error::input("--expect", problem))
}

/// Says where two recordings or commands part, and ends with the status for it.
pub(super) fn verdict(parting: Option<Parting>) -> Result<()> {
    let say = |line: &str| print(&format!("{line}\n"));
    match parting {
        None => say("no difference: the same at every step that was compared in both"),
        Some(parting) => {
            say(&parting.to_string())?;
            Err(Error::Parted)
        }
    }
}
