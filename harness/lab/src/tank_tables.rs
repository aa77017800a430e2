//! The tables of a bar in a tank: the load along it, and how the grains go round in the ring that it sweeps.

use bitgrain_sim::table::{Cell, Table, column};
use bitgrain_sim::units::Units;

/// Sectors of half a turn.
pub const SECTORS: usize = 36;

/// The ring whose grains show how the bed goes round, over half of the bar's length: near the middle the bar sweeps
/// nothing, and beyond its ends neither.
pub const RING: [f64; 2] = [0.25, 0.9];

/// A part of the bar, both halves together: means over the samples of the window, and of what comes after it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BarRow {
    /// Where it begins, from the middle, over the length of the bar.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Drag over length.
    pub drag: Option<f64>,
    /// Lift over length.
    pub lift: Option<f64>,
    /// The same after the first half turn.
    pub drag_after: Option<f64>,
    /// The same after the first half turn.
    pub lift_after: Option<f64>,
}

/// The table of the load along the bar.
pub const BAR: Table<BarRow> = Table(&[
    column("from", |r| Cell::Real(&mut r.from)),
    column("to", |r| Cell::Real(&mut r.to)),
    column("drag", |r| Cell::Optional(&mut r.drag)),
    column("lift", |r| Cell::Optional(&mut r.lift)),
    column("drag_after", |r| Cell::Optional(&mut r.drag_after)),
    column("lift_after", |r| Cell::Optional(&mut r.lift_after)),
]);

/// Its text.
pub fn bar_text(units: &Units, rows: &[BarRow]) -> String {
    let comment = format!(
        "from, to over the length of the bar, from its middle; drag, lift {} over {}; after: after the first half \
         turn",
        units.force, units.length
    );
    BAR.text(&comment, rows)
}

/// The grains of a layer and a sector of the ring: means over the samples of the window, and of what comes after it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VelocityRow {
    /// Angle from the nearest half of the bar, positive ahead of it (degrees).
    pub angle: f64,
    /// Height of the middle of the layer (length).
    pub height: f64,
    /// Speed round the axis over that of the bar at the same radius.
    pub ahead: Option<f64>,
    /// Upward speed over the same.
    pub up: Option<f64>,
    /// The same after the first half turn.
    pub ahead_after: Option<f64>,
    /// The same after the first half turn.
    pub up_after: Option<f64>,
}

/// The table of speeds in the ring.
pub const VELOCITY: Table<VelocityRow> = Table(&[
    column("angle", |r| Cell::Real(&mut r.angle)),
    column("height", |r| Cell::Real(&mut r.height)),
    column("ahead", |r| Cell::Optional(&mut r.ahead)),
    column("up", |r| Cell::Optional(&mut r.up)),
    column("ahead_after", |r| Cell::Optional(&mut r.ahead_after)),
    column("up_after", |r| Cell::Optional(&mut r.up_after)),
]);

/// Its text.
pub fn velocity_text(units: &Units, rows: &[VelocityRow]) -> String {
    let comment = format!(
        "angle from the nearest half of the bar in degrees, positive ahead; height {}; speeds over that of the bar at \
         the same radius, of grains {} to {} of its half length from the axis; after: after the first half turn",
        units.length, RING[0], RING[1]
    );
    VELOCITY.text(&comment, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_as_they_were_written() {
        let units = crate::scenario::load("quick", &[]).unwrap().units();
        let bar = BarRow {
            from: 0.25,
            to: 1.0 / 3.0,
            drag: Some(0.1),
            lift_after: Some(-7.5),
            ..BarRow::default()
        };
        let velocity = VelocityRow {
            angle: -87.5,
            height: 0.1 + 0.2,
            up: Some(1e-300),
            ..VelocityRow::default()
        };
        let text = bar_text(&units, &[bar, bar]);
        assert_eq!(BAR.parse(&text).unwrap(), [bar, bar]);
        assert_eq!(BAR.parse(&format!("{text}1,2\n")), Err(5));
        let text = velocity_text(&units, &[velocity]);
        assert_eq!(VELOCITY.parse(&text).unwrap(), [velocity]);
    }
}
