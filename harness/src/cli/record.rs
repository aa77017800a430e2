//! `bitgrain record`.

use std::path::PathBuf;

use clap::Args;

use super::channels::{print, shown};
use super::checks::{check_link, verdict};
use bitgrain_lab::recording::parting::Held;
use bitgrain_lab::recording::read::Recorded;
use bitgrain_lab::recording::stream::record_all;
use bitgrain_lab::recording::{Keep, Recorder};
use bitgrain_sim::error::{Error, Result, UNEXPECTED};

/// What errors call the source.
const SOURCE: &str = "standard input";

/// What `bitgrain record` takes.
#[derive(Args)]
pub(super) struct Record {
    /// Folder for the recording.
    folder: PathBuf,
    /// Which arrays to keep beside their digests: digests (none), all, every:STEPS, last:COUNT or FROM-TO.
    #[arg(long, default_value_t = Keep::Digests)]
    keep: Keep,
    /// Another recording: what comes is compared with it step by step, and at the first difference the command ends
    /// with status 3. To end before it, or to go on after it, is a difference.
    #[arg(long, value_name = "RECORDING")]
    against: Option<PathBuf>,
    /// What comes may be the beginning of that recording, or that recording the beginning of what comes.
    #[arg(long, requires = "against")]
    prefix: bool,
    /// The last link of a recording that was kept elsewhere: the command ends with status 3 if it does not arrive
    /// at it.
    #[arg(long, value_name = "LINK")]
    expect: Option<String>,
}

/// Records what comes on standard input.
pub(super) fn run(what: &Record) -> Result<()> {
    if let Some(word) = &what.expect {
        check_link(word)?;
    }
    let golden = what.against.as_deref().map(Recorded::open).transpose()?;
    let mut held = golden.as_ref().map(|golden| Held::new(golden, what.prefix));
    let mut recorder = Recorder::create(&what.folder, what.keep)?;
    let source = std::io::stdin().lock();
    let (steps, parting) = record_all(source, SOURCE, &mut recorder, held.as_mut())?;
    let folder = shown(&what.folder);
    let sides = golden.as_ref().map(|golden| {
        let golden = shown(&golden.place);
        format!("the first is {golden}, the second {SOURCE}, recorded in {folder}\n")
    });
    let sides = sides.unwrap_or_default();
    if parting.is_some() {
        print(&sides)?;
        return verdict(parting);
    }
    let link = recorder.close()?;
    print(&format!("{folder}: {steps} steps; last link {link}\n"))?;
    if steps == 0 && what.expect.is_some() {
        return Err(Error::input(SOURCE, "has no step: nothing was compared"));
    }
    if let Some(held) = held {
        let parting = held.end(true, SOURCE)?;
        print(&sides)?;
        verdict(parting)?;
        let (same, all) = held.counts();
        print(&format!(
            "{same} of {all} steps of the first were compared\n"
        ))?;
    }
    match &what.expect {
        Some(expected) if *expected != link => Err(Error::Unverified {
            problem: format!("{folder}: its last link is not {expected}"),
            hint: UNEXPECTED,
        }),
        _ => Ok(()),
    }
}
