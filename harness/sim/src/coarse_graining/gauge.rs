//! Fields and load of a drag, averaged during the drag: nothing but sums is stored.

use bitgrain_kernel::{ContactForce, Partner, Shape};
use serde::{Deserialize, Serialize};

use super::grid::Grid;
use super::load::{Load, LoadSums, PARTS};
use super::plane::{Fields, IntruderOutline, plane, points};
use super::sums::{Ball, Branch, NUMBERS, Sums};
use crate::motion::Motion;
use crate::observe::{INTRUDER, offset};
use crate::simulation::Simulation;

/// Where and how often fields are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Points.
    pub grid: Grid,
    /// Radius of the averaging window about each point.
    pub window: f64,
    /// Steps between samples, at least 1.
    pub every: u64,
}

/// What is summed during the drag.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoarseGraining {
    /// Steps between samples.
    every: u64,
    /// First and last step that are averaged.
    steps: [u64; 2],
    /// 1 if the intruder moves along +x, -1 if the bed does.
    forward: f64,
    sums: Sums,
    load: LoadSums,
}

impl CoarseGraining {
    /// A gauge for a bed that is about to move.
    pub fn new(sampling: &Sampling, motion: &Motion) -> Self {
        Self {
            every: sampling.every,
            steps: motion.window,
            forward: motion.moves.forward(),
            sums: Sums::new(sampling.grid, sampling.window),
            load: LoadSums::default(),
        }
    }

    /// Whether the state and the contacts after this step are a sample.
    pub fn is_due(&self, n: u64) -> bool {
        n >= self.steps[0] && (n - self.steps[0] + 1).is_multiple_of(self.every)
    }

    /// Adds a sample: the state after step `n` and all its touching contacts.
    pub fn add(&mut self, sim: &Simulation, contacts: &[ContactForce<f64>], n: u64) {
        let body = &sim.obstacles[INTRUDER as usize];
        let place = |x: [f64; 4]| {
            let d = sim.domain.separation([x[0], x[1], x[2]], body.point);
            [d[0], d[1], x[2]]
        };
        // In the intruder's frame.
        let velocity = |v: [f64; 4]| [0, 1, 2].map(|a| v[a] - body.velocity[a]);
        let ball = |i: usize| Ball {
            centre: place(sim.position[i]),
            radius: sim.position[i][3],
            velocity: velocity(sim.velocity[i]),
        };
        let balls: Vec<Ball> = (0..sim.count()).map(ball).collect();
        let mut sorted: Vec<&ContactForce<f64>> = contacts.iter().collect();
        // One order for every list.
        sorted.sort_by_key(|c| match c.partner {
            Partner::Grain(j) => (0, c.i, j),
            Partner::Obstacle(k) => (1, c.i, k),
        });
        let force = |c: &ContactForce<f64>| {
            [0, 1, 2].map(|a| c.normal_force * c.normal[a] + c.tangential_force[a])
        };
        let branch = |c: &&ContactForce<f64>| {
            let i = c.i as usize;
            // An obstacle is met at its surface, a grain at its centre.
            let other = match c.partner {
                Partner::Grain(j) => sim.position[j as usize][3],
                Partner::Obstacle(_) => 0.0,
            };
            let length = sim.position[i][3] + other - c.overlap;
            Branch {
                from: balls[i].centre,
                along: c.normal.map(|x| -length * x),
                force: force(c),
            }
        };
        let branches: Vec<Branch> = sorted.iter().map(branch).collect();
        self.sums.add(&balls, &branches);
        let on_body = sorted
            .iter()
            .filter(|c| c.partner == Partner::Obstacle(INTRUDER));
        let pushes: Vec<(f64, [f64; 2])> = on_body
            .map(|c| {
                let x = sim.position[c.i as usize];
                let d = offset(&sim.domain, body, [x[0], x[1], x[2]]);
                let angle = libm::atan2(-d[2], self.forward * d[0]);
                let f = force(c);
                (angle, [self.forward * f[0], 0.0 - f[2]])
            })
            .collect();
        let [first, last] = self.steps;
        let part = (n - first) * PARTS as u64 / (last - first + 1);
        self.load.add(part as usize, &pushes);
    }

    /// The sums as little-endian words, for a checkpoint's array.
    pub fn array(&self) -> Vec<u8> {
        let words = self.sums.values.as_flattened().iter();
        words.flat_map(|x| x.to_le_bytes()).collect()
    }

    /// Takes the sums up again from such an array; `None` if it is of another length.
    #[must_use]
    pub fn with_array(mut self, bytes: &[u8]) -> Option<Self> {
        let (words, rest) = bytes.as_chunks::<8>();
        let reals: Vec<f64> = words.iter().map(|w| f64::from_le_bytes(*w)).collect();
        let (points, more) = reals.as_chunks::<NUMBERS>();
        let whole = rest.is_empty() && more.is_empty() && points.len() == self.sums.grid.points();
        self.sums.values = points.to_vec();
        (whole && self.load.is_whole()).then_some(self)
    }

    /// How many samples there are.
    pub fn samples(&self) -> u64 {
        self.sums.samples
    }

    /// Mean fields at every point.
    pub fn points(&self, hole: IntruderOutline) -> Fields {
        points(&self.sums, hole)
    }

    /// Mean fields in the plane x, z.
    pub fn plane(&self, hole: IntruderOutline) -> Fields {
        plane(&self.sums, hole)
    }

    /// Mean load on a cylinder of this length; `None` on a ball.
    pub fn load(&self, hole: IntruderOutline, length: f64) -> Option<Load> {
        let load = hole
            .cylinder
            .then(|| self.load.load(2.0 * hole.radius, length));
        load.flatten()
    }
}

/// The intruder of a state, as fields see it.
pub fn intruder_outline(sim: &Simulation) -> IntruderOutline {
    let body = &sim.obstacles[INTRUDER as usize];
    IntruderOutline {
        height: body.point[2],
        radius: body.reach(),
        cylinder: matches!(body.shape, Shape::Cylinder { .. }),
    }
}
