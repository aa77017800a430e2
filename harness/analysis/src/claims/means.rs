//! Means over the seeds of each point of flowing beds, as rows of tables: by what drag and lift are divided, and where
//! the axis lies, side by side.

use super::load::{PointLoad, equation_4, odd_part, point_load};
use super::place::Place;
use super::points::{Group, Point, Spread, Way, groups};
use super::shape::{ALIKE, share};
use crate::analysis::Value;
use bitgrain_lab::summary::Summary;
use bitgrain_sim::format::{number_with_error, short};

/// What the runs of a point say.
#[derive(Clone, Debug, PartialEq)]
pub struct Means {
    /// How the effective depth is made.
    pub way: Way,
    /// Runs, one for each seed.
    pub runs: usize,
    /// Where the axis lies.
    pub place: Place,
    /// Effective depth over D.
    pub depth: f64,
    /// Drag over rho g h~ D L: C_d as the paper has it (Guillard 2014, eq. 2).
    pub over_depth: Spread,
    /// Drag over D L and the weight above the axis over the area of the box.
    pub over_weight: Spread,
    /// Lift over buoyancy.
    pub lift: Spread,
    /// How much of eq. 4's curve the odd part of the normal stress holds, if the load was measured: what lifts.
    pub odd: Option<Value>,
}

/// The odd part of a load's normal stress over the curve that eq. 4 makes of the same load.
pub(super) fn asymmetry(load: &PointLoad) -> Value {
    share(&odd_part(load), &equation_4(load), &ALIKE)
}

pub(super) fn means_of(summary: &Summary, group: &Group, point: &Point) -> Means {
    Means {
        way: point.way,
        runs: point.runs.len(),
        place: point.place,
        depth: point.effective_depth / group.diameter,
        over_depth: point.drag_over_depth,
        over_weight: point.drag_over_weight,
        lift: point.lift,
        odd: point_load(summary, group, point).map(|load| asymmetry(&load)),
    }
}

/// A row for each point of a group, by way and then by depth.
pub fn means(summary: &Summary, group: &Group) -> Vec<Means> {
    let points = group.points.iter();
    points.map(|p| means_of(summary, group, p)).collect()
}

/// What the columns of a table of means are called; the first holds words.
pub const HEADS: [&str; 8] = [
    "way",
    "runs",
    "floor/D",
    "surface/D",
    "h~/D",
    "C_d",
    "C_d of the weight",
    "lift over buoyancy",
];

/// What the last column is called, of loads that were measured.
pub const ODD: &str = "odd part over eq. 4";

impl Means {
    /// The cells of a row, lengths over the diameter `d` of the cylinder; the last is there if the load was measured.
    pub fn cells(&self, d: f64) -> Vec<String> {
        let number = |x: &Spread| number_with_error(x.mean, x.error);
        let mut cells = vec![
            self.way.name().to_owned(),
            self.runs.to_string(),
            short(self.place.floor / d),
            short(self.place.surface / d),
            short(self.depth),
            number(&self.over_depth),
            number(&self.over_weight),
            number(&self.lift),
        ];
        cells.extend(self.odd.map(|odd| number_with_error(odd.value, odd.error)));
        cells
    }
}

/// The means of all flowing beds of a run as text; empty if no bed flows.
pub fn text(summary: &Summary) -> String {
    let mut out = String::new();
    for group in groups(summary) {
        let rows = means(summary, &group);
        let mut table: Vec<Vec<String>> = vec![HEADS.map(str::to_owned).to_vec()];
        if rows.iter().any(|row| row.odd.is_some()) {
            table[0].push(ODD.to_owned());
        }
        table.extend(rows.iter().map(|row| row.cells(group.diameter)));
        out.push_str(&format!(
            "\nflowing beds, D/d = {}, speed {}: C_d is the drag over rho g h~ D L, and over the weight measured above \
             the axis\n",
            short(group.over_grain),
            short(group.speed)
        ));
        let width = |k: usize| {
            let cells = table.iter().filter_map(|row| row.get(k));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        for row in &table {
            let cells = row.iter().enumerate();
            let cells = cells.map(|(k, cell)| format!("{cell:<0$}", width(k)));
            let line = cells.collect::<Vec<_>>().join("  ");
            out.push_str(&format!("  {}\n", line.trim_end()));
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{self, Asked};
    use super::super::synthetic_load::load;
    use super::*;

    /// A load of 15 P_0 cos(theta) has 7.5 cos(theta) sin(theta) rho g D in eq. 4; a part 20 cos(theta) sin(theta) with
    /// a gradient is 8/3 of that, and an even load has none.
    #[test]
    fn the_odd_part_is_told_in_curves_of_equation_4() {
        assert!(asymmetry(&load(16.0, false, 0.0)).value.abs() < 1e-12);
        let with = asymmetry(&load(16.0, true, 0.0)).value;
        // The curve of the whole load has (20/15/16) cos sin^2 in it, too, of which the square is half that of cos sin.
        let own = 1.0 + 0.5 * (20.0 / 15.0 / 16.0_f64).powi(2);
        assert!((with - 20.0 / 7.5 / own).abs() < 1e-3, "{with}");
    }

    /// Drags over a weight that is less than rho g h~ are larger by that.
    #[test]
    fn drags_stand_over_both_pressures() {
        let asked = Asked {
            change: |flow| {
                if flow.pressure_gradient {
                    flow.pressure_measured = 0.8 * flow.pressure;
                }
            },
            ..Asked::default()
        };
        let summary = synthetic::summary(&asked);
        let group = &groups(&summary)[0];
        let rows = means(&summary, group);
        assert_eq!(rows.len(), 8);
        for row in &rows {
            let weight = if row.way.has_gradient() { 0.8 } else { 1.0 };
            assert!((row.over_depth.mean - 10.0).abs() < 1e-9, "{row:?}");
            assert!((row.over_weight.mean - 10.0 / weight).abs() < 1e-9);
            assert_eq!(
                row.place.words(group.diameter),
                "6.1 D above the floor and 6.1 D below the surface"
            );
            assert_eq!(row.odd, None);
        }
        let told = text(&summary);
        let lines: Vec<&str> = told.lines().collect();
        assert_eq!(lines.len(), 2 + 1 + 8, "{told}");
        assert!(lines[2].contains("C_d of the weight  lift over buoyancy"));
        assert!(!told.contains(ODD));
        let first = lines[3].split("  ").map(str::trim);
        let first: Vec<&str> = first.filter(|cell| !cell.is_empty()).collect();
        assert_eq!(first[1..5], ["2", "6.061", "6.061", "8.081"], "{first:?}");
        assert!(first[5].starts_with("10.00") && first[6].starts_with("12.50"));
    }
}
