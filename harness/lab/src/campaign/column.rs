//! A column of a campaign's table, and the row that it has a cell of.

use crate::scenario::{CheckedScenario, DragPlan};
use crate::summary::DragRecord;
use bitgrain_sim::block_averaging::Mean;

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// It succeeded.
    Done(Box<DragRecord>),
    /// It failed, or its bed did, and why.
    Failed(String),
}

/// One finished run of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Row<'a> {
    /// Its member.
    pub member: &'a str,
    /// The member's scenario.
    pub scenario: &'a CheckedScenario,
    /// The run.
    pub plan: DragPlan,
    /// How it ended.
    pub status: &'a Status,
}

/// One cell; a missing value is empty in CSV and null in Parquet.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(Option<String>),
    /// A whole number.
    Whole(Option<i64>),
    /// A real number.
    Real(Option<f64>),
}

/// A column: its name, what one of its numbers counts, and its cell in a row.
pub struct Column {
    /// Name in the table's head.
    pub name: String,
    /// Unit, in the campaign's scaling; `""` if there is none.
    pub unit: Unit,
    of: Box<dyn Fn(&Row<'_>) -> Cell>,
}

/// What the numbers of a column count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Nothing, or words.
    None,
    /// Lengths.
    Length,
    /// Times.
    Time,
    /// Speeds.
    Speed,
    /// Forces.
    Force,
    /// Radians.
    Angle,
}

impl Column {
    /// The cell of a row.
    pub fn of(&self, row: &Row<'_>) -> Cell {
        (self.of)(row)
    }
}

impl Row<'_> {
    /// What it measured, if it succeeded.
    pub(super) fn record(&self) -> Option<&DragRecord> {
        match self.status {
            Status::Done(record) => Some(record),
            Status::Failed(_) => None,
        }
    }
}

fn push(
    all: &mut Vec<Column>,
    name: impl Into<String>,
    unit: Unit,
    of: impl Fn(&Row<'_>) -> Cell + 'static,
) {
    all.push(Column {
        name: name.into(),
        unit,
        of: Box::new(of),
    });
}

/// A column of words.
pub(super) fn text(
    all: &mut Vec<Column>,
    name: &str,
    of: impl Fn(&Row<'_>) -> Option<String> + 'static,
) {
    push(all, name, Unit::None, move |row| Cell::Text(of(row)));
}

/// A column of whole numbers.
pub(super) fn whole(
    all: &mut Vec<Column>,
    name: &str,
    of: impl Fn(&Row<'_>) -> Option<u64> + 'static,
) {
    push(all, name, Unit::None, move |row| {
        Cell::Whole(of(row).map(|n| n as i64))
    });
}

/// A column of numbers.
pub(super) fn real(
    all: &mut Vec<Column>,
    name: &str,
    unit: Unit,
    of: impl Fn(&Row<'_>) -> Option<f64> + 'static,
) {
    push(all, name, unit, move |row| {
        Cell::Real(of(row).filter(|x| x.is_finite()))
    });
}

/// A mean and its standard error.
pub(super) fn mean(
    all: &mut Vec<Column>,
    name: &str,
    unit: Unit,
    of: impl Fn(&DragRecord) -> Option<Mean> + Copy + 'static,
) {
    let with_error = format!("{name}_error");
    real(all, name, unit, move |row| Some(of(row.record()?)?.mean));
    real(all, &with_error, unit, move |row| {
        Some(of(row.record()?)?.standard_error)
    });
}
