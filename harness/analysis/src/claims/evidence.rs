//! The evidence of claims: a campaign, its table alone, or a run.

use std::path::Path;

use super::book::{Book, Claim, Measured};
use super::number::{Found, Number};
use super::{guillard, kumar, restitution, tank};
use crate::analysis::{Analysis, analyse, text};
use bitgrain_lab::campaign::folder::{Beside, CampaignFolder};
use bitgrain_lab::campaign::table::{CampaignTable, of_run};
use bitgrain_lab::folder::{Folder, is_of};
use bitgrain_lab::manifest::{FolderKind, Vouched};
use bitgrain_lab::scenario::IntruderShape;
use bitgrain_lab::scenario::source::hash;
use bitgrain_lab::summary::{Summary, parse_summary, read_folder};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;

/// Name of what is computed instead of measured on runs.
pub const DIRECT: &str = "direct";

/// Results, what they say, and which claims they concern.
pub struct Evidence {
    /// Name of the scenario or campaign.
    pub by: String,
    /// Digest of the results.
    pub digest: String,
    /// The results as a table.
    pub table: CampaignTable,
    /// What that says.
    pub analysis: Analysis,
    /// A run's own summary; none of a campaign.
    pub summary: Option<Summary>,
    /// What lies beside the table in a campaign's folder.
    pub beside: Option<Beside>,
}

impl Evidence {
    /// Reads a campaign's folder, a run's folder (of what is done, if it is unfinished) or summary, or a
    /// table, which is named after its folder; summary and table may be packed by gzip. Runs whose bed slid along as
    /// a plug are left out unless `plugs`.
    ///
    /// # Errors
    /// [`Error::Input`] if it is none of them.
    pub fn read(from: &Path, plugs: bool) -> Result<Self> {
        if !disk::is_folder(from) {
            let text = read_text(from)?;
            return Self::of_text(text, from, None, plugs);
        }
        if !is_of(from, FolderKind::Campaign) {
            let vouched = Vouched::open(from, FolderKind::Run)?;
            let (text, summary) = read_folder(&Folder(from), &vouched)?;
            return Self::of_summary(&text, summary, from, plugs);
        }
        let campaign = CampaignFolder(from);
        let vouched = Vouched::open(from, FolderKind::Campaign)?;
        let text = vouched.text(&campaign.table())?;
        let beside = campaign.beside(&vouched)?;
        Self::of_text(text, &campaign.table(), Some(beside), plugs)
    }

    /// A summary or a table, by its text.
    fn of_text(text: String, path: &Path, beside: Option<Beside>, plugs: bool) -> Result<Self> {
        // A summary is JSON; no table begins like that.
        if text.starts_with('{') {
            let summary = parse_summary(&text, path)?;
            return Self::of_summary(&text, summary, path, plugs);
        }
        let by = match &beside {
            Some(beside) => beside.name.clone(),
            None => name_of_folder(path)?,
        };
        let table = CampaignTable::parse(&text, &path.display().to_string())?;
        Ok(Self {
            by,
            digest: hash(&text),
            analysis: analyse(&table, plugs),
            table,
            summary: None,
            beside,
        })
    }

    /// A run, by its summary and the text that this was read from.
    fn of_summary(text: &str, summary: Summary, path: &Path, plugs: bool) -> Result<Self> {
        let table = of_run(&held(&summary));
        let table = CampaignTable::parse(&table, &path.display().to_string())?;
        Ok(Self {
            by: summary.scenario.clone(),
            digest: hash(text),
            analysis: analyse(&table, plugs),
            table,
            summary: Some(summary),
            beside: None,
        })
    }

    /// All findings as JSON.
    pub fn text(&self) -> String {
        text(&self.analysis)
    }

    /// How much of a run is done, if it is unfinished.
    fn part(&self) -> Option<String> {
        let summary = self.summary.as_ref()?;
        let (done, planned) = (summary.runs.len(), summary.inputs.drags().len());
        (done < planned).then(|| format!("{done} of {planned} drags"))
    }

    /// Measures what it can of a book's claims and enters it there; nothing of claims that are tested by
    /// others, unless this is not one of those that ship.
    pub fn record(&self, book: &mut Book) {
        let known = book
            .claim
            .iter()
            .any(|claim| claim.tested_by.contains(&self.by));
        let part = self.part();
        let mut all = Vec::new();
        for claim in &book.claim {
            if known && !claim.tested_by.contains(&self.by) {
                continue;
            }
            let found = match &self.summary {
                Some(summary) if claim.id.starts_with("guillard-") => {
                    of_run_in(claim, summary, &self.table)
                }
                _ => tank::measure(claim, &self.table)
                    .or_else(|| kumar::measure(claim, &self.analysis)),
            };
            if let Some(found) = found {
                let found = match &part {
                    Some(part) => match found {
                        Ok(number) => Ok(Number {
                            note: format!("{part}: {}", number.note),
                            ..number
                        }),
                        Err(why) => Err(format!("{part}: {why}")),
                    },
                    None => found,
                };
                all.push((
                    claim.id.clone(),
                    Measured::new(&self.by, &self.digest, found),
                ));
            }
        }
        all.into_iter()
            .for_each(|(id, measured)| book.record(&id, measured));
    }
}

/// The measurement of a claim of Guillard 2014 on a run, whose table is given too: of its experiment on a bar in a
/// tank, of its simulations on a cylinder in a bed that flows.
fn of_run_in(claim: &Claim, summary: &Summary, table: &CampaignTable) -> Option<Found> {
    match summary.inputs.is_tank() {
        true => tank::measure(claim, table),
        false => guillard::measure(claim, summary),
    }
}

/// The drags of a summary whose force is that of a speed: not those in which forces move the intruder.
fn held(summary: &Summary) -> Summary {
    let mut held = summary.clone();
    held.runs.retain(|run| run.released.is_none());
    held
}

/// Name of the folder that a file is in.
fn name_of_folder(file: &Path) -> Result<String> {
    let full = std::path::absolute(file).map_err(|e| Error::read(file, &e))?;
    let folder = full.parent().and_then(Path::file_name);
    Ok(folder.unwrap_or_default().to_string_lossy().into_owned())
}

/// Enters what is computed on the spot into a book.
pub fn record_direct(book: &mut Book) {
    let found = restitution::measure();
    book.record("kumar-restitution", Measured::new(DIRECT, "", found));
}

/// The book with the numbers that a run gives for claims about flowing beds and tanks: none of a sphere, which they do
/// not concern.
pub fn book_of_run(summary: &Summary) -> Book {
    let mut book = Book::shipped();
    for claim in &mut book.claim {
        claim
            .measured
            .retain(|measured| measured.by != summary.scenario);
    }
    if summary.inputs.intruder.shape == IntruderShape::Sphere {
        return book;
    }
    let Ok(table) = CampaignTable::parse(&of_run(summary), &summary.scenario) else {
        return book;
    };
    let claims = book
        .claim
        .iter()
        .filter(|claim| claim.id.starts_with("guillard-"));
    let found = claims.filter_map(|claim| {
        let number = of_run_in(claim, summary, &table)?.ok()?;
        let measured = Measured::new(&summary.scenario, "", Ok(number));
        Some((claim.id.clone(), measured))
    });
    for (id, measured) in found.collect::<Vec<_>>() {
        book.record(&id, measured);
    }
    book
}
