//! `bitgrain record`.

use std::path::PathBuf;

use clap::Args;

use super::channels::{print, shown};
use bitgrain_lab::recording::stream::record_all;
use bitgrain_lab::recording::{Keep, Recorder};
use bitgrain_sim::error::Result;

/// What `bitgrain record` takes.
#[derive(Args)]
pub(super) struct Record {
    /// Folder for the recording.
    folder: PathBuf,
    /// Which arrays to keep beside their digests: digests (none), all, every:STEPS, last:COUNT or FROM-TO.
    #[arg(long, default_value_t = Keep::Digests)]
    keep: Keep,
}

/// Records what comes on standard input.
pub(super) fn run(what: &Record) -> Result<()> {
    let mut recorder = Recorder::create(&what.folder, what.keep)?;
    let steps = record_all(std::io::stdin().lock(), "standard input", &mut recorder)?;
    let link = recorder.close()?;
    let folder = shown(&what.folder);
    print(&format!("{folder}: {steps} steps; last link {link}\n"))
}
