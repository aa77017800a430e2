//! What bars in tanks say of the experiments of Guillard 2014, section II: read from the table of a run or a campaign.

use super::book::Claim;
use super::number::Found;
use crate::analysis::Value;
use bitgrain_lab::campaign::table::CampaignTable;
use bitgrain_sim::format::short;

/// What makes two runs differ; of two that are compared all are alike but one. Only runs in tanks have a turning rate.
const VARIED: [&str; 5] = ["diameter", "length", "depth_asked", "turning_rate", "seed"];

/// Relative difference up to which two numbers are one: rates are quotients.
const SAME: f64 = 1e-9;

/// Depth over D from which the lift on thick bars is saturated (Guillard 2014, Fig. 6).
const SATURATED: f64 = 10.0;

/// A drag, by what makes it differ from others.
pub(crate) struct Drag {
    varied: [f64; VARIED.len()],
    /// Depth of the axis over D, as measured in the settled bed.
    pub(crate) depth: f64,
    /// Over rho g h D L.
    pub(crate) drag: Value,
    /// Over the buoyancy.
    pub(crate) lift: Value,
    /// Drag of the second half turn over that of the first.
    second: Option<Value>,
    /// Whether the error of the drag converged.
    pub(crate) converged: bool,
}

impl Drag {
    fn read(table: &CampaignTable, row: usize) -> Option<Self> {
        let real = |column: &str| table.real(row, column);
        let value =
            |column: &str| Some(Value::new(real(column)?, real(&format!("{column}_error"))?));
        let second = || Some(value("drag_turn_2")?.over(value("drag_turn_1")?));
        let mut varied = [0.0; VARIED.len()];
        for (to, column) in varied.iter_mut().zip(VARIED) {
            *to = real(column)?;
        }
        Some(Self {
            varied,
            depth: real("depth")? / real("diameter")?,
            drag: value("drag_coefficient")?,
            lift: value("lift_over_buoyancy")?,
            second: second(),
            converged: table.text(row, "drag_converged") != "false",
        })
    }

    fn note(&self) -> String {
        let [.., seed] = self.varied;
        format!("h/D = {:.1}, {}, seed {seed}", self.depth, self.bar())
    }

    /// Its diameter.
    pub(crate) fn diameter(&self) -> f64 {
        self.varied[0]
    }

    /// The bar's length and how fast it turns, in words.
    pub(crate) fn bar(&self) -> String {
        let [diameter, length, _, rate, _] = self.varied;
        format!("L/D = {:.1}, Omega = {}", length / diameter, short(rate))
    }
}

/// The drags of a table that are of bars in tanks.
pub(crate) fn drags(table: &CampaignTable) -> Vec<Drag> {
    let rows = 0..table.len();
    rows.filter_map(|row| Drag::read(table, row)).collect()
}

/// The measurement of a claim on the experiment; `None` if this is no such claim, or no run was in a tank.
pub fn measure(claim: &Claim, table: &CampaignTable) -> Option<Found> {
    let drags = drags(table);
    if drags.is_empty() {
        return None;
    }
    let each = |of: fn(&Drag) -> Option<Value>| {
        let all = drags
            .iter()
            .filter_map(|drag| Some((of(drag)?, drag.note())));
        all.collect::<Vec<_>>()
    };
    let found = match claim.id.strip_prefix("guillard-")? {
        "tank-half-turn" => claim.together(each(|d| d.second), "no run goes beyond half a turn"),
        "tank-drag" => claim.together(each(|d| Some(d.drag)), "no drag was measured"),
        "tank-drag-depth" => {
            claim.together(ends(&drags, "depth_asked", |d| d.drag), &alone("depth"))
        }
        "tank-drag-length" => claim.together(ends(&drags, "length", |d| d.drag), &alone("length")),
        "tank-drag-speed" => {
            claim.together(ends(&drags, "turning_rate", |d| d.drag), &alone("speed"))
        }
        "tank-lift-up" => claim.together(each(|d| Some(d.lift)), "no lift was measured"),
        "tank-lift-grows" => {
            let shallow: Vec<&Drag> = drags.iter().filter(|d| d.depth < SATURATED).collect();
            claim.together(ends(shallow, "depth_asked", |d| d.lift), &alone("depth"))
        }
        "tank-lift-saturates" => saturation(claim, &drags),
        "tank-lift-length" => claim.together(ends(&drags, "length", |d| d.lift), &alone("length")),
        _ => return None,
    };
    Some(found)
}

fn alone(what: &str) -> String {
    format!("no two runs differ in {what} alone")
}

/// Of runs that differ in one column alone, the value at its largest over that at its least.
fn ends<'a>(
    drags: impl IntoIterator<Item = &'a Drag>,
    column: &str,
    of: fn(&Drag) -> Value,
) -> Vec<(Value, String)> {
    let own = VARIED.iter().position(|name| *name == column).unwrap_or(0);
    let same = |a: f64, b: f64| (a - b).abs() <= SAME * b.abs();
    let alike = |a: &Drag, b: &Drag| {
        let mut pairs = a.varied.into_iter().zip(b.varied).enumerate();
        pairs.all(|(k, (a, b))| k == own || same(a, b))
    };
    let mut groups: Vec<Vec<&Drag>> = Vec::new();
    for drag in drags {
        match groups.iter_mut().find(|group| alike(group[0], drag)) {
            Some(group) => group.push(drag),
            None => groups.push(vec![drag]),
        }
    }
    let ratio = |mut group: Vec<&Drag>| {
        group.sort_by(|a, b| a.varied[own].total_cmp(&b.varied[own]));
        let (first, last) = (group.first()?, group.last()?);
        if group.len() < 2 {
            return None;
        }
        let note = format!(
            "{column} {} over {}, {}",
            last.varied[own],
            first.varied[own],
            last.note()
        );
        Some((of(last).over(of(first)), note))
    };
    groups.into_iter().filter_map(ratio).collect()
}

/// The lift at the largest depth over that at the least, of bars that are deep enough for the paper's to be saturated.
fn saturation(claim: &Claim, drags: &[Drag]) -> Found {
    let deepest = drags.iter().fold(0.0, |most: f64, d| most.max(d.depth));
    let deep = drags.iter().filter(|d| d.depth >= SATURATED);
    let none = format!(
        "the deepest bar lies {deepest:.1} D deep, and no two lie {SATURATED} D deep or more, where the paper's lift \
         is saturated"
    );
    claim.together(ends(deep, "depth_asked", |d| d.lift), &none)
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    /// Rows of diameter, length, depth, speed, C_d, lift and the drag of the second half turn over the first.
    fn table(rows: &[[f64; 7]]) -> CampaignTable {
        let mut text = "member,run,status,froude,drag,drag_error,seed,turning_rate,diameter,length,depth_asked,depth,\
                        drag_coefficient,drag_coefficient_error,lift_over_buoyancy,lift_over_buoyancy_error,\
                        drag_turn_1,drag_turn_1_error,drag_turn_2,drag_turn_2_error\n"
            .to_owned();
        for [diameter, length, depth, speed, drag, lift, second] in rows {
            text += &format!(
                "m,r,done,0.1,1,0.1,1,{speed},{diameter},{length},{depth},{depth},{drag},0.1,{lift},0.1,2,0.01,{},\
                 0.01\n",
                2.0 * second
            );
        }
        CampaignTable::parse(&text, "table").unwrap()
    }

    fn found(id: &str, rows: &[[f64; 7]]) -> Found {
        measure(&synthetic::shipped(id), &table(rows)).unwrap()
    }

    /// Runs that differ in one quantity are compared, and no others.
    #[test]
    fn what_is_varied_alone_is_told() {
        let rows = [
            [1.0, 6.0, 3.0, 0.1, 10.0, 4.0, 0.7],
            [1.0, 6.0, 6.0, 0.1, 11.0, 8.0, 0.6],
            [1.0, 9.0, 6.0, 0.1, 12.1, 9.6, 0.65],
            [1.0, 6.0, 6.0, 0.2, 13.2, 8.0, 0.65],
        ];
        let value = |id: &str| found(id, &rows).unwrap().value.value;
        let near = |id: &str, expected: f64| assert!((value(id) - expected).abs() < 1e-12, "{id}");
        near("guillard-tank-drag-depth", 1.1);
        near("guillard-tank-drag-length", 1.1);
        near("guillard-tank-drag-speed", 1.2);
        near("guillard-tank-lift-grows", 2.0);
        near("guillard-tank-lift-length", 1.2);
        assert!((value("guillard-tank-half-turn") - 0.65).abs() < 0.01);
        assert!((value("guillard-tank-drag") - 11.575).abs() < 1e-9);
        let why = found("guillard-tank-lift-saturates", &rows).unwrap_err();
        assert!(why.contains("6.0 D deep"), "{why}");
        let why = found("guillard-tank-drag-speed", &rows[..3]).unwrap_err();
        assert!(why.contains("differ in speed alone"), "{why}");
    }

    /// Depths beyond ten diameters count for the plateau, others for the rise.
    #[test]
    fn deep_bars_show_the_plateau() {
        let rows = [5.0, 10.0, 20.0].map(|depth| [1.0, 6.0, depth, 0.1, 10.0, 2.0 * depth, 0.7]);
        let deep = found("guillard-tank-lift-saturates", &rows).unwrap();
        assert!((deep.value.value - 2.0).abs() < 1e-12, "{deep:?}");
        assert!(found("guillard-tank-lift-grows", &rows).is_err());
        let claim = synthetic::shipped("guillard-drag");
        assert!(measure(&claim, &table(&rows)).is_none());
    }
}
