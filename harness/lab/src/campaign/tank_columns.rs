//! The columns of bars in tanks.

use super::column::{Column, Row, Unit, real};
use crate::summary::Tank;
use crate::tank::HalfTurn;
use bitgrain_sim::block_averaging::Mean;

/// What only bars in tanks have, if one of the rows is of one: the tank, the bar, and drag and lift of each half turn.
pub(super) fn tanks(all: &mut Vec<Column>, rows: &[Row<'_>]) {
    fn own<'a>(row: &'a Row<'_>) -> Option<&'a Tank> {
        row.record()?.run.tank.as_ref()
    }
    let turns = rows
        .iter()
        .filter_map(|row| Some(own(row)?.half_turns.len()));
    let Some(turns) = turns.max() else {
        return;
    };
    type Number = (&'static str, Unit, fn(&Tank) -> Option<f64>);
    let numbers: [Number; 6] = [
        ("tank_diameter", Unit::Length, |t| Some(t.diameter)),
        ("length", Unit::Length, |t| Some(t.length)),
        ("turning_rate", Unit::None, |t| Some(t.turning_rate)),
        ("turns", Unit::None, |t| Some(t.turns)),
        ("centrifugal", Unit::None, |t| Some(t.centrifugal)),
        ("direct", Unit::None, |t| t.direct),
    ];
    for (name, unit, of) in numbers {
        real(all, name, unit, move |row| of(own(row)?));
    }
    for k in 0..turns {
        let half = move |row: &Row<'_>| own(row)?.half_turns.get(k).copied();
        for (name, of) in [
            ("drag", (|half| half.drag) as fn(HalfTurn) -> Mean),
            ("lift", |half| half.lift),
        ] {
            let name = format!("{name}_turn_{}", k + 1);
            real(all, &name, Unit::Force, move |row| {
                Some(of(half(row)?).mean)
            });
            real(all, &format!("{name}_error"), Unit::Force, move |row| {
                Some(of(half(row)?).standard_error)
            });
        }
    }
}
