//! `bitgrain analyse` and `bitgrain claims`.

use std::path::{Path, PathBuf};

use clap::Args;

use super::print;
use crate::analysis::{analyse, text, words};
use crate::campaign::folder::CampaignFolder;
use crate::campaign::table::{Table, of_run};
use crate::claims::book::{Book, table};
use crate::claims::evidence::{Evidence, record_direct};
use crate::error::Result;
use crate::files::{read_text, write_whole};
use crate::folder::Folder;
use crate::summary::read_summary;

/// What `bitgrain analyse` takes.
#[derive(Args)]
pub(super) struct Analyse {
    /// The folder of a campaign or of a run, or a table: results.csv of a campaign.
    from: PathBuf,
    /// Count runs too whose bed slid along as a plug.
    #[arg(long)]
    plugs: bool,
    /// Write all findings into this file, as JSON [default: analysis.json in the folder; of a table, none].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// What `bitgrain claims` takes.
#[derive(Args)]
pub(super) struct Claims {
    /// Folders of campaigns or runs, tables or summaries to measure the claims on [default: none; what was
    /// last measured is printed].
    from: Vec<PathBuf>,
    /// A book of claims to read instead of the one that ships, and to write what was measured into.
    #[arg(long, value_name = "FILE")]
    book: Option<PathBuf>,
}

/// Runs `bitgrain analyse`.
pub(super) fn run(what: Analyse) -> Result<()> {
    let (table, own) = read(&what.from)?;
    let analysis = analyse(&table, what.plugs);
    if let Some(path) = what.out.or(own) {
        write_whole(&path, text(&analysis).as_bytes())?;
    }
    print(&words(&analysis))
}

/// A table, and where its findings belong.
fn read(from: &Path) -> Result<(Table, Option<PathBuf>)> {
    let campaign = CampaignFolder(from);
    if !from.is_dir() {
        return Ok((Table::read(from)?, None));
    }
    if campaign.table().exists() {
        return Ok((Table::read(&campaign.table())?, Some(campaign.analysis())));
    }
    let path = Folder(from).summary();
    let rows = of_run(&read_summary(&path)?);
    let table = Table::parse(&rows, &path.display().to_string())?;
    Ok((table, Some(campaign.analysis())))
}

/// Runs `bitgrain claims`.
pub(super) fn run_claims(what: Claims) -> Result<()> {
    let (mut book, before) = match &what.book {
        None => (Book::shipped(), String::new()),
        Some(path) => {
            let text = read_text(path)?;
            (Book::parse(&text, &path.display().to_string())?, text)
        }
    };
    for from in &what.from {
        Evidence::read(from)?.record(&mut book);
    }
    if !what.from.is_empty() {
        record_direct(&mut book);
        if let Some(path) = &what.book {
            write_whole(path, book.text(&before).as_bytes())?;
        }
    }
    print(&table(&book))
}
