//! What claims are measured on: a campaign, its table alone, or a run.

use std::path::Path;

use super::book::{Book, Measured};
use super::{guillard, kumar, restitution};
use crate::analysis::{Analysis, analyse};
use crate::campaign::folder::CampaignFolder;
use crate::campaign::table::{Table, of_run};
use crate::error::{Error, Result};
use crate::files::read_text;
use crate::folder::Folder;
use crate::scenario::source::hash;
use crate::summary::{Summary, read_summary};

/// Name of what is measured on no run, but computed.
pub const DIRECT: &str = "direct";

/// Results to measure claims on.
pub struct Evidence {
    /// Name of the scenario or campaign.
    pub by: String,
    /// Digest of the results.
    pub digest: String,
    analysis: Analysis,
    summary: Option<Summary>,
}

impl Evidence {
    /// Reads a campaign's folder, a run's, or a table, which is named after its folder.
    ///
    /// # Errors
    /// [`Error::Input`] where it is none of them.
    pub fn read(from: &Path) -> Result<Self> {
        let campaign = CampaignFolder(from);
        let folder = Folder(from);
        if from.is_dir() && !campaign.table().exists() {
            return Self::of_summary(&folder.summary());
        }
        let (path, named) = if from.is_dir() {
            (campaign.table(), from)
        } else if from
            .file_name()
            .is_some_and(|name| name.to_string_lossy().ends_with(".json"))
        {
            return Self::of_summary(from);
        } else {
            (from.to_path_buf(), from.parent().unwrap_or(from))
        };
        let text = read_text(&path)?;
        let table = Table::parse(&text, &path.display().to_string())?;
        let full = std::path::absolute(named).map_err(|e| Error::read(named, &e))?;
        let name = full
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        Ok(Self {
            by: name,
            digest: hash(&text),
            analysis: analyse(&table, false),
            summary: None,
        })
    }

    /// A run, by its summary.
    fn of_summary(path: &Path) -> Result<Self> {
        let text = read_text(path)?;
        let summary = read_summary(path)?;
        let table = of_run(&summary);
        let table = Table::parse(&table, &path.display().to_string())?;
        Ok(Self {
            by: summary.scenario.clone(),
            digest: hash(&text),
            analysis: analyse(&table, false),
            summary: Some(summary),
        })
    }

    /// Measures what it can of a book's claims and puts it there; of claims that name others as what tests
    /// them nothing, unless this is none of those that ship.
    pub fn record(&self, book: &mut Book) {
        let known = book
            .claim
            .iter()
            .any(|claim| claim.tested_by.contains(&self.by));
        let mut all = Vec::new();
        for claim in &book.claim {
            if known && !claim.tested_by.contains(&self.by) {
                continue;
            }
            let found = match &self.summary {
                Some(summary) if claim.id.starts_with("guillard-") => {
                    guillard::measure(&claim.id, summary)
                }
                _ => kumar::measure(&claim.id, &self.analysis),
            };
            if let Some(found) = found {
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

/// Puts what is computed on the spot into a book.
pub fn record_direct(book: &mut Book) {
    let found = restitution::measure();
    book.record("kumar-restitution", Measured::new(DIRECT, "", found));
}
