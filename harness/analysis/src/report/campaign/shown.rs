//! What a campaign's page shows, and the names of its parts.

use super::super::text::{escape, typeset};
use crate::analysis::{self, Analysis, Curve, Finding, Material};
use crate::claims::book::Book;
use crate::fit::Fit;
use bitgrain_lab::campaign::folder::Beside;
use bitgrain_lab::campaign::table::CampaignTable;

/// What a page shows.
pub(super) struct Shown<'a> {
    /// Name of the campaign.
    pub(super) name: &'a str,
    /// What lies beside its table; none for a table alone.
    pub(super) beside: Option<&'a Beside>,
    /// Its table.
    pub(super) table: &'a CampaignTable,
    /// What that says.
    pub(super) analysis: &'a Analysis,
    /// Claims with what it measured of them.
    pub(super) book: &'a Book,
}

impl Shown<'_> {
    /// What the table holds of a run, `member/run`.
    pub(super) fn cell(&self, name: &str, column: &str) -> Option<&str> {
        let (member, run) = name.split_once('/')?;
        let mut rows = 0..self.table.len();
        let is = |row: &usize| {
            self.table.text(*row, "member") == member && self.table.text(*row, "run") == run
        };
        rows.find(is).map(|row| self.table.text(row, column))
    }

    /// Whether the error of a run's drag did not converge.
    pub(super) fn is_open(&self, name: &str) -> bool {
        self.cell(name, "drag_converged") == Some("false")
    }

    /// A quantity with the unit of a column, plain text.
    pub(super) fn label(&self, name: &str, column: &str) -> String {
        match typeset(&self.table.unit(column)) {
            unit if unit.is_empty() => name.to_owned(),
            unit => format!("{name} ({unit})"),
        }
    }
}

/// Grains in words, plain text.
pub(super) fn material(m: &Material) -> String {
    greek(&analysis::material(m))
}

/// Properties of grains besides their friction, plain text.
pub(super) fn grains(m: &Material) -> String {
    greek(&analysis::grains(m))
}

/// An intruder in words, plain text.
pub(super) fn intruder(curve: &Curve) -> String {
    analysis::intruder(curve)
}

pub(super) fn greek(text: &str) -> String {
    let letters = [
        ("gamma_n", "\u{3b3}_n"),
        ("mu", "\u{3bc}"),
        ("chi^2", "\u{3c7}\u{b2}"),
    ];
    letters
        .iter()
        .fold(text.to_owned(), |text, (name, letter)| {
            text.replace(name, letter)
        })
}

/// A fit or why there is none, HTML.
pub(super) fn text_of(found: &Finding<Fit>) -> String {
    match found {
        Finding::Found(fit) => escape(&greek(&fit.line())),
        Finding::Refused(why) => format!("none, because {}", escape(&why.0)),
    }
}
