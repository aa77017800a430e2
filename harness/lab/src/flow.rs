//! What is measured of a bed that flows past its intruder, as that of Guillard 2014, section III A:
//! whether it follows its base, what base and lid carry, the pressure at the intruder, and what floats
//! above the lid.
//!
//! A periodic bed is held by nothing but its base and its lid. If the drag is more than their
//! friction can bear the bed slips, and the speed past the intruder is not the one asked for. The speed of
//! grains is taken from displacements: velocities at an instant show bursts, and mislead.

use serde::{Deserialize, Serialize};

use bitgrain_sim::motion::{Motion, Moves};
use bitgrain_sim::notes::{Note, Watch};
use bitgrain_sim::observe::{INTRUDER, packing_fraction, pressure_at};
use bitgrain_sim::simulation::{Role, Simulation};
use bitgrain_sim::table::{Cell, Table, column};

/// Travel between rows, in mean diameters.
const EVERY: f64 = 0.5;

/// Part of the box, on either side of the intruder, that is near it: the rest is the far field.
const NEAR: f64 = 0.25;

/// One row of the flow series: means over the steps since the row before, or the state at its step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlowRow {
    /// Steps since the motion began.
    pub step: u64,
    /// Travel of the intruder through the bed.
    pub distance: f64,
    /// Drag on the intruder since the row before.
    pub drag: f64,
    /// Lift since the row before.
    pub lift: f64,
    /// Drag carried by the base and the planes since the row before.
    pub base: f64,
    /// Drag carried by the lid since the row before.
    pub lid: f64,
    /// Speed of the far grains past the intruder over the speed asked for, from their displacements since
    /// the row before.
    pub far_field: f64,
    /// Momentum of the free grains along the motion of the bed past the intruder.
    pub momentum: f64,
    /// Weight above the height of the intruder's centre over the area of the box.
    pub pressure: f64,
    /// Solid fraction between a grain above the floor and two below the surface of the settled bed.
    pub packing: f64,
    /// Mean height of the lid's grains; 0 without a lid.
    pub lid_height: f64,
    /// Free grains above the lid.
    pub floating: u64,
}

/// A flow series.
pub const FLOW: Table<FlowRow> = Table(&[
    column("step", |r| Cell::Whole(&mut r.step)),
    column("distance", |r| Cell::Real(&mut r.distance)),
    column("drag", |r| Cell::Real(&mut r.drag)),
    column("lift", |r| Cell::Real(&mut r.lift)),
    column("base", |r| Cell::Real(&mut r.base)),
    column("lid", |r| Cell::Real(&mut r.lid)),
    column("far_field", |r| Cell::Real(&mut r.far_field)),
    column("momentum", |r| Cell::Real(&mut r.momentum)),
    column("pressure", |r| Cell::Real(&mut r.pressure)),
    column("packing", |r| Cell::Real(&mut r.packing)),
    column("lid_height", |r| Cell::Real(&mut r.lid_height)),
    column("floating", |r| Cell::Whole(&mut r.floating)),
]);

/// The text of a flow series: a line of units, the column names, the rows.
pub fn flow_text(units: &bitgrain_sim::units::Units, rows: &[FlowRow]) -> String {
    let comment = format!(
        "units: distance, lid_height {}; drag, lift, base, lid {}; momentum force times time; \
         pressure force over length^2",
        units.length, units.force
    );
    FLOW.text(&comment, rows)
}

/// Mean speed of the far grains by height.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Sums of displacement over the bed's travel, and how many, of layers a mean diameter thick.
    layers: Vec<(f64, u64)>,
    thickness: f64,
}

impl Profile {
    fn add(&mut self, height: f64, value: f64) {
        let layer = (height / self.thickness).max(0.0) as usize;
        if layer >= self.layers.len() {
            self.layers.resize(layer + 1, (0.0, 0));
        }
        self.layers[layer].0 += value;
        self.layers[layer].1 += 1;
    }

    /// Layers with grains in them: lower and upper height, mean speed over the speed asked for.
    pub fn speeds(&self) -> Vec<(f64, f64, f64)> {
        let layers = self.layers.iter().enumerate();
        let full = layers.filter(|(_, (_, count))| *count > 0);
        full.map(|(k, (sum, count))| {
            let low = k as f64 * self.thickness;
            (low, low + self.thickness, sum / *count as f64)
        })
        .collect()
    }

    /// Its file, [`PROFILE`]: the mean over the window's rows, every grain of every row alike.
    pub fn text(&self) -> String {
        PROFILE.text("", &self.speeds())
    }
}

/// Layers of a profile: lower and upper height, mean speed over the speed asked for.
pub const PROFILE: Table<(f64, f64, f64)> = Table(&[
    column("z_low", |r| Cell::Real(&mut r.0)),
    column("z_high", |r| Cell::Real(&mut r.1)),
    column("far_field", |r| Cell::Real(&mut r.2)),
]);

/// Means of the rows that lie wholly in the averaging window.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowMeans {
    /// Rows.
    pub rows: usize,
    /// Speed of the far grains past the intruder over the speed asked for.
    pub far_field: f64,
    /// Drag over the same rows.
    pub drag: f64,
    /// Drag carried by the base and the planes.
    pub base: f64,
    /// Drag carried by the lid.
    pub lid: f64,
    /// Force that changed the momentum of the bed between the first and the last row.
    pub inertia: f64,
    /// Pressure at the height of the intruder's centre.
    pub pressure: f64,
    /// Solid fraction.
    pub packing: f64,
    /// Most free grains above the lid in any row.
    pub floating: u64,
    /// Drag over the first and the second half of the rows.
    pub drag_halves: [f64; 2],
    /// Lift over them.
    pub lift_halves: [f64; 2],
}

/// What is measured during the drag.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FlowGauge {
    /// 1 if the bed moves along +x past the intruder, -1 if the intruder moves.
    sign: f64,
    /// Velocity of the frame in which the intruder rests, times -1.
    frame: f64,
    every: u64,
    speed: f64,
    base: Vec<usize>,
    lid: Vec<usize>,
    /// Height up to which the packing is taken, and the thickness that is left out below.
    packing_top: f64,
    diameter: f64,
    sums: [f64; 4],
    /// Where every far free grain was at the last row, unwrapped along x.
    before: Vec<Option<f64>>,
    /// Rows so far.
    pub rows: Vec<FlowRow>,
    /// Speeds by height, over the window's rows.
    pub profile: Profile,
    first: u64,
    begin: Option<(u64, f64)>,
}

impl FlowGauge {
    /// A gauge for a bed that is about to move; `first` is the first step of the averaging window and
    /// `surface` the height of the settled bed's.
    pub fn new(sim: &Simulation, motion: &Motion, surface: f64) -> Self {
        let d = motion.grain_diameter;
        let of = |role: Role| (0..sim.count()).filter(|&i| sim.role(i) == role).collect();
        let every = (EVERY * d / (motion.speed * sim.dt)).round() as u64;
        let bed_moves = motion.moves == Moves::Bed;
        let mut gauge = Self {
            sign: -motion.moves.forward(),
            frame: if bed_moves { 0.0 } else { motion.speed },
            every: every.max(1),
            speed: motion.speed,
            base: of(Role::Base),
            lid: of(Role::Lid),
            packing_top: surface - 2.0 * d,
            diameter: d,
            sums: [0.0; 4],
            before: Vec::new(),
            rows: Vec::new(),
            profile: Profile {
                layers: Vec::new(),
                thickness: d,
            },
            first: motion.window[0],
            begin: None,
        };
        gauge.before = gauge.far_places(sim);
        if gauge.first <= 1 {
            gauge.begin = Some((0, gauge.momentum(sim)));
        }
        gauge
    }

    /// What must be noted of each step for [`FlowGauge::read`]: all obstacles, and the grains of base and lid.
    pub fn watch(&self, obstacles: usize) -> Watch {
        let grains = self.base.iter().chain(&self.lid);
        Watch {
            obstacles: (0..obstacles as u32).collect(),
            grains: grains.map(|i| *i as u32).collect(),
        }
    }

    /// Takes the readings of a step; `force` is drag, lift and side force on the intruder.
    pub fn read(&mut self, note: &Note, force: [f64; 3]) {
        let along = |forces: &[[f64; 3]]| forces.iter().map(|force| force[0]).sum::<f64>();
        let (base, lid) = note.forces.split_at(self.base.len());
        let mut base = along(base);
        for (k, obstacle) in note.obstacles.iter().enumerate() {
            if k != INTRUDER as usize {
                base += obstacle.body.force[0];
            }
        }
        // Base and lid bear the force of the grains along x.
        let bears = [-self.sign * base, -self.sign * along(lid)];
        for (sum, value) in self
            .sums
            .iter_mut()
            .zip([force[0], force[1], bears[0], bears[1]])
        {
            *sum += value;
        }
    }

    /// Whether a row ends with step `n`.
    pub fn is_due(&self, n: u64) -> bool {
        n.is_multiple_of(self.every)
    }

    /// Ends the row of step `n`, the last one that was read.
    pub fn end_row(&mut self, sim: &Simulation, n: u64) {
        let steps = self.every as f64;
        let [drag, lift, base, lid] = self.sums.map(|sum| sum / steps);
        self.sums = [0.0; 4];
        let travel = steps * sim.dt * self.speed;
        // The row's steps are n - every + 1 .. n.
        let counted = n - self.every + 1 >= self.first;
        let (mut moved, mut count) = (0.0, 0u64);
        for (i, before) in self.before.iter().enumerate() {
            if let Some(before) = before {
                let way = self.sign * (unwrapped(sim, i) - before);
                let share = (way + self.frame * steps * sim.dt) / travel;
                moved += share;
                count += 1;
                if counted {
                    self.profile.add(sim.position[i][2], share);
                }
            }
        }
        self.before = self.far_places(sim);
        let momentum = self.momentum(sim);
        if self.begin.is_none() && n + 1 >= self.first {
            self.begin = Some((n, momentum));
        }
        let height = self.lid.iter().map(|&i| sim.position[i][2]).sum::<f64>();
        let center = sim.obstacles[INTRUDER as usize].point[2];
        self.rows.push(FlowRow {
            step: n,
            distance: n as f64 * sim.dt * self.speed,
            drag,
            lift,
            base,
            lid,
            far_field: moved / count.max(1) as f64,
            momentum,
            pressure: pressure_at(sim, center),
            packing: packing_fraction(sim, self.diameter, self.packing_top),
            lid_height: height / self.lid.len().max(1) as f64,
            floating: floating(sim, &self.lid),
        });
    }

    fn momentum(&self, sim: &Simulation) -> f64 {
        let free = (0..sim.count()).filter(|&i| sim.role(i) == Role::Free);
        let along =
            free.map(|i| sim.velocity[i][3] * (sim.velocity[i][0] * self.sign + self.frame));
        along.sum()
    }

    /// Where the free grains of the far field are along x, unwrapped.
    fn far_places(&self, sim: &Simulation) -> Vec<Option<f64>> {
        let body = &sim.obstacles[INTRUDER as usize];
        let width = sim.domain.hi()[0] - sim.domain.lo()[0];
        let place = |i: usize| {
            let x = sim.position[i];
            let off = sim.domain.separation([x[0], x[1], x[2]], body.point)[0];
            let far = off.abs() >= NEAR * width && sim.role(i) == Role::Free;
            far.then(|| unwrapped(sim, i))
        };
        (0..sim.count()).map(place).collect()
    }

    /// Means of the rows that lie wholly in the averaging window; `None` if there are fewer than two.
    pub fn means(&self, dt: f64) -> Option<FlowMeans> {
        let inside = |row: &&FlowRow| row.step - self.every + 1 >= self.first;
        let rows: Vec<&FlowRow> = self.rows.iter().filter(inside).collect();
        let (begin, momentum) = self.begin?;
        if rows.len() < 2 {
            return None;
        }
        let over = |rows: &[&FlowRow], of: fn(&FlowRow) -> f64| {
            rows.iter().map(|row| of(row)).sum::<f64>() / rows.len() as f64
        };
        let mean = |of: fn(&FlowRow) -> f64| over(&rows, of);
        let (early, late) = rows.split_at(rows.len() / 2);
        let last = rows[rows.len() - 1];
        Some(FlowMeans {
            rows: rows.len(),
            far_field: mean(|r| r.far_field),
            drag: mean(|r| r.drag),
            base: mean(|r| r.base),
            lid: mean(|r| r.lid),
            inertia: (last.momentum - momentum) / ((last.step - begin) as f64 * dt),
            pressure: mean(|r| r.pressure),
            packing: mean(|r| r.packing),
            floating: rows.iter().map(|r| r.floating).max().unwrap_or(0),
            drag_halves: [over(early, |r| r.drag), over(late, |r| r.drag)],
            lift_halves: [over(early, |r| r.lift), over(late, |r| r.lift)],
        })
    }
}

/// A grain's place along x with the crossings of the box counted.
fn unwrapped(sim: &Simulation, i: usize) -> f64 {
    let width = sim.domain.hi()[0] - sim.domain.lo()[0];
    sim.position[i][0] + f64::from(sim.image[i][0]) * width
}

/// Free grains that lie higher than the grain of the lid which is nearest to them from above.
fn floating(sim: &Simulation, lid: &[usize]) -> u64 {
    let lowest = lid.iter().map(|&k| sim.position[k][2]);
    let lowest = lowest.fold(f64::INFINITY, |a, b| if b < a { b } else { a });
    let above = |i: &usize| {
        let x = sim.position[*i];
        if sim.role(*i) != Role::Free || x[2] <= lowest {
            return false;
        }
        let distance = |k: usize| {
            let y = sim.position[k];
            let d = sim.domain.separation([x[0], x[1], 0.0], [y[0], y[1], 0.0]);
            d[0] * d[0] + d[1] * d[1]
        };
        let nearest = lid
            .iter()
            .copied()
            .min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        nearest.is_some_and(|k| x[2] > sim.position[k][2])
    };
    (0..sim.count()).filter(above).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_back() {
        let mut profile = Profile {
            layers: Vec::new(),
            thickness: 0.5,
        };
        profile.add(0.6, 0.25);
        profile.add(0.7, 0.75);
        let layers = PROFILE.parse(&profile.text()).unwrap();
        assert_eq!(layers, [(0.5, 1.0, 0.5)]);
        assert_eq!(PROFILE.parse("z_low,z_high,far_field\n1,2\n"), Err(2));
        let row = FlowRow {
            step: 3,
            drag: 0.1,
            floating: 2,
            ..FlowRow::default()
        };
        let units = crate::scenario::load("quick", &[]).unwrap().units();
        let text = flow_text(&units, &[row, row]);
        assert_eq!(FLOW.parse(&text).unwrap(), [row, row]);
        let good = text.lines().last().unwrap();
        for bad in [
            "1,2,x",
            FLOW.head().split_once(',').unwrap().1,
            &good[..good.len() - 2],
            &format!("{good},1"),
            &good.replacen("0.1", "NaN", 1),
            &good.replacen("0.1", "inf", 1),
            &good.replacen('3', "-3", 1),
            &good.replacen(",2", ",2.5", 1),
        ] {
            assert_ne!(bad, good);
            assert_eq!(
                FLOW.parse(&format!("{text}{bad}\n{good}\n")),
                Err(5),
                "{bad}"
            );
        }
        assert_eq!(PROFILE.parse("z_low,z_high,far_field\n1,2,NaN\n"), Err(2));
        assert_eq!(
            PROFILE.parse("z_low,z_high,far_field\n1,2,3\n1,2,3,4\n"),
            Err(3)
        );
    }
}
