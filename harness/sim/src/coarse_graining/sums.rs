//! Sums over averaging windows about the points of a grid: volume and momentum of the grains inside, and what
//! the contacts inside add to the stress (Guillard 2014, eqs. A2 and A3).

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::grid::Grid;
use super::window::{lens, part_inside};

/// Numbers of a point: volume, volume times velocity, and force times branch, all inside its window.
pub const NUMBERS: usize = 13;

/// A grain, as the grid has its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub centre: [f64; 3],
    /// Its radius.
    pub radius: f64,
    /// Its velocity.
    pub velocity: [f64; 3],
}

/// A contact: the straight line between the centres of two grains, or from a grain's centre to where it touches
/// an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// Where the grain's centre is.
    pub from: [f64; 3],
    /// From there to the partner.
    pub along: [f64; 3],
    /// Force on the grain.
    pub force: [f64; 3],
}

/// Sums over all samples.
///
/// Grains and then contacts are added in the order given, point by point, so that the sums do not depend on
/// the number of threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sums {
    /// The points, x fastest.
    pub grid: Grid,
    /// Radius R of the windows.
    pub window: f64,
    /// How many samples.
    pub samples: u64,
    /// The sums of each point; a checkpoint keeps them in a separate array.
    #[serde(skip)]
    pub values: Vec<[f64; NUMBERS]>,
}

impl Sums {
    /// Nothing summed so far.
    pub fn new(grid: Grid, window: f64) -> Self {
        Self {
            grid,
            window,
            samples: 0,
            values: vec![[0.0; NUMBERS]; grid.points()],
        }
    }

    /// Volume of a window.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * (self.window * self.window * self.window)
    }

    /// Adds one state.
    pub fn add(&mut self, balls: &[Ball], branches: &[Branch]) {
        let (grid, window) = (self.grid, self.window);
        let ball_layers = self.layers(balls, |b| (b.centre, b.radius));
        let branch_layers = self.layers(branches, Branch::hull);
        let layer = grid.counts[0] * grid.counts[1];
        self.values
            .par_chunks_mut(layer)
            .enumerate()
            .for_each(|(k, points)| {
                let z = grid.at(2, k);
                let mut points = Layer { grid, z, points };
                for &i in &ball_layers[k] {
                    points.add_ball(&balls[i as usize], window);
                }
                for &i in &branch_layers[k] {
                    points.add_branch(&branches[i as usize], window);
                }
            });
        self.samples += 1;
    }

    /// Which of some things may reach into the windows of each layer of points, in their order.
    fn layers<T>(&self, things: &[T], ball: impl Fn(&T) -> ([f64; 3], f64)) -> Vec<Vec<u32>> {
        let mut layers = vec![Vec::new(); self.grid.counts[2]];
        for (i, thing) in things.iter().enumerate() {
            let (centre, radius) = ball(thing);
            for (k, _) in self.grid.near(2, centre[2], self.window + radius) {
                layers[k].push(i as u32);
            }
        }
        layers
    }
}

impl Branch {
    /// A ball round the line.
    fn hull(&self) -> ([f64; 3], f64) {
        let [x, y, z] = self.along;
        let half = 0.5 * (x * x + y * y + z * z).sqrt();
        ([0, 1, 2].map(|a| self.from[a] + 0.5 * self.along[a]), half)
    }
}

/// Points at one height.
struct Layer<'a> {
    grid: Grid,
    z: f64,
    points: &'a mut [[f64; NUMBERS]],
}

impl Layer<'_> {
    /// Calls `add` with the sums of each point within `reach` of a place and the way there from it.
    fn near(
        &mut self,
        place: [f64; 3],
        reach: f64,
        mut add: impl FnMut(&mut [f64; NUMBERS], [f64; 3]),
    ) {
        let z = self.z - place[2];
        // The points are on a circle of the ball's.
        let left = reach * reach - z * z;
        if left <= 0.0 {
            return;
        }
        let across = left.sqrt();
        let columns = self.grid.near(0, place[0], across);
        for (ky, y) in self.grid.near(1, place[1], across) {
            for (kx, x) in columns.clone() {
                if x * x + y * y < left {
                    add(&mut self.points[ky * self.grid.counts[0] + kx], [x, y, z]);
                }
            }
        }
    }

    fn add_ball(&mut self, ball: &Ball, window: f64) {
        let (radius, v) = (ball.radius, ball.velocity);
        self.near(ball.centre, window + radius, |point, [x, y, z]| {
            let inside = lens(window, radius, (x * x + y * y + z * z).sqrt());
            point[0] += inside;
            for a in 0..3 {
                point[1 + a] += inside * v[a];
            }
        });
    }

    fn add_branch(&mut self, branch: &Branch, window: f64) {
        let (centre, half) = branch.hull();
        let (f, l) = (branch.force, branch.along);
        self.near(centre, window + half, |point, [x, y, z]| {
            let from = [-x - 0.5 * l[0], -y - 0.5 * l[1], -z - 0.5 * l[2]];
            let to = [-x + 0.5 * l[0], -y + 0.5 * l[1], -z + 0.5 * l[2]];
            let part = part_inside(from, to, window);
            for a in 0..3 {
                for b in 0..3 {
                    // Compression is positive: the force on the grain points away from its partner.
                    point[4 + 3 * a + b] -= part * f[a] * l[b];
                }
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grid so fine that a sum over its points is an integral to a few parts in ten thousand.
    fn fine() -> Sums {
        let grid = Grid {
            counts: [50, 40, 60],
            size: [10.0, 8.0, 12.0],
        };
        Sums::new(grid, 1.3)
    }

    fn total(sums: &Sums) -> [f64; NUMBERS] {
        let cell: f64 = sums.grid.step().iter().product();
        let mut all = [0.0; NUMBERS];
        for point in &sums.values {
            for (a, v) in all.iter_mut().zip(point) {
                *a += v * cell / sums.volume();
            }
        }
        all
    }

    /// Every grain is shared out among the windows: volumes and momenta add up to those of the grains, across the
    /// edges of the box too.
    #[test]
    fn volume_and_momentum_are_those_of_the_grains() {
        let ball = |centre, radius, velocity| Ball {
            centre,
            radius,
            velocity,
        };
        let balls = [
            ball([0.1, 0.2, 6.0], 0.5, [1.0, -2.0, 3.0]),
            ball([-4.9, 3.9, 5.0], 0.4, [0.5, 0.0, -1.0]),
            ball([4.7, -3.8, 7.3], 0.6, [-3.0, 1.0, 2.0]),
        ];
        let mut sums = fine();
        sums.add(&balls, &[]);
        let all = total(&sums);
        let volume = |b: &Ball| lens(b.radius, b.radius, 0.0);
        // The sum over points is off the integral by so much on this grid; it falls as the grid gets finer.
        let near = |got: f64, want: f64| assert!((got - want).abs() < 2e-3, "{got} {want}");
        near(all[0], balls.iter().map(volume).sum());
        for a in 0..3 {
            let momentum = balls.iter().map(|b| volume(b) * b.velocity[a]).sum();
            near(all[1 + a], momentum);
        }
        assert_eq!(all[4..], [0.0; 9]);
    }

    /// The mean stress is the virial: over all windows each contact gives its force times its branch.
    #[test]
    fn stress_is_the_virial() {
        let branch = |from, along, force| Branch { from, along, force };
        let branches = [
            branch([0.0, 0.1, 6.0], [0.9, 0.2, -0.3], [-5.0, -1.0, 1.0]),
            branch([4.8, -3.9, 5.0], [0.6, -0.5, 0.4], [-2.0, 3.0, -1.0]),
        ];
        let mut sums = fine();
        sums.add(&[], &branches);
        let all = total(&sums);
        assert_eq!(all[..4], [0.0; 4]);
        for a in 0..3 {
            for b in 0..3 {
                let virial: f64 = branches.iter().map(|c| -c.force[a] * c.along[b]).sum();
                let got = all[4 + 3 * a + b];
                assert!((got - virial).abs() < 2e-2, "{a} {b}: {got} {virial}");
            }
        }
        // A force that pushes a grain from its partner is a pressure.
        assert!(all[4] > 0.0);
    }

    /// Threads share out layers, never the order within a point.
    #[test]
    fn threads_do_not_change_a_bit() {
        let ball = |k: u32| {
            let x = f64::from(k);
            Ball {
                centre: [libm::sin(x) * 5.0, libm::sin(1.7 * x) * 4.0, 0.1 * x],
                radius: 0.5,
                velocity: [libm::cos(x), x, 1.0 / (1.0 + x)],
            }
        };
        let balls: Vec<Ball> = (0..120).map(ball).collect();
        let sums = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let mut sums = fine();
            pool.build().unwrap().install(|| sums.add(&balls, &[]));
            sums
        };
        assert_eq!(sums(1), sums(3));
    }
}
