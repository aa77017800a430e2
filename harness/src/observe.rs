//! What is read off a state: free surface, packing fraction, coordination, support of the weight.
//!
//! Every function reads and none changes a state; sums run by ascending id.

use bitgrain_kernel::Bond;

use crate::sim::Sim;
use crate::summary::Mean;

/// Number of the intruder among the obstacles of a bed.
pub const INTRUDER: u32 = 0;

/// Height of the free surface: the median, over square columns about two mean diameters wide, of
/// the highest grain top; columns without grains are left out.
pub fn surface_height(sim: &Sim, mean_diameter: f64) -> f64 {
    let (lo, hi) = (sim.domain.lo(), sim.domain.hi());
    let columns = |a: usize| (((hi[a] - lo[a]) / (2.0 * mean_diameter)) as usize).max(1);
    let (nx, ny) = (columns(0), columns(1));
    let mut tops = vec![f64::NEG_INFINITY; nx * ny];
    for x in &sim.position {
        let place = |a: usize, n: usize| {
            let k = ((x[a] - lo[a]) / (hi[a] - lo[a]) * n as f64) as usize;
            k.min(n - 1)
        };
        let top = &mut tops[place(1, ny) * nx + place(0, nx)];
        if x[2] + x[3] > *top {
            *top = x[2] + x[3];
        }
    }
    tops.retain(|top| top.is_finite());
    tops.sort_by(f64::total_cmp);
    match tops.len() {
        0 => 0.0,
        n if n % 2 == 1 => tops[n / 2],
        n => 0.5 * (tops[n / 2 - 1] + tops[n / 2]),
    }
}

/// Volume of the part of a ball below the plane at height `z`.
fn ball_below(center: f64, radius: f64, z: f64) -> f64 {
    let h = (z - (center - radius)).clamp(0.0, 2.0 * radius);
    std::f64::consts::PI * h * h * (radius - h / 3.0)
}

/// Solid fraction of the layer between two heights, the intruder's part of it left out.
pub fn packing_fraction(sim: &Sim, from: f64, to: f64, intruder: ([f64; 3], f64)) -> f64 {
    let (lo, hi) = (sim.domain.lo(), sim.domain.hi());
    let within = |z: f64, r: f64| ball_below(z, r, to) - ball_below(z, r, from);
    let solid: f64 = sim.position.iter().map(|x| within(x[2], x[3])).sum();
    let room = (hi[0] - lo[0]) * (hi[1] - lo[1]) * (to - from);
    solid / (room - within(intruder.0[2], intruder.1))
}

/// Mean number of contacts, with grains and obstacles, of the free grains whose centres lie below
/// `top`; 0 where there are none.
pub fn coordination_number(sim: &mut Sim, top: f64) -> f64 {
    let bonds = sim.bonds();
    let counted = |place: u32| {
        let i = place as usize;
        !sim.groups[sim.group[i] as usize].heavy && sim.position[i][2] < top
    };
    let mut contacts = 0usize;
    for bond in &bonds {
        match *bond {
            Bond::Pair { i, j, .. } => {
                contacts += usize::from(counted(i)) + usize::from(counted(j))
            }
            Bond::Touch { i, .. } => contacts += usize::from(counted(i)),
        }
    }
    let grains = (0..sim.count() as u32).filter(|&i| counted(i)).count();
    if grains == 0 {
        0.0
    } else {
        contacts as f64 / grains as f64
    }
}

/// Deepest overlap of two grains, from the positions; 0 where none touch.
pub fn deepest_overlap(sim: &mut Sim) -> f64 {
    let mut deepest = 0.0;
    for bond in sim.bonds() {
        let Bond::Pair { i, j, .. } = bond else {
            continue;
        };
        let (x, y) = (sim.position[i as usize], sim.position[j as usize]);
        let d = sim
            .domain
            .separation([x[0], x[1], x[2]], [y[0], y[1], y[2]]);
        let overlap = x[3] + y[3] - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        if overlap > deepest {
            deepest = overlap;
        }
    }
    deepest
}

/// Free grains, their weight, and the upward force that base, planes and intruder put on them (by
/// the third law: what the frozen grains and the obstacles feel downward).
pub fn weight_and_support(sim: &Sim, gravity: f64) -> (usize, f64, f64) {
    let (mut free, mut weight, mut support) = (0, 0.0, 0.0);
    for i in 0..sim.count() {
        if sim.groups[sim.group[i] as usize].heavy {
            support -= sim.force[i][2];
        } else {
            free += 1;
            weight += sim.velocity[i][3] * gravity;
        }
    }
    for body in &sim.obstacles {
        support -= body.force[2];
    }
    (free, weight, support)
}

/// Number of blocks that standard errors come from.
pub const BLOCKS: u64 = 8;

/// Sums of a quantity over a window of a known number of steps, in step order: over all of it and
/// over each of 8 equal blocks.
#[derive(Clone, Debug)]
pub struct BlockSums {
    window: u64,
    steps: u64,
    all: f64,
    blocks: [f64; BLOCKS as usize],
}

impl BlockSums {
    /// For a window of this many steps, at least 8.
    pub fn new(window: u64) -> Self {
        Self {
            window,
            steps: 0,
            all: 0.0,
            blocks: [0.0; BLOCKS as usize],
        }
    }

    /// Adds the next step's value. Steps left over after the eighth block count in the mean alone.
    pub fn add(&mut self, value: f64) {
        self.all += value;
        let block = self.steps / (self.window / BLOCKS).max(1);
        if let Some(sum) = self.blocks.get_mut(block as usize) {
            *sum += value;
        }
        self.steps += 1;
    }

    /// The mean, and its standard error from the means of the blocks.
    pub fn mean(&self) -> Mean {
        let size = (self.window / BLOCKS).max(1) as f64;
        let means = self.blocks.map(|sum| sum / size);
        let middle = means.iter().sum::<f64>() / BLOCKS as f64;
        let spread: f64 = means.iter().map(|b| (b - middle) * (b - middle)).sum();
        let variance = spread / (BLOCKS - 1) as f64;
        Mean {
            mean: self.all / self.steps as f64,
            standard_error: (variance / BLOCKS as f64).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ball_volumes_add_up() {
        let whole = ball_below(0.0, 0.5, 1.0);
        assert!((whole - std::f64::consts::PI / 6.0).abs() < 1e-15);
        assert!((ball_below(0.0, 0.5, 0.0) - whole / 2.0).abs() < 1e-15);
        assert_eq!(ball_below(0.0, 0.5, -0.5), 0.0);
    }

    #[test]
    fn block_mean_of_eight_known_blocks() {
        let mut sums = BlockSums::new(17);
        (0..16).for_each(|k| sums.add(f64::from(k / 2)));
        sums.add(3.5);
        let mean = sums.mean();
        assert_eq!(mean.mean, 3.5);
        // Variance of 0..7 is 6; over 8 blocks.
        assert!((mean.standard_error - (6.0f64 / 8.0).sqrt()).abs() < 1e-15);
    }
}
