//! What is measured of a bar that turns against its tank, beside the force on it: drag and lift of each half turn, how
//! they are shared along the bar, and how the grains go round in the ring that the bar sweeps (Guillard 2014, section
//! II).
//!
//! Both halves of the bar count alike: places are told by the distance from its middle, and directions by the angle
//! from the nearest half, from -90 degrees behind it to 90 ahead.

use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{ContactForce, Obstacle, Partner, Shape};
use serde::{Deserialize, Serialize};

use crate::tank_tables::{BarRow, RING, SECTORS, VelocityRow};
use bitgrain_sim::block_averaging::{BlockSums, Mean};
use bitgrain_sim::motion::Motion;
use bitgrain_sim::observe::{INTRUDER, on_turning_bar};
use bitgrain_sim::simulation::{Role, Simulation};

/// Parts of a half of the bar.
pub const PARTS: usize = 8;

/// Share of its steps that a half turn must have to be reported.
const WHOLE: f64 = 0.5;

/// Drag, lift and the force along itself of a bar that turns about z: the drag of a uniform load with the torque M that
/// holds it back, `F = 4 M/L` (Guillard 2014, eq. 1). `None` of a body of another shape.
pub fn force_on_bar(body: &Obstacle<f64>) -> Option<[f64; 3]> {
    let Shape::FiniteCylinder { half_length, .. } = body.shape else {
        return None;
    };
    let (f, a) = (body.force, body.direction());
    let along = f[0] * a[0] + f[1] * a[1] + f[2] * a[2];
    // A difference, so that no torque is +0.
    Some([0.0 - 2.0 * body.torque[2] / half_length, f[2], along])
}

/// Sums over the samples of some half turns.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Samples {
    count: u64,
    /// Drag by eq. 1, and summed against the motion of each half.
    drag: [f64; 2],
    /// Drag and lift on each part of the bar, both halves together.
    parts: [[f64; 2]; PARTS],
    /// Speeds ahead and up over that of the bar at the same radius, and how many, by layer and then sector.
    cells: Vec<[f64; 3]>,
}

/// What is measured during the drag.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TankGauge {
    /// First and last step of the averaging window.
    window: [u64; 2],
    /// Steps of half a turn.
    half_turn: f64,
    /// Steps between samples.
    every: u64,
    /// Thickness of a layer: the mean grain diameter.
    layer: f64,
    /// Drag and lift by half turn, of the first from the window's beginning.
    turns: Vec<[BlockSums; 2]>,
    /// Of the window, and of all that comes after it.
    samples: [Samples; 2],
}

/// Drag and lift of half a turn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HalfTurn {
    /// Drag by eq. 1.
    pub drag: Mean,
    /// Lift.
    pub lift: Mean,
}

impl TankGauge {
    /// Nothing yet; the ends of the bar travel by `half_turn` in half a turn, and a sample is taken each `every` steps.
    pub fn new(motion: &Motion, half_turn: f64, every: u64) -> Self {
        Self {
            window: motion.window,
            half_turn: half_turn / (motion.speed * motion.dt),
            every,
            layer: motion.grain_diameter,
            turns: Vec::new(),
            samples: Default::default(),
        }
    }

    /// Takes the readings of step `n`; `force` is that of [`force_on_bar`].
    pub fn read(&mut self, n: u64, force: [f64; 3]) {
        if n < self.window[0] {
            return;
        }
        let turn = ((n - 1) as f64 / self.half_turn) as usize;
        while self.turns.len() <= turn {
            self.turns.push(Default::default());
        }
        for (sums, value) in self.turns[turn].iter_mut().zip(force) {
            sums.add(value);
        }
    }

    /// Whether a sample is taken after step `n`, for which its contacts must be seen.
    pub fn is_due(&self, n: u64) -> bool {
        n.is_multiple_of(self.every) && n >= self.window[0]
    }

    /// Takes the sample of step `n`, of which `seen` are the contacts.
    pub fn sample(&mut self, sim: &Simulation, seen: &[ContactForce<f64>], n: u64) {
        let body = sim.obstacles[INTRUDER as usize];
        let (Some(force), Shape::FiniteCylinder { half_length, .. }) =
            (force_on_bar(&body), body.shape)
        else {
            return;
        };
        let samples = &mut self.samples[usize::from(n > self.window[1])];
        samples.count += 1;
        samples.drag[0] += force[0];
        for contact in seen
            .iter()
            .filter(|c| c.partner == Partner::Obstacle(INTRUDER))
        {
            let grain = sim.position[contact.i as usize];
            let to_surface = grain[3] - contact.overlap;
            let place = [0, 1, 2].map(|a| grain[a] - to_surface * contact.normal[a]);
            let Some((along, ahead)) = on_turning_bar(&sim.domain, &body, place) else {
                return;
            };
            let on_bar = [0, 1, 2]
                .map(|a| -(contact.normal_force * contact.normal[a] + contact.tangential_force[a]));
            let drag = -(on_bar[0] * ahead[0] + on_bar[1] * ahead[1]);
            let part = (along.abs() / half_length * PARTS as f64) as usize;
            let part = &mut samples.parts[part.min(PARTS - 1)];
            samples.drag[1] += drag;
            part[0] += drag;
            part[1] += on_bar[2];
        }
        let rate = body.angular_velocity[2];
        for i in (0..sim.count()).filter(|&i| sim.role(i) == Role::Free) {
            let Some((sector, radius, round)) = round_bar(sim, &body, i) else {
                continue;
            };
            let over = radius / half_length;
            if !(RING[0]..=RING[1]).contains(&over) {
                continue;
            }
            let layer = (sim.position[i][2] / self.layer).max(0.0) as usize;
            let cell = layer * SECTORS + sector;
            if cell >= samples.cells.len() {
                samples.cells.resize((layer + 1) * SECTORS, [0.0; 3]);
            }
            let speed = rate * radius;
            let cell = &mut samples.cells[cell];
            cell[0] += round / speed;
            cell[1] += sim.velocity[i][2] / speed;
            cell[2] += 1.0;
        }
    }

    /// Drag and lift of each half turn that was done for the most part.
    pub fn half_turns(&self) -> Vec<HalfTurn> {
        let whole = |k: usize, sums: &BlockSums| {
            // Of the first only the window counts.
            k == 0 || sums.count() as f64 >= WHOLE * self.half_turn
        };
        let turns = self.turns.iter().enumerate();
        let turns = turns.filter(|(k, [drag, _])| whole(*k, drag));
        let turns = turns.map(|(_, [drag, lift])| {
            Some(HalfTurn {
                drag: drag.mean()?,
                lift: lift.mean()?,
            })
        });
        turns.flatten().collect()
    }

    /// The drag of the window's samples as the sum of the forces against the motion of each half, over that of eq. 1:
    /// 1 if the load is the same all along the bar. `None` without a sample.
    pub fn direct(&self) -> Option<f64> {
        let [by_torque, direct] = self.samples[0].drag;
        Some(direct / by_torque).filter(|ratio| ratio.is_finite())
    }

    /// The load along the bar.
    pub fn bar(&self, length: f64) -> Vec<BarRow> {
        let wide = 0.5 / PARTS as f64;
        let load = |samples: &Samples, part: usize, which: usize| {
            // Both halves are in the sum.
            let long = 2.0 * wide * length * samples.count as f64;
            (samples.count > 0).then(|| samples.parts[part][which] / long)
        };
        let [first, after] = &self.samples;
        let row = |k: usize| BarRow {
            from: k as f64 * wide,
            to: (k + 1) as f64 * wide,
            drag: load(first, k, 0),
            lift: load(first, k, 1),
            drag_after: load(after, k, 0),
            lift_after: load(after, k, 1),
        };
        (0..PARTS).map(row).collect()
    }

    /// How the grains of the ring go round, by layer and then sector; layers without grains are left out.
    pub fn velocity(&self) -> Vec<VelocityRow> {
        let cells = self.samples.iter().map(|samples| samples.cells.len());
        let mean = |samples: &Samples, cell: usize, which: usize| {
            let sums = samples.cells.get(cell).filter(|sums| sums[2] > 0.0)?;
            Some(sums[which] / sums[2])
        };
        let [first, after] = &self.samples;
        let sector = 180.0 / SECTORS as f64;
        let row = |cell: usize| VelocityRow {
            angle: ((cell % SECTORS) as f64 + 0.5) * sector - 90.0,
            height: ((cell / SECTORS) as f64 + 0.5) * self.layer,
            ahead: mean(first, cell, 0),
            up: mean(first, cell, 1),
            ahead_after: mean(after, cell, 0),
            up_after: mean(after, cell, 1),
        };
        (0..cells.max().unwrap_or(0)).map(row).collect()
    }
}

/// The sector of a grain round a bar that turns about z, its distance from the axis of turning, and its speed round
/// that axis; `None` of a grain on it.
fn round_bar(sim: &Simulation, body: &Obstacle<f64>, i: usize) -> Option<(usize, f64, f64)> {
    let x = sim.position[i];
    let (_, ahead) = on_turning_bar(&sim.domain, body, head(x))?;
    let d = sim.domain.separation(head(x), body.point);
    let radius = (d[0] * d[0] + d[1] * d[1]).sqrt();
    if radius <= 0.0 {
        return None;
    }
    // The half that is nearest lies a quarter turn behind where it moves.
    let (across, along) = (
        d[0] * ahead[0] + d[1] * ahead[1],
        d[0] * ahead[1] - d[1] * ahead[0],
    );
    let share = libm::atan2(across, along) / std::f64::consts::PI + 0.5;
    let sector = ((share * SECTORS as f64).max(0.0) as usize).min(SECTORS - 1);
    let v = sim.velocity[i];
    let round = (d[0] * v[1] - d[1] * v[0]) / radius;
    Some((sector, radius, round))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_kernel::{Domain, Group, conformance};
    use bitgrain_sim::motion::Moves;
    use bitgrain_sim::simulation::{AnyLaw, Grain};

    const LENGTH: f64 = 8.0;
    const RATE: f64 = 0.5;

    /// A bar along y that turns, and grains against it: ahead of both halves, one in each part, all with the same
    /// force.
    fn loaded() -> (Simulation, Vec<ContactForce<f64>>) {
        let place = |k: usize| {
            let y = (k as f64 + 0.5) * LENGTH / (2 * PARTS) as f64 - 0.5 * LENGTH;
            // The half along +y moves along -x.
            [if y > 0.0 { -1.5 } else { 1.5 }, y, 0.0]
        };
        let grain = |k: usize| Grain {
            id: k as u32 + 1,
            group: 0,
            diameter: 1.0,
            density: 1.0,
            position: place(k),
            velocity: [-RATE * place(k)[1], RATE * place(k)[0], 0.1],
            spin: [0.0; 3],
        };
        let grains: Vec<Grain> = (0..2 * PARTS).map(grain).collect();
        let bar = Obstacle {
            angular_velocity: [0.0, 0.0, RATE],
            ..Obstacle::finite_cylinder([0.0; 3], [0.0, 1.0, 0.0], 1.0, 0.5 * LENGTH)
        };
        let law = AnyLaw::HertzHistory(conformance::history(0.5));
        let groups = vec![Group::free([0.0; 3])];
        let mut sim = Simulation::new(law, Domain::open(), 1e-3, groups, &grains, vec![bar]);
        let contact = |k: usize| ContactForce {
            i: k as u32,
            partner: Partner::Obstacle(INTRUDER),
            surface: 0,
            overlap: 0.0,
            normal: [place(k)[0].signum(), 0.0, 0.0],
            normal_force: 3.0,
            // Grains that are pushed down press the bar up.
            tangential_force: [0.0, 0.0, -2.0],
            torque: [0.0; 3],
        };
        let seen: Vec<ContactForce<f64>> = (0..2 * PARTS).map(contact).collect();
        let body = &mut sim.obstacles[0];
        for (k, contact) in seen.iter().enumerate() {
            let x = place(k);
            let force = [-contact.normal_force * contact.normal[0], 0.0, 2.0];
            let arm = [x[0] - 0.5 * contact.normal[0], x[1]];
            body.torque[2] += arm[0] * force[1] - arm[1] * force[0];
            for a in 0..3 {
                body.force[a] += force[a];
            }
        }
        (sim, seen)
    }

    fn gauge() -> TankGauge {
        let motion = Motion {
            moves: Moves::Intruder,
            speed: 0.5 * RATE * LENGTH,
            dt: 1e-3,
            grain_diameter: 1.0,
            window: [1, 10],
            last: 40,
        };
        TankGauge::new(&motion, 10.0 * motion.speed * motion.dt, 1)
    }

    /// Under a uniform load eq. 1 is the sum of the forces against the motion of each half, and it is the same in all
    /// parts; grains that go with the bar have its speed.
    #[test]
    fn a_uniform_load_is_that_of_equation_1() {
        let (sim, seen) = loaded();
        let load = 3.0 * 2.0 * PARTS as f64;
        let force = force_on_bar(&sim.obstacles[0]).unwrap();
        // The middle of the parts has the torque of the parts.
        assert!((force[0] / load - 1.0).abs() < 1e-12, "{force:?}");
        assert_eq!(force[1], 2.0 * 2.0 * PARTS as f64);
        assert_eq!(force[2], 0.0);
        let mut gauge = gauge();
        gauge.sample(&sim, &seen, 5);
        assert!((gauge.direct().unwrap() - 1.0).abs() < 1e-12);
        for row in gauge.bar(LENGTH) {
            let (drag, lift) = (row.drag.unwrap() * LENGTH, row.lift.unwrap() * LENGTH);
            assert!((drag / load - 1.0).abs() < 1e-12, "{row:?}");
            assert!((lift / force[1] - 1.0).abs() < 1e-12, "{row:?}");
            assert_eq!(row.drag_after, None);
        }
        let known = gauge
            .velocity()
            .into_iter()
            .filter(|row| row.ahead.is_some());
        let known: Vec<VelocityRow> = known.collect();
        assert!(!known.is_empty());
        for row in known {
            assert!((row.ahead.unwrap() - 1.0).abs() < 1e-12, "{row:?}");
            assert!(row.angle > 0.0 && row.up.unwrap() > 0.0, "{row:?}");
        }
        // Turned by any angle the numbers are the same.
        let (mut turned, mut seen) = loaded();
        let turn = |v: [f64; 3]| [0.6 * v[0] - 0.8 * v[1], 0.8 * v[0] + 0.6 * v[1], v[2]];
        let world = &mut *turned;
        for row in world.position.iter_mut().chain(&mut world.velocity) {
            let [x, y, z] = turn(head(*row));
            *row = [x, y, z, row[3]];
        }
        for contact in &mut seen {
            contact.normal = turn(contact.normal);
        }
        let body = &mut turned.obstacles[0];
        // Half of the angle whose cosine is 0.6.
        body.orientation = [0.8f64.sqrt(), 0.0, 0.0, 0.2f64.sqrt()];
        body.force = turn(body.force);
        let mut other = self::gauge();
        other.sample(&turned, &seen, 5);
        for (a, b) in gauge.bar(LENGTH).iter().zip(other.bar(LENGTH)) {
            assert!(
                (a.drag.unwrap() - b.drag.unwrap()).abs() < 1e-12,
                "{a:?} {b:?}"
            );
        }
        for (a, b) in gauge.velocity().iter().zip(other.velocity()) {
            assert_eq!(a.ahead.is_some(), b.ahead.is_some(), "{a:?} {b:?}");
        }
    }

    /// Steps of half turns are told apart; the window's first and those of a last that was hardly begun do not count.
    #[test]
    fn half_turns_are_told_apart() {
        let motion = Motion {
            moves: Moves::Intruder,
            speed: 1.0,
            dt: 1e-2,
            grain_diameter: 1.0,
            window: [21, 100],
            last: 240,
        };
        let mut gauge = TankGauge::new(&motion, 1.0, 10);
        for n in 1..=motion.last {
            gauge.read(n, [n as f64, -1.0, 0.0]);
        }
        let half_turns = gauge.half_turns();
        let drags: Vec<f64> = half_turns.iter().map(|half| half.drag.mean).collect();
        // The mean of 21 to 100 and of 101 to 200; 40 steps are less than half of the next.
        assert_eq!(drags, [60.5, 150.5]);
        assert!(half_turns.iter().all(|half| half.lift.mean == -1.0));
        assert!(gauge.is_due(30) && !gauge.is_due(20) && !gauge.is_due(31));
    }
}
