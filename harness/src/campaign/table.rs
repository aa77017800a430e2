//! The table of a campaign as CSV, written and read.

use std::path::Path;

use super::columns::{Cell, Row, Status, Unit, columns};
use crate::error::{Error, Result};
use crate::files::{bits, read_text};
use crate::summary::{RunRecord, RunSummary, Summary};
use crate::units::Units;

/// The table as CSV: a comment with the units, the names, a line for each row; shortest decimals that read
/// back to the same bits.
pub fn text(units: &Units, rows: &[Row<'_>]) -> String {
    let columns = columns();
    let unit = |unit: Unit| match unit {
        Unit::None => "",
        Unit::Length => &units.length[..],
        Unit::Time => &units.time,
        Unit::Speed => &units.speed,
        Unit::Force => &units.force,
        Unit::Angle => "rad",
    };
    let mut named: Vec<String> = Vec::new();
    for kind in [
        Unit::Length,
        Unit::Time,
        Unit::Speed,
        Unit::Force,
        Unit::Angle,
    ] {
        let of: Vec<&str> = columns
            .iter()
            .filter(|c| c.unit == kind)
            .map(|c| &c.name[..])
            .collect();
        named.push(format!("{} {}", of.join(" "), unit(kind)));
    }
    let mut out = csv::Writer::from_writer(Vec::new());
    let write = "a row of text can be written into memory";
    out.write_record(columns.iter().map(|c| &c.name))
        .expect(write);
    for row in rows {
        out.write_record(columns.iter().map(|c| cell_text(c.of(row))))
            .expect(write);
    }
    let body = out.into_inner().expect(write);
    let body = String::from_utf8(body).expect("cells are text");
    format!("# units: {}; {}\n{body}", named.join("; "), bits())
}

/// The table of one run: a row for each of its drags.
pub fn of_run(whole: &Summary) -> String {
    let plans = whole.inputs.runs();
    let row = |run: &RunSummary| {
        let plan = plans.iter().find(|plan| plan.name == run.name)?;
        let bed = whole.beds.iter().find(|bed| bed.name == run.bed)?;
        let record = RunRecord {
            version: whole.version.clone(),
            bits_version: whole.bits_version,
            units: whole.units.clone(),
            inputs: whole.inputs.clone(),
            standard_error_method: whole.standard_error_method.clone(),
            bed: bed.clone(),
            run: run.clone(),
        };
        Some(Row {
            member: &whole.scenario,
            scenario: &whole.inputs,
            plan: plan.clone(),
            status: Status::Done(Box::new(record)),
        })
    };
    let rows: Vec<Row> = whole.runs.iter().filter_map(row).collect();
    text(&whole.units, &rows)
}

fn cell_text(cell: Cell) -> String {
    match cell {
        Cell::Text(text) => text.unwrap_or_default(),
        Cell::Whole(n) => n.map_or(String::new(), |n| n.to_string()),
        Cell::Real(x) => x.map_or(String::new(), |x| x.to_string()),
    }
}

/// A campaign's table as it was written: names and cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a table.
    ///
    /// # Errors
    /// [`Error::Input`] with the line that does not fit.
    pub fn read(path: &Path) -> Result<Self> {
        Self::parse(&read_text(path)?, &path.display().to_string())
    }

    /// Reads the text of a table; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`Table::read`].
    pub fn parse(text: &str, name: &str) -> Result<Self> {
        let wrong = |e: csv::Error| {
            let line = e.position().map_or(1, csv::Position::line);
            Error::input(
                format!("{name}:{line}"),
                format!("{e}; is the file cut off?"),
            )
        };
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let names: Vec<String> = reader
            .headers()
            .map_err(wrong)?
            .iter()
            .map(String::from)
            .collect();
        for needed in ["member", "run", "status", "froude", "drag", "drag_error"] {
            if !names.iter().any(|n| n == needed) {
                let problem = format!("has no column `{needed}`: it is no table of a campaign");
                return Err(Error::input(name, problem));
            }
        }
        let mut rows = Vec::new();
        for record in reader.records() {
            rows.push(record.map_err(wrong)?.iter().map(String::from).collect());
        }
        Ok(Self { names, rows })
    }

    /// How many rows it has.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The words of a cell; `""` where there is none, or no such column.
    pub fn text(&self, row: usize, column: &str) -> &str {
        let place = self.names.iter().position(|name| name == column);
        place
            .and_then(|k| self.rows[row].get(k))
            .map_or("", |word| word)
    }

    /// The number of a cell; `None` where there is none.
    pub fn real(&self, row: usize, column: &str) -> Option<f64> {
        crate::series::finite(self.text(row, column))
    }
}
