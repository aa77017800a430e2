//! `bitgrain analyse` and `bitgrain claims`.

use std::path::PathBuf;

use clap::Args;

use super::channels::print;
use bitgrain_analysis::analysis::describe;
use bitgrain_analysis::claims::book::Book;
use bitgrain_analysis::claims::evidence::{Evidence, record_direct};
use bitgrain_analysis::claims::means;
use bitgrain_analysis::claims::{lines, table};
use bitgrain_analysis::report::campaign_page;
use bitgrain_lab::beside::{refuse_foreign, refuse_result, write_beside};
use bitgrain_lab::campaign::folder::CampaignFolder;
use bitgrain_sim::disk::{is_folder, write_whole};
use bitgrain_sim::error::Result;
use bitgrain_sim::files::read_text;

/// What `bitgrain analyse` takes.
#[derive(Args)]
pub(super) struct Analyse {
    /// The folder of a campaign or of a run, or a table: results.csv of a campaign.
    from: PathBuf,
    /// Also count runs whose bed slid along as a plug.
    #[arg(long)]
    plugs: bool,
    /// Write all findings into this file, as JSON, and no other [default: analysis.json in the folder; of a
    /// table, none].
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Write the page with all charts into this file, and no other but --out [default: report.html in a
    /// campaign's folder; of a table or a run, none].
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
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
    /// Print what each claim says, every measurement of it, and what that rests on.
    #[arg(long)]
    full: bool,
}

/// Runs `bitgrain analyse`.
pub(super) fn run(what: Analyse) -> Result<()> {
    for named in what.out.iter().chain(&what.report) {
        refuse_result(named)?;
    }
    let evidence = Evidence::read(&what.from, what.plugs)?;
    print(&describe(&evidence.analysis))?;
    if let Some(summary) = &evidence.summary {
        print(&means::text(summary))?;
    }
    let folder = CampaignFolder(&what.from);
    // With a file named, no others are written.
    let own = is_folder(&what.from) && what.out.is_none() && what.report.is_none();
    if own {
        let page = evidence.beside.is_some();
        let page = page.then(|| (folder.report(), campaign_page(&evidence)));
        let both = [(folder.analysis(), evidence.text())];
        let both: Vec<_> = both.into_iter().chain(page).collect();
        for (path, _) in &both {
            refuse_foreign(path)?;
        }
        for (path, text) in both {
            write_beside(&path, text.as_bytes())?;
        }
    }
    if let Some(path) = what.out {
        write_whole(&path, evidence.text().as_bytes())?;
    }
    if let Some(path) = what.report {
        write_whole(&path, campaign_page(&evidence).as_bytes())?;
    }
    Ok(())
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
        Evidence::read(from, false)?.record(&mut book);
    }
    if !what.from.is_empty() {
        record_direct(&mut book);
        if let Some(path) = &what.book {
            write_whole(path, book.text(&before).as_bytes())?;
        }
    }
    print(&match what.full {
        true => table(&book),
        false => lines(&book),
    })
}
