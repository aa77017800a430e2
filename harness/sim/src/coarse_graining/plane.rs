//! Mean fields in the plane x, z through the intruder, or at every point.

use super::grid::Grid;
use super::sums::{NUMBERS, Sums};

/// Least packing fraction of a mean: less is a grain that passed by, not a flow.
const THINNEST: f64 = 0.01;

/// What is known at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Flag {
    /// Its fields.
    #[default]
    Whole,
    /// The same, but the intruder, or what is below the floor, fills a part of the averaging window: there the
    /// stress is too low.
    Cut,
    /// Nothing: it is inside the intruder, or hardly a grain came by.
    Empty,
}

impl Flag {
    /// As tables have it: 0, 1 or 2.
    pub fn number(self) -> u8 {
        self as u8
    }

    /// What a table's number stands for.
    pub fn of(number: u8) -> Option<Self> {
        [Flag::Whole, Flag::Cut, Flag::Empty]
            .get(usize::from(number))
            .copied()
    }
}

/// Mean fields at a point. Velocities are those in the frame of the intruder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldPoint {
    /// Packing fraction of the window.
    pub packing_fraction: f64,
    /// Velocity, every volume alike (Guillard 2014, eq. A2).
    pub velocity: [f64; 3],
    /// Stress, compression positive (Guillard 2014, eq. A3, over the window's volume); rows are the directions
    /// of the force.
    pub stress: [[f64; 3]; 3],
}

impl FieldPoint {
    /// A third of the trace of the stress.
    pub fn pressure(&self) -> f64 {
        (self.stress[0][0] + self.stress[1][1] + self.stress[2][2]) / 3.0
    }

    /// `sqrt(s:s/2)` of the symmetric stress without its trace.
    pub fn shear_stress(&self) -> f64 {
        let p = self.pressure();
        let mut square = 0.0;
        for a in 0..3 {
            for b in 0..3 {
                let s = 0.5 * (self.stress[a][b] + self.stress[b][a]);
                let s = if a == b { s - p } else { s };
                square += s * s;
            }
        }
        (0.5 * square).sqrt()
    }
}

/// Fields on a grid; along y there may be one point, for the mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Fields {
    /// Where the points are.
    pub grid: Grid,
    /// What is known there, x fastest.
    pub flags: Vec<Flag>,
    /// The fields; meaningless if nothing is known.
    pub points: Vec<FieldPoint>,
}

/// An intruder as fields see it: in the middle of the box at this height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntruderOutline {
    /// Height of its centre or axis.
    pub height: f64,
    /// Its radius.
    pub radius: f64,
    /// Whether it is a cylinder along y.
    pub cylinder: bool,
}

impl IntruderOutline {
    /// How far a place lies from its centre or axis.
    pub fn distance(&self, [x, y, z]: [f64; 3]) -> f64 {
        let (y, z) = (if self.cylinder { 0.0 } else { y }, z - self.height);
        (x * x + y * y + z * z).sqrt()
    }
}

/// The fields of single points, each the mean over the samples.
pub fn points(sums: &Sums, hole: IntruderOutline) -> Fields {
    fields(sums.grid, &sums.values, sums, 1.0, hole)
}

/// The fields in the plane x, z: round a cylinder the mean along y too, round a ball those through its centre
/// (or just beside it, if the points along y are even in number).
pub fn plane(sums: &Sums, hole: IntruderOutline) -> Fields {
    let [nx, ny, nz] = sums.grid.counts;
    let mut grid = sums.grid;
    grid.counts[1] = 1;
    let layers = match hole.cylinder {
        true => 0..ny,
        false => ny / 2..ny / 2 + 1,
    };
    let mut values = vec![[0.0; NUMBERS]; nx * nz];
    for (place, sum) in values.iter_mut().enumerate() {
        let (kx, kz) = (place % nx, place / nx);
        for ky in layers.clone() {
            let point = &sums.values[(kz * ny + ky) * nx + kx];
            for (a, b) in sum.iter_mut().zip(point) {
                *a += b;
            }
        }
    }
    fields(grid, &values, sums, layers.len() as f64, hole)
}

/// From sums over `each` points at a time.
fn fields(
    grid: Grid,
    values: &[[f64; NUMBERS]],
    sums: &Sums,
    each: f64,
    hole: IntruderOutline,
) -> Fields {
    let windows = sums.volume() * sums.samples as f64 * each;
    let point = |v: &[f64; NUMBERS]| FieldPoint {
        packing_fraction: v[0] / windows,
        velocity: [v[1] / v[0], v[2] / v[0], v[3] / v[0]],
        stress: [0, 1, 2].map(|a| [0, 1, 2].map(|b| v[4 + 3 * a + b] / windows)),
    };
    let flag = |(k, v): (usize, &[f64; NUMBERS])| {
        let [nx, ny, _] = grid.counts;
        let at = [k % nx, k / nx % ny, k / nx / ny];
        let away = hole.distance([grid.at(0, at[0]), grid.at(1, at[1]), grid.at(2, at[2])]);
        match () {
            () if v[0] <= THINNEST * windows || away < hole.radius => Flag::Empty,
            () if away < hole.radius + sums.window => Flag::Cut,
            () if grid.at(2, at[2]) < sums.window => Flag::Cut,
            () => Flag::Whole,
        }
    };
    Fields {
        grid,
        flags: values.iter().enumerate().map(flag).collect(),
        points: values.iter().map(point).collect(),
    }
}

impl Fields {
    /// The fields at a point of a plane, if they are known.
    pub fn at(&self, kx: usize, kz: usize) -> Option<&FieldPoint> {
        let k = kz * self.grid.counts[0] + kx;
        (self.flags[k] != Flag::Empty).then(|| &self.points[k])
    }

    /// Norm of the shear rate, `sqrt(2 e:e)` with e the symmetric gradient of the velocity in the plane, at
    /// each point; `None` if a gradient is not known.
    pub fn shear_rates(&self) -> Vec<Option<f64>> {
        let [nx, _, nz] = self.grid.counts;
        let all = (0..nz).flat_map(|kz| (0..nx).map(move |kx| (kx, kz)));
        all.map(|(kx, kz)| self.shear_rate(kx, kz)).collect()
    }

    fn shear_rate(&self, kx: usize, kz: usize) -> Option<f64> {
        let [nx, _, nz] = self.grid.counts;
        let [step_x, _, step_z] = self.grid.step();
        let here = self.at(kx, kz)?;
        // The box goes on along x; below the lowest and above the highest points nothing is known.
        let (left, right) = (self.at((kx + nx - 1) % nx, kz), self.at((kx + 1) % nx, kz));
        let below = kz.checked_sub(1).and_then(|k| self.at(kx, k));
        let above = (kz + 1 < nz).then(|| self.at(kx, kz + 1)).flatten();
        let dx = slope(left, here, right, step_x)?;
        let dz = slope(below, here, above, step_z)?;
        let (xz, xy, yz) = (0.5 * (dz[0] + dx[2]), 0.5 * dx[1], 0.5 * dz[1]);
        let square = dx[0] * dx[0] + dz[2] * dz[2] + 2.0 * (xz * xz + xy * xy + yz * yz);
        Some((2.0 * square).sqrt())
    }
}

/// Change of the velocity over a length: from both neighbours, or from the one that is known.
fn slope(
    before: Option<&FieldPoint>,
    here: &FieldPoint,
    after: Option<&FieldPoint>,
    step: f64,
) -> Option<[f64; 3]> {
    let (from, to, steps) = match (before, after) {
        (Some(a), Some(b)) => (a, b, 2.0),
        (Some(a), None) => (a, here, 1.0),
        (None, Some(b)) => (here, b, 1.0),
        (None, None) => return None,
    };
    Some([0, 1, 2].map(|a| (to.velocity[a] - from.velocity[a]) / (steps * step)))
}

/// Inertial number `rate d sqrt(rho_g/P)`: shear rate, mean diameter, density of the grains, pressure; `None`
/// without a pressure.
pub fn inertial_number(rate: f64, diameter: f64, density: f64, pressure: f64) -> Option<f64> {
    (pressure > 0.0).then(|| rate * diameter * (density / pressure).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::sums::Ball;
    use super::*;

    const HOLE: IntruderOutline = IntruderOutline {
        height: 5.0,
        radius: 1.0,
        cylinder: true,
    };

    /// A cubic lattice that is sheared, or turned like a rigid body, about the middle of the box.
    fn lattice(of: fn([f64; 3]) -> [f64; 3]) -> Sums {
        let grid = Grid {
            counts: [20, 3, 20],
            size: [10.0, 4.0, 10.0],
        };
        let mut sums = Sums::new(grid, 1.0);
        let mut balls = Vec::new();
        for k in 0..400 {
            let (i, j, l) = (k % 10, k / 10 % 4, k / 40);
            let centre = [i as f64 - 4.5, j as f64 - 1.5, l as f64 + 0.5];
            balls.push(Ball {
                centre,
                radius: 0.5,
                velocity: of(centre),
            });
        }
        sums.add(&balls, &[]);
        sums.add(&balls, &[]);
        sums
    }

    /// A uniform shear of a given rate gives that rate. On a lattice the window's mean place is not quite its
    /// centre, which is why a rate is off by up to a twentieth from one point to the next, and right in the
    /// mean.
    #[test]
    fn uniform_shear_gives_its_rate() {
        let fields = plane(&lattice(|x| [0.3 * x[2], 0.0, 0.0]), HOLE);
        let rates = fields.shear_rates();
        // Two cells from floor and top, where windows are cut off.
        let inside: Vec<f64> = (4..16)
            .flat_map(|kz| (0..20).map(move |kx| (kx, kz)))
            .filter(|&(kx, kz)| fields.flags[kz * 20 + kx] == Flag::Whole)
            .filter_map(|(kx, kz)| rates[kz * 20 + kx])
            .collect();
        let mean = inside.iter().sum::<f64>() / inside.len() as f64;
        assert!((mean - 0.3).abs() < 0.003, "{mean}");
        assert!(inside.len() > 100);
        assert!(inside.iter().all(|r| (r - 0.3).abs() < 0.05), "{inside:?}");
    }

    #[test]
    fn a_rigid_turn_is_no_shear() {
        let fields = plane(&lattice(|x| [0.3 * (x[2] - 5.0), 0.0, -0.3 * x[0]]), HOLE);
        let rates = fields.shear_rates();
        let mut told = 0;
        for kz in 4..16 {
            // Away from the edge, where the turn of this box meets that of its neighbour.
            for kx in 4..16 {
                if let Some(rate) = rates[kz * 20 + kx] {
                    assert!(rate < 0.06, "{kx} {kz}: {rate}");
                    told += 1;
                }
            }
        }
        assert!(told > 100, "{told}");
    }

    #[test]
    fn what_the_intruder_fills_or_cuts_is_said() {
        let fields = plane(&lattice(|_| [1.0, 2.0, 3.0]), HOLE);
        let flag = |x: f64, z: f64| {
            let (kx, kz) = (((x + 5.0) / 0.5) as usize, (z / 0.5) as usize);
            fields.flags[kz * 20 + kx]
        };
        assert_eq!(flag(0.0, 5.0), Flag::Empty);
        assert_eq!(flag(1.5, 5.0), Flag::Cut);
        assert_eq!(flag(3.0, 5.0), Flag::Whole);
        assert_eq!(
            [0.2, 0.8, 1.2].map(|z| flag(3.0, z)),
            [Flag::Cut, Flag::Cut, Flag::Whole]
        );
        let whole = fields.flags.iter().position(|f| *f == Flag::Whole).unwrap();
        for (got, want) in fields.points[whole].velocity.iter().zip([1.0, 2.0, 3.0]) {
            assert!((got - want).abs() < 1e-12, "{got}");
        }
        assert_eq!([0, 1, 2].map(|k| Flag::of(k).unwrap().number()), [0, 1, 2]);
        assert_eq!(Flag::of(3), None);
        // Where no grain came by nothing is known.
        let none = points(&Sums::new(fields.grid, 1.0), HOLE);
        assert!(none.flags.iter().all(|f| *f == Flag::Empty));
        assert!(none.shear_rates().iter().all(Option::is_none));
    }

    /// Mean density of a cubic lattice, each grain in a cube of side 1; a grid that goes with the lattice sees
    /// some places of it more often than others, and is off by half a per cent.
    #[test]
    fn packing_fractions_and_stresses_are_means() {
        let fields = plane(&lattice(|_| [0.0; 3]), HOLE);
        let inside = (4..16).flat_map(|kz| (0..20).map(move |kx| kz * 20 + kx));
        let solid: Vec<f64> = inside.map(|k| fields.points[k].packing_fraction).collect();
        let mean = solid.iter().sum::<f64>() / solid.len() as f64;
        assert!((mean - std::f64::consts::PI / 6.0).abs() < 5e-3, "{mean}");
        let point = FieldPoint {
            packing_fraction: 0.6,
            velocity: [0.0; 3],
            stress: [[3.0, 0.5, 0.0], [1.5, 2.0, 0.0], [0.0, 0.0, 1.0]],
        };
        assert_eq!(point.pressure(), 2.0);
        assert_eq!(point.shear_stress(), 2.0_f64.sqrt());
        let same = inertial_number(2.0, 0.5, 4.0, 16.0);
        assert_eq!(same, Some(0.5));
        assert_eq!(inertial_number(2.0, 0.5, 4.0, 0.0), None);
    }
}
