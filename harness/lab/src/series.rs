//! Force series: what was measured as the intruder moved, as rows of a CSV file.

use std::path::Path;

use serde::{Deserialize, Serialize};

use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;
use bitgrain_sim::table::{Cell, Table, column, optional};
use bitgrain_sim::units::Units;

/// Where an intruder that forces move is at a step, and how it moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyRow {
    /// Its centre; the periods of the box that it crossed count (length).
    pub place: [f64; 3],
    /// Velocity.
    pub velocity: [f64; 3],
    /// Angular velocity (radians / time).
    pub spin: [f64; 3],
}

/// One row of a force series.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeriesRow {
    /// Steps since the drag began.
    pub step: u64,
    /// Time since the drag began.
    pub time: f64,
    /// Travel of the intruder: along x, and down if it is dropped.
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
    /// The intruder, if forces move it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body: Option<BodyRow>,
}

impl SeriesRow {
    /// The intruder, to be read into.
    fn body_mut(&mut self) -> &mut BodyRow {
        self.body.get_or_insert_default()
    }
}

/// A force series; torque, what is known of contacts, and an intruder that forces move may be left out.
pub const SERIES: Table<SeriesRow> = Table(&[
    column("step", |r| Cell::Whole(&mut r.step)),
    column("time", |r| Cell::Real(&mut r.time)),
    column("distance", |r| Cell::Real(&mut r.distance)),
    column("drag", |r| Cell::Real(&mut r.force[0])),
    column("lift", |r| Cell::Real(&mut r.force[1])),
    column("side", |r| Cell::Real(&mut r.force[2])),
    column("drag_mean", |r| Cell::Real(&mut r.force_mean[0])),
    column("lift_mean", |r| Cell::Real(&mut r.force_mean[1])),
    column("side_mean", |r| Cell::Real(&mut r.force_mean[2])),
    optional("torque_x", |r| Cell::Real(&mut r.torque[0])),
    optional("torque_y", |r| Cell::Real(&mut r.torque[1])),
    optional("torque_z", |r| Cell::Real(&mut r.torque[2])),
    optional("contacts", |r| Cell::Count(&mut r.contacts)),
    optional("angle", |r| Cell::Optional(&mut r.angle)),
    optional("coordination", |r| Cell::Optional(&mut r.coordination)),
    optional("x", |r| Cell::Real(&mut r.body_mut().place[0])),
    optional("y", |r| Cell::Real(&mut r.body_mut().place[1])),
    optional("z", |r| Cell::Real(&mut r.body_mut().place[2])),
    optional("velocity_x", |r| Cell::Real(&mut r.body_mut().velocity[0])),
    optional("velocity_y", |r| Cell::Real(&mut r.body_mut().velocity[1])),
    optional("velocity_z", |r| Cell::Real(&mut r.body_mut().velocity[2])),
    optional("spin_x", |r| Cell::Real(&mut r.body_mut().spin[0])),
    optional("spin_y", |r| Cell::Real(&mut r.body_mut().spin[1])),
    optional("spin_z", |r| Cell::Real(&mut r.body_mut().spin[2])),
]);

/// The columns of an intruder that forces move.
const BODY: [&str; 9] = [
    "x",
    "y",
    "z",
    "velocity_x",
    "velocity_y",
    "velocity_z",
    "spin_x",
    "spin_y",
    "spin_z",
];

/// Which of the columns that may be left out a series file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    /// The torque.
    pub torque: bool,
    /// The three about contacts.
    pub contacts: bool,
    /// The nine about an intruder that forces move.
    pub body: bool,
}

impl Columns {
    /// All of them.
    pub const ALL: Self = Self {
        torque: true,
        contacts: true,
        body: true,
    };
}

/// The text of a series file: a line of units, the column names, the rows. Torque and the three columns about
/// contacts, and those about an intruder that forces move, are there as `asked`.
pub fn series_text(units: &Units, asked: Columns, rows: &[SeriesRow]) -> String {
    let mut comment = format!(
        "units: time {}; distance {}; drag, lift, side {}; torque {}; angle rad",
        units.time, units.length, units.force, units.torque
    );
    let mut left_out = Vec::new();
    if !asked.torque {
        left_out.extend(["torque_x", "torque_y", "torque_z"]);
    }
    if !asked.contacts {
        left_out.extend(["contacts", "angle", "coordination"]);
    }
    if asked.body {
        comment += &format!(
            "; x, y, z {}; velocity {}; spin rad/({})",
            units.length, units.speed, units.time
        );
    } else {
        left_out.extend(BODY);
    }
    SERIES.text_without(&left_out, &comment, rows)
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
    SERIES.parse(text).map_err(|line| {
        let head = text.lines().find(|line| !line.starts_with('#'));
        let columns = head.map_or(0, |head| head.split(',').count());
        let problem = format!("expected {columns} numbers; is the file cut off?");
        Error::input(format!("{name}:{line}"), problem)
    })
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
            body: Some(BodyRow {
                place: [0.1, -2.0, 7.0],
                velocity: [1e-9, 3.0, -0.5],
                spin: [0.3, 0.2, 0.1],
            }),
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("series.csv");
        std::fs::write(&path, series_text(&units, Columns::ALL, &[row, row])).unwrap();
        assert_eq!(read_series(&path).unwrap(), [row, row]);
        let text = series_text(&units, Columns::ALL, &[row]);
        std::fs::write(&path, format!("{text}3\n")).unwrap();
        let error = read_series(&path).unwrap_err().to_string();
        assert!(error.contains("series.csv:4"), "{error}");
        let error = parse_series(&text.replace("0.1,", "nan,"), "text").unwrap_err();
        assert!(error.to_string().contains("text:3"), "{error}");
    }
}
