//! The columns of a campaign's table: inputs, observables with their standard errors, digests.

pub use super::column::{Cell, Column, Row, Status, Unit};
use super::column::{mean, real, text, whole};
use super::tank_columns::tanks;
use crate::scenario::BedPlan;
use crate::summary::{DragSummary, Flow, Reach, Tank};
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::format::round10;

/// Grains with this many contacts or more share the last of the columns of coordination numbers.
pub const MOST_CONTACTS: usize = 12;

/// What the columns of the drag over a diameter of travel begin with; the number of the diameter follows, from 1.
pub const DRAG_BY_TRAVEL: &str = "drag_travel_";

/// All columns of a table with these rows, in order: the last of them are as many as the rows have diameters of
/// travel, and those of the reaches that a row was measured at.
pub fn columns(rows: &[Row<'_>]) -> Vec<Column> {
    let mut all = Vec::new();
    names(&mut all);
    inputs(&mut all);
    law(&mut all);
    bed(&mut all);
    forces(&mut all);
    around(&mut all);
    flow(&mut all);
    digests(&mut all);
    tanks(&mut all, rows);
    pouring(&mut all, rows);
    reaches(&mut all, rows);
    travel(&mut all, rows);
    all
}

fn names(all: &mut Vec<Column>) {
    text(all, "member", |row| Some(row.member.into()));
    text(all, "run", |row| Some(row.plan.name.clone()));
    text(all, "status", |row| {
        let word = match row.status {
            Status::Done(_) => "done",
            Status::Failed(_) => "failed",
        };
        Some(word.into())
    });
    text(all, "reason", |row| match row.status {
        Status::Done(_) => None,
        Status::Failed(reason) => Some(reason.clone()),
    });
}

fn inputs(all: &mut Vec<Column>) {
    fn plan<'a>(row: &Row<'a>) -> &'a BedPlan {
        &row.scenario.beds()[row.plan.bed]
    }
    whole(all, "seed", move |row| Some(plan(row).seed));
    real(all, "gravity", Unit::None, |row| Some(row.scenario.gravity));
    for (a, axis) in ["x", "y", "z"].into_iter().enumerate() {
        real(all, &format!("box_{axis}"), Unit::Length, move |row| {
            Some(row.scenario.bed.size[a])
        });
    }
    real(all, "diameter_least", Unit::Length, |row| {
        Some(row.scenario.bed.diameters[0])
    });
    real(all, "diameter_most", Unit::Length, |row| {
        Some(row.scenario.bed.diameters[1])
    });
    real(all, "density", Unit::None, |row| {
        Some(row.scenario.bed.density)
    });
    real(all, "base", Unit::Length, |row| Some(row.scenario.bed.base));
    text(all, "floor", |row| Some(row.scenario.bed.floor.to_string()));
    real(all, "settled", Unit::None, |row| {
        Some(row.scenario.bed.settled)
    });
    real(all, "diameter", Unit::Length, move |row| {
        Some(plan(row).diameter)
    });
    real(all, "intruder_density", Unit::None, |row| {
        row.scenario.intruder.density
    });
    real(all, "intruder_height", Unit::Length, move |row| {
        Some(plan(row).center[2])
    });
    real(all, "depth_asked", Unit::Length, move |row| {
        let bed = plan(row);
        let depth = row.scenario.expected_surface(bed.diameter) - bed.center[2];
        // As it was given: converting it to a height and back changes the last digits.
        Some(round10(depth))
    });
    real(all, "effective_depth_asked", Unit::Length, move |row| {
        plan(row).lid?.effective_depth
    });
    real(all, "speed", Unit::Speed, |row| Some(row.plan.motion.speed));
    real(all, "froude", Unit::None, |row| Some(row.plan.froude));
    real(all, "dt", Unit::Time, |row| Some(row.scenario.drag.dt));
    real(all, "distance", Unit::Length, |row| Some(row.plan.distance));
    real(all, "discard", Unit::Length, |row| Some(row.plan.discard));
    whole(all, "steps", |row| Some(row.plan.steps()));
    whole(all, "every", |row| Some(row.scenario.measure.every));
}

/// The friction of the pouring, if one of the rows has another than that of its law.
fn pouring(all: &mut Vec<Column>, rows: &[Row<'_>]) {
    let own = |row: &Row<'_>| row.scenario.bed.pouring_mu;
    if rows.iter().any(|row| own(row).is_some()) {
        real(all, "pouring_mu", Unit::None, own);
    }
}

fn law(all: &mut Vec<Column>) {
    text(all, "law", |row| Some(row.scenario.law.kind()));
    // These column names never change; a key that a law lacks is empty.
    for name in [
        "mu",
        "kn",
        "kt",
        "gamma_n",
        "gamma_t",
        "young",
        "poisson",
        "restitution",
    ] {
        real(all, name, Unit::None, move |row| {
            row.scenario.law.value(name)
        });
    }
}

fn bed(all: &mut Vec<Column>) {
    text(all, "bed", |row| Some(row.record()?.bed.name.clone()));
    whole(all, "grains", |row| Some(row.record()?.bed.grains as u64));
    real(all, "surface", Unit::Length, |row| {
        Some(row.record()?.bed.surface)
    });
    real(all, "depth", Unit::Length, |row| {
        Some(row.record()?.bed.depth)
    });
    real(all, "packing_fraction", Unit::None, |row| {
        Some(row.record()?.bed.packing_fraction)
    });
    real(all, "bed_coordination", Unit::None, |row| {
        Some(row.record()?.bed.coordination_number)
    });
}

fn forces(all: &mut Vec<Column>) {
    mean(all, "drag", Unit::Force, |r| Some(r.run.drag));
    mean(all, "lift", Unit::Force, |r| Some(r.run.lift));
    mean(all, "side", Unit::Force, |r| Some(r.run.side));
    text(all, "drag_converged", |row| {
        Some(row.record()?.run.drag.converged.to_string())
    });
    whole(all, "drag_blocks", |row| {
        Some(row.record()?.run.drag.blocks as u64)
    });
    whole(all, "drag_block_length", |row| {
        Some(row.record()?.run.drag.block_length)
    });
    real(all, "drag_uncut", Unit::Force, |row| {
        Some(row.record()?.run.drag_uncut)
    });
    real(all, "plug_ratio", Unit::None, |row| {
        Some(row.record()?.run.plug_ratio)
    });
    text(all, "plug", |row| {
        Some(row.record()?.run.plug.word().into())
    });
    mean(all, "drift", Unit::None, |r| r.run.drift);
    real(all, "overlap_max", Unit::None, |row| {
        Some(row.record()?.run.overlap_max)
    });
}

fn around(all: &mut Vec<Column>) {
    mean(all, "contacts", Unit::None, |r| Some(r.run.contacts));
    mean(all, "contact_angle", Unit::Angle, |r| r.run.contact_angle);
    mean(all, "new_contact_angle", Unit::Angle, |r| {
        r.run.new_contact_angle
    });
    mean(all, "coordination", Unit::None, |r| r.run.coordination);
    mean(all, "floating", Unit::None, |r| r.run.floating);
    mean(all, "moving", Unit::None, |r| r.run.moving);
    real(all, "kappa", Unit::None, |row| row.record()?.run.kappa);
    real(all, "kappa_error", Unit::None, |row| {
        row.record()?.run.kappa_error
    });
    for contacts in 0..=MOST_CONTACTS {
        real(
            all,
            &format!("coordination_{contacts}"),
            Unit::None,
            move |row| {
                let shares = &row.record()?.run.coordination_shares;
                let end = if contacts == MOST_CONTACTS {
                    shares.len()
                } else {
                    contacts + 1
                };
                Some(shares.get(contacts..end).unwrap_or_default().iter().sum())
            },
        );
    }
}

fn flow(all: &mut Vec<Column>) {
    type Number = (
        &'static str,
        Unit,
        fn(&Flow) -> f64,
        fn(&Tank) -> Option<f64>,
    );
    // Beds in tanks have some of them too.
    let numbers: [Number; 9] = [
        ("effective_depth", Unit::Length, |f| f.effective_depth, none),
        ("pressure", Unit::None, |f| f.pressure, |t| Some(t.pressure)),
        (
            "buoyancy",
            Unit::Force,
            |f| f.buoyancy,
            |t| Some(t.buoyancy),
        ),
        (
            "drag_coefficient",
            Unit::None,
            |f| f.drag_coefficient,
            |t| Some(t.drag_coefficient),
        ),
        (
            "drag_coefficient_error",
            Unit::None,
            |f| f.drag_coefficient_error,
            |t| Some(t.drag_coefficient_error),
        ),
        (
            "lift_over_buoyancy",
            Unit::None,
            |f| f.lift_over_buoyancy,
            |t| Some(t.lift_over_buoyancy),
        ),
        (
            "lift_over_buoyancy_error",
            Unit::None,
            |f| f.lift_over_buoyancy_error,
            |t| Some(t.lift_over_buoyancy_error),
        ),
        ("far_field", Unit::None, |f| f.far_field, none),
        ("travel", Unit::None, |f| f.travel, none),
    ];
    text(all, "pressure_gradient", |row| {
        Some(
            row.record()?
                .run
                .flow
                .as_ref()?
                .pressure_gradient
                .to_string(),
        )
    });
    for (name, unit, of, of_tank) in numbers {
        real(all, name, unit, move |row| {
            let run = &row.record()?.run;
            match &run.tank {
                Some(tank) => of_tank(tank),
                None => run.flow.as_ref().map(of),
            }
        });
    }
}

fn none(_: &Tank) -> Option<f64> {
    None
}

fn digests(all: &mut Vec<Column>) {
    text(all, "bed_digest", |row| {
        Some(row.record()?.bed.digest.clone())
    });
    text(all, "chain", |row| Some(row.record()?.run.chain.clone()));
    text(all, "digest", |row| Some(row.record()?.run.digest.clone()));
    whole(all, "bits_version", |row| {
        Some(u64::from(row.record()?.bits_version))
    });
}

fn with_error(mean: Mean) -> [Option<f64>; 2] {
    [Some(mean.mean), Some(mean.standard_error)]
}

/// Coordination within other distances of the intruder: of each distance, in mean diameters, three means.
fn reaches(all: &mut Vec<Column>, rows: &[Row<'_>]) {
    fn in_diameters(row: &Row<'_>) -> Vec<f64> {
        let d = row.scenario.mean_diameter();
        let asked = row.scenario.measure.reaches.iter();
        asked.map(|reach| round10(reach / d)).collect()
    }
    let mut asked: Vec<f64> = rows.iter().flat_map(in_diameters).collect();
    asked.sort_by(f64::total_cmp);
    asked.dedup();
    for at in asked {
        let of = move |row: &Row<'_>| {
            let place = in_diameters(row).iter().position(|reach| *reach == at)?;
            let asked = row.scenario.measure.reaches[place];
            let all = &row.record()?.run.reaches;
            all.iter().find(|one| one.reach == asked).copied()
        };
        type Number = (&'static str, fn(&Reach) -> [Option<f64>; 2]);
        let numbers: [Number; 3] = [
            ("coordination", |r| with_error(r.coordination)),
            ("floating", |r| with_error(r.floating)),
            ("kappa", |r| [r.kappa, r.kappa_error]),
        ];
        for (name, number) in numbers {
            let name = format!("{name}_within_{at}");
            real(all, &name, Unit::None, move |row| number(&of(row)?)[0]);
            real(all, &format!("{name}_error"), Unit::None, move |row| {
                number(&of(row)?)[1]
            });
        }
    }
}

/// The error of the uncut mean, the share of large overlaps, and the drag over each mean diameter of travel.
fn travel(all: &mut Vec<Column>, rows: &[Row<'_>]) {
    // Tables of earlier versions have neither.
    type Number = (&'static str, Unit, fn(&DragSummary) -> Option<f64>);
    let numbers: [Number; 2] = [
        ("drag_uncut_error", Unit::Force, |run| run.drag_uncut_error),
        ("large_overlaps", Unit::None, |run| run.large_overlaps),
    ];
    for (name, unit, of) in numbers {
        if rows
            .iter()
            .any(|row| row.record().is_some_and(|r| of(&r.run).is_some()))
        {
            real(all, name, unit, move |row| of(&row.record()?.run));
        }
    }
    let lengths = rows
        .iter()
        .filter_map(|row| Some(row.record()?.run.drag_by_travel.len()));
    for k in 0..lengths.max().unwrap_or(0) {
        let name = format!("{DRAG_BY_TRAVEL}{}", k + 1);
        real(all, &name, Unit::Force, move |row| {
            row.record()?.run.drag_by_travel.get(k).copied()
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table has the friction of the pouring if one of its rows was poured with another than its law's.
    #[test]
    fn another_friction_of_the_pouring_has_a_column() {
        let scenarios = [&[][..], &["bed.pouring_mu=0.1".to_string()]];
        let [plain, dense] = scenarios.map(|s| crate::scenario::load("quick", s).unwrap());
        let failed = Status::Failed(String::new());
        let row = |scenario| Row {
            member: "m",
            scenario,
            plan: plain.drags()[0].clone(),
            status: &failed,
        };
        let of = |rows: &[Row<'_>]| {
            let own = columns(rows).into_iter().find(|c| c.name == "pouring_mu");
            own.map(|column| [0, rows.len() - 1].map(|k| column.of(&rows[k])))
        };
        assert_eq!(of(&[row(&plain)]), None);
        let both = [Cell::Real(None), Cell::Real(Some(0.1))];
        assert_eq!(of(&[row(&plain), row(&dense)]), Some(both));
    }
}
