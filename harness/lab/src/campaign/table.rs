//! The table of a campaign as CSV, written and read.

use std::path::Path;

use super::columns::{Cell, Row, Status, Unit, columns};
use crate::scenario::DragPlan;
use crate::summary::{DragRecord, DragSummary, Summary};
use bitgrain_sim::error::{CHANGED, Error, Result};
use bitgrain_sim::files::{bits, read_text};
use bitgrain_sim::units::Units;

/// The table as CSV: a comment with the units, the names, a line for each row; shortest decimals that read
/// back to the same bits.
pub fn text(units: &Units, rows: &[Row<'_>]) -> String {
    let columns = columns(rows);
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
    let plans = whole.inputs.drags();
    let done = |run: &DragSummary| {
        let plan = plans.iter().find(|plan| plan.name == run.name)?;
        let bed = whole.beds.iter().find(|bed| bed.name == run.bed)?;
        let record = DragRecord {
            version: whole.version.clone(),
            bits_version: whole.bits_version,
            units: whole.units.clone(),
            inputs: whole.inputs.clone(),
            standard_error_method: whole.standard_error_method.clone(),
            bed: bed.clone(),
            run: run.clone(),
        };
        Some((plan, Status::Done(Box::new(record))))
    };
    let ended: Vec<_> = whole.runs.iter().filter_map(done).collect();
    let row = |(plan, status)| Row {
        member: &whole.scenario,
        scenario: &whole.inputs,
        plan: DragPlan::clone(plan),
        status,
    };
    let rows: Vec<Row> = ended
        .iter()
        .map(|(plan, status)| row((*plan, status)))
        .collect();
    text(&whole.units, &rows)
}

fn cell_text(cell: Cell) -> String {
    match cell {
        Cell::Text(text) => text.unwrap_or_default(),
        Cell::Whole(n) => n.map_or(String::new(), |n| n.to_string()),
        Cell::Real(x) => x.map_or(String::new(), |x| x.to_string()),
    }
}

/// Most rows of a table that is read: more than the largest campaign has drags.
const ROWS_MAX: usize = 200_000;

/// A campaign's table as it was written: names and cells.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignTable {
    /// Of each unit the columns that have it, then the unit, as the comment says.
    units: Vec<String>,
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl CampaignTable {
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
    /// As [`CampaignTable::read`].
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
                let problem = format!("has no column `{needed}`: it is not a campaign table");
                return Err(Error::input(name, problem));
            }
        }
        let mut rows: Vec<Vec<String>> = Vec::new();
        for record in reader.records() {
            if rows.len() == ROWS_MAX {
                let problem = format!("has more than {ROWS_MAX} rows: it is not a campaign table");
                return Err(Error::input(name, problem));
            }
            rows.push(record.map_err(wrong)?.iter().map(String::from).collect());
        }
        let comment = text
            .lines()
            .next()
            .and_then(|l| l.strip_prefix("# units: "));
        let units = comment.map_or(Vec::new(), |c| c.split("; ").map(String::from).collect());
        Ok(Self { units, names, rows })
    }

    /// What the numbers of a column are counted in; `""` if that is not said.
    pub fn unit(&self, column: &str) -> String {
        let has = |kind: &&String| kind.split(' ').any(|word| word == column);
        let kind = self.units.iter().find(has).map_or("", |kind| kind);
        let name = |word: &&str| self.names.iter().any(|name| name == word);
        let words: Vec<&str> = kind.split(' ').skip_while(name).collect();
        words.join(" ")
    }

    /// How many of its done runs that are wanted have the same row in another table: every column of that one.
    ///
    /// # Errors
    /// [`Error::Unverified`] with the first run, column and both texts that differ, or what is missing.
    pub fn check_against(
        &self,
        other: &CampaignTable,
        place: &str,
        wants: impl Fn(&str, &str) -> bool,
    ) -> Result<usize> {
        let missing = other.names.iter().find(|name| !self.names.contains(name));
        let digest = other.names.iter().any(|name| name == "digest");
        if missing.is_some() || !digest {
            let column = missing.map_or("digest", |name| name);
            let problem = format!("only one of the table and {place} has a column `{column}`");
            return Err(Error::Unverified {
                problem,
                hint: CHANGED,
            });
        }
        let mut same = 0;
        for row in (0..self.len()).filter(|&row| self.text(row, "status") == "done") {
            let key = |table: &CampaignTable, row| {
                ["member", "run"].map(|c| table.text(row, c).to_owned())
            };
            let [member, run] = key(self, row);
            if !wants(&member, &run) {
                continue;
            }
            let twin = (0..other.len()).find(|&k| key(other, k) == key(self, row));
            let problem = match twin {
                None => Some(format!("{place} has no row of {member}/{run}")),
                Some(twin) => {
                    let differs = |name: &&String| self.text(row, name) != other.text(twin, name);
                    let first = other.names.iter().find(differs);
                    first.map(|name| {
                        format!(
                            "{member}/{run}: {name} is {}, and {} in {place}",
                            self.text(row, name),
                            other.text(twin, name)
                        )
                    })
                }
            };
            if let Some(problem) = problem {
                return Err(Error::Unverified {
                    problem,
                    hint: CHANGED,
                });
            }
            same += 1;
        }
        Ok(same)
    }

    /// Names of its columns.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(|name| &name[..])
    }

    /// How many rows it has.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The words of a cell; `""` if there is none, or no such column.
    pub fn text(&self, row: usize, column: &str) -> &str {
        let place = self.names.iter().position(|name| name == column);
        place
            .and_then(|k| self.rows[row].get(k))
            .map_or("", |word| word)
    }

    /// The number of a cell; `None` if there is none.
    pub fn real(&self, row: usize, column: &str) -> Option<f64> {
        bitgrain_sim::files::finite(self.text(row, column))
    }
}
