//! The program as its users run it: commands, their messages, their files, and the documents about them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use bitgrain_tests::wee::Room;
use bitgrain_tests::{CAMPAIGN, CampaignDesk, copied, made_run, results};

mod against;
mod any_law;
mod api;
mod asked;
mod benchmark;
mod bisect;
mod blocks;
mod campaigns;
mod channels;
mod claims;
mod cli;
mod corpus;
mod damage;
mod documents;
mod elsewhere;
mod errors;
mod export;
mod figures;
mod forecasts;
mod foreign;
mod forged;
mod forged_members;
mod formats;
mod header;
mod layers;
mod memory;
mod merged;
mod notices;
mod packed;
mod parsers;
mod paths;
#[cfg(unix)]
mod planted;
mod recorder;
mod recordings;
mod releases;
mod resume;
mod resumed;
mod safety;
mod saved;
mod slurm;
mod sources;
mod sweep;
mod tasks;
mod tidy;
mod time_steps;
mod verify;

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

/// A finished run, a finished campaign and their library, to be copied.
static FURNISHED: LazyLock<Room> = LazyLock::new(|| Room::furnished(PROGRAM));

/// A finished campaign of [`CAMPAIGN`], and its files.
static CAMP: LazyLock<CampaignDesk> = LazyLock::new(|| {
    let desk = CampaignDesk::new(PROGRAM, CAMPAIGN);
    desk.done(&[]);
    desk
});
static FINISHED: LazyLock<BTreeMap<String, Vec<u8>>> = LazyLock::new(|| results(&CAMP.out()));

/// A finished run of two drags.
static RUN: LazyLock<tempfile::TempDir> = LazyLock::new(|| made_run(PROGRAM));

/// A copy of it, to be changed.
fn copy() -> tempfile::TempDir {
    copied(RUN.path())
}
