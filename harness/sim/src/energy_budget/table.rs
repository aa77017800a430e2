//! Rows of the energy budget, as a series and as a replay print them.

use serde::{Deserialize, Serialize};

use crate::table::{Cell, Table, column, optional};
use crate::units::Units;

/// The energy budget of a simulation at one step: state, and sums since the budget began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnergyRow {
    /// Step.
    pub step: u64,
    /// Kinetic energy of all grains, by velocity and by spin.
    pub kinetic: f64,
    /// Stored in the normal direction of contacts.
    pub normal: f64,
    /// Stored in tangential springs.
    pub tangential: f64,
    /// Gravitational energy, less that at the start.
    pub gravitational: f64,
    /// Work of the obstacles on the grains.
    pub obstacles: f64,
    /// Work of what carries grains: of base and lid, by the velocities that are prescribed.
    pub carriers: f64,
    /// Dissipated by normal damping.
    pub normal_damping: f64,
    /// Dissipated by tangential damping of contacts that do not slide.
    pub tangential_damping: f64,
    /// Dissipated by sliding.
    pub sliding: f64,
    /// Gained by tangential springs that grew stiffer at fixed displacement, less what those that grew
    /// softer lost.
    pub stiffening: f64,
    /// Lost by tangential springs whose plane turned: by the projection.
    pub projection: f64,
    /// Lost with the history of contacts that parted.
    pub erased: f64,
    /// Taken by the torques that resist rolling, what their springs store included; none if the law has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rolling: Option<f64>,
    /// What the residual is compared with: work of obstacles, of carriers and of gravity, each step's as
    /// a magnitude, and what kinetic and elastic energy there was at the start.
    pub work: f64,
    /// What remains of the balance: the change of the four energies, less work and stiffening, plus all that
    /// was dissipated and lost.
    pub residual: f64,
}

impl EnergyRow {
    /// The residual over the work done; 0 if nothing has happened.
    pub fn closure(&self) -> f64 {
        if self.work > 0.0 {
            self.residual / self.work
        } else {
            0.0
        }
    }
}

/// An energy series.
pub const ENERGY: Table<EnergyRow> = Table(&[
    column("step", |r| Cell::Whole(&mut r.step)),
    column("kinetic", |r| Cell::Real(&mut r.kinetic)),
    column("normal", |r| Cell::Real(&mut r.normal)),
    column("tangential", |r| Cell::Real(&mut r.tangential)),
    column("gravitational", |r| Cell::Real(&mut r.gravitational)),
    column("obstacles", |r| Cell::Real(&mut r.obstacles)),
    column("carriers", |r| Cell::Real(&mut r.carriers)),
    column("normal_damping", |r| Cell::Real(&mut r.normal_damping)),
    column("tangential_damping", |r| {
        Cell::Real(&mut r.tangential_damping)
    }),
    column("sliding", |r| Cell::Real(&mut r.sliding)),
    column("stiffening", |r| Cell::Real(&mut r.stiffening)),
    column("projection", |r| Cell::Real(&mut r.projection)),
    column("erased", |r| Cell::Real(&mut r.erased)),
    optional("rolling", |r| Cell::Optional(&mut r.rolling)),
    column("work", |r| Cell::Real(&mut r.work)),
    column("residual", |r| Cell::Real(&mut r.residual)),
]);

/// The text of an energy series: a line of units, the column names, the rows.
pub fn energy_text(units: &Units, rows: &[EnergyRow]) -> String {
    let comment = format!("units: all energies {}, since the first step", units.energy);
    let none = rows.iter().all(|row| row.rolling.is_none());
    let left_out: &[&str] = if none { &["rolling"] } else { &[] };
    ENERGY.text_without(left_out, &comment, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let row = EnergyRow {
            step: 25,
            kinetic: 0.1,
            sliding: 1e-300,
            erased: -3.0,
            residual: -2.5e-7,
            work: 2.0,
            ..EnergyRow::default()
        };
        let units = crate::units::Units::reduced();
        let text = energy_text(&units, &[row, row]);
        assert_eq!(ENERGY.parse(&text), Ok(vec![row, row]));
        assert_eq!(row.closure(), -1.25e-7);
        assert_eq!(EnergyRow::default().closure(), 0.0);
        let good = text.lines().last().unwrap();
        for bad in [
            "1,2,x",
            good.rsplit_once(',').unwrap().0,
            &format!("{good},1"),
            &good.replacen("0.1", "NaN", 1),
            &good.replacen("25", "-25", 1),
        ] {
            assert_ne!(bad, good);
            assert_eq!(ENERGY.parse(&format!("{text}{bad}\n")), Err(5), "{bad}");
        }
    }
}
