//! Force series: what was measured as the intruder moved, as rows of a CSV file.

use bitgrain_sim::files::finite;
use std::path::Path;

use serde::{Deserialize, Serialize};

use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::{bits, read_text};
use bitgrain_sim::units::Units;

/// One row of a force series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesRow {
    /// Steps since the drag began.
    pub step: u64,
    /// Time since the drag began.
    pub time: f64,
    /// Travel of the intruder.
    pub distance: f64,
    /// Drag, lift and side force at this step.
    pub force: [f64; 3],
    /// Their means over the steps since the row before.
    pub force_mean: [f64; 3],
    /// Torque on the intruder about its centre at this step.
    pub torque: [f64; 3],
    /// Grains that touch the intruder at this step.
    pub contacts: u32,
    /// Mean contact angle at this step (radians); none without a contact.
    pub angle: Option<f64>,
    /// Mean number of contacts of the grains near the intruder at this step; none without grains.
    pub coordination: Option<f64>,
}

/// Column names of a series file, in order.
pub const SERIES_COLUMNS: [&str; 15] = [
    "step",
    "time",
    "distance",
    "drag",
    "lift",
    "side",
    "drag_mean",
    "lift_mean",
    "side_mean",
    "torque_x",
    "torque_y",
    "torque_z",
    "contacts",
    "angle",
    "coordination",
];

/// Which of the columns that may be left out a series file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    /// The torque.
    pub torque: bool,
    /// The three about contacts.
    pub contacts: bool,
}

impl Columns {
    /// All of them.
    pub const ALL: Self = Self {
        torque: true,
        contacts: true,
    };
}

/// The text of a series file: a line of units, the column names, the rows; shortest decimals that
/// read back to the same bits, nothing where there is none. Torque and the three columns about
/// contacts are there as `asked`.
pub fn series_text(units: &Units, asked: Columns, rows: &[SeriesRow]) -> String {
    let wanted = |name: &str| match name {
        "torque_x" | "torque_y" | "torque_z" => asked.torque,
        "contacts" | "angle" | "coordination" => asked.contacts,
        _ => true,
    };
    let columns: Vec<&str> = SERIES_COLUMNS
        .into_iter()
        .filter(|name| wanted(name))
        .collect();
    let mut out = format!(
        "# units: time {}; distance {}; drag, lift, side {}; torque {}; angle rad; {}\n{}\n",
        units.time,
        units.length,
        units.force,
        units.torque,
        bits(),
        columns.join(",")
    );
    for row in rows {
        let mut row = *row;
        let words = columns.iter().map(|name| match *name {
            "step" => row.step.to_string(),
            "contacts" => row.contacts.to_string(),
            "angle" => row.angle.map_or(String::new(), |x| x.to_string()),
            "coordination" => row.coordination.map_or(String::new(), |x| x.to_string()),
            _ => row.real(name).map_or(String::new(), |x| x.to_string()),
        });
        out.push_str(&words.collect::<Vec<String>>().join(","));
        out.push('\n');
    }
    out
}

impl SeriesRow {
    /// The number of a column that holds a real number.
    fn real(&mut self, column: &str) -> Option<&mut f64> {
        Some(match column {
            "time" => &mut self.time,
            "distance" => &mut self.distance,
            "drag" => &mut self.force[0],
            "lift" => &mut self.force[1],
            "side" => &mut self.force[2],
            "drag_mean" => &mut self.force_mean[0],
            "lift_mean" => &mut self.force_mean[1],
            "side_mean" => &mut self.force_mean[2],
            "torque_x" => &mut self.torque[0],
            "torque_y" => &mut self.torque[1],
            "torque_z" => &mut self.torque[2],
            _ => return None,
        })
    }

    fn parse(columns: &[&str], line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split(',').collect();
        if words.len() != columns.len() {
            return None;
        }
        let mut row = Self::default();
        for (name, word) in columns.iter().zip(words) {
            match *name {
                "step" => row.step = word.parse().ok()?,
                "contacts" => row.contacts = word.parse().ok()?,
                "angle" | "coordination" if word.is_empty() => {}
                "angle" => row.angle = Some(finite(word)?),
                "coordination" => row.coordination = Some(finite(word)?),
                _ => *row.real(name)? = finite(word)?,
            }
        }
        Some(row)
    }
}

/// Reads a series file, plain or gzip; columns that it leaves out are zero.
///
/// # Errors
/// [`Error::Input`] with the line that does not fit the column names.
pub fn read_series(path: &Path) -> Result<Vec<SeriesRow>> {
    let text = read_text(path)?;
    parse_series(&text, &path.display().to_string())
}

/// Reads the text of a series file; `name` is what errors call it.
///
/// # Errors
/// As [`read_series`].
pub fn parse_series(text: &str, name: &str) -> Result<Vec<SeriesRow>> {
    let mut columns: Vec<&str> = Vec::new();
    let mut rows = Vec::new();
    for (k, line) in text.lines().enumerate() {
        if line.starts_with('#') {
            continue;
        }
        if columns.is_empty() {
            columns = line.split(',').collect();
            continue;
        }
        let row = SeriesRow::parse(&columns, line).ok_or_else(|| {
            let place = format!("{name}:{}", k + 1);
            let problem = format!("expected {} numbers; is the file cut off?", columns.len());
            Error::input(place, problem)
        })?;
        rows.push(row);
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_reads_back_to_the_same_bits() {
        let units = Units {
            length: "d".into(),
            time: "sqrt(d/g)".into(),
            speed: "sqrt(g d)".into(),
            force: "rho d^3 g".into(),
            torque: "rho d^4 g".into(),
            energy: "rho d^4 g".into(),
        };
        let row = SeriesRow {
            step: 7,
            time: 0.1 + 0.2,
            distance: 1.0 / 3.0,
            force: [1e-300, -5.5, f64::MIN_POSITIVE],
            force_mean: [1e22, -0.0, 3.0],
            torque: [2.5e-8, 0.1, -7.0],
            contacts: 12,
            angle: Some(1.0 / 7.0),
            coordination: None,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        std::fs::write(&path, series_text(&units, Columns::ALL, &[row, row])).unwrap();
        assert_eq!(read_series(&path).unwrap(), [row, row]);
        std::fs::write(&path, "step,time\n1,2\n3\n").unwrap();
        let error = read_series(&path).unwrap_err().to_string();
        assert!(error.contains("series.csv:3"), "{error}");
        let error = parse_series("step,time\n1,nan\n", "text").unwrap_err();
        assert!(error.to_string().contains("text:2"), "{error}");
    }
}
